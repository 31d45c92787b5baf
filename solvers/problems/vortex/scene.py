"""VortexScene: a run of the generalized vortex, its defaults and its rules."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from types import ModuleType
from typing import ClassVar

import numpy as np

from solvers.problems.planar.circular import CircularScene
from solvers.problems.planar.validity import NO_LATTICE
from solvers.problems.vortex import exact, step_bound, validity
from solvers.problems.vortex.exact import INNER, MIDDLE, OUTER, circle_force, lame, turn
from solvers.scene.effects import EFFECTS
from solvers.scene.option import described, option
from solvers.scene.remedies import FILTER, FROZEN
from solvers.scene.rules import require_number
from solvers.scene.scene import DEFAULT_CFL
from solvers.scene.step_bound import StepBound

SIDE = 3.0  # of the grid, in metres, the ring in its middle
LARGEST_SHEAR = 7.07  # R |h'| over the ring: the shear is that times A
MOST_AMPLITUDE = 0.5 * math.pi  # with which the vortex has been studied; beyond, a ring tears on any grid that we had
LOOKED_AT = 64  # circles, for the largest displacement


@described
@dataclass(frozen=True)
class VortexScene(CircularScene):
    """One run of the vortex: h = 3 m/``cells``, ``ppc`` counts per direction.

    ``amplitude`` is an angle: by how much the middle circle turns against the rims, which rest. ``frequency`` is B,
    the turns change as sin(pi B t). ``plan`` says how the step is spread over threads.
    """

    problem: str = option("vortex", choices=("vortex",))
    method: str = option("cpdi", "Shape functions of the particles; cpgimp stretches its boxes by F, cpgimp-v by the "
                         "spatial stretch V, which a rotation leaves alone",
                         choices=("ugimp", "cpgimp", "cpgimp-v", "cpdi", "mpm"))
    cells: int = option(48, "Cells of the grid along a side; h = 3 m / cells")
    ppc: int = option(3, "Particles per cell and direction")
    amplitude: float = option(1.0, "Amplitude A of the angle by which the middle circle turns", "rad")
    modulus: float = option(1000.0, "Young's modulus E", "Pa")
    poisson_ratio: float = option(0.3, "Poisson's ratio; it is not in the exact solution, but in the errors")
    density: float = option(1000.0, "Density", "kg/m3")
    frequency: float = option(1.0, "B: the angles are A sin(pi B t), and the period is 2/B", "1/s")
    cfl: float | None = option(None, "Time step as dt c/h, no unit, c = sqrt((lambda + 2 mu)/density) of the material "
                               "at rest; instead of --dt", hint=f"{DEFAULT_CFL} without --dt")
    body_force: str = option(
        "material", "Body force: at material points, none, or two tones; only the first has a built-in solution",
        choices=("material", "none", "two-tone"))
    linearity_preserving: bool = option(False, "Not offered for the vortex: only off is accepted")
    effects: tuple[str, ...] = option((*EFFECTS, "spin"), "What to compute beside the method, with commas between; "
                                      "what is left out costs nothing", hint="all")
    layout: str = option("polar", "Lattice on which the particles begin", choices=("polar", "cartesian"))
    plan: str = option("auto", "How the step is spread over the threads; auto takes the faster one for the number of "
                       "particles", choices=("auto", "serial", "parallel"))

    EXACT: ClassVar[ModuleType] = exact
    PLOTTED = "angular"
    TITLE = "generalized vortex"
    SETTING = "A ring with radii 0.75 m and 1.25 m, whose circles turn against each other, on a square grid, 3 m wide."
    ESTIMATORS = ("transport", "recovered", "companion")
    VALIDITY = validity.RULES
    IMPOSSIBLE = NO_LATTICE
    # Not the coupling of F with the displacements: measured at A = 1 on 48 cells, every GIMP run that has it breaks.
    REMEDIES = (FILTER, FROZEN)
    OWN_EFFECTS = ("spin",)
    STRAIN_PER_AMPLITUDE = LARGEST_SHEAR
    GENTLE_AMPLITUDE = 0.05
    HARD_AMPLITUDES = (0.25, 0.5, 1.0)
    SIDE, INNER, OUTER, ANGLE = SIDE, INNER, OUTER, 2 * math.pi
    PLANES = (False, False)
    FEWEST_CELLS = 12
    DEFAULT_PERIODS = 0.5
    SAMPLES_A_PERIOD = 100  # of which an ordinary run lasts half a one

    NOT_LINEARITY_PRESERVING = ("is not offered for the vortex: at a free surface it breaks action and reaction; leave "
                                "it off")
    MENDS = "the filter mends"

    @staticmethod
    def polar_counts(cells: int, ppc: int) -> tuple[int, int]:
        """As many in each quarter."""
        return 4 * max(1, round(2 * math.pi * ppc * cells / 12)), max(1, round(ppc * cells / 6))

    @property
    def coarse(self) -> bool:
        """Where a fit over four cells is as wide as the ring; measured, a comes out at .5 to .75 of its error."""
        return self.cells < 24

    @property
    def lame_moduli(self) -> tuple[float, float]:
        return lame(self)

    def circle_velocity(self, R: np.ndarray) -> np.ndarray:
        return 1j * R * turn(self, R, 0.0).rate

    def circle_force(self, R: np.ndarray, t: np.ndarray) -> np.ndarray:
        return circle_force(self, R, t)

    def critical_time_step(self) -> StepBound:
        return step_bound.critical_time_step(self)

    @property
    def wave_speed(self) -> float:
        """c = sqrt((lambda + 2 mu)/rho) of the material at rest; sheared by g, it is about sqrt(1 + g^2) as fast."""
        nu = self.poisson_ratio
        return math.sqrt(self.modulus * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / self.density)

    @property
    def angular_frequency(self) -> float:
        """w = pi B."""
        return math.pi * self.frequency

    @functools.cached_property
    def motion_amplitude(self) -> float:
        """Largest displacement of the exact solution, 2 R sin(alpha/2), in metres."""
        radii = (INNER + (OUTER - INNER) * k / LOOKED_AT for k in range(LOOKED_AT + 1))
        return max(2 * R * math.sin(0.5 * min(math.pi, self.amplitude * _share(R))) for R in radii)

    def size_of(self, quantity: str) -> float:
        """What an error of x, v, sigma or a is compared with: the largest displacement and what goes with it."""
        A, w, shear, mu = self.amplitude, self.angular_frequency, LARGEST_SHEAR * self.amplitude, lame(self)[1]
        return {"x": self.motion_amplitude, "v": A * w, "sigma": mu * shear * (1 + shear), "a": A * w * w}[quantity]

    def _check_amplitude(self) -> None:
        require_number("amplitude", self.amplitude, 1e-12, MOST_AMPLITUDE,
                       f"give an angle in radians above 1e-12 and up to pi/2, {MOST_AMPLITUDE:.4f}")
        require_number("poisson_ratio", self.poisson_ratio, -0.9, 0.49)
        require_number("frequency", self.frequency, 1e-6, 1e6)


def _share(R: float) -> float:
    """h(R): the part of the middle circle's angle by which another one turns."""
    square = (R - MIDDLE) ** 2
    return 1 - 32 * square + 256 * square * square
