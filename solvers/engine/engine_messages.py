"""Messages between the page and an engine. All are small and pickle quickly."""

from dataclasses import dataclass, field

import numpy as np

from solvers.engine.shared_frames import FrameOptions
from solvers.scene.scene import Scene
from solvers.solver.soundness import OK
from solvers.solver.step_breakdown import StepBreakdown

FRAME_SECONDS = 1 / 30


@dataclass(frozen=True)
class Pace:
    """Pace of a run. ``speed`` is in periods per second. ``restarts`` and ``single_steps`` are counters: an engine acts
    when they have increased. A run that ``ends`` stops at its scene's end; others continue."""

    playing: bool = True
    speed: float = 1.0
    restarts: int = 0
    single_steps: int = 0
    ends: bool = False


@dataclass(frozen=True)
class SessionRequest:
    """Complete request of a visitor: an engine acts on the latest and discards the others.

    ``number`` increases with every request and returns in frames, to match answers with requests. ``memory`` is the
    name of the shared memory block for frames, ``frame`` their contents. ``partner`` is another session of the same
    engine: the two are synchronised in periods, and restart together. ``frame_seconds`` is the time between two frames
    of a running session.
    """

    session: int
    number: int
    memory: str
    scene: Scene
    pace: Pace = field(default_factory=Pace)
    frame: FrameOptions = field(default_factory=FrameOptions)
    partner: int | None = None
    frame_seconds: float = FRAME_SECONDS


@dataclass(frozen=True)
class SessionClosed:
    """Message that the visitor has left, so that the session's resources can be freed."""

    session: int


@dataclass(frozen=True)
class Prewarm:
    """Scenes that visitors usually request, the likeliest first, to be compiled when there is time."""

    scenes: tuple[Scene, ...]


@dataclass(eq=False)
class FrameReport:
    """Report of a frame in the session's block ``memory``. ``rows`` are the samples since the last frame. The receiver
    may unify equal ``scene`` objects of several reports, and changes nothing else.

    ``fresh`` marks the first frame after a build, when data collected before belong to another run. ``rate`` is million
    particle-steps per second of kernel time; ``real_speed`` is in simulated seconds per second, None until measured.
    ``not_valid`` has a sentence for each estimator that does not hold here, known beforehand or found in the run;
    ``holds`` are the contents of the frame that exist. ``status`` is "ok", "unstable" or "lost"
    (``solvers.solver.soundness``), ``reason`` a sentence why, ``since`` the time in s since when. An unstable run has
    stopped, a lost one continues; one that is ok for positions has a reason where other quantities have errors as large
    as themselves. ``not_checked`` says what is not checked. ``breakdown`` is that of the last step, if requested and a
    single step. ``goals`` are numbers of the body, at most half a second old while the run moves
    (:func:`solvers.running.quantities_of_interest.evaluate_goal`).
    """

    session: int
    number: int
    memory: str
    scene: Scene
    fresh: bool
    playing: bool
    particles: int
    step: int
    time: float
    rows: np.ndarray
    reason: str | None
    rate: float
    real_speed: float | None
    arch: str
    not_valid: dict[str, str] = field(default_factory=dict)
    holds: FrameOptions = field(default_factory=FrameOptions)
    status: str = OK
    since: float | None = None
    breakdown: StepBreakdown | None = None
    not_checked: str | None = None
    goals: dict[str, dict] = field(default_factory=dict)

    @property
    def valid_estimators(self) -> tuple[str, ...]:
        """Names of the run's estimators that hold in it, as far as known by now."""
        return tuple(name for name in self.scene.active_estimators if name not in self.not_valid)


@dataclass(frozen=True)
class FrameBatch:
    """Frames of several sessions that are due together: each message by itself wakes the page's threads."""

    reports: tuple[FrameReport, ...]


@dataclass(frozen=True)
class EngineError:
    """Error of an engine that could not fulfil a request; ``sentence`` is for the visitor."""

    session: int
    number: int
    sentence: str


@dataclass(frozen=True)
class CompilePending:
    """Message that request ``number`` must be compiled first; meanwhile the previous scene continues."""

    session: int
    number: int


@dataclass(frozen=True)
class ForkStarted:
    """Message that the engine has a child that compiles: if the engine dies, the page must reap it."""

    process_id: int


@dataclass(frozen=True)
class EngineReplaced:
    """Message that a child has replaced the engine and has all of its sessions (``solvers.engine.compiling_fork``);
    sent by this new process."""

    process_id: int


class EngineReady:
    """Message that the engine has started and compiled the kernels of the first page."""
