"""The generalized vortex: a full ring whose circles turn against each other, so that it shears and rotates.

x = Q(alpha) X, alpha = A sin(wt) h(R), w = pi B, with h = 1 - 32 (R-1)^2 + 256 (R-1)^4. Both h and h' vanish at the
rims, which therefore rest and carry no traction. J = 1: lambda drops out of the solution, but not out of the errors.
Source: Brannon, Kamojjala & Sadeghirad, Establishing credibility of particle methods through verification testing,
Particles 2011; Kamojjala, Brannon, Sadeghirad & Guilkey, Eng. Comput. 31 (2015) 199-213.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from solvers.motion.jets import sin, sqrt
from solvers.problems import vortex_estimator_limits
from solvers.problems.planar.circular_scene import CircularScene
from solvers.problems.planar.problem import PlanarProblem, ViewSettings
from solvers.scene.effects import EFFECTS
from solvers.scene.field_options import document_fields, option
from solvers.scene.scene import DEFAULT_CFL
from solvers.scene.stabilisations import FILTER, FROZEN
from solvers.scene.validation import require_number
from solvers.translatable_message import Message

MOST_AMPLITUDE = 0.5 * math.pi  # with which the vortex has been studied; beyond, a ring tears on any grid that we had


def swirl_profile(R: Any) -> Any:
    """Returns h(R), the angle of the circle of radius R (m) over that of the middle circle; arrays or jets."""
    square = (R - 1.0) * (R - 1.0)
    return (256.0 * square - 32.0) * square + 1.0


@document_fields
@dataclass(frozen=True)
class VortexScene(CircularScene):
    """Definition of a run of the vortex: cells are 3 m/``cells`` wide, ``ppc`` counts per direction.

    ``amplitude`` is the angle in rad by which the middle circle turns against the rims, which rest; ``frequency``,
    in 1/s, is B in sin(pi B t)."""

    problem: str = option("vortex", choices=("vortex",))
    method: str = option("cpdi", "Shape functions of the particles; cpgimp stretches its boxes by F, cpgimp-v by the "
                         "spatial stretch V, which a rotation leaves alone",
                         choices=("ugimp", "cpgimp", "cpgimp-v", "cpdi", "mpm"))
    cells: int = option(48, "Cells of the grid along a side; h = 3 m / cells")
    ppc: int = option(3, "Particles per cell and direction")
    amplitude: float = option(1.0, "Amplitude A of the angle by which the middle circle turns", "rad")
    modulus: float = option(1000.0, "Young's modulus E", "Pa")
    poisson_ratio: float = option(0.3, "Poisson's ratio; it is not in the exact solution, but in the errors")
    frequency: float = option(1.0, "B: the angles are A sin(pi B t), and the period is 2/B", "1/s")
    cfl: float | None = option(None, "Time step as dt c/h, no unit, c = sqrt((lambda + 2 mu)/density) of the material "
                               "at rest; instead of --dt", hint=f"{DEFAULT_CFL} without --dt")
    linearity_preserving: bool = option(False, "Not offered for the vortex: only off is accepted")
    effects: tuple[str, ...] = option((*EFFECTS, "spin"), "What to compute beside the method, with commas between; "
                                      "what is left out costs nothing", hint="all")

    TITLE = "generalized vortex"
    SETTING = "A ring with radii 0.75 m and 1.25 m, whose circles turn against each other, on a square grid, 3 m wide."
    SIDE, INNER, OUTER, ANGLE = 3.0, 0.75, 1.25, 2 * math.pi
    PLANES, DIRECTION, EXTREMES = (False, False), "angular", (0.0, 0.25)
    ESCAPE_SENTENCE = Message("was thrown off (it is {farthest:.3g} m or more from the centre, at an edge of the grid)")
    COARSE_BELOW = 24  # a fit over four cells is as wide as the ring; measured, a comes out at .5 to .75 of its error
    COMPANION_MESHES = ((math.inf, 6, 6),)  # 2e-7 m and 0.3 Pa off at A = 1, the finest run of the tables 4e-3 and 300
    ESTIMATORS = ("transport", "recovered", "companion")
    LIMITS = vortex_estimator_limits.LIMITS
    wave_angle_per_metre = property(vortex_estimator_limits.wave_angle_per_metre)
    # Not the coupling of F with the displacements: measured at A = 1 on 48 cells, every GIMP run that has it breaks.
    REMEDIES = (FILTER, FROZEN)
    OWN_EFFECTS = ("spin",)
    STRAIN_PER_AMPLITUDE = 7.07  # the largest R |h'|, which times A is the shear
    GENTLE_AMPLITUDE, HARD_AMPLITUDES = 0.05, (0.25, 0.5, 1.0)
    FEWEST_CELLS, DEFAULT_PERIODS, SAMPLES_A_PERIOD = 12, 0.5, 100
    NOT_LINEARITY_PRESERVING = Message("is not offered for the vortex: at a free surface it breaks action and "
                                       "reaction; leave it off")
    MENDS = Message("the filter corrects")

    def displacement_at(self, X: Any, Y: Any, t: Any) -> tuple[Any, Any]:
        angle = self.amplitude * sin(self.angular_frequency * t) * swirl_profile(sqrt(X * X + Y * Y))
        nearer, around = -2.0 * sin(0.5 * angle) * sin(0.5 * angle), sin(angle)  # cos - 1, sin
        return nearer * X - around * Y, around * X + nearer * Y

    def second_tone_shape(self, X: np.ndarray, t: Any) -> np.ndarray:
        """Returns the shape (P, 2) in m, at X (P, 2) and time t, of the second tone of the body force "two-tone"."""
        x, y = self.EXACT.position(self, X, t).T
        return self.amplitude * swirl_profile(np.linalg.norm(X, axis=1))[:, None] * np.stack([-y, x], axis=1)

    @staticmethod
    def lattice_counts(cells: int, ppc: int) -> tuple[int, int]:
        return 4 * max(1, round(2 * math.pi * ppc * cells / 12)), max(1, round(ppc * cells / 6))  # as in each quarter

    @property
    def angular_frequency(self) -> float:
        return math.pi * self.frequency

    def size_of(self, quantity: str) -> float:
        """Returns the scale of errors of "x", "v", "sigma" or "a", in m, m/s, Pa or m/s^2: for x the largest
        displacement, for the others what belongs to it."""
        A, w, shear = self.amplitude, self.angular_frequency, self.STRAIN_PER_AMPLITUDE * self.amplitude
        return {"x": self.motion_amplitude, "v": A * w, "sigma": self.lame_moduli[1] * shear * (1 + shear),
                "a": A * w * w}[quantity]

    def _check_amplitude(self) -> None:
        require_number("amplitude", self.amplitude, 1e-12, MOST_AMPLITUDE,
                       Message("give an angle in radians above 1e-12 and up to pi/2, {most:.4f}", MOST_AMPLITUDE))
        require_number("frequency", self.frequency, 1e-6, 1e6)


VORTEX = PlanarProblem(VortexScene, ViewSettings(
    cells=(12, 96, 2), ppc=(1, 3), amplitude=(0.01, MOST_AMPLITUDE), modulus=(100.0, 10_000.0),
    amplitude_hint="angle in radians by which the middle circle turns while the rims stay fixed; the largest shear is "
                   "seven times as large",
    prices={"transport": 0.07, "recovered": 0.24, "companion": 0.04}, speed=0.1,
    details={"layout": "where particles begin: Cartesian rims are staircases", "body_force": "which force acts"},
    modulus_hint="Young's modulus: the body force keeps the motion the same, but the errors change",
    poisson_hint="resistance to a change of volume: not in the exact motion, which has none, but in the errors and, "
                 "with the speed of waves, in the time step",
    sparks=("widen", "staircase", "break"), breaking=("hat functions fail in shear", {"method": "mpm"}, 0.4)))
