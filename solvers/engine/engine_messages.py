"""What the page and an engine say to each other. Everything here is small and pickles quickly."""

from dataclasses import dataclass, field

import numpy as np

from solvers.engine.shared_frames import FrameOptions
from solvers.scene.scene import Scene
from solvers.solver.soundness import OK
from solvers.solver.step_breakdown import StepBreakdown

FRAME_SECONDS = 1 / 30


@dataclass(frozen=True)
class Pace:
    """How a run moves. ``speed`` is in periods a second. ``restarts`` and ``single_steps`` are counts: an engine acts
    when they have grown. A run that ``ends`` stops where its scene says; others go on."""

    playing: bool = True
    speed: float = 1.0
    restarts: int = 0
    single_steps: int = 0
    ends: bool = False


@dataclass(frozen=True)
class SessionRequest:
    """Everything a visitor wants, in one piece: an engine acts on the latest and forgets the rest.

    ``number`` grows with every wish and comes back in frames, so that an answer can be told from an echo. ``memory``
    names the shared memory block that frames go to, ``frame`` is what they should hold. ``partner`` is another session
    of the same engine: the two keep together in periods, and start again together. ``frame_seconds`` is the time
    between two frames of a run that plays.
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
    """The visitor has left: free what the session holds."""

    session: int


@dataclass(frozen=True)
class Prewarm:
    """What visitors usually ask for, the likeliest first: to be compiled when there is time."""

    scenes: tuple[Scene, ...]


@dataclass(eq=False)
class FrameReport:
    """A frame lies in the session's block called ``memory``. ``rows`` are the samples since the last frame. Whoever
    gets many puts one ``scene`` into those that have equal ones, and changes nothing else.

    ``fresh`` marks the first frame after a build, when what was collected before belongs to another run. ``rate`` is
    million particle-steps per second of kernel time; ``real_speed`` is in simulated seconds a second, None until it has
    been measured. ``not_valid`` has a sentence for each estimator that does not hold here, known beforehand or found
    out by now; ``holds`` is what the frame holds of what was asked for. ``status`` is "ok", "unstable" or "lost"
    (``solvers.solver.soundness``), ``reason`` says why in a sentence, ``since`` from which time in s on. An unstable
    run has stopped; a lost one goes on; one that is ok for positions has a reason where other quantities are as wrong
    as they are large. ``not_checked`` says what nobody looks at. ``breakdown`` is of the last step, if the wish asks
    for it and that was a single one. ``goals`` are numbers of the body as of half a second ago at most, while the run
    moves (:func:`solvers.running.quantities_of_interest.evaluate`).
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
        """The estimators of the run that hold in it, as far as is known by now."""
        return tuple(name for name in self.scene.active_estimators if name not in self.not_valid)


@dataclass(frozen=True)
class FrameBatch:
    """Frames of several sessions that have come due about together: each message by itself wakes the page's threads."""

    reports: tuple[FrameReport, ...]


@dataclass(frozen=True)
class EngineError:
    """The engine could not do what the wish says; ``sentence`` is for the visitor."""

    session: int
    number: int
    sentence: str


@dataclass(frozen=True)
class CompilePending:
    """What wish ``number`` asks for has to be compiled first; the scene before it goes on meanwhile."""

    session: int
    number: int


@dataclass(frozen=True)
class ForkStarted:
    """The engine has a successor at work: should the engine die, that is left to the page."""

    process_id: int


@dataclass(frozen=True)
class EngineReplaced:
    """The engine has been replaced by a successor of its own, which has all that it had
    (``solvers.engine.compiling_fork``); this is the process that speaks from now on."""

    process_id: int


class EngineReady:
    """The engine has started and compiled what the first page needs."""
