"""Scene: everything that defines a run, in one frozen object, and the rules that it must satisfy.

The command line, the page and the tests all build a ``Scene``; nothing else is configured anywhere.
A ``Scene`` that exists is valid: a bad value raises :class:`SceneError` with one sentence that names the
input, says what is wrong and what is allowed.
"""

from __future__ import annotations

import math
import sys
from abc import ABC, abstractmethod
from dataclasses import dataclass, fields
from typing import ClassVar, Literal, get_args

Estimator = Literal["transport", "recovered", "companion", "two-grid"]
Effect = Literal["truth", "estimate", "crossings", "energy", "acceleration"]
Arch = Literal["cpu", "gpu"]

ESTIMATORS: tuple[Estimator, ...] = get_args(Estimator)
EFFECTS: tuple[Effect, ...] = get_args(Effect)

MOST_PARTICLES = 1_000_000
MOST_STEPS = 2_000_000_000  # the step index is a 32-bit integer
MOST_SAMPLES = 1_000_000

#: Where a field's name and its flag differ. The flag, with ``_`` for ``-``, is also the key in the JSON object.
FLAGS = {"particles_per_cell": "ppc", "estimators": "estimator"}


class SceneError(ValueError):
    """A value that no run can have. ``field`` names the input, ``sentence`` says what is wrong and allowed."""

    def __init__(self, field: str, value: object, sentence: str):
        self.field, self.value, self.sentence = field, value, sentence
        super().__init__(f"{field_label(field)} {value}: {sentence}")


def field_key(field: str) -> str:
    """The name of a field in the JSON object: ``particles_per_cell`` is ``ppc``."""
    return FLAGS.get(field, field)


def field_label(field: str) -> str:
    """The name of a field as a person reads it: ``body_force`` is ``body force``."""
    return field_key(field).replace("_", " ")


