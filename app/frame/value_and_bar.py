"""Texts of a value and its error bar, and of other values in one unit."""

import math
from collections.abc import Sequence

from app.language.translation import localise_number
from app.names_and_units import with_unit


def value_and_bar(value: float, bar: float | None, unit: str) -> tuple[str, str]:
    """Returns a value and its error bar as texts in one unit, both to the second digit of the bar: 1.79 m, 0.03 m; the
    second is "" if there is no bar."""
    if bar is None or not 0 < bar < math.inf:
        return with_unit(value, unit).replace("-", "−"), ""
    size, factor = _prefixed_unit((value, bar), unit)
    places = max(0, 1 - math.floor(math.log10(bar / factor)))
    texts = (localise_number(f"{number / factor:,.{places}f}").replace("-", "−") for number in (value, bar))
    return tuple(f"{text} {size}" for text in texts)  # type: ignore[return-value]


def in_one_unit(values: Sequence[float], unit: str) -> list[str]:
    """Formats round values with one unit and prefix: −0.5 m, 0 m, 1 m."""
    size, factor = _prefixed_unit(values, unit)
    return [f"{localise_number(f'{value / factor + 0:.4g}')} {size}".replace("-", "−") for value in values]


def _prefixed_unit(values: Sequence[float], unit: str) -> tuple[str, float]:
    """Returns the unit with the prefix that suits the largest size of the values, and that prefix' factor."""
    size = with_unit(max(map(abs, values)), unit).split()[-1]
    return size, {"k": 1e3, "M": 1e6, "G": 1e9, "m": 1e-3, "µ": 1e-6, "n": 1e-9}.get(size[:-len(unit)], 1.0)
