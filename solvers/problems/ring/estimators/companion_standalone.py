"""The companion on the ring, solved by itself in numpy (see ``solvers.estimators.standalone``)."""

import numpy as np

from solvers.estimators.spectral import Elements
from solvers.estimators.standalone import PolarBody
from solvers.problems.ring import exact
from solvers.problems.ring.estimators.companion_mesh import directions, free, unit_frequency
from solvers.problems.ring.scene import RingScene


class RingCompanionBody(PolarBody):
    """The quarter ring, its surfaces free, held across the planes of symmetry."""

    def __init__(self, scene: RingScene, across: int, around: int, order: int):
        radial = Elements(exact.INNER, exact.OUTER, across, order)
        angular = Elements(0.0, 0.5 * np.pi, around, order)
        # strain stiffens: the tangent of the exact motion is at most mu (1 + 1/s^2), s the least stretch
        stretches = [np.min(exact.stretches(scene, radial.nodes, s * scene.period / 4)) for s in (1, 3)]
        stiffest = 0.5 * (1 + 1 / max(0.1, min(stretches)) ** 2)
        super().__init__(radial, angular, directions(angular), free(radial, angular), scene.density,
                         scene.wave_speed * unit_frequency(radial, angular) * float(np.sqrt(stiffest)))
        self._scene = scene
        self.velocity = exact.velocity(scene, self.places, 0.0) * free(radial, angular).reshape(-1, 2)
        self._directions = np.broadcast_to(directions(angular), (self.rows, self.row, 2)).reshape(-1, 2)

    def piola(self, F: np.ndarray) -> np.ndarray:
        J = F[..., 0, 0] * F[..., 1, 1] - F[..., 0, 1] * F[..., 1, 0]
        turned = np.stack([F[..., 1, 1], -F[..., 1, 0], -F[..., 0, 1], F[..., 0, 0]], axis=-1).reshape(F.shape)
        return 0.5 * self._scene.modulus * (F - turned / J[..., None, None])

    def force(self, t: float) -> np.ndarray:
        return np.repeat(exact.body_force(self._scene, self.radial.nodes, t), self.row)[:, None] * self._directions
