"""Texts that stand beside the code in files of Markdown, part by part, and are filled with numbers."""

import string
from pathlib import Path


class Template(string.Template):
    """Markdown with formulas, in which ``@name`` stands for something: dollars and braces are taken."""

    delimiter = "@"


def read(path: Path, **values: float | str) -> dict[str, str]:
    """The parts of a file by their headings, ``## name``, each as one line. In a part ``@name`` stands for a value,
    numbers to 15 digits, or for a part further up."""
    parts = {name: value if isinstance(value, str) else f"{value:.15g}" for name, value in values.items()}
    for part in path.read_text(encoding="utf-8").split("\n## ")[1:]:
        head, _, text = part.partition("\n")
        parts[head] = Template(" ".join(text.split())).substitute(parts)
    return parts
