"""Playback controls below the stage, built once before the tabs: run, speed, pin, look back, the second run."""

import json
from collections.abc import Callable
from html import escape
from typing import Any

import viser

from app.language.translation import lazy, localise_number, tr
from app.names_and_units import functions_name
from app.page.panels.frame_and_drawing_controls import FrameAndTraceControls
from app.page.panels.scene_widgets import SceneWidgetFactory
from app.page.visit.run_session import RunSession
from app.shareable_state import State

PLAY, PAUSE, STEP, RESET = lazy("Play"), lazy("Pause"), lazy("Step"), lazy("Reset")
PIN, UNPIN = lazy("Pin this run"), lazy("Unpin")
SLOW = 0.0125  # periods per second, at which one sees single particles change their cell
SPEEDS = {SLOW: lazy("slow"), 0.25: "¼", 0.5: "½", 1.0: "1", 2.0: "2"}
NOTHING, PINNED, KEEP = "nothing", "pinned", "keep"  # choices beside the methods
NAMES = {NOTHING: lazy("nothing"), PINNED: lazy("the pinned run"), KEEP: lazy("this run, as it is now")}


class PlaybackControls:
    """One visitor's widgets for run, speed, pin and look back, made by ``bound``; ``on_view`` redraws the stage."""

    def __init__(self, gui: viser.GuiApi, session: RunSession, history: FrameAndTraceControls,
                 bound: SceneWidgetFactory, on_view: Callable[[], None]):
        self._session, self._on_view = session, on_view
        self.play: Callable[[bool], None] = session.play  # or that of what replaces the run on the stage
        self.acts = {PLAY: lambda: self.play(True), PAUSE: lambda: self.play(False),
                     STEP: lambda: session.play(False, single_steps=1), RESET: session.reset}
        shown = {tr(name): act for name, act in self.acts.items()}
        self._choices = gui.add_html("")
        gui.add_html("<i class='lab-at-run'></i>")
        buttons = gui.add_button_group(tr("Run"), tuple(shown))
        buttons.on_click(lambda event: shown[event.target.value]())
        speed_mark = gui.add_html("<i class='lab-at-speed'></i>")
        self._speeds = _offered_speeds(session.speed)
        self._speed = gui.add_dropdown(tr("Speed"), tuple(self._speeds), initial_value=_speed_name(session.speed),
                                       hint=tr("periods of the exact vibration in a second of yours"))
        bound.on_change(self._speed, lambda name: session.set_speed(self._speeds[name]))
        pin_mark = gui.add_html("<i class='lab-at-pin'></i>")
        self._pin = gui.add_button(tr(PIN), hint=tr("keep this run on the stage for comparison: both runs advance "
                                                    "together, period by period"))
        self._pin.on_click(lambda _: self._toggle_pin())
        back_mark = gui.add_html("<i class='lab-at-back'></i>")
        self._back = history.build_slider(gui)
        # Removed with its widget, as it would otherwise mark the next one.
        self.parts: dict[str, tuple[Any, ...]] = {
            "pin": (pin_mark, self._pin), "look-back": (back_mark, self._back), "speed": (speed_mark, self._speed)}

    def show_second_run(self, state: State) -> None:
        """Begins the second run of a state, if it has one, beside that on the stage."""
        if state.compared:
            self._session.pin(self._on_pinned_frame, method=state.compared)
        elif state.pinned:
            self._session.pin(self._on_pinned_frame, state.pinned)
        self.refresh()

    def on_choice(self, choice: object) -> None:
        """Compares the run with what the visitor has chosen: a method by its key, nothing, or the run as it is now."""
        if choice == KEEP:
            self._session.pin(self._on_pinned_frame)
        elif choice == NOTHING:
            self._session.unpin()
        elif isinstance(choice, str) and choice in self._session.scene.choices("method"):
            self._session.pin(self._on_pinned_frame, method=choice)
        self.refresh()
        self._on_view()

    def show(self) -> None:
        """Updates the speed and the pin's label for the session's present scene."""
        speed = self._session.speed
        if speed not in self._speeds.values():
            self._speeds = _offered_speeds(speed)
            self._speed.options = tuple(self._speeds)
        self._speed.value = _speed_name(speed)  # type: ignore[misc]
        self.refresh()

    def refresh(self) -> None:
        """Updates the label of the pin's button, "Pin this run" or "Unpin", and the choices of what to compare with."""
        session, scene = self._session, self._session.scene
        self._pin.label = tr(PIN if session.pinned_scene is None else UNPIN)
        stays = [(PINNED, tr(NAMES[PINNED]))] if session.pinned_scene else []
        said = {"chosen": PINNED if stays else session.pinned.follows if session.pinned else NOTHING, "choices": [
            (NOTHING, tr(NAMES[NOTHING])), *((key, functions_name(key)) for key in scene.choices("method")), *stays,
            (KEEP, tr(NAMES[KEEP]))]}
        self._choices.content = f"<i class='lab-compared' data-said='{escape(json.dumps(said))}'></i>"

    def _toggle_pin(self) -> None:
        self.on_choice(KEEP if self._session.pinned_scene is None else NOTHING)

    def _on_pinned_frame(self) -> None:
        """Redraws the stage for a new frame of the pinned run, unless the run beside it plays and redraws it anyway."""
        if not (self._session.report and self._session.report.playing):
            self._on_view()


def _offered_speeds(present: float) -> dict[str, float]:
    """Returns the speeds offered in periods per second, by name; the ``present`` one of a link may be another."""
    return {_speed_name(speed): speed for speed in sorted({*SPEEDS, present})}


def _speed_name(speed: float) -> str:
    """Returns the name of a speed in periods per second: "slow", "½", or its number."""
    return tr(SPEEDS[speed]) if speed in SPEEDS else localise_number(f"{speed:g}")
