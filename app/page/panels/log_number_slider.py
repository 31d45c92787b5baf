"""Widget for a positive number: a slider with a logarithmic scale and a text field."""

import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import viser

from app.language.translation import lazy, tr, with_language
from app.names_and_units import parse_size, with_unit
from app.page.panels.page_header import add_widget_marker
from app.page.panels.scene_widgets import SceneWidgetFactory
from solvers.untrusted import quoting

TYPING = 0.8  # seconds without a key after which the input is applied
EMPTY = 5.0  # seconds after which an emptied field shows its number again
STEP = 0.005  # of the slider, in powers of ten
DIGITS = 6
TYPE_SIZE, TYPE = lazy("type a number in {unit}, or with a prefix: {example}"), lazy("type a number: {example}")
NO_SIZE = lazy("{name}: '{typed}' is not a number above 0 in {unit}; give one such as {example}")
NO_NUMBER = lazy("{name}: '{typed}' is not a number above 0; give one such as {example}")


@dataclass(frozen=True)
class SliderSpec:
    """Specification of a slider: name and unit of its number, ends (``reach``) and ``default`` in that unit, hint, and
    ``words`` beside it; ``place`` is a CSS class for its position on the page, or ""."""

    name: str
    unit: str
    reach: tuple[float, float]
    default: float
    hint: str
    words: str = ""
    place: str = ""


class LogNumberSlider:
    """Logarithmic slider and text field for one positive number; ``act`` receives the value that the visitor sets, in
    the unit of ``size``. A value refused by the session is reset."""

    def __init__(self, gui: viser.GuiApi, bound: SceneWidgetFactory, size: SliderSpec, value: float,
                 act: Callable[[float], None]):
        self._bound, self._size, self._act = bound, size, act
        self._typed: threading.Timer | None = None
        self._value = value  # the last accepted value
        low, high = _ends(size, value)
        marks = [add_widget_marker(gui, "lab-logarithmic", *filter(None, [size.place]), words=size.words)]
        self._slider = gui.add_slider(size.name, low, high, STEP, float(np.log10(value)), hint=size.hint)
        marks.append(add_widget_marker(gui, "lab-typed", *filter(None, [size.place])))
        self._text = gui.add_text(
            tr("{name}, typed", name=size.name), self._format(value),
            hint=tr(TYPE_SIZE if size.unit else TYPE, unit=size.unit, example=self._format(size.default)))
        # Removed with its widget, as it would otherwise mark the next one.
        self._parts: tuple[Any, ...] = (*marks, self._slider, self._text)
        self._read_in_turn = bound.serialised_callback(self._read)
        bound.on_change(self._slider, self._on_slider_moved)
        bound.on_change(self._text, self._read_after_typing)
        bound.on_enter(self._text, self._on_entered)

    def set_range_and_value(self, size: SliderSpec, value: float) -> None:
        """Changes the slider's range to that of ``size``, and shows a value in its unit."""
        self._size = size
        self._slider.min, self._slider.max = _ends(size, value)
        self.show(value)

    def show(self, value: float) -> None:
        """Shows a value that the visitor has not set, without calling ``act``."""
        self._value = value
        self._set_slider(value)
        self._text.value = self._format(value)  # type: ignore[misc]

    @property
    def visible(self) -> bool:
        return self._slider.visible

    @visible.setter
    def visible(self, visible: bool) -> None:
        for part in self._parts:
            part.visible = visible

    def _set_slider(self, value: float) -> None:
        self._slider.value = float(  # type: ignore[misc]
            np.clip(np.log10(value), self._slider.min, self._slider.max))

    def _format(self, value: float) -> str:
        return with_unit(value, self._size.unit, DIGITS) if self._size.unit else f"{value:.{DIGITS}g}"

    def _on_slider_moved(self, logarithm: float) -> None:
        default = self._size.default
        near = abs(logarithm - np.log10(default)) < 0.5 * STEP
        value = default if near else float(f"{10**logarithm:.3g}")
        self._text.value = self._format(value)  # type: ignore[misc]
        self._try(value)

    def _try(self, value: float) -> None:
        if self._bound.apply_or_reset(self._slider, lambda: self._act(value), lambda: self.show(self._value)):
            self._value = value

    def _read_after_typing(self, text: str) -> None:
        """Reads the text 0.8 s after the last key: half a number is another number; an empty one 5 s after it."""
        if self._typed:
            self._typed.cancel()
        self._typed = threading.Timer(TYPING if text.strip() else EMPTY, with_language(self._read_in_turn), (text,))
        self._typed.daemon = True
        self._typed.start()

    def _on_entered(self) -> None:
        """Applies the finished input at once, and formats the number in the text field."""
        if self._typed and self._typed.is_alive():
            self._typed.cancel()
            self._read(self._text.value)
        self._text.value = self._format(self._value)  # type: ignore[misc]

    def _read(self, text: str) -> None:
        if self._text.value != text:  # the slider has been moved since
            return
        if not text.strip():
            self._text.value = self._format(self._value)  # type: ignore[misc]
            return
        try:
            value = parse_size(text, self._size.unit)
        except ValueError:
            size = self._size
            refusal = tr(NO_SIZE if size.unit else NO_NUMBER, name=size.name, typed=quoting.quote(text, 20),
                         unit=size.unit, example=self._format(size.default))
            self._bound.apply_or_reset(self._slider, lambda: self._bound.refuse(refusal),
                                       lambda: self.show(self._value))
            return
        self._set_slider(value)
        self._try(value)


def _ends(size: SliderSpec, value: float) -> tuple[float, float]:
    """Returns the decimal logarithms of the slider's ends, extended to include a value."""
    return float(np.log10(min(*size.reach, value))), float(np.log10(max(*size.reach, value)))
