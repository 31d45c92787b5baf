"""Widget for a positive number: a slider with a logarithmic scale and a text field."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import viser

from app.language.translation import lazy, localise_number, tr
from app.names_and_units import parse_size, with_unit
from app.page.panels.page_header import add_widget_marker
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
    ``multiple`` is the number of which the slider has multiples only, or 0."""

    name: str
    unit: str
    reach: tuple[float, float]
    default: float
    hint: str
    multiple: float = 0.0


class LogNumberSlider:
    """Logarithmic slider and text field for one positive number; ``act`` receives the value that the visitor sets, in
    the unit of ``size``. A value refused by the session is reset."""

    def __init__(self, gui: viser.GuiApi, bound: SceneWidgetFactory, size: SliderSpec, value: float,
                 act: Callable[[float], None]):
        self._bound, self.size, self._act = bound, size, act
        self.value = value  # the last accepted value
        low, high = (float(np.log10(end((*size.reach, value)))) for end in (min, max))
        self._slider = gui.add_slider(size.name, low, high, STEP, float(np.log10(value)), hint=size.hint)
        add_widget_marker(gui, "lab-typed")
        self._text = gui.add_text(
            tr("{name}, typed", name=size.name), self._format(value),
            hint=tr(TYPE_SIZE if size.unit else TYPE, unit=size.unit, example=self._format(size.default)))
        bound.on_change(self._slider, self._on_slider_moved)
        bound.on_enter(self._text, self._on_entered)

    def show(self, value: float) -> None:
        """Shows a value that the visitor has not set, without calling ``act``."""
        self.value = value
        self._show(value)

    def choose(self, value: float) -> None:
        """Sets a value that the visitor has chosen elsewhere, as if the slider had been moved there."""
        with self._bound.turn:
            self._set(value)

    def _show(self, value: float) -> None:
        self._slider.value = float(  # type: ignore[misc]
            np.clip(np.log10(value), self._slider.min, self._slider.max))
        self._text.value = self._format(value)  # type: ignore[misc]

    def _set(self, value: float) -> None:
        self._show(value)
        self._try(value)

    def _format(self, value: float) -> str:
        return with_unit(value, self.size.unit, DIGITS) if self.size.unit else localise_number(f"{value:.{DIGITS}g}")

    def _on_slider_moved(self, logarithm: float) -> None:
        default, multiple = self.size.default, self.size.multiple
        near = abs(logarithm - np.log10(default)) < 0.5 * STEP
        value = default if near else float(f"{10**logarithm:.3g}")
        if multiple:
            value = max(multiple, multiple * round(value / multiple))
        self._text.value = self._format(value)  # type: ignore[misc]
        self._try(value)

    def _try(self, value: float) -> None:
        if self._bound.apply_or_reset(self._slider, lambda: self._act(value), lambda: self.show(self.value)):
            self.value = value

    def _on_entered(self, text: str) -> None:
        """Applies a finished text, and shows its number as it is written; an empty one leaves the value as it was."""
        if not text.strip():
            self.show(self.value)
            return
        try:
            value = parse_size(text, self.size.unit)
        except ValueError:
            size = self.size
            refusal = tr(NO_SIZE if size.unit else NO_NUMBER, name=size.name, typed=quoting.quote(text, 20),
                         unit=size.unit, example=self._format(size.default))
            self._bound.apply_or_reset(self._slider, lambda: self._bound.refuse(refusal),
                                       lambda: self.show(self.value))
            return
        self._set(value)
