"""SizeControl: a number that may be of any size, as a slider whose steps are factors and as text to read and type."""

import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import viser

from app.page.panels.head import LOGARITHMIC, TYPED
from app.words import size_in, with_unit

TYPING = 0.8  # seconds without another key, after which what has been typed counts
STEP = 0.005  # of the slider, in powers of ten
DIGITS = 6


@dataclass(frozen=True)
class Size:
    """What the number is: name, unit, the reach of its slider, and the default, which the slider meets exactly."""

    name: str
    unit: str
    reach: tuple[float, float]
    default: float
    hint: str


class SizeControl:
    """Two widgets that show one number. ``act`` is called with a number that the visitor has set, ``refuse`` with a
    sentence about text that is none; ``follow`` binds a widget to what happens when the visitor, and nobody else,
    changes it, and what is done ``in_turn`` is not done once the widgets have gone."""

    def __init__(self, gui: viser.GuiApi, size: Size, value: float, act: Callable[[float], None],
                 refuse: Callable[[str], None], follow: Callable[[Any, Callable[[Any], None]], None],
                 in_turn: Callable[[Callable[[str], None]], Callable[[str], None]]):
        self._size, self._act, self._refuse = size, act, refuse
        self._typed: threading.Timer | None = None
        low, high = (float(np.log10(end)) for end in (min(*size.reach, value), max(*size.reach, value)))
        decades = range(int(np.ceil(low)), int(np.floor(high)) + 1)
        gui.add_html(LOGARITHMIC)
        self._slider = gui.add_slider(size.name, low, high, STEP, float(np.log10(value)), hint=size.hint,
                                      marks=tuple((float(d), f"{10.0**d:g}" if abs(d) < 4 else f"1e{d}")
                                                  for d in decades))
        gui.add_html(TYPED)
        self._text = gui.add_text(f"{size.name}, typed", self._shown(value), hint=f"{size.hint}. Type a number"
                                  + f" in {size.unit}, or with a prefix: {self._shown(size.default)}" * bool(size.unit))
        self._ends, self._read_in_turn = (low, high), in_turn(self._read)
        follow(self._slider, self._moved)
        follow(self._text, self._keyed)

    def show(self, value: float) -> None:
        """Show another value, which nobody has set by hand."""
        self._slider.value = float(np.clip(np.log10(value), *self._ends))  # type: ignore[misc]
        self._text.value = self._shown(value)  # type: ignore[misc]

    def _shown(self, value: float) -> str:
        return with_unit(value, self._size.unit, DIGITS) if self._size.unit else f"{value:.{DIGITS}g}"

    def _moved(self, logarithm: float) -> None:
        default = self._size.default
        near = abs(logarithm - np.log10(default)) < 0.5 * STEP
        value = default if near else float(f"{10**logarithm:.3g}")
        self._text.value = self._shown(value)  # type: ignore[misc]
        self._act(value)

    def _keyed(self, text: str) -> None:
        """Wait for the rest: half a number is another number."""
        if self._typed:
            self._typed.cancel()
        self._typed = threading.Timer(TYPING, self._read_in_turn, (text,))
        self._typed.daemon = True
        self._typed.start()

    def _read(self, text: str) -> None:
        if self._text.value != text:  # the slider has been moved since
            return
        try:
            value = size_in(text, self._size.unit)
        except ValueError:
            unit = f" in {self._size.unit}" * bool(self._size.unit)
            self._refuse(f"{self._size.name}: {text!r} is not a number above 0{unit}; "
                         f"give one such as {self._shown(self._size.default)}")
            return
        self._slider.value = float(np.clip(np.log10(value), *self._ends))  # type: ignore[misc]
        self._act(value)
