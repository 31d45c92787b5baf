"""Widgets for fields of the scene, with a message below the one changed last: compiling, or why refused."""

import functools
import threading
from collections.abc import Callable, Mapping
from dataclasses import replace
from html import escape
from time import monotonic
from typing import Any

import viser

from app import names_and_units
from app.language.translation import tr, translate_message
from app.page.panels.page_header import add_widget_marker
from app.page.visit.first_scene import first_scene
from app.page.visit.run_session import RunSession
from app.problems.interface import LinearSlider
from app.problems.views import VIEWS
from app.viewer.widget_validation import is_removed, set_max_length, widget_id
from solvers.motion.formula import MOST_CHARACTERS
from solvers.scene.effects import Effect
from solvers.scene.scene import Scene
from solvers.scene.stabilisations import Remedy
from solvers.scene.validation import SceneError, field_label

REST = 0.7  # seconds without another refusal after which the control is reset: not while it is being moved
TO_BE_READ = 8.0  # seconds that a refusal is shown


class WidgetStatusMessage:
    """Message below the widget changed last (``js/answers.js``). Call :meth:`refresh` a few times a second."""

    def __init__(self, gui: viser.GuiApi, clock: Callable[[], float] = monotonic):
        self._html, self._clock = gui.add_html(""), clock
        self._lock = threading.Lock()
        self._last: Any = None  # the widget that was changed last
        self._refusal: tuple[float, str] | None = None
        self._back: Callable[[], None] | None = None

    def record_change(self, widget: Any) -> None:
        """Notes which widget the visitor has changed last, and drops the message about an earlier one."""
        with self._lock:
            self._last, self._refusal, self._back = widget, None, None

    def refuse(self, widget: Any, sentence: str, reset: Callable[[], None]) -> None:
        """Shows below a widget why its value is refused; ``reset`` is called after 0.7 s without another refusal."""
        with self._lock:
            self._last, self._refusal, self._back = widget, (self._clock(), sentence), reset

    def refresh(self, compiling: bool) -> None:
        """Shows the message due now: a refusal, or that the scene is ``compiling``; resets a refused widget."""
        with self._lock:
            widget, back, now = self._last, None, self._clock()
            since, sentence = self._refusal or (now, "")
            if self._back and now > since + REST:
                back, self._back = self._back, None
            if now > since + TO_BE_READ:
                self._refusal = None
        if widget is None or is_removed(widget):
            content = ""
        elif self._refusal:
            content = _message_html(widget, "refused", f"{sentence[:1].upper()}{sentence[1:]}.")
        else:
            content = _message_html(widget, "compiling", tr("compiling …")) if compiling else ""
        self._html.content = content
        if back and not is_removed(widget):
            back()


def _message_html(widget: Any, kind: str, sentence: str) -> str:
    return f"<i class='lab-answer' data-of='{widget_id(widget)}' data-kind='{kind}' data-says='{escape(sentence)}'></i>"


