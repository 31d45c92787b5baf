"""The companion on the vortex, solved by itself in numpy (see ``solvers.estimators.standalone``)."""

import numpy as np

from solvers.estimators.spectral import Elements
from solvers.estimators.standalone import ElasticBody
from solvers.problems.vortex import exact
from solvers.problems.vortex.estimators.companion_mesh import masses, unit_frequency
from solvers.problems.vortex.exact import force_at_rest, on_axis, right, turned
from solvers.problems.vortex.scene import VortexScene

STIFFENED = 1.3  # of the companion's steps: how much stiffer than at rest the vortex may grow, as a frequency


class VortexCompanionBody(ElasticBody):
    """Two functions of the radius, on a line of elements: with every angle the same, they tell all (why, and the
    equations, are in ``solvers.problems.vortex.estimators.companion``). The unknowns are the displacement of the
    particles on the x axis, along it and across it."""

    def __init__(self, scene: VortexScene, count: int, order: int):
        self._scene, self._elements = scene, Elements(exact.INNER, exact.OUTER, count, order)
        self._R, self._lame = self._elements.nodes, exact.lame(scene)
        self._inverse_mass = 1 / (scene.density * masses(self._elements))[:, None]
        self.velocity = exact.velocity(scene, on_axis(self._R), 0.0)
        self.frequency = STIFFENED * scene.wave_speed * unit_frequency(self._elements)

    def accelerations(self, u: np.ndarray, t: float) -> np.ndarray:
        (lam, mu), node, D = self._lame, self._elements.of_node, self._elements.derivative
        local, R, weight = u[node], self._R[node][..., None], self._elements.weights[:, None]
        along = np.einsum("ki,eic->ekc", D, local) + np.array([1.0, 0.0])  # F e_R, then F e_Theta
        around = right(-local) / R + np.array([0.0, 1.0])
        J = along[..., :1] * around[..., 1:] - along[..., 1:] * around[..., :1]
        with np.errstate(all="ignore"):  # a motion that is lost, which its end tells
            back = (lam * np.log(J) - mu) / J
        radial = mu * along + back * right(around)  # P e_R
        hoop = mu * around - back * right(along)  # P e_Theta
        pull = np.einsum("ki,ekc->eic", D, weight * R * radial) + weight * right(hoop)
        total = np.zeros_like(u)
        np.add.at(total, node, pull)
        return force_at_rest(self._scene, self._R, t) - self._inverse_mass * total

    def read(self, u: np.ndarray, X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        R = np.linalg.norm(X, axis=1)
        e = X / R[:, None]
        element, values, slopes = self._elements.locate(R)
        local = u[self._elements.of_node[element]]
        there, slope = (np.einsum("pi,pic->pc", basis, local) for basis in (values, slopes))
        outward, around = turned(e, slope), turned(e, right(-there) / R[:, None])
        return turned(e, there), outward[:, :, None] * e[:, None] + around[:, :, None] * right(-e)[:, None]
