"""Text that is content stands in files of its own; what changes in it has its place there: ``{{name}}``."""

import re
from pathlib import Path


def rendered(file: Path, **parts: object) -> str:
    """The text of a file with the parts in their places."""
    return re.sub(r"\{\{(\w+)\}\}", lambda place: f"{parts[place[1]]}", file.read_text(encoding="utf-8"))
