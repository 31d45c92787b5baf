"""The numbers that the paper prints in its Tables 1 to 3, by row, and how it writes them."""

import functools
import json
from pathlib import Path

FILE = Path(__file__).parents[3] / "assets" / "reference" / "paper.json"
KEYS = {"err_x": "x", "err_v": "v", "err_sigma": "sigma_log", "err_a": "a_nodes"}


@functools.cache
def _numbers() -> dict:
    return json.loads(FILE.read_text(encoding="utf-8"))


def bar(modulus: float, cells: int) -> dict[str, float]:
    """Table 1: errors, ``grid_crossings`` and the indices ``index_x`` ...; empty for a row that it has not."""
    for case in _numbers()["table1"]["cases"]:
        for row in case["rows"]:
            if case["modulus"] == modulus and row["cells"] == cells:
                return {KEYS.get(key, key): value for key, value in row.items() if key != "cells"}
    return {}


def ring_errors(method: str, cells: int) -> dict[str, float]:
    """Table 2: errors of x, v and of the acceleration."""
    return {KEYS[key]: value for key, value in _ring_row("table2", cells).get(method, {}).items()}


def ring_index(method: str, cells: int) -> dict[str, float]:
    """Table 3: the index of the displacement error."""
    row = _ring_row("table3", cells)
    return {"index_x": row[method]} if method in row else {}


def _ring_row(table: str, cells: int) -> dict:
    return next((row for row in _numbers()[table]["rows"] if row["cells"] == cells), {})


def digits(value: float, count: int) -> str:
    """A number with so many significant digits, with an exponent only where it is shorter: 3.49e-6, 0.0581."""
    mantissa, _, exponent = f"{value:.{count - 1}e}".partition("e")
    power = int(exponent)
    return f"{value:.{max(0, count - 1 - power)}f}" if -2 <= power <= 2 else f"{mantissa}e{power}"


def short(value: float) -> str:
    """A round number: 0.025, 2.5e-4, 1e7."""
    mantissa, _, exponent = f"{value:.1e}".partition("e")
    return f"{value:g}" if 1e-3 <= value < 1e4 else f"{mantissa.removesuffix('.0')}e{int(exponent)}"