class SceneWidgetFactory:
    """Makes one visitor's widgets for scene fields; their callbacks take the lock ``turn``: the last change wins."""

    def __init__(self, gui: viser.GuiApi, session: RunSession, answers: WidgetStatusMessage, turn: threading.RLock):
        self._gui, self._session, self._answers = gui, session, answers
        self.turn, self._made = turn, object()
        self._enters: dict[str, Callable[[str], None]] = {}

    def disable_callbacks(self) -> None:
        """Disables the callbacks of all widgets made so far, because they are about to be removed."""
        self._made = object()
        self._enters = {}

    def on_enter(self, text: viser.GuiTextHandle, act: Callable[[str], None]) -> None:
        """Calls ``act`` with a text that the visitor has finished: pressed Enter, or left the field."""
        def act_on_change(entered: str) -> None:
            self._answers.record_change(text)
            act(entered)

        self._enters[widget_id(text)] = self.serialised_callback(act_on_change)

    def apply_entered_text(self, widget: str, entered: str) -> None:
        """Calls what :meth:`on_enter` registered for the text field of this widget id, if anything."""
        if act := self._enters.get(widget):
            act(entered[:MOST_CHARACTERS + 1])

    def serialised_callback(self, act: Callable[..., None]) -> Callable[..., None]:
        """Returns a callback that calls ``act`` under the lock, and does nothing after :meth:`disable_callbacks`."""
        made = self._made

        def run_in_turn(*arguments: Any) -> None:
            with self.turn:
                if made is self._made:
                    act(*arguments)

        return run_in_turn

    def add_checkboxes(self, field: str, kinds: Mapping[str, Effect] | Mapping[str, Remedy]) -> None:
        """Adds a checkbox for each value of a scene's list field ("effects"), labelled by ``kinds``."""
        session, scene = self._session, self._session.scene
        boxes = {}
        for name in scene.choices(field):
            boxes[name] = self._gui.add_checkbox(tr(kinds[name].label), name in getattr(scene, field),
                                                 hint=tr(kinds[name].explanation))
        for box in boxes.values():
            self.on_change_or_reset(box, lambda _: session.set_scene_fields(
                **{field: tuple(name for name, b in boxes.items() if b.value)}))

    def on_change_or_reset(self, widget: Any, act: Callable[[Any], None]) -> None:
        """Calls ``act`` with each value that the visitor sets; one that the session refuses is reset in the widget."""
        met = [widget.value]

        def apply(value: Any) -> None:
            if self.apply_or_reset(widget, lambda: act(value), lambda: setattr(widget, "value", met[0])):
                met[0] = value

        self.on_change(widget, apply)
        widget.on_update(lambda event: met.__setitem__(0, widget.value) if event.client is None else None)

    def on_change(self, widget: Any, act: Callable[[Any], None]) -> None:
        """Calls ``act`` with the widget's value, under the lock, whenever the visitor (not the page) changes it."""
        asked = self.serialised_callback(lambda: act(widget.value))

        def on_update(event: viser.GuiEvent) -> None:
            if event.client is not None:  # otherwise the page has set the value
                self._answers.record_change(widget)
                asked()

        widget.on_update(on_update)

    def apply_or_reset(self, widget: Any, act: Callable[[], None], reset: Callable[[], None]) -> bool:
        """Calls ``act``; if the session refuses, says why below the widget, calls ``reset`` later and returns False."""
        self._answers.record_change(widget)
        before = self._session.refused
        act()
        refused = self._session.refused
        if refused is None or refused is before:
            return True
        self._answers.refuse(widget, refused[1], self.serialised_callback(reset))
        return False

    def add_field(self, field: str, hint: str) -> None:
        """Adds a dropdown for a scene's field with several choices, or a checkbox for a bool, with a tooltip."""
        scene, label, hint = self._session.scene, tr(field_label(field)), tr(hint)
        label = label[:1].upper() + label[1:]
        value, names = getattr(scene, field), names_and_units.choice_labels(type(scene), field)
        codes = {name: code for code, name in names.items()}
        widget = self._gui.add_dropdown(label, tuple(codes), hint=hint, initial_value=names[value]) if names \
            else self._gui.add_checkbox(label, value, hint=hint)
        self.on_change_or_reset(widget,
                                lambda shown: self._session.set_scene_fields(**{field: codes.get(shown, shown)}))

    def add_formula(self, field: str, label: str, hint: str) -> None:
        """Adds a text for a formula in a scene's field, checked while it is typed and applied when it is finished."""
        add_widget_marker(self._gui, "lab-formula")
        text = self._gui.add_text(tr(label), getattr(self._session.scene, field), hint=tr(hint))
        set_max_length(text, MOST_CHARACTERS)
        said = self._gui.add_html("")

        def check(typed: str) -> None:
            said.content = ""
            try:
                replace(self._session.scene, **dict[str, Any]({field: typed}))
            except SceneError as error:
                sentence = translate_message(error.sentence)
                said.content = f"<p class='lab-formula-says'>{escape(sentence[:1].upper() + sentence[1:])}.</p>"

        def apply(entered: str) -> None:
            self.apply_or_reset(text, lambda: self._session.set_scene_fields(**{field: entered}), lambda: None)

        self.on_change(text, check)
        self.on_enter(text, apply)

    def add_sliders(self, sliders: Mapping[str, LinearSlider]) -> None:
        """Adds a linear slider for each of these fields of the scene."""
        values = self._session.scene.to_dict()
        for field, (label, low, high, step, hint) in sliders.items():
            value = values[field]
            slider = self._gui.add_slider(tr(label), min(low, value), max(high, value), step, value, hint=tr(hint))
            self.on_change_or_reset(slider, functools.partial(self._set_scene_field, field))

    def _set_scene_field(self, field: str, value: float) -> None:
        self._session.set_scene_fields(**{field: value})

    def add_motion_dropdown(self, on_motion: Callable[[Scene, str | None, float | None], None]) -> None:
        """Adds a dropdown of the problem's motions, if it has several; ``on_motion(scene, quantity, speed)`` receives
        the changed scene, with quantity ("x") and speed (periods per second) to use, or None to keep them."""
        scene = self._session.scene
        motion = VIEWS[scene.problem].motion
        if motion is None:
            return
        names = names_and_units.choice_labels(type(scene), "motion")
        shown = self._gui.add_dropdown(tr("Motion"), tuple(names.values()), hint=tr(motion.hint),
                                       initial_value=names[scene.to_dict()["motion"]])

        def on_chosen(_: viser.GuiEvent) -> None:
            now = self._session.scene
            code = next(code for code, name in names.items() if name == shown.value)
            changed = motion.change_motion(now, code, first_scene(now.problem).estimators)
            on_motion(changed, *((None, None) if changed.swings else (motion.quantity, motion.speed)))

        shown.on_update(on_chosen)

    def refuse(self, sentence: str) -> None:
        """Refuses a number that the visitor has typed, for the reason given by a sentence without a full stop."""
        self._session.refuse(sentence, "number")
