"""Text files with placeholders ``{{name}}``, and ``{{"Play"}}`` for translated texts."""

import re
from html import escape
from pathlib import Path

from app.language.translation import tr


def render_template(file: Path, **parts: object) -> str:
    """Returns a file's text with ``parts`` in its placeholders as they are, and its texts translated and escaped."""
    return re.sub(r"\{\{(?:(\w+)|\"([^\"]+)\")\}\}",
                  lambda place: f"{parts[place[1]]}" if place[1] else escape(tr(place[2])),
                  file.read_text(encoding="utf-8"))
