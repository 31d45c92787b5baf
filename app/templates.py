"""Texts in files of their own, with places ``{{name}}``, and ``{{"Play"}}`` for words that are translated."""

import re
from html import escape
from pathlib import Path

from app.language.translation import tr


def render_template(file: Path, **parts: object) -> str:
    """The text of a file with the parts in their places, and its words in the language that is spoken."""
    return re.sub(r"\{\{(?:(\w+)|\"([^\"]+)\")\}\}",
                  lambda place: f"{parts[place[1]]}" if place[1] else escape(tr(place[2])),
                  file.read_text(encoding="utf-8"))
