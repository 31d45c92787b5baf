"""A companion that is solved by itself, beside no particles: for those of another code, at whatever times it has.

The same spectral elements as those that run beside our own particles (``companion``), in numpy: nobody waits for a
compiler, and steps end at the times that are asked for. Time is Nystrom's method of fourth order, as there.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np

SAFE_STEP = 1.5  # omega H of a step: 2.58 is where the method ends; at 1.5 its error is no part of the whole


class ElasticBody(ABC):
    """What moves: N nodes with D components.

    ``velocity`` (N, D) is the initial one, ``frequency`` the highest of the body at rest, in 1/s.
    """

    velocity: np.ndarray
    frequency: float

    @abstractmethod
    def accelerations(self, u: np.ndarray, t: float) -> np.ndarray:
        """(N, D) in m/s^2 at the displacements u (N, D) and the time t."""

    @abstractmethod
    def read(self, u: np.ndarray, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Of a field of the nodes (N, D): its values (P, D) and gradients (P, D, D) at the material points X (P, D)."""


class MotionLost(ArithmeticError):
    """A motion that the companion cannot follow to the ``time``: it is no number any more."""

    def __init__(self, time: float):
        self.time = time
        super().__init__(f"lost before t = {time:g} s")


def longest_step(body: ElasticBody) -> float:
    """Of a step in seconds, so that what it adds to the error is no part of the whole."""
    return SAFE_STEP / body.frequency


class NystromIntegrator:
    """A body on its way from t = 0, at rest in shape, by steps of at most ``longest`` seconds: ``u``, ``v`` and ``a``
    (N, D) are those of the ``time`` to which it was brought last."""

    def __init__(self, body: ElasticBody, longest: float = math.inf):
        self.body, self.time, self.longest = body, 0.0, min(longest, longest_step(body))
        self.u, self.v = np.zeros_like(body.velocity), body.velocity.copy()
        self.a = body.accelerations(self.u, 0.0)

    def advance_to(self, time: float) -> None:
        """Go on to a time that is not earlier. Raises :class:`MotionLost` where the motion breaks down."""
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
            raise MotionLost(time)


def solve(body: ElasticBody, times: Sequence[float]) -> list[tuple[np.ndarray, np.ndarray]]:
    """Displacement and velocity of the nodes, (N, D) each, at the times, which do not fall and begin at 0 or later.

    Raises :class:`MotionLost` where the motion breaks down.
    """
    integrator, found = NystromIntegrator(body), []
    for time in times:
        integrator.advance_to(time)
        found.append((integrator.u, integrator.v))
    return found
