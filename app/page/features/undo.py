"""Undo: the states that a visitor has left, the last one last, and a button in the head (``js/undo.js``)."""

import threading
from collections import deque
from collections.abc import Callable
from dataclasses import fields
from html import escape
from time import monotonic

import viser

from app.language.translation import tr
from app.lessons.markdown_html import FIELDS
from app.names_and_units import choice_labels, difference_text, format_number, functions_name, unit_of, with_unit
from app.page.feature import Feature, VisiblePageState
from app.page.page_context import PageContext
from app.shareable_state import State
from solvers.scene.scene import Scene
from solvers.scene.validation import field_label

MOST = 50  # states kept
TOGETHER = 1.4  # seconds between changes of one setting that are undone as one
LABELS = {field: label for label, field in FIELDS.items()}
TIME_STEP = {"cfl", "dt"}


class Undo(Feature):
    """One visitor's earlier states; ``state`` returns the state shown, ``restore`` puts one back. A tour, a lesson, a
    file on the stage or the link that the page was opened with begins anew."""

    def __init__(self, gui: viser.GuiApi, state: Callable[[], State], restore: Callable[[State], None],
                 is_touring: Callable[[], bool], clock: Callable[[], float] = monotonic):
        self._html, self._state, self._restore = gui.add_html(""), state, restore
        self._is_touring, self._clock = is_touring, clock
        self.shortcuts = {"undo": self.undo}
        self._lock = threading.Lock()
        self._left = deque[State](maxlen=MOST)
        self._present: State | None = None
        self._last = "", 0.0  # the setting changed last, "" for several, and when

    @classmethod
    def build(cls, page: PageContext) -> "Undo":
        return cls(page.gui, lambda: page.controls.state, page.controls.restore,
                   lambda: page.is_touring() or not page.store.has_answered)

    def refresh(self, view: VisiblePageState) -> None:
        """Notes a change of the scene, of the run beside it or of the estimator on the stage; updates the button."""
        with self._lock:
            if view.has_stage and not self._is_touring():
                self._note(self._state())
            else:
                self._left.clear()
                self._present = None
            title = ""
            if self._left and self._present:
                title = tr("Undo: {change}", change=describe_change(self._left[-1], self._present)[1])
        self._html.content = f"<i class='lab-undo' data-title='{escape(title, quote=True)}'></i>"

    def undo(self) -> None:
        """Puts the last state left back on the stage."""
        with self._lock:
            if self._left:
                self._present = None
                self._restore(self._left.pop())

    def _note(self, state: State) -> None:
        before, self._present = self._present, state
        if before is None or (setting := describe_change(before, state)[0]) is None:
            return
        now, (last, since) = self._clock(), self._last
        if not (setting and setting == last and now < since + TOGETHER and self._left):
            self._left.append(before)
        elif describe_change(self._left[-1], state)[0] is None:  # back again
            self._left.pop()
        self._last = setting, now


def describe_change(before: State, after: State) -> tuple[str | None, str]:
    """Returns which setting differs between two states, a field of the scene, "" for several or None if nothing differs
    that can be undone, and the change in words: "Amplitude A, 3.4 mm to 5 mm"."""
    old, new = before.scene, after.scene
    if old.problem != new.problem:
        return "", tr("back to the {problem}", problem=tr(old.TITLE))
    changed = {field.name for field in fields(new) if getattr(old, field.name) != getattr(new, field.name)}
    several = before.pinned != after.pinned or (changed and before.compared != after.compared)
    if several or len(changed - TIME_STEP) + bool(changed & TIME_STEP) > 1:
        return "", tr("back to {run}", run=difference_text(old, new) or tr("the run as it was"))
    if changed:
        field = "cfl" if changed & TIME_STEP else changed.pop()
        label = tr(LABELS.get(field, field_label(field)))
        label = label[:1].upper() + label[1:]
        return field, _change_text(label, _format_field(old, field), _format_field(new, field))
    if before.compared != after.compared:
        return "compared", _change_text(tr("Compare with"), *(
            functions_name(state.compared) if state.compared else tr("nothing") for state in (before, after)))
    if before.estimator == after.estimator or before.quantity != after.quantity:
        return None, ""  # one that has no values of another quantity is replaced
    return "estimator", _change_text(tr("On the stage"), *(
        state.estimator or state.scene.first_estimator or tr("none") for state in (before, after)))


def _change_text(setting: str, old: str, new: str) -> str:
    return tr("{setting}, {old} to {new}", setting=setting, old=old, new=new)


def _format_field(scene: Scene, field: str) -> str:
    """Returns the value of a scene's field as text, that of the time step as CFL number."""
    value, names = getattr(scene, field), choice_labels(type(scene), field)
    if field == "cfl":
        return format_number(scene.courant_number)
    if isinstance(value, tuple):
        return ", ".join(value) or tr("none")
    if names:
        return names[value]
    unit = unit_of(type(scene), field)
    return with_unit(value, unit) if unit else str(value)