@dataclass(frozen=True)
class Scene(ABC):
    """One run. Lengths in metres, times in seconds, modulus in pascals, density in kg/m³.

    ``dt`` or ``cfl`` sets the time step (``cfl`` = dt c/h, c = sqrt(modulus/density)); ``t_end`` or ``periods``
    the end. A ``None`` takes the default: ``cfl`` 0.05, 5 ``periods``, about 200 samples a period. Each problem has
    a scene class of its own with its defaults, its choices and its geometry.
    """

    problem: str
    method: str
    cells: int
    particles_per_cell: int
    amplitude: float
    modulus: float
    density: float
    dt: float | None = None
    cfl: float | None = None
    t_end: float | None = None
    periods: float | None = None
    body_force: str = "material"
    linearity_preserving: bool = False
    velocity: str = "grid"
    estimators: tuple[Estimator, ...] = ("transport",)
    effects: tuple[Effect, ...] = EFFECTS
    arch: Arch = "cpu"
    threads: int = 1
    sample_every: int | None = None

    #: What each field with a choice may be; a problem's scene adds its own.
    CHOICES: ClassVar[dict[str, tuple[str, ...]]] = {"arch": get_args(Arch)}
    #: What the problem's own error norm is called in the result (see ``solvers.samples``).
    EXTRA_ERROR: ClassVar[str]
    DIMENSIONS: ClassVar[int] = 1
    STRAIN_PER_AMPLITUDE: ClassVar[float]  # largest strain of the exact solution over its amplitude, 1/m
    FEWEST_CELLS: ClassVar[int] = 4
    DEFAULT_PERIODS: ClassVar[float] = 5.0
    SAMPLES_A_PERIOD: ClassVar[int] = 200

    def __post_init__(self) -> None:
        self._check_choices()
        self._check_numbers()
        self._check_time()
        self._check_combinations()

    @property
    @abstractmethod
    def spacing(self) -> float:
        """Cell size h."""

    @property
    @abstractmethod
    def particles(self) -> int:
        """Number of particles."""

    @abstractmethod
    def _check_amplitude(self) -> None:
        """Refuse an amplitude for which there is no exact solution."""

    def _check_combinations(self) -> None:  # noqa: B027 (a problem without such rules has none)
        """Refuse what does not go together."""

    def warnings(self) -> list[str]:
        """Sentences about what is allowed but will surprise."""
        if "truth" in self.effects and not self.solution_known:
            return [f"body force {self.body_force}: no exact solution is built in, so the true error is unknown"]
        return []

    # ---- derived quantities -------------------------------------------------------------------------------

    @property
    def wave_speed(self) -> float:
        """c = sqrt(E/rho)."""
        return math.sqrt(self.modulus / self.density)

    @property
    def angular_frequency(self) -> float:
        """w = c pi/l of the exact solution, l = 1 (eq 32)."""
        return self.wave_speed * math.pi

    @property
    def motion_amplitude(self) -> float:
        """Largest displacement of the exact solution."""
        return self.amplitude

    def size_of(self, quantity: str) -> float:
        """What an error of x, v, sigma or a is compared with: A, A w, E times the largest strain, A w^2."""
        A, w = self.motion_amplitude, self.angular_frequency
        return {"x": A, "v": A * w, "sigma": self.modulus * A * self.STRAIN_PER_AMPLITUDE, "a": A * w * w}[quantity]

    @property
    def period(self) -> float:
        """One full vibration, 2 pi/w."""
        return 2 * math.pi / self.angular_frequency

    @property
    def time_step(self) -> float:
        """The step in seconds, from ``dt`` or ``cfl``."""
        return self.dt if self.dt is not None else self.courant_number * self.spacing / self.wave_speed

    @property
    def courant_number(self) -> float:
        """``cfl`` as given, or that of ``dt``."""
        if self.dt is not None:
            return self.dt * self.wave_speed / self.spacing
        return DEFAULT_CFL if self.cfl is None else self.cfl

    @property
    def end_time(self) -> float:
        if self.t_end is not None:
            return self.t_end
        return (self.DEFAULT_PERIODS if self.periods is None else self.periods) * self.period

    @property
    def steps(self) -> int:
        """Whole steps to the end time; the end time is met to the nearest step."""
        return max(1, round(self.end_time / self.time_step))

    @property
    def sample_interval(self) -> int:
        """Steps between two samples of the norms."""
        if self.sample_every is not None:
            return self.sample_every
        wanted = int(min(self.period / self.time_step, MOST_STEPS)) // self.SAMPLES_A_PERIOD
        wanted = max(wanted, math.ceil(self.steps / SAMPLES_A_RUN))
        return max(1, wanted // self.estimate_interval) * self.estimate_interval

    @property
    def estimate_interval(self) -> int:
        """Steps between two steps of an estimator: half the time a wave takes through a cell, at most 10."""
        return max(1, min(10, int(0.5 / self.courant_number)))

    @property
    def not_valid(self) -> dict[str, str]:
        """Why an estimator asked for is not run: a sentence for each that is known not to hold here."""
        from solvers.estimators.validity import not_valid  # it is about scenes, so it imports this file

        reasons = {name: not_valid(self, name) for name in self.estimators}
        return {name: reason for name, reason in reasons.items() if reason}

    @property
    def active_estimators(self) -> tuple[Estimator, ...]:
        """The estimators that run: those asked for that are valid here, if the effect is on."""
        refused = self.not_valid if "estimate" in self.effects else {}
        return tuple(e for e in self.estimators if e not in refused) if "estimate" in self.effects else ()

    @property
    def solution_known(self) -> bool:
        """Whether an exact solution is built in, so that there is a true error."""
        return self.body_force != "two-tone"

    def has(self, effect: Effect) -> bool:
        """Whether the effect is switched on and can be (``truth`` needs an exact solution; ``acceleration``, kept to
        be compared with the exact one or estimated, one of the two)."""
        if effect == "acceleration":
            return "acceleration" in self.effects and (self.has("truth") or self.has("estimate"))
        if effect == "truth":
            return "truth" in self.effects and self.solution_known
        return bool(self.active_estimators) if effect == "estimate" else effect in self.effects

    def to_dict(self) -> dict:
        """Every input with the defaults filled in, keyed as in the JSON contract."""
        values = {field_key(f.name): getattr(self, f.name) for f in fields(self)}
        filled = {"dt": self.time_step, "cfl": self.courant_number, "t_end": self.end_time,
                  "periods": self.end_time / self.period, "sample_every": self.sample_interval}
        lists = {"estimator": list(self.estimators), "effects": list(self.effects)}
        return {**values, **filled, **lists}

    # ---- rules --------------------------------------------------------------------------------------------

    def _check_choices(self) -> None:
        for field, allowed in self.CHOICES.items():
            require_choice(field, getattr(self, field), allowed)
        if not isinstance(self.linearity_preserving, bool):
            raise SceneError("linearity_preserving", self.linearity_preserving, "give True or False")
        for field, allowed in (("estimators", ESTIMATORS), ("effects", EFFECTS)):
            chosen = getattr(self, field)
            if not isinstance(chosen, (tuple, list)):
                raise SceneError(field, chosen, f"give a list of names out of {', '.join((*allowed, 'none'))}")
            object.__setattr__(self, field, tuple(chosen))  # a list is welcome, but a scene must be hashable
            for item in chosen:
                require_choice(field, item, allowed, also="none")
            if len(set(chosen)) != len(chosen):
                raise SceneError(field, " ".join(chosen), "names something twice; give each name once")

    def _check_numbers(self) -> None:
        require_whole("cells", self.cells, self.FEWEST_CELLS, 100_000)
        require_whole("particles_per_cell", self.particles_per_cell, 1, 64)
        require_whole("threads", self.threads, 1, 1024)
        self._check_amplitude()
        require_number("modulus", self.modulus, 1e-6, 1e12)
        require_number("density", self.density, 1e-6, 1e12)
        if self.particles > MOST_PARTICLES:
            raise SceneError("particles_per_cell", self.particles_per_cell,
                             f"{self.cells} cells with so many particles each make {self.particles:,} particles; "
                             f"at most {MOST_PARTICLES:,} are allowed")

    def _check_time(self) -> None:
        for one, other in (("dt", "cfl"), ("t_end", "periods")):
            if getattr(self, one) is not None and getattr(self, other) is not None:
                raise SceneError(other, getattr(self, other),
                                 f"{one.replace('_', '-')} is given too; give one of the two")
            for field in (one, other):
                if getattr(self, field) is not None:
                    require_number(field, getattr(self, field), 0, math.inf)
        if self.courant_number > MOST_CFL:
            field, allowed = ("dt", f"{MOST_CFL * self.spacing / self.wave_speed:.3g}") if self.dt is not None \
                else ("cfl", f"{MOST_CFL:g}")
            raise SceneError(field, getattr(self, field), "is far beyond any stable step; "
                             f"give a number above 0 and up to {allowed} (cfl {MOST_CFL:g})")
        if self.courant_number < LEAST_CFL:
            field, allowed = ("dt", LEAST_CFL * self.spacing / self.wave_speed) if self.dt is not None \
                else ("cfl", LEAST_CFL)
            raise SceneError(field, getattr(self, field), "is so short a step that rounding would swallow it; "
                             f"give {allowed:.3g} (cfl {LEAST_CFL:g}) or more")
        if self.end_time / self.time_step > MOST_STEPS:
            field = "t_end" if self.t_end is not None else "periods"
            raise SceneError(field, getattr(self, field) or self.DEFAULT_PERIODS,
                             f"needs {self.end_time / self.time_step:.3g} steps; "
                             f"at most {MOST_STEPS:,} are allowed: end earlier or take longer steps")
        if self.sample_every is not None:
            require_whole("sample_every", self.sample_every, 1, MOST_STEPS)
        if self.steps / self.sample_interval > MOST_SAMPLES:
            raise SceneError("sample_every", self.sample_interval,
                             f"makes {self.steps // self.sample_interval:,} samples; at most {MOST_SAMPLES:,} "
                             f"are allowed, so sample every {math.ceil(self.steps / MOST_SAMPLES)} steps or more")


DEFAULT_CFL = 0.05
SAMPLES_A_RUN = 100_000  # that a long run takes unless it is told how many
LEAST_CFL = 1e-9
MOST_CFL = 10.0  # an unstable run is a result worth seeing; this only keeps the numbers finite for a while


def require_choice(field: str, value: object, allowed: tuple[str, ...], also: str = "") -> None:
    if value not in allowed:
        names = ", ".join((*allowed, also) if also else allowed)
        raise SceneError(field, value, f"is not known; give {'one of ' if ',' in names else ''}{names}")


def require_whole(field: str, value: object, least: int, most: int) -> None:
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
        raise SceneError(field, value, f"give a whole number from {least:,} to {most:,}")


def require_number(field: str, value: object, above: float, most: float, allowed: str = "") -> None:
    number = isinstance(value, (int, float)) and not isinstance(value, bool) \
        and abs(value) <= sys.float_info.max  # False for NaN, infinity and integers beyond them
    if not number or not above < value <= most:
        upper = "" if math.isinf(most) else f" and up to {most:g}"
        raise SceneError(field, value, allowed or f"give a number above {above:g}{upper}")
