"""Base class of every problem's solver: stepping, sampling, and the reason why a run stopped."""

import functools
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import replace
from time import perf_counter
from typing import Any, ClassVar

import numpy as np

from solvers.estimators.estimator_arrays import unpack_arrays
from solvers.scene.estimator_hooks import NEVER, EstimatorHooks
from solvers.scene.kernel_options import KernelOptions, kernel_key, kernel_options_of
from solvers.scene.scene import Scene
from solvers.solver.particle_snapshot import ParticleFields, Snapshot
from solvers.solver.particle_step_breakdown import ParticleStepBreakdown
from solvers.solver.samples import MARGIN, MAX_ROWS
from solvers.solver.soundness import LOST, OK, UNSTABLE, SoundnessFinding
from solvers.solver.state_arrays import DiagnosticsState, StateBuffers
from solvers.solver.verdict_basis import LargeRelativeError, large_error_warning
from solvers.translatable_message import Message

STEP, MEASURE, REPORT = 0, 1, 2  # purpose of a launch
NO_LARGE_ERRORS: Mapping[str, LargeRelativeError] = {}
SOUND, INVERTED, CRUSHED, ESCAPED = 0, 1, 2, 3  # first number of a verdict


class Solver(ABC):
    """Owner of the arrays of one run, which it steps and samples. All calls must come from the thread that started
    Taichi.

    A problem's solver sets ``arch``, ``plan`` and ``threads``, calls :meth:`_start`, and supplies the initial state
    (with a member ``material_position``), the kernels and the estimators.
    """

    plan: str = "serial"
    HOOKS: ClassVar[Mapping[str, EstimatorHooks]]  # of every estimator that the problem has
    PHASES: ClassVar[Any]  # of ``solvers.solver.serial_stepping``
    STATE: ClassVar[type[DiagnosticsState]]
    STEP_BREAKDOWN: Any  # the problem's module of this name
    _arrays: DiagnosticsState
    _stepping: Any  # launches the kernels on them, such as ``solvers.solver.serial_stepping.SerialStepper``
    _switches: KernelOptions

    def __init__(self, scene: Scene):
        self.scene = scene
        self.step = 0
        self.arch = ""
        self.setup_seconds = 0.0  # time to place particles and set up estimators
        self.threads = 1
        self._switches = kernel_options_of(scene)
        self._buffers = StateBuffers()
        self._stepping = None

    def restart(self, scene: Scene, idle_estimators: bool = False) -> bool:
        """Starts another scene with the same kernels at t = 0, in the arrays that are there, several times as fast as a
        new solver and equal to it, to the bit. Arrays that have no room for it are replaced.

        With ``idle_estimators`` the kernels may have estimators that are not active in the scene: they do nothing, and
        their columns of samples mean nothing. Returns False, and changes nothing, where a new solver is needed: for
        other compile-time options, another plan, and on a GPU. Raises :class:`SceneError` where a new solver would.
        States and bookmarks of the previous scene cannot be restored afterwards.
        """
        options, own = kernel_options_of(scene), self._switches
        if idle_estimators and set(options.estimators) < set(own.estimators):
            options = options._replace(estimators=own.estimators)
        same = options == own and kernel_key(scene)[:-1] == kernel_key(self.scene)[:-1]
        if self.plan == "gpu" or not same or self._plan_of(scene) != self.plan:
            return False
        self._start(scene)
        return True

    def _start(self, scene: Scene) -> None:
        """Stores the initial state of a scene, and prepares the launches of its kernels."""
        begun = perf_counter()
        self.scene, self.step = scene, 0
        self._arrays = self.STATE(**self._buffers.store(self._initial_state(scene)))
        vars(self).pop("_estimator_arrays", None)  # views of the previous scene's
        if self._stepping is None or self._buffers.moved or not self._stepping.restart(scene, self._arrays):
            self._stepping = self._make_stepper()
        self.setup_seconds = perf_counter() - begun

    @property
    def time(self) -> float:
        return self.step * self.scene.time_step

    @property
    def options(self) -> KernelOptions:
        """Compile-time options of the kernels."""
        return self._switches

    @property
    def particles(self) -> int:
        """Number of particles, of which a layout may have a few more than its scene says."""
        return len(self._arrays.members()["material_position"])

    @property
    def bytes(self) -> int:
        """Memory of all arrays, in bytes."""
        return sum(a.nbytes for a in self._arrays.members().values() if isinstance(a, np.ndarray))

    @property
    def sound(self) -> bool:
        """Whether no check has found the run unstable so far."""
        return self._arrays.verdict[0] == SOUND

    @property
    def longest_advance(self) -> int:
        """Number of steps that one :meth:`advance` may take before its samples have to be collected."""
        return (MAX_ROWS - 1) * self.scene.sample_interval

    def compile(self) -> None:
        """Compiles (or loads from the cache) the kernels of this scene, without stepping."""
        self._run(0)
        self._stepping.compile()
        if self.scene.has("margin"):
            self._stepping.compute_step_margin()

    def advance(self, steps: int, margins: bool = True) -> np.ndarray:
        """Takes steps, 0 to :attr:`longest_advance`; returns the rows of samples on the way (n, columns), as in
        ``solvers.solver.samples``.

        An unstable run stops where it was noticed; see :attr:`sound` and :meth:`reason`. If the step margin is
        requested, launches end at the steps where it is evaluated, so that calls of any length give the same run;
        without ``margins`` they do not, which is faster and leaves most margins out.
        """
        interval, end, rows = self.scene.margin_interval, self.step + steps, []
        while True:
            ends_early = margins and self.scene.has("margin")
            stop = min(end, (self.step // interval + 1) * interval) if ends_early else end
            rows.append(self._launch(stop - self.step))
            if self.step >= end or not self.sound:
                return np.concatenate(rows) if len(rows) > 1 else rows[0]

    def _launch(self, steps: int) -> np.ndarray:
        """Takes steps in one launch, or in as many as the plan needs; returns the rows of samples (n, columns)."""
        interval, before = self.scene.sample_interval, self.step
        self._run(steps)
        self.step = self.step + steps if self.sound else int(self._arrays.verdict[1])
        rows = self._arrays.samples[:max(0, self.step // interval - before // interval)].copy()
        return self._with_margin(rows) if self.step % self.scene.margin_interval == 0 else rows

    def break_down(self, particle: int) -> tuple[np.ndarray, ParticleStepBreakdown]:
        """Takes one step; returns its rows of samples (0 or 1, columns), and its details around a particle's number."""
        self._stepping.fetch()
        before = self.STEP_BREAKDOWN.particle_state(self.scene, self._arrays)
        rows = self.advance(1)
        self._stepping.fetch()
        return rows, self.STEP_BREAKDOWN.breakdown(self.scene, self._arrays, particle, self.step, before)

    def measure(self) -> np.ndarray:
        """Checks the present state and returns its sample, one row (1, columns) as in ``solvers.solver.samples``."""
        self._stepping.inspect_state(self.step, MEASURE)
        return self._with_margin(self._arrays.samples[:1].copy())

    def _with_margin(self, rows: np.ndarray) -> np.ndarray:
        """Returns rows of samples (n, columns) after writing the step margin, if requested, into the last of them."""
        if len(rows) and self.scene.has("margin"):
            self._stepping.compute_step_margin()
            rows[-1, MARGIN] = self._arrays.step_margin[0]
        return rows

    def not_valid(self) -> dict[str, str]:
        """Returns the estimators that do not hold here, by name, with a sentence why: known before, or by the run."""
        found = {name: self.HOOKS[name].verdict(self.scene, self._estimator_arrays)
                 for name in self.scene.active_estimators}
        return {**self.scene.not_valid, **{name: reason for name, reason in found.items() if reason}}

    @functools.cached_property
    def _estimator_arrays(self) -> dict[str, np.ndarray]:
        """Arrays of the estimators by name: views of those that the kernels write to."""
        return unpack_arrays(self.HOOKS, self._arrays.memory)

    @property
    def estimate_intervals(self) -> tuple[int, ...]:
        """Number of run steps between two steps of each active estimator."""
        intervals = zip(self._switches.estimators, self._arrays.estimate_intervals, strict=False)
        return tuple(int(n) for name, n in intervals if name in self.scene.active_estimators)

    def bookmark(self) -> Callable[[], None]:
        """Saves the present state; returns a function () that restores it to the bit, any number of times."""
        return functools.partial(self.restore, *self.state())

    def state(self) -> tuple[int, dict[str, np.ndarray]]:
        """Returns the step number and copies of all arrays by name, from which a solver of the same scene can go on."""
        self._stepping.fetch()
        return self.step, {name: a.copy() for name, a in self._arrays.members().items() if isinstance(a, np.ndarray)}

    def restore(self, step: int, arrays: Mapping[str, np.ndarray]) -> None:
        """Restores, to the bit, a step number and arrays that :meth:`state` of a solver of the same scene returned."""
        members = self._arrays.members()
        for name, values in arrays.items():
            members[name][...] = values
        self._stepping.upload()
        self.step = step

    def without_estimators(self) -> "Solver":
        """Returns another solver for the same scene without estimators, in the same state, at the same step."""
        self._stepping.fetch()
        other = type(self)(replace(self.scene, estimators=(), sample_every=self.scene.sample_interval))
        own, theirs = self._arrays.members(), other._arrays.members()
        watching = {"estimate", "estimate_intervals", "samples", *self._arrays.memory}
        for name in own.keys() - watching:
            if isinstance(own[name], np.ndarray) and own[name].shape == theirs[name].shape:
                theirs[name][...] = own[name]
        other._stepping.upload()
        other.step = self.step
        return other

    def disable_estimator(self, estimator: str) -> None:
        """Stops the active estimator of this name, for timings; restoring a bookmarked state starts it again."""
        self._arrays.estimate_intervals[self._switches.estimators.index(estimator)] = NEVER

    def reason(self) -> str:
        """Returns in one sentence why an unstable run stopped."""
        kind, step, p = (int(n) for n in self._arrays.verdict)
        what = {INVERTED: Message("turned inside out (its deformation gradient fell to zero or is not a number)"),
                CRUSHED: Message("was crushed to less than a thousandth of its size"),
                ESCAPED: self._escape_sentence()}[kind]
        return Message("the run went unstable at t = {time:.4g} s: particle {p} (X = {place}) {what}",
                       step * self.scene.time_step, p, self._position_text(p), what) + self._known_weakness()

    def status(self, finding: SoundnessFinding | None,
               as_large: Mapping[str, LargeRelativeError] = NO_LARGE_ERRORS) -> tuple[str, str | None, float | None]:
        """Returns "ok", "unstable" or, with a ``finding``, "lost"; a sentence that explains it, or None; and the time
        in s since when, or None. A run that is ok has a sentence where errors, by quantity, are ``as_large`` as the
        quantities."""
        since = None if finding is None else finding.time
        if not self.sound:
            return UNSTABLE, self.reason(), self.time if since is None else since
        if finding is None:
            return OK, large_error_warning(self.scene, as_large), None
        return LOST, self.loss_sentence(finding), since

    def loss_sentence(self, finding: SoundnessFinding) -> str:
        """Returns a sentence when, by the ``finding``, the run was lost, where most, and why."""
        where = "" if finding.particle is None else \
            Message(", most at particle {particle} (X = {place})", finding.particle,
                    self._position_text(finding.particle))
        return Message("the run is lost from t = {time:.4g} s on: {sentence}{where}", finding.time, finding.sentence,
                       where) + self._known_weakness()

    def _position_text(self, particle: int) -> str:
        return ", ".join(f"{x:.4f}" for x in np.atleast_1d(self._arrays.members()["material_position"][particle]))

    def _known_weakness(self) -> str:
        """Returns what is known to break runs of this scene, to be put behind a sentence; "" for nothing."""
        weakness = self.scene.known_weakness
        return Message("; {weakness}", weakness) if weakness else ""

    def _plan_of(self, scene: Scene) -> str:
        """Returns the plan by which a new solver would step a scene."""
        return "serial"

    @abstractmethod
    def _initial_state(self, scene: Scene) -> dict[str, Any]:
        """Returns the numbers and arrays of ``STATE`` by name at the start of a scene."""

    @abstractmethod
    def _make_stepper(self) -> Any:
        """Returns a new stepper of the buffers, with the numbers of the present state."""

    @abstractmethod
    def snapshot(self, differences: bool = False, plotted: str | None = None) -> Snapshot:
        """Returns the particles as they are now, with their true and estimated errors; with ``differences`` also those
        between the two, with ``plotted``, a key of ``samples.QUANTITIES``, in one dimension also this quantity's
        field."""

    def plotted(self, quantity: str) -> np.ndarray | None:
        """Returns, in one dimension, the present field of "x", "v", "sigma" or "a" and its deviation from the exact one
        (P, 2), in SI; None in the plane, where only errors are plotted."""
        return None

    @abstractmethod
    def fields(self) -> ParticleFields:
        """Returns all present fields of the particles, in SI, and their known or estimated signed errors."""

    def _run(self, steps: int) -> None:
        """Launches the kernels for ``steps`` steps from ``self.step``."""
        self._stepping.run(self.step, steps)

    @abstractmethod
    def _escape_sentence(self) -> str:
        """Returns how a particle outside the allowed region has moved, as part of a sentence."""
