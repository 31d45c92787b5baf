"""What the player needs to draw the variant of a name as ``app.lessons.lesson`` does: Unicode's rules of case."""

import sys
from collections.abc import Iterator


def folds() -> dict[str, str]:
    """The letters whose case is folded otherwise than by making them small."""
    return {letter: letter.casefold() for letter in _letters() if letter.casefold() != letter.lower()}


def spaces() -> str:
    """All letters at which Python splits a text."""
    return "".join(letter for letter in _letters() if letter.isspace())


def _letters() -> Iterator[str]:
    return (chr(code) for code in range(sys.maxunicode + 1) if not 0xD800 <= code < 0xE000)
