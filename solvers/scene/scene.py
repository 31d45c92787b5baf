"""Scene: everything that defines a run, in one frozen object, and the rules that it must satisfy.

The command line, the page and the tests all build a ``Scene``; nothing else is configured anywhere. A ``Scene`` that
exists is valid: a bad value raises :class:`~solvers.scene.validation.SceneError` with one sentence that names the
input, says what is wrong and what is allowed.
"""

from __future__ import annotations

import functools
import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any, ClassVar

from solvers.scene import effects, estimator_limits, estimator_registry, validation
from solvers.scene.derived_quantities import DerivedSceneQuantities
from solvers.scene.effects import ALL, EFFECTS, effects_of
from solvers.scene.field_options import option
from solvers.scene.stabilisations import FROZEN
from solvers.scene.step_bound import SAFE, StepBound, scene_step_bound, step_warnings
from solvers.scene.validation import SceneError, field_key, require_choice, require_names, require_number, require_whole
from solvers.translatable_message import Message

MOST_PARTICLES = 1_000_000  # on a processor
MOST_ON_GPU = 50_000_000
MOST_STEPS = 2_000_000_000  # the step index is a 32-bit integer
MOST_SAMPLES = 1_000_000
DEFAULT_CFL = 0.05
LOOKS_A_PERIOD = 20  # checks for contradictions; more would find nothing important earlier
STEPS_A_SAMPLE = 20  # at least, for a sample with its estimates costs several steps; but
LEAST_SAMPLES_A_PERIOD = 20  # however long the steps
MOST_MARGINS = 200  # evaluations of the step margin in a run, about
SAMPLES_A_RUN = 100_000  # of a long run, unless the scene sets the sample interval
LISTS = ("estimators", "effects", "remedies")
AUTO = "auto"
ESTIMATORS_HELP = "Error estimators, one or several"
LEAST_CFL = 1e-9
MOST_CFL = 10.0  # an unstable run is instructive; this only keeps the numbers finite for a while


