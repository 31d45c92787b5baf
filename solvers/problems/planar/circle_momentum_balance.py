"""Motion of a ring's circles by the balance of momentum (see ``solvers.scene.displacement_moments``).

Start, loads and material are the same all around, so that each circle of material stays one, widens and turns as a
whole: a particle at R e_R goes to z = p + i q, p along e_R and q along e_Theta of where it is at rest. These are the
equations of the companion (``solvers.problems.planar.estimators.circular_companion``) on one spectral element from rim
to rim, by leapfrog, where a run looks for contradictions, 20 times a period.
"""

import bisect
import functools
import math
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import legendre

from solvers.estimators.spectral_elements import unresolved_size
from solvers.problems.planar.estimators.circular_companion_body import CircularCompanionBody
from solvers.problems.planar.particle_layout import circle_counts
from solvers.scene.displacement_moments import MODES, DisplacementMoments

#: Orders of the element, up to an amplitude: of 500 random motions with an exact solution they missed at most 0.03 of
#: the amplitude in two periods, mostly a thousandth. A ring that all but turns inside out needs the higher one.
ORDERS = ((0.35, 6), (math.inf, 10))
COURANT = 1.2  # highest frequency times step: leapfrog is stable up to 2
STEPS_A_PERIOD = 60  # of the loads, at least
MAX_UNRESOLVED = 0.05  # of the amplitude: what the element's polynomials leave out, up to which they are to be trusted
MOST_STEPS = 200_000  # of one scene, some five seconds; a motion that needs more is not followed to its end
MOST_INSTANTS = 20_000  # instants of a run that goes on and on
STEPS_PER_BATCH = 16  # steps whose loads are computed together, and between two updates of the stiffness
TO_COMPLEX = np.array([1, 1j])  # what makes a number of a vector


class RadialNodeState(NamedTuple):
    """State of the circles at ``time`` s: complex places p + i q in m (None where unknown) and velocities in m/s, (N,)
    each, of the nodes along a radius."""

    time: float
    place: np.ndarray | None
    velocity: np.ndarray


class CircleMotionIntegrator:
    """Motion of a scene's circles of material by the balance of momentum, computed up to requested times and cached."""

    def __init__(self, scene: Any):
        self._scene = scene
        order = next(order for most, order in ORDERS if scene.amplitude <= most)
        self._body = CircularCompanionBody(scene, 1, order)
        self._R = self._body.elements.node_coordinates
        self._instants = [RadialNodeState(0.0, self._R.astype(complex), self._body.velocity @ TO_COMPLEX)]
        self._steps = 0
        radii, self._counts = circle_counts(scene)
        _, self._read, _ = self._body.elements.evaluate_basis(radii)
        middle = 0.5 * (scene.INNER + scene.OUTER)
        self._shapes = legendre.legvander((radii - middle) / (scene.OUTER - middle), MODES // 2 - 1)
        gram = np.kron(np.eye(2), self._shapes.T @ (self._counts[:, None] * self._shapes))
        self._inverse = np.linalg.pinv(gram, hermitian=True)

    def moments(self, times: np.ndarray) -> DisplacementMoments:
        """Returns displacement moments at times (T,) in s, with Legendre polynomials of R: along e_R, then e_Theta."""
        sums, squares = np.zeros((len(times), MODES)), np.zeros(len(times))
        trusted = np.zeros(len(times), bool)
        for row, time in enumerate(times):
            place = self._state_at(float(time)).place
            if place is not None:
                u = self._read @ (place - self._R)
                weighted = self._shapes.T @ (self._counts * u)
                sums[row], squares[row] = [*weighted.real, *weighted.imag], self._counts @ np.abs(u) ** 2
                trusted[row] = True
        return DisplacementMoments(sums, squares, self._inverse, int(self._counts.sum()), trusted)

    def _state_at(self, time: float) -> RadialNodeState:
        """Returns the circles at a time in s, computed from the last cached state before it, and caches them."""
        known = bisect.bisect_right(self._instants, time, key=lambda one: one.time)
        last = self._instants[known - 1]
        if last.time == time:
            return last
        with np.errstate(all="ignore"):  # a motion that breaks down ends as no number
            found = self._advance(last, time)
        if last.place is not None:
            self._instants.insert(known, found)
        if len(self._instants) > MOST_INSTANTS:
            del self._instants[1]
        return found

    def _advance(self, start: RadialNodeState, end: float) -> RadialNodeState:
        """Returns the state at a later time ``end`` in s; without places where the computation fails."""
        z, v, t = start.place, start.velocity, start.time
        while z is not None and t < end:
            stiffening = self._body.stiffening(self._body.deformation_gradient(z))
            rate = max(self._body.frequency_at_rest * stiffening / COURANT, STEPS_A_PERIOD / self._scene.period)
            if not self._steps + (end - t) * rate <= MOST_STEPS:  # true for NaN too
                return RadialNodeState(end, None, v)
            left = math.ceil((end - t) * rate)
            steps = min(left, STEPS_PER_BATCH)
            z, v = self._steps_from(z, v, t, (end - t) / left, steps)
            t = end if steps == left else t + steps * (end - t) / left
            self._steps += steps
        # What the element's polynomials leave out is not to be more than is to be trusted.
        if z is not None and not abs(unresolved_size((z - self._R)[None],
                                                     1)[0]) <= MAX_UNRESOLVED * self._scene.motion_amplitude:
            z = None
        return RadialNodeState(end, z, v)

    def _steps_from(self, z: np.ndarray, v: np.ndarray, t: float, H: float,
                    steps: int) -> tuple[np.ndarray, np.ndarray]:
        """Returns complex places (m) and velocities (m/s), (N,) each, ``steps`` steps of H s after z and v at t s."""
        loads = [self._body.force(t + H * k) @ TO_COMPLEX for k in range(steps + 1)]
        a = loads[0] + self._body.internal_acceleration(z)
        for b in loads[1:]:
            v = v + 0.5 * H * a
            z = z + H * v
            a = b + self._body.internal_acceleration(z)
            v = v + 0.5 * H * a
        return z, v


@functools.lru_cache(maxsize=4)
def cached_circle_motion(scene: Any) -> CircleMotionIntegrator:
    """Returns the motion of a scene's circles; the last four scenes' are cached, to continue while a run is watched."""
    return CircleMotionIntegrator(scene)
