"""CircularScene: base class of plane problems between two radii whose motion is the same all around.

Start, loads and material are rotationally symmetric, so that each circle of material stays a circle, widens and turns
as a whole: the motion follows from its points on the x axis, where e_R and e_Theta are the axes.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

from solvers.motion.separable_field import SeparableField, separate
from solvers.problems.planar import circle_momentum_balance
from solvers.problems.planar.estimators.circular_companion_body import CircularCompanionBody
from solvers.problems.planar.particle_layout import points_on_x_axis
from solvers.problems.planar.scene import GHOSTS, PlanarScene
from solvers.scene.displacement_moments import DisplacementMoments
from solvers.scene.field_options import option

CIRCLES, INSTANTS = 32, 32  # of the means over the body and over a period
FINE, COARSE = (8, 6), (6, 5)  # of the companion beside another code: elements across the body, their order
MOST_TERMS, LEAST_TERM = 32, 1e-13  # of a displacement's expansion along the radius; the last, over the largest


@dataclass(frozen=True)
class CircularScene(PlanarScene):
    """Definition of a run between two radii, with a motion that is the same all around. A subclass defines
    ``displacement_at`` and may override more."""

    method: str = option("cpdi", "Shape functions of the particles", choices=("ugimp", "cpgimp", "cpdi", "mpm"))
    ppc: int = option(2, "Particles per cell and direction")
    density: float = option(1000.0, "Density", "kg/m3")
    body_force: str = option(
        "material", "Body force: at material points, none, or two tones; only the first has a built-in solution",
        choices=("material", "none", "two-tone"))
    layout: str = option("polar", "Lattice on which the particles begin", choices=("polar", "cartesian"))
    plan: str = option("auto", "How the step is spread over the threads; auto takes the faster one for the number of "
                       "particles", choices=("auto", "serial", "parallel"))

    CIRCULAR = True

    @classmethod
    def draw_point(cls, chance: np.random.Generator) -> tuple[float, float]:
        R, angle = chance.uniform(cls.INNER, cls.OUTER), chance.uniform(0, cls.ANGLE)
        return R * math.cos(angle), R * math.sin(angle)

    @property
    def active_rows(self) -> int:
        return min(self.row, int(self.farthest / self.spacing) + GHOSTS + 3) if self.PLANES[0] else self.row

    @property
    def farthest(self) -> float:
        """Largest coordinate of particles in a sound run, in m, with half an amplitude to spare; inside the grid."""
        return self.OUTER + 1.5 * self.amplitude + self.spacing if self.PLANES[0] else 0.5 * (self.SIDE - self.spacing)

    @functools.cached_property
    def motion_amplitude(self) -> float:
        """Largest displacement of the exact solution, in m."""
        X = points_on_x_axis(np.linspace(self.INNER, self.OUTER, 2 * CIRCLES + 1))
        return max(float(np.linalg.norm(self.EXACT.displacement(self, X, part * self.period), axis=1).max())
                   for part in self.EXTREMES)

    @property
    def wave_angle_per_metre(self) -> float:
        """Angle in radians that a wave runs along the fastest circle while a wave at rest runs a metre."""
        return 1 / self.INNER

    def companion_body(self, fine: bool | None) -> CircularCompanionBody:
        count, order = next(sizes for most, *sizes in self.COMPANION_MESHES if self.cells <= most) if fine is None \
            else FINE if fine else COARSE
        return CircularCompanionBody(self, count, order)

    def node_acceleration_field(self) -> SeparableField:
        """Returns the displacement in m on the x axis, for any time, as coefficients (terms, 2) of Chebyshev
        polynomials of the radius between the rims, in increasing order, as many as needed."""
        middle, half = 0.5 * (self.OUTER + self.INNER), 0.5 * (self.OUTER - self.INNER)
        there = chebyshev.chebpts1(MOST_TERMS)
        field = separate(lambda X, t: self.EXACT.displacement(self, X, t), points_on_x_axis(middle + half * there),
                         self.period)
        modes = np.einsum("mk,krc->mrc", np.linalg.inv(chebyshev.chebvander(there, MOST_TERMS - 1)), field.modes)
        sizes = np.abs(modes).max(axis=(1, 2))
        terms = 1 + int(np.flatnonzero(sizes > LEAST_TERM * sizes.max())[-1])
        return SeparableField(modes[:terms], field.series, field.angular_frequency)

    @functools.cached_property
    def _rms_sizes(self) -> dict[str, float]:
        """RMS over the body and a period of "x" (u), "v", "sigma" and "a" in the exact motion, in SI units, from
        lengths of vectors and Frobenius norms."""
        edges = np.linspace(self.INNER, self.OUTER, CIRCLES + 1)
        R = 0.5 * (edges[1:] + edges[:-1])
        return {name: float(np.sqrt(np.mean([np.average(now, weights=R) for now in squares])))
                for name, squares in self.exact_squares(points_on_x_axis(R), INSTANTS).items()}

    def rms_of(self, quantity: str) -> float:
        return self._rms_sizes[quantity]

    def momentum_balance_moments(self, times: np.ndarray) -> DisplacementMoments:
        return circle_momentum_balance.cached_circle_motion(self).moments(times)
