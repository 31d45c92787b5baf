"""Companion without a run beside it, for particles of other codes at arbitrary times.

The same spectral elements as beside our own particles (``companion``), in numpy: nothing is compiled, and steps end at
the requested times. Time integration is Nystrom's method of fourth order, as there.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np

SAFE_STEP = 1.5  # omega H of a step: 2.58 is where the method ends; at 1.5 its error is no part of the whole


class ElasticBody(ABC):
    """Elastic body of N nodes: initial ``velocity`` (N, D) in m/s; highest angular ``frequency`` at rest in 1/s."""

    velocity: np.ndarray
    frequency: float

    @abstractmethod
    def accelerations(self, u: np.ndarray, t: float) -> np.ndarray:
        """Returns the nodes' accelerations (N, D) in m/s^2 at displacements u (N, D) in m and the time t in s."""

    @abstractmethod
    def values_and_gradients(self, u: np.ndarray, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Returns values (P, D) and gradients (P, D, D; per m) of nodal values u (N, D) at material points X (P, D)."""


class MotionDivergedError(ArithmeticError):
    """Error for a motion that has become infinite or NaN before ``time`` (s), so that no companion can follow it."""

    def __init__(self, time: float):
        self.time = time
        super().__init__(f"lost before t = {time:g} s")


def accurate_time_step(body: ElasticBody) -> float:
    """Returns a step of :class:`NystromIntegrator`, in s, so short that the error in time is negligible for a body."""
    return SAFE_STEP / body.frequency


class NystromIntegrator:
    """Time integrator of a body, undeformed at t = 0, with steps of at most ``longest`` seconds: ``u`` (m), ``v`` (m/s)
    and ``a`` (m/s^2), (N, D) each, are those of the nodes at ``time`` (s), to which it was advanced last."""

    def __init__(self, body: ElasticBody, longest: float = math.inf):
        self.body, self.time, self.longest = body, 0.0, min(longest, accurate_time_step(body))
        self.u, self.v = np.zeros_like(body.velocity), body.velocity.copy()
        self.a = body.accelerations(self.u, 0.0)

    def advance_to(self, time: float) -> None:
        """Advances ``u``, ``v``, ``a`` and ``time`` to a time in s that is not earlier. Raises
        :class:`MotionDivergedError` where the motion becomes infinite or NaN."""
        u, v, k1, body = self.u, self.v, self.a, self.body
        steps = math.ceil((time - self.time) / self.longest)
        for step in range(steps):
            H, t = (time - self.time) / steps, self.time + step * (time - self.time) / steps
            k2 = body.accelerations(u + 0.5 * H * v + 0.125 * H * H * k1, t + 0.5 * H)
            k3 = body.accelerations(u + H * v + 0.5 * H * H * k2, t + H)
            u = u + H * (v + H / 6 * (k1 + 2 * k2))
            v = v + H / 6 * (k1 + 4 * k2 + k3)
            k1 = body.accelerations(u, t + H)
        self.u, self.v, self.a, self.time = u, v, k1, time
        if not (np.isfinite(u) & np.isfinite(v)).all():
            raise MotionDivergedError(time)


def solve(body: ElasticBody, times: Sequence[float]) -> list[tuple[np.ndarray, np.ndarray]]:
    """Returns displacements in m and velocities in m/s of a body's nodes, (N, D) each, at each of the ``times`` in s,
    from 0 on and never decreasing. Raises :class:`MotionDivergedError` where the motion becomes infinite or NaN."""
    integrator, motion = NystromIntegrator(body), []
    for time in times:
        integrator.advance_to(time)
        motion.append((integrator.u, integrator.v))
    return motion
