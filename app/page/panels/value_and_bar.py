"""Texts of a value and its error bar."""

import math

from app.language.translation import localise_number
from app.names_and_units import with_unit


def value_and_bar(value: float, bar: float | None, unit: str) -> tuple[str, str]:
    """Returns a value and its error bar as texts in one unit, both to the second digit of the bar: 1.79 m, 0.03 m; the
    second is "" if there is no bar."""
    if bar is None or not 0 < bar < math.inf:
        return signed_with_unit(value, unit), ""
    size = with_unit(max(abs(value), bar), unit).split()[-1]  # with its prefix
    factor = {"k": 1e3, "M": 1e6, "G": 1e9, "m": 1e-3, "µ": 1e-6, "n": 1e-9}.get(size[:-len(unit)], 1.0)
    places = max(0, 1 - math.floor(math.log10(bar / factor)))
    texts = (localise_number(f"{number / factor:,.{places}f}").replace("-", "−") for number in (value, bar))
    return tuple(f"{text} {size}" for text in texts)  # type: ignore[return-value]


def signed_with_unit(value: float, unit: str) -> str:
    """Formats a value with its unit and prefix, and with a minus sign if it is negative: −3.29 m."""
    return with_unit(value, unit).replace("-", "−")
