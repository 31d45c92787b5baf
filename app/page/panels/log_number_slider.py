"""Widget for a positive number: a slider with a logarithmic scale and a text field."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import viser

from app.language.translation import lazy, tr
from app.names_and_units import parse_size, with_unit
from app.page.panels.page_header import add_widget_marker, widget_marker_html
from app.page.panels.scene_widgets import SceneWidgetFactory
from solvers.untrusted import quoting

STEP = 0.005  # of the slider, in powers of ten
DIGITS = 6
TYPE_SIZE, TYPE = lazy("type a number in {unit}, or with a prefix: {example}"), lazy("type a number: {example}")
NO_SIZE = lazy("{name}: '{typed}' is not a number above 0 in {unit}; give one such as {example}")
NO_NUMBER = lazy("{name}: '{typed}' is not a number above 0; give one such as {example}")


@dataclass(frozen=True)
class SliderSpec:
    """Specification of a slider: name and unit of its number, ends (``reach``) and ``default`` in that unit, hint;
    ``multiple`` is the number whose multiples it has, or 0; ``place`` is a CSS class for its position, or ""."""

    name: str
    unit: str
    reach: tuple[float, float]
    default: float
    hint: str
    multiple: float = 0.0
    place: str = ""


class LogNumberSlider:
    """Logarithmic slider and text field for one positive number; ``act`` receives the value that the visitor sets, in
    the unit of ``size``. A value refused by the session is reset. ``mark`` is the html in front of it, at first
    ``marked`` or that of any logarithmic slider."""

    def __init__(self, gui: viser.GuiApi, bound: SceneWidgetFactory, size: SliderSpec, value: float,
                 act: Callable[[float], None], marked: str = ""):
        self._bound, self._size, self._act = bound, size, act
        self._value = value  # the last accepted value
        low, high = _ends(size, value)
        self.mark = gui.add_html(marked or widget_marker_html("lab-logarithmic", size.place))
        self._slider = gui.add_slider(size.name, low, high, STEP, float(np.log10(value)), hint=size.hint)
        text_mark = add_widget_marker(gui, "lab-typed", size.place)
        self._text = gui.add_text(
            tr("{name}, typed", name=size.name), self._format(value),
            hint=tr(TYPE_SIZE if size.unit else TYPE, unit=size.unit, example=self._format(size.default)))
        # Removed with its widget, as it would otherwise mark the next one.
        self._parts: tuple[Any, ...] = (self.mark, text_mark, self._slider, self._text)
        bound.on_change(self._slider, self._on_slider_moved)
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

    def choose(self, value: float) -> None:
        """Sets a value that the visitor has chosen elsewhere, as if the slider had been moved there."""
        with self._bound.turn:
            if self._slider.visible:
                self._set_slider(value)
                self._text.value = self._format(value)  # type: ignore[misc]
                self._try(value)

    @property
    def shown_value(self) -> float:
        return self._value

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
        default, multiple = self._size.default, self._size.multiple
        near = abs(logarithm - np.log10(default)) < 0.5 * STEP
        value = default if near else float(f"{10**logarithm:.3g}")
        if multiple:
            value = max(multiple, multiple * round(value / multiple))
        self._text.value = self._format(value)  # type: ignore[misc]
        self._try(value)

    def _try(self, value: float) -> None:
        if self._bound.apply_or_reset(self._slider, lambda: self._act(value), lambda: self.show(self._value)):
            self._value = value

    def _on_entered(self, text: str) -> None:
        """Applies a finished text, and shows its number as it is written; an empty one leaves the value as it was."""
        if not text.strip():
            self.show(self._value)
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
        self._text.value = self._format(value)  # type: ignore[misc]
        self._try(value)


def _ends(size: SliderSpec, value: float) -> tuple[float, float]:
    """Returns the decimal logarithms of the slider's ends, extended to include a value."""
    return float(np.log10(min(*size.reach, value))), float(np.log10(max(*size.reach, value)))
