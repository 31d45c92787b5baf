"""Numbers as people and files write them, read in one way: ASCII digits with a point and an exponent, nothing else.

Python's own ``float`` and ``int`` take more: ``4_0``, digits of every script, ``inf``, ``nan``, numbers of any length.
"""

import math
import re

NUMERAL = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:e[+-]?\d+)?", re.ASCII | re.IGNORECASE)
WHOLE = re.compile(r"[+-]?\d+", re.ASCII)
LONGEST = 60  # characters; the shortest that gives any double to its last bit has 24
LARGEST_EXACT = 1e15  # "1e3" is a fine way to write 1000, but a float this large no longer means one integer


def parse_float(text: str) -> float:
    """The finite number that a text is; :class:`ValueError` where it is none."""
    bare = text.strip(" ") if len(text) <= LONGEST else ""
    if not NUMERAL.fullmatch(bare) or not math.isfinite(value := float(bare)):
        raise ValueError("is no number")
    return value


def parse_number(text: str) -> int | float:
    """The same, as a whole number where the text is one, with an exponent too."""
    value = parse_float(text)
    if WHOLE.fullmatch(text.strip(" ")):
        return int(text)
    return int(value) if value.is_integer() and abs(value) < LARGEST_EXACT and "e" in text.lower() else value


def parse_count(text: str) -> int | None:
    """A whole number from 0 on, of at most nine digits and nothing else; None where the text is none."""
    return int(text) if re.fullmatch("[0-9]{1,9}", text) else None


def is_number(text: str) -> bool:
    """Whether a text is a finite number."""
    try:
        parse_float(text)
    except ValueError:
        return False
    return True
