"""Widgets that are bound to the session: what a visitor changes is wished of the scene, and waits for a compiler."""

import functools
import threading
from collections.abc import Callable, Mapping
from typing import Any

import viser

from app import words
from app.page.panels.head import WIDE_LABEL
from app.page.panels.size import Size, SizeControl
from app.page.visit.session import Session, first_scene
from app.problems.interface import LinearSlider
from app.problems.views import VIEWS
from app.viewer.widgets import is_removed
from solvers.scene.effects import Effect
from solvers.scene.remedies import Remedy
from solvers.scene.rules import field_label
from solvers.scene.scene import Scene

MARK = "\ncompiling …"  # below the label, in small letters (style.css): a row is high enough for both


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

    def __init__(self, gui: viser.GuiApi, session: Session, patience: Patience):
        self._gui, self._session, self._patience = gui, session, patience
        self.turn, self._made = threading.RLock(), object()

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
        """A dropdown of what the problem does, where it can do several things. ``move`` is called with the scene of
        another motion, and with the quantity and the speed that it begins with, None for no change and for the usual.
        """
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

    def size(self, size: Size, value: float, act: Callable[[float], None]) -> SizeControl:
        """A slider and a text for a number of any size."""
        return SizeControl(self._gui, size, value, act, self._session.refuse, self.follow, self.in_turn)
