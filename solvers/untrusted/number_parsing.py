"""Parsing of numbers from people and files: ASCII digits with a point and an exponent, nothing else.

Python's own ``float`` and ``int`` accept more: ``4_0``, digits of every script, ``inf``, ``nan``, numbers of any
length.
"""

import math
import re

NUMERAL = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:e[+-]?\d+)?", re.ASCII | re.IGNORECASE)
WHOLE = re.compile(r"[+-]?\d+", re.ASCII)
LONGEST = 60  # characters; the shortest that gives any double to its last bit has 24
LARGEST_EXACT = 1e15  # "1e3" is a fine way to write 1000, but a float this large no longer means one integer


def parse_float(text: str) -> float:
    """Returns the finite number in a text. Raises :class:`ValueError` where there is none."""
    bare = text.strip(" ") if len(text) <= LONGEST else ""
    if not NUMERAL.fullmatch(bare) or not math.isfinite(value := float(bare)):
        raise ValueError("is no number")
    return value


def parse_number(text: str) -> int | float:
    """Returns the finite number in a text, as an int if it is whole, with an exponent too. Raises
    :class:`ValueError`."""
    value = parse_float(text)
    if WHOLE.fullmatch(text.strip(" ")):
        return int(text)
    return int(value) if value.is_integer() and abs(value) < LARGEST_EXACT and "e" in text.lower() else value


def parse_count(text: str) -> int | None:
    """Returns a whole number from 0 on, of at most nine digits and nothing else; None for other texts."""
    return int(text) if re.fullmatch("[0-9]{1,9}", text) else None


def is_number(text: str) -> bool:
    """Returns whether a text is a finite number."""
    try:
        parse_float(text)
    except ValueError:
        return False
    return True
