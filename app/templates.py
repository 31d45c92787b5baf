"""Text files with placeholders ``{{name}}``, and ``{{"Play"}}`` for translated texts; hashes of scripts."""

import base64
import hashlib
import re
from html import escape
from pathlib import Path

from app.language.translation import tr


def render_template(file: Path, **parts: object) -> str:
    """Returns a file's text with ``parts`` in its placeholders as they are, and its texts translated and escaped."""
    return re.sub(r"\{\{(?:(\w+)|\"([^\"]+)\")\}\}",
                  lambda place: f"{parts[place[1]]}" if place[1] else escape(tr(place[2])),
                  file.read_text(encoding="utf-8"))


def script_source(script: str) -> str:
    """Returns the source for the script-src of a Content-Security-Policy that lets this script run: its SHA-256, as a
    browser computes it, with normalised line endings."""
    plain = script.replace("\r\n", "\n").replace("\r", "\n")
    return f"'sha256-{base64.b64encode(hashlib.sha256(plain.encode()).digest()).decode()}'"