@dataclass(frozen=True)
class Scene(DerivedSceneQuantities, ABC):
    """Definition of a run. Lengths in metres, times in seconds, modulus in pascals, density in kg/m³.

    ``dt`` or ``cfl`` sets the time step (``cfl`` = dt c/h, c = sqrt(modulus/density)); ``t_end`` or ``periods`` the
    end; None takes the default. Each problem has a scene class of its own with its defaults, choices and geometry.
    """

    problem: str = option("")
    method: str = option("", "Shape functions of the particles")
    cells: int = option(0, "Cells of the grid")
    ppc: float = option(0, "Particles per cell")  # whole, but where a problem says otherwise
    amplitude: float = option(0.0, "Amplitude A of the displacement", "m")
    modulus: float = option(0.0, "Young's modulus E", "Pa")
    density: float = option(0.0, "Density", "kg/m3")
    dt: float | str | None = option(None, "Time step, or auto: what the motion ahead bears; instead of --cfl", "s",
                                    hint="from --cfl")
    cfl: float | None = option(None, "Time step as dt c/h, no unit, c = sqrt(E/density); instead of --dt",
                               hint=f"{DEFAULT_CFL} without --dt")
    t_end: float | None = option(None, "End of the run; instead of --periods", "s", hint="from --periods")
    periods: float | None = option(None, "End of the run in periods of the vibration; instead of --t-end",
                                   hint="{scene.DEFAULT_PERIODS:g} without --t-end")
    body_force: str = option("material", "Body force", choices=("material",))
    linearity_preserving: bool = option(False, "Make the particle-grid transfers exact for linear fields")
    velocity: str = option("grid", "Velocity that moves the particles", choices=("grid", "particle"))
    estimators: tuple[str, ...] = option((), ESTIMATORS_HELP)  # of each problem its default judge
    effects: tuple[str, ...] = option(tuple(EFFECTS), "What to compute beside the method, with commas between, in "
                                      "place of the default, or +NAME beside it; what is left out costs nothing",
                                      hint="all")
    remedies: tuple[str, ...] = option((), "Remedies against the diseases of long and large motions, with commas "
                                       "between", hint="none")
    arch: str = option("cpu", "Where to run: on the processor, or what is in the plane on a GPU, found or by name",
                       choices=("cpu", "gpu", "cuda", "vulkan"))
    threads: int = option(1, "Processor threads, at most")
    sample_every: int | None = option(None, "Steps between two samples of the errors",
                                      hint="about {scene.SAMPLES_A_PERIOD} samples a period")

    SETTING: ClassVar[str]  # where it is, in the words of its command's help
    EXTRA_ERROR: ClassVar[str]  # what its own error norm is called in the result (see ``solvers.solver.samples``)
    LIMITS: ClassVar[tuple[estimator_limits.Limit, ...]] = ()  # beyond which an estimator is known not to hold
    DIMENSIONS: ClassVar[int] = 1
    GENTLE_AMPLITUDE: ClassVar[float]  # at which every method's run stays sound, for timings
    HARD_AMPLITUDES: ClassVar[tuple[float, ...]]  # of a stability map
    FEWEST_CELLS: ClassVar[int] = 4
    ESTIMATORS: ClassVar[tuple[str, ...]] = ()  # that the problem has, of those in ``solvers.scene.estimator_registry``
    REMEDIES: ClassVar[tuple[str, ...]] = ()
    OWN_EFFECTS: ClassVar[tuple[str, ...]] = ()  # that not every problem has
    DEFAULT_PERIODS: ClassVar[float] = 5.0
    SAMPLES_A_PERIOD: ClassVar[int] = 200

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        if "ESTIMATORS" in vars(cls):
            cls.__annotations__["estimators"] = Scene.__annotations__["estimators"]
            cls.estimators = option(estimator_registry.default_estimators(cls.ESTIMATORS), ESTIMATORS_HELP)

    @classmethod
    def choices(cls, name: str) -> tuple[str, ...]:
        """Returns the names that the field called ``name`` may hold, one or several; empty for a number."""
        if name == "estimators":
            return estimator_registry.names(cls.problem, cls.ESTIMATORS)
        if name == "remedies":
            return cls.REMEDIES
        if name == "effects":
            return effects_of(cls.problem, cls.OWN_EFFECTS)
        return cls.__dataclass_fields__[name].metadata.get("choices", ())

    @classmethod
    def candidates(cls) -> tuple[tuple[str, bool], ...]:
        """Returns the pairs (method, linearity preserving) that an advisor tries."""
        return tuple((method, False) for method in cls.choices("method"))

    def __reduce__(self) -> tuple[Callable[..., Any], tuple]:
        """Pickles the scene as its values. Unpickling returns the same object each time: a scene is sent with every
        frame, and each process validates it and derives its properties once."""
        return _cached_scene, (type(self), *(getattr(self, name) for name in self.__match_args__))

    def __post_init__(self) -> None:
        if self.problem != (kind := type(self)).problem:  # it came first, without a name
            raise SceneError("problem", self.problem, "is not {problem}; give the inputs of a scene by name, as in "
                             "{name}(cells=40)", Message(kind.problem), kind.__name__)
        for name, value in self._normalized_inputs().items():  # the one place where a scene is written to
            object.__setattr__(self, name, value)
        self._check_choices()
        self._check_numbers()
        self._check_time()
        self._check_combinations()

    @property
    @abstractmethod
    def spacing(self) -> float:
        """Cell size h, in m."""

    @property
    @abstractmethod
    def particles(self) -> int:
        """Number of particles."""

    @abstractmethod
    def critical_time_step(self) -> StepBound:
        """Returns the longest stable steps of the motion ahead by linear theory, in s: see :attr:`step_bound`."""

    @abstractmethod
    def _check_amplitude(self) -> None:
        """Raises :class:`SceneError` for an amplitude without an exact solution."""

    def warnings(self) -> list[str]:
        """Returns sentences for the user about inputs that are valid but surprising."""
        sentences = step_warnings(self)
        if "truth" in self.effects and not self.solution_known:
            sentences.append(Message("body force {body_force}: no exact solution is built in, so the true error is "
                                     "unknown", self.body_force))
        return sentences

    @functools.cached_property
    def period(self) -> float:
        """Period of the vibration, 2 pi/w, in s."""
        return 2 * math.pi / self.angular_frequency

    @functools.cached_property
    def time_step(self) -> float:
        """Time step in s, from ``dt`` or ``cfl``; for ``dt`` "auto" a share of :attr:`step_bound`."""
        if self.dt == AUTO:
            return SAFE * self.step_bound
        return float(self.dt) if self.dt is not None else self.courant_number * self.spacing / self.wave_speed

    @property
    def step_bound(self) -> float:
        """Longest stable step of the motion ahead, in s, by linear theory (``solvers.scene.step_bound``)."""
        return scene_step_bound(self).longest

    @property
    def frozen(self) -> bool:
        """Whether the weights are computed only once, at the material positions."""
        return FROZEN in self.remedies

    @property
    def courant_number(self) -> float:
        """Courant number dt c/h: ``cfl`` as given, or from ``dt``."""
        if self.dt is not None:
            return self.time_step * self.wave_speed / self.spacing
        return DEFAULT_CFL if self.cfl is None else self.cfl

    @property
    def end_time(self) -> float:
        if self.t_end is not None:
            return self.t_end
        return (self.DEFAULT_PERIODS if self.periods is None else self.periods) * self.period

    @functools.cached_property
    def steps(self) -> int:
        """Number of steps to the end time, rounded to the nearest step."""
        return max(1, round(self.end_time / self.time_step))

    @functools.cached_property
    def sample_interval(self) -> int:
        """Number of steps from one sample of the errors' norms to the next."""
        if self.sample_every is not None:
            return self.sample_every
        a_period = int(min(self.period / self.time_step, MOST_STEPS))
        wanted = max(a_period // self.SAMPLES_A_PERIOD, min(STEPS_A_SAMPLE, a_period // LEAST_SAMPLES_A_PERIOD))
        wanted = max(wanted, math.ceil(self.steps / SAMPLES_A_RUN))
        return max(1, wanted // self.estimate_interval) * self.estimate_interval

    @functools.cached_property
    def look_interval(self) -> int:
        """Number of steps from one check for contradictions to the next, a multiple of the sample interval."""
        return self.sample_interval * max(1, int(self.period / self.time_step / LOOKS_A_PERIOD / self.sample_interval))

    @functools.cached_property
    def margin_interval(self) -> int:
        """Number of steps between evaluations of the step margin: each costs a launch, so that long runs have fewer."""
        return self.look_interval * max(1, self.steps // (MOST_MARGINS * self.look_interval))

    @property
    def estimate_interval(self) -> int:
        """Number of run steps in one of an estimator: half the time a wave takes through a cell, at most 10."""
        return max(1, min(10, int(0.5 / self.courant_number)))

    @functools.cached_property
    def not_valid(self) -> dict[str, str]:
        """Requested estimators that are known not to hold here and do not run, by name, each with a sentence why."""
        reasons = {name: estimator_limits.reason(self.LIMITS, name, self) for name in self.estimators}
        if self.prefers_gpu:
            reasons |= {name: Message(estimator_registry.PROCESSOR_REASON, name=name) for name in self.estimators
                        if not estimator_registry.ESTIMATORS[name].beside_gpu}
        return {name: Message("not valid here: {reason}", reason) for name, reason in reasons.items() if reason}

    @functools.cached_property
    def active_estimators(self) -> tuple[str, ...]:
        """Names of the estimators that run: those requested that are valid here, if the effect ``estimate`` is on.
        Their order does not depend on the request, so that their kernels are compiled once."""
        if "estimate" not in self.effects:
            return ()
        return tuple(e for e in self.choices("estimators") if e in self.estimators and e not in self.not_valid)

    def has(self, effect: str) -> bool:
        """Returns whether the effect of this name is on and has what it needs, as ``estimate`` needs an estimator."""
        if effect not in self.effects:
            return False
        if effect == "estimate":
            return bool(self.active_estimators)
        kind = ALL[effect]
        return (self.solution_known or not kind.needs_solution) and (not kind.needs or any(map(self.has, kind.needs)))

    @functools.cached_property
    def active_effects(self) -> tuple[str, ...]:
        """Names of the effects that are on and possible, in the order of the registry."""
        return tuple(filter(self.has, ALL))

    def to_dict(self) -> dict:
        """Returns every input with defaults filled in, by its key in JSON objects."""
        values = {field_key(f.name): getattr(self, f.name) for f in fields(self)}
        filled = {"dt": self.time_step, "cfl": self.courant_number, "t_end": self.end_time,
                  "periods": self.end_time / self.period, "sample_every": self.sample_interval}
        return {**values, **filled, **{field_key(name): list(getattr(self, name)) for name in LISTS}}

    def _normalized_inputs(self) -> dict[str, Any]:
        """Returns by field name those inputs that are replaced by their normal form."""
        return validation.normalized_inputs(self, LISTS)

    def _check_choices(self) -> None:
        estimator_registry.require_offered(self.estimators, type(self).problem, self.choices("estimators"))
        effects.require_offered(self.effects, type(self).problem, self.choices("effects"))
        for name in self.__dataclass_fields__:
            if name in LISTS:
                require_names(name, getattr(self, name), self.choices(name))
            elif self.choices(name):
                require_choice(name, getattr(self, name), self.choices(name))
        if not isinstance(self.linearity_preserving, bool):
            raise SceneError("linearity_preserving", self.linearity_preserving, "give True or False")

    def _check_numbers(self) -> None:
        require_whole("cells", self.cells, self.FEWEST_CELLS, 100_000)
        self._check_per_cell()
        require_whole("threads", self.threads, 1, 1024)
        self._check_amplitude()
        require_number("modulus", self.modulus, 1e-6, 1e12)
        require_number("density", self.density, 1e-6, 1e12)
        most = MOST_ON_GPU if self.prefers_gpu else MOST_PARTICLES
        if self.particles > most:
            raise SceneError("ppc", self.ppc, "{cells} cells with so many particles each make {particles:,} particles; "
                             "at most {most:,} are allowed", self.cells, self.particles, most)

    def _check_time(self) -> None:
        for one, other in (("dt", "cfl"), ("t_end", "periods")):
            if getattr(self, one) is not None and getattr(self, other) is not None:
                raise SceneError(other, getattr(self, other),
                                 "{one} is given too; give one of the two", Message(one.replace("_", "-")))
            for name in (one, other):
                if getattr(self, name) is not None and (name, getattr(self, name)) != ("dt", AUTO):
                    allowed = Message("give a number above 0, or auto") if name == "dt" else ""
                    require_number(name, getattr(self, name), 0, math.inf, allowed)
        name, unit = ("cfl", 1.0) if self.dt is None else ("dt", self.spacing / self.wave_speed)
        if self.courant_number > MOST_CFL:
            raise SceneError(name, getattr(self, name), "is far above any stable step; give a number above 0 and up to "
                             "{unit:.3g} (cfl {most:g})", MOST_CFL * unit, MOST_CFL)
        if self.courant_number < LEAST_CFL:
            raise SceneError(name, getattr(self, name), "is too short a step for the floating-point precision; give "
                             "{unit:.3g} (cfl {least:g}) or more", LEAST_CFL * unit, LEAST_CFL)
        if self.end_time / self.time_step > MOST_STEPS:
            name = "t_end" if self.t_end is not None else "periods"
            raise SceneError(name, getattr(self, name) or self.DEFAULT_PERIODS, "needs {end_time:.3g} steps; at most "
                             "{most:,} are allowed: end earlier or take longer steps", self.end_time / self.time_step,
                             MOST_STEPS)
        if self.sample_every is not None:
            require_whole("sample_every", self.sample_every, 1, MOST_STEPS)
        if self.steps / self.sample_interval > MOST_SAMPLES:
            raise SceneError("sample_every", self.sample_interval, "makes {steps:,} samples; at most {most:,} are "
                             "allowed, so sample every {interval} steps or more", self.steps // self.sample_interval,
                             MOST_SAMPLES, math.ceil(self.steps / MOST_SAMPLES))


@functools.lru_cache(maxsize=256, typed=True)  # 1, 1.0 and True are different inputs
def _cached_scene(kind: type[Scene], *values: Any) -> Scene:
    return kind(*values)
