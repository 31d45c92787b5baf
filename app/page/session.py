"""Session: one visitor's wishes and what has come back. Knows nothing of how it is shown."""

import threading
from collections.abc import Callable
from dataclasses import dataclass, fields
from time import monotonic
from typing import Any, Protocol

from app.page.history import History
from app.problems.views import VIEWS
from solvers.bar.scene import BarScene
from solvers.engine.frames import FrameArrays
from solvers.engine.messages import FrameReport
from solvers.engine.pool import Listener, SessionLink
from solvers.problems import PROBLEMS
from solvers.rules import SceneError
from solvers.scene import Scene

FIRST_SCENE = BarScene(periods=1)
CAPPED_BELOW = 0.9  # of the speed asked for
LOST = 0.5  # error of x over the amplitude from which on a run shows something else than the solution
BROKEN = 30.0  # error index from which on an estimate is no estimate
SLOW_ANSWER = 0.4  # seconds without an answer after which the page says that it is preparing


@dataclass(frozen=True)
class Notice:
    """A sentence for the visitor. ``kind`` is "refused", "unstable", "wait" or "trouble"."""

    kind: str
    sentence: str


class Engines(Protocol):
    """What a session needs of the pool."""

    def open(self, listener: Listener) -> SessionLink: ...


class Session:
    """Holds the wished scene (the latest wins), the last frame and the run's history."""

    def __init__(self, pool: Engines, scene: Scene, on_frame: Callable[[FrameReport, FrameArrays], None]):
        self._lock = threading.RLock()
        self._on_frame = on_frame
        self._refusal: str | None = None
        self._trouble: str | None = None
        self._lost = False
        self._restarts = self._single_steps = 0
        self._differences = False
        self._asked_at = monotonic()
        self._number = 0
        self._wished = _fields(scene)
        self.scene, self.playing, self.speed = scene, True, _first_speed(scene)
        self.history = History(scene, scene.particles)
        self.report: FrameReport | None = None
        self._link = pool.open(self)
        self._ask()

    # ---- what the visitor does ----------------------------------------------------------------------------

    def set(self, **fields: object) -> None:
        """Ask for some fields of the scene. What cannot be is refused in words, and the present scene runs on.

        A refused value stays wished, as it stays on the visitor's slider, until the whole wish can be met.
        """
        with self._lock:
            self._wished |= fields
            try:
                self.scene, self._refusal = PROBLEMS[self._wished["problem"]].scene(**self._wished), None
            except SceneError as refusal:
                self._refusal = str(refusal)
                return
            self._ask()

    def choose(self, scene: Scene) -> None:
        """Take another problem's scene whole; what was wished of the one before is forgotten."""
        with self._lock:
            self._wished, self.scene, self._refusal = _fields(scene), scene, None
            self.playing, self.speed = True, _first_speed(scene)
            self._ask()

    def play(self, playing: bool) -> None:
        with self._lock:
            self.playing = playing
            self._ask()

    def step(self) -> None:
        """Pause, and take one time step."""
        with self._lock:
            self.playing = False
            self._single_steps += 1
            self._ask()

    def reset(self) -> None:
        """Start the scene again from t = 0."""
        with self._lock:
            self._restarts += 1
            self._ask()

    def set_speed(self, speed: float) -> None:
        """Simulated seconds a second."""
        with self._lock:
            self.speed = speed
            self._ask()

    def compare(self, differences: bool) -> None:
        """Ask that frames bring the size of estimate minus truth, or no longer."""
        with self._lock:
            self._differences = differences
            self._ask()

    def close(self) -> None:
        self._link.close()

    # ---- what the page asks -------------------------------------------------------------------------------

    @property
    def capped(self) -> bool:
        """Whether the engine runs well short of the speed asked for."""
        report = self.report
        return bool(report and report.playing and report.real_speed is not None
                    and report.real_speed < CAPPED_BELOW * self.speed)

    @property
    def valid_estimators(self) -> tuple[str, ...]:
        """The estimators of the present run that hold in it, as far as is known by now."""
        report = self.report
        return tuple(e for e in report.scene.active_estimators if e not in report.not_valid) if report else ()

    def notice(self) -> Notice | None:
        """The one thing that the visitor should read now, if any."""
        with self._lock:
            waiting = self.report is None or self.report.number < self._number
            if self._trouble:
                return Notice("trouble", self._trouble)
            if self._lost and waiting:
                return Notice("wait", "The simulation process ended unexpectedly; it is being restarted "
                                      "and the scene begins again.")
            if self._refusal:
                return Notice("refused", f"{self._refusal}. The scene before it runs on.")
            waited = monotonic() - self._asked_at
            if waiting and waited > SLOW_ANSWER:
                return Notice("wait", _preparing(waited))
            if self.report and self.report.reason and not waiting:
                return Notice("unstable", f"{self.report.reason}.")
            return None if waiting else self._doubt()

    def _doubt(self) -> Notice | None:
        """A run can be sound in every number and still have nothing to do with the solution; so can an estimate."""
        series, scene = self.history.series, self.history.scene
        if "error_x" not in series or not len(series["error_x"]):
            return None
        lost = series["error_x"][-1] / scene.motion_amplitude
        if lost > LOST:
            return Notice("unstable", f"The particles have lost the solution: their error of x is {lost:.2g} times "
                                      "the amplitude. More cells or a smaller amplitude keep it longer.")
        for estimator in self.valid_estimators:
            index = series[f"{estimator}/index_x"][-1]
            if index > BROKEN:
                return Notice("refused", f"The estimate {estimator} has broken down: it is {index:.2g} times the "
                                         "true error of x. Do not trust it here.")
        return Notice("refused", f"{scene.warnings()[0]}.") if scene.warnings() else None

    # ---- what the engine says (from its reader thread) ----------------------------------------------------

    def on_frame(self, report: FrameReport, arrays: FrameArrays) -> None:
        with self._lock:
            if report.fresh:
                self.history = History(report.scene, report.particles)
            self.history.add(report.rows)
            self.report, self._lost, self._trouble = report, False, None
        self._on_frame(report, arrays)

    def on_trouble(self, sentence: str) -> None:
        with self._lock:
            self._trouble = sentence

    def on_engine_lost(self) -> None:
        with self._lock:
            self._lost = True
            self._number += 1  # the link asks again under the next number

    # ---- inside -------------------------------------------------------------------------------------------

    def _ask(self) -> None:
        self._trouble, self._asked_at = None, monotonic()
        self._number = self._link.ask(self.scene, self.playing, self.speed, self._restarts,
                                      self._single_steps, self._differences)


def _preparing(seconds: float) -> str:
    so_far = f", for {seconds:.0f} s so far" if seconds > 2 else ""
    return (f"Preparing this scene{so_far}: a combination of method, estimators and effects is compiled the first time "
            "it is used; several estimators at once take longest.")


def _first_speed(scene: Scene) -> float:
    """Simulated seconds a second at which a problem begins."""
    return VIEWS[scene.problem].speed * scene.period


def _fields(scene: Scene) -> dict[str, Any]:
    return {field.name: getattr(scene, field.name) for field in fields(scene)}
