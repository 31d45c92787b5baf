"""Parsing of numbers from people and files: ASCII digits with a point and an exponent, nothing else.

Python's own ``float`` and ``int`` accept more: ``4_0``, digits of any script, ``inf``, ``nan``, numbers of any length.
"""

import math
import re

NUMERAL = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:e[+-]?\d+)?", re.ASCII | re.IGNORECASE)
WHOLE = re.compile(r"[+-]?\d+", re.ASCII)
LONGEST = 60  # characters; the shortest that gives any double to its last bit has 24
LARGEST_EXACT = 1e15  # "1e3" is a fine way to write 1000, but a float this large no longer means one integer


def parse_float(text: str) -> float:
    """Returns the finite number that a text is, "-1.5e3" for example. Raises :class:`ValueError` for other texts."""
    bare = text.strip(" ") if len(text) <= LONGEST else ""
    if not NUMERAL.fullmatch(bare) or not math.isfinite(value := float(bare)):
        raise ValueError("is no number")
    return value


def parse_number(text: str) -> int | float:
    """Returns the finite number that a text is: an int for "12" and "1e3", otherwise a float, for "1.0" too. Raises
    :class:`ValueError` for other texts."""
    value = parse_float(text)
    if WHOLE.fullmatch(text.strip(" ")):
        return int(text)
    return int(value) if value.is_integer() and abs(value) < LARGEST_EXACT and "e" in text.lower() else value


def parse_count(text: str) -> int | None:
    """Returns the whole number that a text of one to nine ASCII digits is; None for other texts."""
    return int(text) if re.fullmatch("[0-9]{1,9}", text) else None


def is_number(text: str) -> bool:
    """Returns whether a text is a finite number that :func:`parse_float` takes."""
    try:
        parse_float(text)
    except ValueError:
        return False
    return True
