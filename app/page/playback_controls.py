"""Playback controls below the stage, built once before the tabs: run, speed, pin, look back."""

from collections.abc import Callable
from typing import Any

import viser

from app.language.translation import lazy, tr
from app.page.panels.frame_and_drawing_controls import FrameAndTraceControls
from app.page.panels.scene_widgets import SceneWidgetFactory
from app.page.visit.run_session import RunSession
from solvers.scene.scene import Scene

PLAY, PAUSE, STEP, RESET = lazy("Play"), lazy("Pause"), lazy("Step"), lazy("Reset")
PIN, UNPIN = lazy("Pin this run"), lazy("Unpin")
SLOW = 0.0125  # periods per second, at which one sees single particles change their cell
SPEEDS = {SLOW: lazy("slow"), 0.25: "¼", 0.5: "½", 1.0: "1", 2.0: "2"}


class PlaybackControls:
    """One visitor's widgets for run, speed, pin and look back, made by ``bound``; ``on_view`` redraws the stage."""

    def __init__(self, gui: viser.GuiApi, session: RunSession, history: FrameAndTraceControls,
                 bound: SceneWidgetFactory, on_view: Callable[[], None]):
        self._session, self._on_view = session, on_view
        self.acts = {PLAY: lambda: session.play(True), PAUSE: lambda: session.play(False),
                     STEP: lambda: session.play(False, single_steps=1), RESET: session.reset}
        shown = {tr(name): act for name, act in self.acts.items()}
        gui.add_html("<i class='lab-at-run'></i>")
        buttons = gui.add_button_group(tr("Run"), tuple(shown))
        buttons.on_click(lambda event: shown[event.target.value]())
        speed_mark = gui.add_html("<i class='lab-at-speed'></i>")
        self._speeds = _offered_speeds(session.speed)
        self._speed = gui.add_dropdown(tr("Speed"), tuple(self._speeds), initial_value=_speed_name(session.speed),
                                       hint=tr("periods of the exact vibration in a second of yours"))
        bound.on_change(self._speed, lambda name: session.set_speed(self._speeds[name]))
        pin_mark = gui.add_html("<i class='lab-at-pin'></i>")
        self._pin = gui.add_button(tr(PIN), hint=tr("keep this run on the stage for comparison: both runs start at t = "
                                                    "0 and advance together, period by period"))
        self._pin.on_click(lambda _: self._toggle_pin())
        back_mark = gui.add_html("<i class='lab-at-back'></i>")
        self._back = history.build_slider(gui)
        # Removed with its widget, as it would otherwise mark the next one.
        self.parts: dict[str, tuple[Any, ...]] = {
            "pin": (pin_mark, self._pin), "look-back": (back_mark, self._back), "speed": (speed_mark, self._speed)}

    def pin(self, scene: Scene | None = None) -> None:
        """Runs a scene, by default that on the stage, beside later runs for comparison."""
        self._session.pin(self._on_pinned_frame, scene)

    def show(self) -> None:
        """Updates the speed and the pin's label for the session's present scene."""
        speed = self._session.speed
        if speed not in self._speeds.values():
            self._speeds = _offered_speeds(speed)
            self._speed.options = tuple(self._speeds)
        self._speed.value = _speed_name(speed)  # type: ignore[misc]
        self.refresh()

    def refresh(self) -> None:
        """Updates the label of the pin's button: "Pin this run" or "Unpin"."""
        self._pin.label = tr(PIN if self._session.pinned is None else UNPIN)

    def _toggle_pin(self) -> None:
        if self._session.pinned is None:
            self.pin()
        else:
            self._session.unpin()
        self.refresh()
        self._on_view()

    def _on_pinned_frame(self) -> None:
        """Redraws the stage for a new frame of the pinned run, unless the run beside it plays and redraws it anyway."""
        if not (self._session.report and self._session.report.playing):
            self._on_view()


def _offered_speeds(present: float) -> dict[str, float]:
    """Returns the speeds offered in periods per second, by name; the ``present`` one of a link may be another."""
    return {_speed_name(speed): speed for speed in sorted({*SPEEDS, present})}


def _speed_name(speed: float) -> str:
    """Returns the name of a speed in periods per second: "slow", "½", or its number."""
    return tr(SPEEDS[speed]) if speed in SPEEDS else f"{speed:g}"
