"""Variants: numbers drawn from a student's name, the same name always the same, put where a text has ``{A}``."""

import hashlib
import re
import unicodedata
from collections.abc import Mapping

from app.lessons.lesson import Lesson

PLACE = re.compile(r"\{([A-Za-z]\w*)\}")

Numbers = Mapping[str, float | int | str]


def drawn(lesson: Lesson, name: str) -> Numbers:
    """The numbers of whoever is called so; those without a name get the first."""
    plain = " ".join(unicodedata.normalize("NFKC", name).casefold().split())
    if not plain:
        return lesson.variants[0]
    digest = hashlib.sha256(f"{lesson.name}\n{plain}".encode()).digest()
    return lesson.variants[int.from_bytes(digest[:8], "big") % len(lesson.variants)]


def filled(text: str, numbers: Numbers) -> str:
    """The text with the numbers in their places. Other braces, those of formulas, stay."""
    return PLACE.sub(lambda found: f"{numbers[found[1]]}" if found[1] in numbers else found[0], text)
