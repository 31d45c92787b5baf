"""The expanding ring: a quarter of a ring that oscillates along its radii, u = A sin(wt) w(R) e_R.

The cubic w has w(b) = 1 and w'(a) = w'(b) = 0 at the radii a and b of the rims, so that with Poisson's ratio 0 both
carry no traction. Source: Berzins' test, with its misprints mended.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from solvers.motion.jets import sin, sqrt
from solvers.problems import ring_estimator_limits
from solvers.problems.planar.circular_scene import CircularScene
from solvers.problems.planar.problem import PlanarProblem, ViewSettings
from solvers.scene.derived_quantities import DerivedSceneQuantities
from solvers.scene.field_options import document_fields, option
from solvers.scene.stabilisations import COUPLED, FILTER, FROZEN
from solvers.scene.validation import SceneError, require_number
from solvers.translatable_message import Message

INNER, OUTER = 0.4, 0.6
SCALE = OUTER * (OUTER - 3 * INNER)
C1, C2, C3 = -6 * INNER / SCALE, 3 * (INNER + OUTER) / (OUTER * SCALE), -2 / (OUTER * SCALE)  # of w(R)
INVERSION = 0.386  # amplitude at which the exact ring turns inside out: 1 + A min w' reaches 0


@document_fields
@dataclass(frozen=True)
class RingScene(CircularScene):
    """Definition of a run of the expanding ring: cells are 1.2 m/``cells`` wide, ``ppc`` counts per direction.

    ``plan`` says how the step is spread over threads: one serial kernel, slabs side by side, or whichever is faster.
    """

    problem: str = option("ring", choices=("ring",))
    cells: int = option(24, "Cells of the grid along a side; h = 1.2 m / cells")
    amplitude: float = option(0.1, "Amplitude A of the outer surface's displacement", "m")
    modulus: float = option(1e7, "Young's modulus E; Poisson's ratio is 0", "Pa")
    linearity_preserving: bool = option(False, "Not offered for the ring: only off is accepted")

    TITLE = "expanding ring"
    SETTING = "A quarter of a ring with radii 0.4 m and 0.6 m on a square grid, 1.2 m wide."
    SIDE, INNER, OUTER, ANGLE = 1.2, INNER, OUTER, 0.5 * math.pi
    PLANES, VOLUMETRIC, DIRECTION = (True, False), False, "radial"
    EARLIER = 0.0  # a(0) = 0: v(0) is that of half a step before to second order
    EXTREMES = (-0.25, 0.25)
    BEYOND_RIMS = True
    FARTHEST_MOVE = 20.0
    ESCAPE_SENTENCE = Message("left the ring's place (it is {farthest:.3g} m or more from the centre, beyond a plane, "
                              "or 20 amplitudes from where it began)")
    COMPANION_MESHES = ((40, 1, 4), (72, 2, 4), (128, 2, 5), (math.inf, 3, 6))
    ESTIMATORS = ("transport", "recovered", "companion", "two-grid")
    LIMITS = ring_estimator_limits.LIMITS
    REMEDIES = (FILTER, COUPLED, FROZEN)
    STRAIN_PER_AMPLITUDE = 1 / INVERSION
    GENTLE_AMPLITUDE, HARD_AMPLITUDES = 1e-2, (0.05, 0.1, 0.15)
    FEWEST_CELLS = 8
    DEFAULT_PERIODS = 1.0
    SAMPLES_A_PERIOD = 50  # a sample of a ring costs more than a step
    # Measured at 48 cells, A = 0.1: everywhere, the internal forces no longer cancel (0.4 of their sum, all at the
    # surface) and uGIMP blows up within a period; at nodes full of material alone, x gets 21 % better for uGIMP and
    # 15 % worse for CPDI, whose parallelograms tile and leave nothing to correct.
    NOT_LINEARITY_PRESERVING = Message("is not offered for the ring: at the free surface it breaks action and reaction "
                                       "and the run blows up, and away from it CPDI gains nothing; leave it off")
    MENDS = Message("the others correct")

    def displacement_at(self, X: Any, Y: Any, t: Any) -> tuple[Any, Any]:
        R = sqrt(X * X + Y * Y)
        share = self.amplitude * sin(self.angular_frequency * t) * ((C3 * R + C2) * R + C1)  # T w(R)/R
        return share * X, share * Y

    def second_tone_shape(self, X: np.ndarray, t: Any) -> np.ndarray:
        """Returns the shape (P, 2) in m, at X (P, 2), of the second tone of the body force "two-tone"."""
        R = np.linalg.norm(X, axis=1)[:, None]
        return self.amplitude * np.cos(math.pi * (R - INNER) / (OUTER - INNER)) * X / R

    @staticmethod
    def lattice_counts(cells: int, ppc: int) -> tuple[int, int]:
        return max(1, round(2 * cells * ppc / 3)), max(1, round(cells * ppc / 6))

    disturbance_growth = property(ring_estimator_limits.disturbance_growth)
    known_weakness = property(ring_estimator_limits.known_weakness)
    motion_amplitude = DerivedSceneQuantities.motion_amplitude  # A, at the outer rim

    def warnings(self) -> list[str]:
        return super().warnings() + ring_estimator_limits.warnings(self)

    def _check_amplitude(self) -> None:
        allowed = Message("give a number above 1e-12 and below {inversion}", INVERSION)
        require_number("amplitude", self.amplitude, 1e-12, math.inf, allowed)
        if self.amplitude >= INVERSION:
            raise SceneError("amplitude", self.amplitude,
                             "the exact ring turns inside out from {inversion} on; {allowed}", INVERSION, allowed)


RING = PlanarProblem(RingScene, ViewSettings(
    cells=(12, 96, 6), ppc=(1, 6), amplitude=(1e-3, 0.4), modulus=(1e5, 1e8),
    amplitude_hint="largest displacement of the outer rim; from 0.115 m on the motion itself is unstable, above 0.198 "
                   "m a real ring wrinkles, from 0.386 m on the exact one turns inside out",
    prices={"transport": 0.06, "recovered": 0.12, "companion": 0.02, "two-grid": 0.09},
    details={"layout": "where particles begin: the Cartesian rim is a staircase",
             "body_force": "where the force is evaluated"},
    sparks=("halve", "transport", "break"),
    breaking=("hat functions, A = 250 mm", {"method": "mpm", "amplitude": 0.25}, 1.2)))
