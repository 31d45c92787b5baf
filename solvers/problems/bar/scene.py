"""BarScene: a run of the vibrating bar or of its patch test, its defaults and its rules."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from solvers.motion.exact_solution_1d import HALF_ERROR, MotionMagnitudes, motion_magnitudes
from solvers.motion.typed_motion import MotionParameters1D
from solvers.problems.bar import estimator_limits, exact_solution, patch_test_inputs, step_bound
from solvers.problems.bar.patch_test_inputs import PATCH, VIBRATE
from solvers.scene.derived_quantities import MOST_PER_CELL
from solvers.scene.displacement_moments import DisplacementMoments
from solvers.scene.error_causes import CAUSES, NOTHING
from solvers.scene.field_options import document_fields, option
from solvers.scene.scene import Scene
from solvers.scene.stabilisations import CENTRED, COUPLED, FILTER, FROZEN, PIECES
from solvers.scene.step_bound import StepBound
from solvers.scene.typed_motion_scene import TYPED, TypedMotionScene
from solvers.scene.validation import SceneError, require_number
from solvers.translatable_message import Message

#: Above this amplitude the exact bar turns inside out: F = 1 + 2 pi A cos(2 pi X) sin(wt) reaches 0.
BAR_AMPLITUDE_LIMIT = 1 / (2 * math.pi)
#: Under two tones it does, or nearly so: F reaches 1 - 8.04 A.
TWO_TONE_AMPLITUDE_LIMIT = 0.118


@document_fields
@dataclass(frozen=True)
class BarScene(TypedMotionScene, Scene):
    """Definition of a run of the bar of unit length: h = 1/``cells`` (see :class:`~solvers.scene.scene.Scene`)."""

    problem: str = option("bar", choices=("bar",))
    method: str = option("ugimp", "Shape functions of the particles", choices=("mpm", "ugimp", "cpgimp", "bspline"))
    cells: int = option(40, "Cells of the grid; h = 1 m / cells")
    ppc: int | float = option(4, "Particles per cell; a whole number but in a patch test, which may have 2.5")
    amplitude: float = option(0.025, "Amplitude A of the displacement", "m")
    modulus: float = option(4.0, "Young's modulus E", "Pa")
    density: float = option(1.0, "Density", "kg/m3")
    body_force: str = option(
        "material", "Body force: at material points, at nodes, none, or two tones",
        choices=("material", "node", "none", "two-tone"))
    velocity: str = option("grid", "Velocity that moves the particles (corners: cpgimp only)",
                           choices=("grid", "particle", "corners"))
    motion: str = option(VIBRATE, "What the bar does: vibrate, or begin evenly stretched and moving, so that exactly "
                         "nothing should happen (patch test)", choices=(VIBRATE, PATCH))
    stretch: float = option(patch_test_inputs.STRETCH, "Stretch F of a patch test, no unit; not 1")
    initial_velocity: float = option(patch_test_inputs.VELOCITY, "Velocity of a patch test", "m/s")
    displacement: str = option("", "Displacement u in m, a formula of X, t, A and w, in place of the built-in one",
                               hint="A*sin(2*pi*X)*sin(w*t)")

    take_away: str = option(NOTHING, "Cause of error that is taken out of the run; needs the effect budget",
                            choices=(NOTHING, *CAUSES))

    TITLE, TYPED_TITLE = "vibrating bar", Message("bar that moves as typed")
    SETTING = "The bar is 1 m long."
    EXTRA_ERROR = "sigma_log"
    ESTIMATORS = ("transport", "recovered", "companion", "two-grid")
    LIMITS = estimator_limits.LIMITS
    OWN_EFFECTS = ("budget",)
    REMEDIES = (FILTER, COUPLED, CENTRED, FROZEN, PIECES)
    RUN_ONLY = dict.fromkeys(("motion", "stretch", "initial_velocity"), patch_test_inputs.NOTHING_TO_SEARCH)
    STRAIN_PER_AMPLITUDE = 1 / BAR_AMPLITUDE_LIMIT
    GENTLE_AMPLITUDE = 1e-3
    HARD_AMPLITUDES = (0.025, 0.05, 0.1, 0.14)

    @classmethod
    def candidates(cls) -> tuple[tuple[str, bool], ...]:
        """Returns pairs (method, linearity preserving) an advisor tries: each method without, uGIMP also with it."""
        return (*super().candidates(), ("ugimp", True))

    @property
    def spacing(self) -> float:
        """Cell size h, in m."""
        return 1.0 / self.cells

    @property
    def particles(self) -> int:
        return round(self.cells * self.ppc)

    @property
    def is_patch(self) -> bool:
        """Whether the scene is a patch test."""
        return self.motion == PATCH

    @property
    def title(self) -> str:
        return Message("patch test of the bar") if self.is_patch else super().title

    @property
    def highest_harmonic(self) -> int:
        """Number of wavelengths in the bar's length, of the shortest wave of its motion and body force that matters."""
        return self._sizes.waves if self.motion_formula else 1

    @property
    def motion_fields(self) -> tuple[str, ...]:
        return ("stretch", "initial_velocity") if self.is_patch else super().motion_fields

    @property
    def compiled_motion(self) -> str:
        """Motion as a compile-time option of kernels: "vibrate", "patch", or "typed" for a displacement as formula."""
        return TYPED if self.motion_formula else self.motion

    @property
    def motion_formula(self) -> str:
        return exact_solution.TWO_TONES if self.body_force == "two-tone" else self.displacement

    @property
    def motion_period(self) -> float:
        return super().motion_period if self.displacement else exact_solution.TWO_TONE_PERIODS * self.period

    @property
    def solution_known(self) -> bool:
        return True

    @property
    def motion_inputs(self) -> MotionParameters1D:
        return MotionParameters1D(self.base_frequency, self.amplitude, self.wave_speed)

    @property
    def swings(self) -> bool:
        return not self.is_patch

    @property
    def neighbour_mismatch(self) -> float:
        """RMS mismatch of neighbours in the exact motion, in amplitudes. The sine moves neighbours dX apart by 2 A
        sin(pi dX) cos(2 pi X_m), X_m their middle, and their mean F implies 2 pi dX A cos(pi dX) cos(2 pi X_m): 0.21
        with four particles, 0.03 with eight. An F - 1 that is half wrong adds dX times that, 0.56 and 0.28."""
        half = math.pi / self.particles
        if self.is_patch:
            return 0.0
        if self.motion_formula:
            return self._sizes.gap / self.motion_amplitude
        return math.sqrt(0.5) * (abs(2 * math.sin(half) - 2 * half * math.cos(half)) + HALF_ERROR * 2 * half)

    @property
    def known_weakness(self) -> str:
        uneven = self.is_patch and not float(self.ppc).is_integer()
        return Message("cells with unequal numbers of particles have unequal forces") if uneven else ""

    @property
    def drift_speed(self) -> float:
        return abs(self.initial_velocity) if self.is_patch else 0.0

    @property
    def velocity_lead(self) -> float:
        """Time in s before t = 0 to which the initial velocity belongs, as in leapfrog."""
        return 0.0 if self.has("budget") and self.take_away == "time_step" else 0.5 * self.time_step

    @property
    def initial_stretch(self) -> float:
        return self.stretch if self.is_patch else 1.0

    @property
    def angular_frequency(self) -> float:
        """Angular frequency w of the exact solution in 1/s: c pi/l with the body force (eq 32), the natural 2 c pi/l
        without; l = 1. In a patch test, where nothing oscillates, that of the vibrating bar."""
        if self.displacement:
            return 2 * math.pi / self.motion_period
        return self.wave_speed * math.pi * (2 if self.body_force == "none" and not self.is_patch else 1)

    @property
    def motion_amplitude(self) -> float:
        """Largest exact displacement in m: A; A/2 for the free bar, of the same initial speed. For a patch test that of
        a vibration with its largest strain, |F - 1|: the motion its stress could cause, a scale of its errors."""
        if self.is_patch:
            return abs(self.stretch - 1) / self.STRAIN_PER_AMPLITUDE
        if self.motion_formula:
            return self._sizes.largest["x"]
        return self.amplitude / 2 if self.body_force == "none" else self.amplitude

    @functools.cached_property
    def _sizes(self) -> MotionMagnitudes:
        return motion_magnitudes(self)

    def size_of(self, quantity: str) -> float:
        return self._sizes.largest[quantity] if self.motion_formula else super().size_of(quantity)

    def rms_of(self, quantity: str) -> float:
        """Returns the RMS of x, v, sigma or a in SI: half the maximum, as for sines; in a patch test the maximum."""
        if self.motion_formula:
            return self._sizes.rms[quantity]
        return self.size_of(quantity) * (1.0 if self.is_patch else 0.5)

    @property
    def loss_limits(self) -> dict[str, float]:
        """Relative errors from which a run is lost: in a patch test of "sigma", as only stress can be wrong there."""
        return {"sigma": patch_test_inputs.FAILED_FROM} if self.is_patch else {}

    @property
    def budget_reference(self) -> str:
        """Solution against which the effect ``budget`` divides the error: "exact" or "companion"."""
        return "exact" if self.has("truth") else "companion"

    def has(self, effect: str) -> bool:
        """Returns whether the effect of this name is on and possible; a budget needs the truth or the companion."""
        known = effect != "budget" or super().has("truth") or "companion" in self.active_estimators
        return known and super().has(effect)

    def momentum_balance_moments(self, times: np.ndarray) -> DisplacementMoments:
        return exact_solution.displacement_moments(self, times)

    def to_dict(self) -> dict:
        """Returns every input by JSON key with defaults filled in, None for those without meaning in this motion."""
        idle = ("amplitude",) if self.is_patch else ("stretch", "initial_velocity")
        return {**super().to_dict(), **dict.fromkeys(idle)}

    def wrap_into_period(self, position: np.ndarray) -> np.ndarray:
        """Returns the positions (P,) in m at which particles at ``position`` (P,) are drawn: for a patch test, which
        drifts, the images in the first metre."""
        if not self.is_patch:
            return position
        with np.errstate(invalid="ignore"):  # for unstable runs
            return position - np.floor(position)

    def warnings(self) -> list[str]:
        sentences = super().warnings()
        if "two-grid" in self.active_estimators and estimator_limits.is_too_noisy_for_two_grid(self):
            sentences.append(Message("two-grid does not estimate a here: particles that cross cells add noise to it, "
                                     "in different places on the two grids"))
        if "budget" in self.effects and not self.has("budget"):
            sentences.append(Message("error budget: it needs the effect truth and an exact solution, or the estimator "
                                     "companion; switch one of the two on"))
        if self.take_away != NOTHING and not self.has("budget"):
            sentences.append(Message("take away {take_away}: nothing is taken away without the effect budget",
                                     self.take_away))
        if self.is_patch and (step := patch_test_inputs.first_edge_step(self, self.initial_velocity)):
            sentences.append(Message("after {step} steps particles are exactly on cell boundaries, and rounding "
                                     "decides in which cell they are: with hat functions this causes errors even with "
                                     "whole particles per cell; another velocity avoids it, such as "
                                     "{initial_velocity:.4g} m/s", step, 0.9717 * self.initial_velocity))
        return sentences

    def critical_time_step(self) -> StepBound:
        return step_bound.critical_time_step(self, self.initial_stretch, self.initial_velocity)

    def _normalized_inputs(self) -> dict[str, Any]:
        meant = patch_test_inputs.normalise_inputs(self.cells, self.ppc,
                                                   self.body_force) if self.motion == PATCH else {}
        return {**super()._normalized_inputs(), **meant}

    def _check_per_cell(self) -> None:
        if self.is_patch:
            return patch_test_inputs.check_particles_per_cell(self.cells, self.ppc)
        if isinstance(self.ppc, float) and 1 <= self.ppc <= MOST_PER_CELL:
            raise SceneError("ppc", self.ppc, "give a whole number from 1 to {most}; only a patch test (motion patch) "
                             "may have a part of one", MOST_PER_CELL)
        super()._check_per_cell()

    def _check_amplitude(self) -> None:
        if self.displacement:
            return super()._check_amplitude()
        limit = TWO_TONE_AMPLITUDE_LIMIT if self.body_force == "two-tone" else BAR_AMPLITUDE_LIMIT
        allowed = Message("give a number above 1e-12 and below {limit:.3g}", limit)
        require_number("amplitude", self.amplitude, 1e-12, math.inf, allowed)
        if self.amplitude >= limit:
            raise SceneError("amplitude", self.amplitude, "the exact bar inverts from {limit:.3g} on; {allowed}",
                             limit, allowed)

    def _check_numbers(self) -> None:
        super()._check_numbers()
        patch_test_inputs.check_stretch_and_velocity(self.stretch, self.initial_velocity)

    def _check_combinations(self) -> None:
        patch_test_inputs.check_inputs_fit_motion(self)
        if self.displacement and self.body_force != "material":
            raise SceneError("body_force", self.body_force, "does not go with a typed displacement, which is the "
                             "solution with a force at material points alone; give material")
        if self.arch not in ("cpu", "gpu"):
            raise SceneError("arch", self.arch, "is for problems in the plane; the bar, of few particles and many "
                             "steps, runs on the processor: give cpu")
        if self.velocity == "corners" and self.method != "cpgimp":
            raise SceneError("velocity", "corners", "moves the corners of convected domains and needs "
                             "the method cpgimp; with other methods give grid or particle")
        if self.frozen:
            self._check_frozen_weights()

    def _check_frozen_weights(self) -> None:
        """Raises :class:`SceneError` for remedies beside frozen weights, which have nothing to correct: the material at
        rest fills the grid evenly."""
        others = [name for name in self.remedies if name != FROZEN]
        if others:
            raise SceneError("remedies", " ".join(self.remedies), "frozen-weights cannot be combined: {name} corrects "
                             "errors of particles that move through the grid; leave one of the two out", others[0])
        for name, value, plain in (("linearity_preserving", self.linearity_preserving, False),
                                   ("body_force", self.body_force == "node", False),
                                   ("velocity", self.velocity == "corners", False)):
            if value != plain:
                raise SceneError(name, getattr(self, name), "does not go with frozen-weights, whose particles do not "
                                 "move through the grid; leave one of the two out")
