"""A companion that is solved by itself, beside no particles: for those of another code, at whatever times it has.

The same spectral elements as those that run beside our own particles (``companion``), in numpy: nobody waits for a
compiler, and steps end at the times that are asked for. Time is Nystrom's method of fourth order, as there.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np

from solvers.estimators.spectral import Elements

SAFE = 1.5  # omega H of a step: 2.58 is where the method ends; at 1.5 its error is no part of the whole


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


class Lost(ArithmeticError):
    """A motion that the companion cannot follow to the ``time``: it is no number any more."""

    def __init__(self, time: float):
        self.time = time
        super().__init__(f"lost before t = {time:g} s")


def longest_step(body: ElasticBody) -> float:
    """Of a step in seconds, so that what it adds to the error is no part of the whole."""
    return SAFE / body.frequency


class NystromIntegrator:
    """A body on its way from t = 0, at rest in shape, by steps of at most ``longest`` seconds: ``u``, ``v`` and ``a``
    (N, D) are those of the ``time`` to which it was brought last."""

    def __init__(self, body: ElasticBody, longest: float = math.inf):
        self.body, self.time, self.longest = body, 0.0, min(longest, longest_step(body))
        self.u, self.v = np.zeros_like(body.velocity), body.velocity.copy()
        self.a = body.accelerations(self.u, 0.0)

    def to(self, time: float) -> None:
        """Go on to a time that is not earlier. Raises :class:`Lost` where the motion breaks down."""
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
            raise Lost(time)


def solve(body: ElasticBody, times: Sequence[float]) -> list[tuple[np.ndarray, np.ndarray]]:
    """Displacement and velocity of the nodes, (N, D) each, at the times, which do not fall and begin at 0 or later.

    Raises :class:`Lost` where the motion breaks down.
    """
    integrator, found = NystromIntegrator(body), []
    for time in times:
        integrator.to(time)
        found.append((integrator.u, integrator.v))
    return found


class PolarBody(ElasticBody):
    """A body between two radii and two angles: elements in R and theta under the exact map, of which the unknowns are
    Cartesian displacements.

    A problem's own says ``piola`` and ``force``; ``free`` (radii, row, 2) is 0 where a component is held.
    """

    def __init__(self, radial: Elements, angular: Elements, directions: np.ndarray, free: np.ndarray, density: float,
                 frequency: float):
        self.radial, self.angular, self.frequency = radial, angular, frequency
        self.rows, self.row = len(radial.nodes), len(angular.nodes)
        self.places = (radial.nodes[:, None, None] * directions).reshape(-1, 2)
        masses = np.outer(radial.assembled_weights * radial.nodes, angular.assembled_weights)
        self.inverse_mass, self._free = free / (density * masses[..., None]), free
        self._node = tuple(np.broadcast_arrays(radial.of_node[:, None, :, None], angular.of_node[None, :, None, :]))
        self._R, self._e = radial.nodes[self._node[0]][..., None], directions[self._node[1]]
        self._t = np.stack([-self._e[..., 1], self._e[..., 0]], axis=-1)
        self._weight = (np.outer(radial.weights, angular.weights)[..., None] * self._R)[..., None]

    @abstractmethod
    def piola(self, F: np.ndarray) -> np.ndarray:
        """The first Piola-Kirchhoff stress (..., 2, 2) in Pa of deformation gradients."""

    @abstractmethod
    def force(self, t: float) -> np.ndarray:
        """The body force (N, 2) per mass at ``places``."""

    def accelerations(self, u: np.ndarray, t: float) -> np.ndarray:
        local = u.reshape(self.rows, self.row, 2)[self._node]
        out = np.einsum("ik,abkjc->abijc", self.radial.derivative, local)
        along = np.einsum("jk,abikc->abijc", self.angular.derivative, local) / self._R
        F = np.eye(2) + out[..., :, None] * self._e[..., None, :] + along[..., :, None] * self._t[..., None, :]
        P = self._weight * self.piola(F)
        P_e = np.einsum("abkjcd,abkjd->abkjc", P, self._e)
        P_t = np.einsum("abikcd,abikd->abikc", P, self._t) / self._R
        pull = np.einsum("ki,abkjc->abijc", self.radial.derivative, P_e) \
            + np.einsum("kj,abikc->abijc", self.angular.derivative, P_t)
        total = np.zeros((self.rows, self.row, 2))
        np.add.at(total, self._node, pull)
        return (self._free * self.force(t).reshape(total.shape) - self.inverse_mass * total).reshape(-1, 2)

    def read(self, u: np.ndarray, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        R, e = np.hypot(X[:, 0], X[:, 1]), X / np.linalg.norm(X, axis=1)[:, None]
        a, outward, slope_out = self.radial.locate(R)
        b, around, slope_around = self.angular.locate(np.arctan2(X[:, 1], X[:, 0]))
        local = u.reshape(self.rows, self.row, 2)[self.radial.of_node[a][:, :, None], self.angular.of_node[b][:, None]]
        values, u_R, u_t = (np.einsum("pi,pj,pijc->pc", radial, angular, local) for radial, angular in (
            (outward, around), (slope_out, around), (outward, slope_around)))
        turned = np.stack([-e[:, 1], e[:, 0]], axis=1)
        return values, u_R[:, :, None] * e[:, None] + (u_t / R[:, None])[:, :, None] * turned[:, None]
