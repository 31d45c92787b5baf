"""Messages between the page and an engine. All are small and pickle quickly."""

from collections.abc import Hashable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from solvers.engine.shared_frames import FrameOptions
from solvers.scene.scene import Scene
from solvers.solver.particle_step_breakdown import ParticleStepBreakdown
from solvers.solver.soundness import OK
from solvers.study.landscape.error_history import ErrorHistory

FRAME_SECONDS = 1 / 30


@dataclass(frozen=True)
class Pace:
    """Pace of a run: whether it is ``playing``, its ``speed`` in periods per second, and whether it ``ends`` at its
    scene's end or continues. ``restarts`` and ``single_steps`` count the requests for a restart or a step so far: an
    engine acts when they have increased. ``begin_at`` is the time in periods that a new run is stepped to, playing or
    not, before its first frame."""

    playing: bool = True
    speed: float = 1.0
    restarts: int = 0
    single_steps: int = 0
    ends: bool = False
    begin_at: float = 0.0

    def first_step(self, scene: Scene) -> int:
        """Returns the number of the step next to ``begin_at`` in a run of a scene."""
        return round(self.begin_at * scene.period / scene.time_step)


@dataclass(frozen=True)
class SessionRequest:
    """Complete request of a visitor: an engine acts on the latest and discards the others.

    ``session`` is the number of the visitor's session; ``number`` increases with every request and returns in frames,
    to match answers with requests. ``memory`` is the name of the shared memory block for frames, ``frame`` their
    optional contents. ``partner`` is the number of another session of the same engine, or None: the two are
    synchronised in periods, and restart together. ``frame_seconds`` is the time in s between two frames of a running
    session."""

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
    """Message that the visitor of the ``session`` of this number has left: the engine frees its resources."""

    session: int


class SurveyPoint(NamedTuple):
    """Point of a landscape: a run of a session's scene with another value of a parameter, until a time in periods.
    Points of a lower ``level`` come first, of all sessions."""

    parameter: str
    value: float
    until: float
    level: int


@dataclass(frozen=True)
class Survey:
    """Request for points of the landscapes of a session's scene, in this order, in place of those that it requested
    before; none, and no scene, to end these."""

    session: int
    scene: Scene | None = None
    points: tuple[SurveyPoint, ...] = ()


@dataclass(frozen=True)
class SurveyResults:
    """Message with histories of runs that were requested, by their keys (``parameter_values.history_key``)."""

    histories: tuple[tuple[Hashable, ErrorHistory], ...]


@dataclass(frozen=True)
class Prewarm:
    """Message with scenes that visitors usually request, the likeliest first, to be compiled when there is time."""

    scenes: tuple[Scene, ...]


@dataclass(eq=False)
class FrameReport:
    """Report of a frame, at the ``time`` in s, in the session's shared memory block ``memory``; ``number`` is that of
    the request. ``rows`` (n, C) are the samples since the last frame. The receiver may unify equal ``scene`` objects of
    several reports, and changes nothing else.

    ``fresh`` marks the first frame after a build, when data collected before belong to another run. ``rate`` is million
    particle-steps per s of kernel time, on one thread of processor time; ``real_speed`` is in simulated s per s, None
    until measured. ``not_valid`` has a sentence for each estimator that does not hold here, known beforehand or found
    in the run; ``holds`` are the optional contents that the frame has. ``status`` is "ok", "unstable" or "lost"
    (``solvers.solver.soundness``), ``reason`` a sentence why, ``since`` the time in s since when. An unstable run has
    stopped, a lost one continues; one that is ok for positions has a reason if other quantities have errors as large as
    themselves. ``not_checked`` is a sentence on what is not checked. ``breakdown`` is that of the last step, if
    requested and a single step. ``goals`` are numbers of the body, at most half a second old while the run moves
    (:func:`solvers.running.quantities_of_interest.evaluate_goal`)."""

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
    breakdown: ParticleStepBreakdown | None = None
    not_checked: str | None = None
    goals: dict[str, dict] = field(default_factory=dict)

    @property
    def valid_estimators(self) -> tuple[str, ...]:
        """Names of the run's estimators that are valid in it, as far as known by now."""
        return tuple(name for name in self.scene.active_estimators if name not in self.not_valid)


@dataclass(frozen=True)
class FrameBatch:
    """Message with the frames of several sessions, together because every message wakes the page's threads."""

    reports: tuple[FrameReport, ...]


@dataclass(frozen=True)
class EngineError:
    """Message that an engine could not fulfil request ``number`` of a session; ``sentence`` is for the visitor."""

    session: int
    number: int
    sentence: str


@dataclass(frozen=True)
class CompilePending:
    """Message that request ``number`` of a session must be compiled first; meanwhile its previous scene continues."""

    session: int
    number: int


@dataclass(frozen=True)
class EngineForked:
    """Message that the engine has a child, of this process id, that compiles or computes landscapes; the page reaps it
    if the engine dies."""

    process_id: int


@dataclass(frozen=True)
class EngineReplacedByFork:
    """Message from a child, of this process id, that it has replaced the engine and has all of its sessions."""

    process_id: int


class EngineReady:
    """Message that the engine has started and compiled the kernels of the first page."""
