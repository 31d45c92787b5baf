"""RingScene: a run of the expanding ring, its defaults and its rules."""

from __future__ import annotations

import math
from dataclasses import dataclass
from types import ModuleType
from typing import ClassVar

import numpy as np

from solvers.problems.planar.circular import CircularScene
from solvers.problems.planar.validity import NO_LATTICE
from solvers.problems.ring import exact, step_bound, validity
from solvers.scene.option import described, option
from solvers.scene.remedies import COUPLED, FILTER, FROZEN
from solvers.scene.rules import SceneError, require_number
from solvers.scene.step_bound import StepBound

INVERSION = 0.386  # amplitude at which the exact ring turns inside out: 1 + A min w' reaches 0
RESONANCE = 0.115  # amplitude from which on the ring's own motion is unstable: a disturbance grows with every period
WRINKLING = 0.198  # amplitude at which the surface of the compressed ring wrinkles (Biot)
#: A small disturbance of the exact motion in the mode n = 2 grows, computed, 1.44 times a period at A = 0.12, 1.84 at
#: 0.13, 2.20 at 0.14 and 2.57 at 0.15: exp(GROWTH sqrt(A^2 - ONSET^2)) to that accuracy. Of larger A no more is known.
GROWTH, ONSET, KNOWN = 9.69, 0.1139, 0.15
FIRST_ERROR = 1e-3  # relative error in that mode after one period, as CPDI leaves it on 24 cells; 48 leave a sixth
LARGE_ERROR = 0.1  # and the one that is called the end


@described
@dataclass(frozen=True)
class RingScene(CircularScene):
    """One run of the ring: h = 1.2 m/``cells``, ``ppc`` counts per direction.

    ``plan`` says how the step is spread over threads: one serial kernel, slabs side by side, or whichever is faster.
    """

    problem: str = option("ring", choices=("ring",))
    method: str = option("cpdi", "Shape functions of the particles", choices=("ugimp", "cpgimp", "cpdi", "mpm"))
    cells: int = option(24, "Cells of the grid along a side; h = 1.2 m / cells")
    ppc: int = option(2, "Particles per cell and direction")
    amplitude: float = option(0.1, "Amplitude A of the outer surface's displacement", "m")
    modulus: float = option(1e7, "Young's modulus E; Poisson's ratio is 0", "Pa")
    density: float = option(1000.0, "Density", "kg/m3")
    body_force: str = option(
        "material", "Body force: at material points, none, or two tones; only the first has a built-in solution",
        choices=("material", "none", "two-tone"))
    linearity_preserving: bool = option(False, "Not offered for the ring: only off is accepted")
    layout: str = option("polar", "Lattice on which the particles begin", choices=("polar", "cartesian"))
    plan: str = option("auto", "How the step is spread over the threads; auto takes the faster one for the number of "
                       "particles", choices=("auto", "serial", "parallel"))

    EXACT: ClassVar[ModuleType] = exact
    PLOTTED = "radial"
    TITLE = "expanding ring"
    SETTING = "A quarter of a ring with radii 0.4 m and 0.6 m on a square grid, 1.2 m wide."
    ESTIMATORS = ("transport", "recovered", "companion", "two-grid")
    VALIDITY = validity.RULES
    IMPOSSIBLE = NO_LATTICE
    REMEDIES = (FILTER, COUPLED, FROZEN)
    STRAIN_PER_AMPLITUDE = 1 / INVERSION
    GENTLE_AMPLITUDE = 1e-2
    HARD_AMPLITUDES = (0.05, 0.1, 0.15)
    SIDE, INNER, OUTER, ANGLE = 1.2, exact.INNER, exact.OUTER, 0.5 * math.pi
    PLANES = (True, False)
    FEWEST_CELLS = 8
    DEFAULT_PERIODS = 1.0
    SAMPLES_A_PERIOD = 50  # a sample of a ring costs more than a step

    # Measured at 48 cells, A = 0.1: everywhere, the internal forces no longer cancel (0.4 of their sum, all at the
    # surface) and uGIMP blows up within a period; at nodes full of material alone, x gets 21 % better for uGIMP and
    # 15 % worse for CPDI, whose parallelograms tile and leave nothing to correct.
    NOT_LINEARITY_PRESERVING = ("is not offered for the ring: at the free surface it breaks action and reaction and "
                                "the run blows up, and away from it CPDI gains nothing; leave it off")
    MENDS = "the others mend"

    @staticmethod
    def polar_counts(cells: int, ppc: int) -> tuple[int, int]:
        return max(1, round(2 * cells * ppc / 3)), max(1, round(cells * ppc / 6))

    @property
    def lame_moduli(self) -> tuple[float, float]:
        return 0.0, 0.5 * self.modulus

    def circle_velocity(self, R: np.ndarray) -> np.ndarray:
        return exact.time_factors(self, 0.0)[1] * exact.shape(R)[0].astype(complex)

    def circle_force(self, R: np.ndarray, t: np.ndarray) -> np.ndarray:
        return exact.body_force(self, R, t)

    def critical_time_step(self) -> StepBound:
        return step_bound.critical_time_step(self)

    def warnings(self) -> list[str]:
        sentences = super().warnings()
        if self.amplitude >= RESONANCE and self.solution_known:
            sentences.append(self._resonance())
        if "two-grid" in self.active_estimators:
            sentences.append("two-grid says nothing of a on the ring: its error is noise of a cell's length, which "
                             "each of the two grids has in other places")
        return sentences

    @property
    def growth(self) -> float:
        """How many times a period a disturbance of the exact motion grows in the mode n = 2, above ``KNOWN`` at least;
        1 where the motion is stable."""
        A = min(self.amplitude, KNOWN)
        return math.exp(GROWTH * math.sqrt(A * A - ONSET * ONSET)) if self.amplitude >= RESONANCE else 1.0

    def expected_life(self, first_error: float = FIRST_ERROR) -> float:
        """Periods until a relative error in the mode n = 2 of ``first_error`` after one has grown to a tenth."""
        return 1 + math.log(LARGE_ERROR / first_error) / math.log(self.growth) if self.growth > 1 else math.inf

    def _resonance(self) -> str:
        """What becomes of a large motion, in one sentence."""
        beyond = self.amplitude > KNOWN
        wrinkles = f"; above {WRINKLING} its surface wrinkles as well" * (self.amplitude > WRINKLING)
        life = self.expected_life()
        return (f"amplitude {self.amplitude:g}: from {RESONANCE} on the ring's own motion is unstable by parametric "
                f"resonance, which nothing cures; an error in the mode n = 2 grows {self.growth:.2f}-fold a period"
                f"{' or faster' * beyond}, from {FIRST_ERROR:.1%} of the amplitude after the first to a tenth after "
                f"{'at most' if beyond else 'about'} {life:.2g}, from less of it later{wrinkles}")

    def _check_amplitude(self) -> None:
        allowed = f"give a number above 1e-12 and below {INVERSION}"
        require_number("amplitude", self.amplitude, 1e-12, math.inf, allowed)
        if self.amplitude >= INVERSION:
            raise SceneError("amplitude", self.amplitude,
                             f"the exact ring turns inside out from {INVERSION} on; {allowed}")

    def _check_remedies(self) -> None:
        if COUPLED in self.remedies and self.method == "cpdi":
            raise SceneError("remedies", " ".join(self.remedies), "coupled-deformation makes CPDI worse, whose domains "
                             "follow the deformation; give null-space-filter or frozen-weights")
