"""Widgets that are bound to the session: what a visitor changes is wished of the scene, and waits for a compiler."""

import functools
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import viser

from app import words
from app.page.panels.head import WIDE_LABEL
from app.page.visit.session import Session, first_scene
from app.problems.interface import LinearSlider
from app.problems.views import VIEWS
from app.viewer.widgets import is_removed
from app.words import size_in, with_unit
from solvers.scene.effects import Effect
from solvers.scene.remedies import Remedy
from solvers.scene.rules import field_label
from solvers.scene.scene import Scene

MARK = "\ncompiling …"  # below the label, in small letters (style.css): a row is high enough for both
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


class Patience:
    """Marks the label of one visitor's last changed widget while its wish waits for a compiler."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._last: Any = None
        self._marked: Any = None

    def changed(self, widget: Any) -> None:
        with self._lock:
            self._last = widget

    def show(self, compiling: bool) -> None:
        """Mark the widget, or take the mark away. Its label may have changed meanwhile."""
        with self._lock:
            wanted = self._last if compiling else None
            marked, self._marked = self._marked, wanted
            if marked and marked is not wanted and not is_removed(marked):
                marked.label = marked.label.removesuffix(MARK)
            if wanted and not is_removed(wanted) and not wanted.label.endswith(MARK):
                wanted.label += MARK


class BoundWidgets:
    """Makes them for one visitor. Callbacks run side by side: they take ``turn``, so that what is read last is asked
    for last, and so do those who make the widgets anew."""

    def __init__(self, gui: viser.GuiApi, session: Session, patience: Patience, turn: threading.RLock):
        self._gui, self._session, self._patience = gui, session, patience
        self.turn, self._made = turn, object()

    def forget(self) -> None:
        """The widgets are about to be removed: from now on nothing that was asked by one of them is done."""
        self._made = object()

    def in_turn(self, act: Callable[..., None]) -> Callable[..., None]:
        """``act``, for a widget of now to call: it waits for its turn, and does nothing if the widget has gone by then,
        for what it would change has gone too."""
        made = self._made

        def acted(*arguments: Any) -> None:
            with self.turn:
                if made is self._made:
                    act(*arguments)

        return acted

    def boxes(self, field: str, kinds: Mapping[str, Effect] | Mapping[str, Remedy]) -> None:
        """A box for each of the names that the scene's field may hold, several at a time."""
        session, scene = self._session, self._session.scene
        boxes = {}
        for name in scene.choices(field):
            self._gui.add_html(WIDE_LABEL)
            boxes[name] = self._gui.add_checkbox(kinds[name].label, name in getattr(scene, field),
                                                 hint=kinds[name].explanation)
        for box in boxes.values():
            self.follow(box, lambda _: session.set(**{field: tuple(name for name, b in boxes.items() if b.value)}))

    def follow(self, widget: Any, act: Callable[[Any], None]) -> None:
        """Call ``act`` with the widget's value whenever the visitor has changed it, for one widget at a time."""
        asked = self.in_turn(lambda: act(widget.value))

        def changed(event: viser.GuiEvent) -> None:
            if event.client is not None:  # else the page has shown something, and nobody wishes anything
                self._patience.changed(widget)
                asked()

        widget.on_update(changed)

    def field(self, field: str, hint: str) -> None:
        """A dropdown of what the scene's field may be, in words; a box for one that is true or false."""
        scene, label = self._session.scene, field_label(field).capitalize()
        value, names = getattr(scene, field), words.choices(type(scene), field)
        codes = {name: code for code, name in names.items()}
        if not names:
            self._gui.add_html(WIDE_LABEL)
        widget = self._gui.add_dropdown(label, tuple(codes), hint=hint, initial_value=names[value]) if names \
            else self._gui.add_checkbox(label, value, hint=hint)
        self.follow(widget, lambda shown: self._session.set(**{field: codes.get(shown, shown)}))

    def sliders(self, sliders: Mapping[str, LinearSlider]) -> None:
        """A slider for each of the scene's fields."""
        values = self._session.scene.to_dict()
        for field, (label, low, high, step, hint) in sliders.items():
            value = values[field]
            slider = self._gui.add_slider(label, min(low, value), max(high, value), step, value, hint=hint)
            self.follow(slider, functools.partial(self._set, field))

    def _set(self, field: str, value: float) -> None:
        self._session.set(**{field: value})

    def motions(self, move: Callable[[Scene, str | None, float | None], None]) -> None:
        """A dropdown of what the problem does, where it can do several things; ``move`` gets another motion's scene,
        and the quantity and the speed that it begins with, None for no change and for the usual."""
        scene = self._session.scene
        motion = VIEWS[scene.problem].motion
        if motion is None:
            return
        names = words.choices(type(scene), "motion")
        shown = self._gui.add_dropdown("Motion", tuple(names.values()), hint=motion.hint,
                                       initial_value=names[scene.to_dict()["motion"]])

        def chosen(_: viser.GuiEvent) -> None:
            now = self._session.scene
            code = next(code for code, name in names.items() if name == shown.value)
            changed = motion.change(now, code, first_scene(now.problem).estimators)
            move(changed, *((None, None) if changed.swings else (motion.quantity, motion.speed)))

        shown.on_update(chosen)

    def size(self, size: Size, value: float, act: Callable[[float], None], place: str = "") -> "SizeControl":
        """A slider and a text for a number of any size. The style may lay them elsewhere by the name of a ``place``."""
        return SizeControl(self._gui, self, size, value, act, self._session.refuse, place)


class SizeControl:
    """Two widgets that show one number, as a slider whose steps are factors and as text to read and type. ``act`` is
    called with a number that the visitor has set, ``refuse`` with a sentence about text that is none."""

    def __init__(self, gui: viser.GuiApi, bound: BoundWidgets, size: Size, value: float, act: Callable[[float], None],
                 refuse: Callable[[str], None], place: str):
        self._size, self._act, self._refuse = size, act, refuse
        self._typed: threading.Timer | None = None
        low, high = _ends(size, value)
        gui.add_html(f"<i class='lab-logarithmic {place}'></i>")
        self._slider = gui.add_slider(size.name, low, high, STEP, float(np.log10(value)), hint=size.hint)
        gui.add_html(f"<i class='lab-typed {place}'></i>")
        self._text = gui.add_text(f"{size.name}, typed", self._shown(value), hint=f"{size.hint}. Type a number"
                                  + f" in {size.unit}, or with a prefix: {self._shown(size.default)}" * bool(size.unit))
        self._read_in_turn = bound.in_turn(self._read)
        bound.follow(self._slider, self._moved)
        bound.follow(self._text, self._keyed)

    def begin(self, size: Size, value: float) -> None:
        """Show a number of another reach."""
        self._size = size
        self._slider.min, self._slider.max = _ends(size, value)
        self.show(value)

    def show(self, value: float) -> None:
        """Show another value, which nobody has set by hand."""
        self._place(value)
        self._text.value = self._shown(value)  # type: ignore[misc]

    @property
    def visible(self) -> bool:
        return self._slider.visible

    @visible.setter
    def visible(self, visible: bool) -> None:
        self._slider.visible = self._text.visible = visible

    def _place(self, value: float) -> None:
        self._slider.value = float(np.clip(np.log10(value), self._slider.min, self._slider.max))  # type: ignore[misc]

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
        self._place(value)
        self._act(value)


def _ends(size: Size, value: float) -> tuple[float, float]:
    """Of a slider that shows this value, too: logarithms."""
    return float(np.log10(min(*size.reach, value))), float(np.log10(max(*size.reach, value)))
