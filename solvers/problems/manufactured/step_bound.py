"""The bound on the time step of a manufactured problem along its motion (see ``solvers.scene.step_bound``)."""

from typing import Any

import numpy as np

from solvers.problems.planar.layout import particle_layout
from solvers.problems.planar.step_bound import Body, Images, body_bound
from solvers.scene.step_bound import StepBound

MOMENTS = 9  # of a period, for the largest stretch


def critical_time_step(scene: Any) -> StepBound:
    """Over a whole period, for nothing is known of its symmetry in time."""
    return body_bound(scene, body_of)


def body_of(scene: Any) -> Body:
    """What of a body between symmetry planes on all sides its bound is made of."""
    layout, (bulk, mu), n = particle_layout(scene), scene.lame_moduli, scene.cells
    X, row = layout.position, 2 * scene.cells

    def deformed(part: float) -> tuple[np.ndarray, np.ndarray]:
        t = scene.period * part
        return X if scene.frozen else scene.EXACT.position(scene, X, t), scene.EXACT.deformation_gradient(scene, X, t)

    def images(i: np.ndarray, j: np.ndarray) -> Images:
        inside = [np.where(k > n, 2 * n - k, np.abs(k)) for k in (i, j)]
        sign_x, sign_y = (np.where((k < 0) | (k > n), -1.0, 1.0) for k in (i, j))
        return Images(inside[0] + row * inside[1], sign_x, sign_y, np.zeros(i.shape, bool))

    def held(number: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        i, j = number % row, number // row
        return (i == 0) | (i == n), (j == 0) | (j == n)

    def stiff(F: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        rest = (bulk + mu - bulk * np.log(np.linalg.det(F)))[:, None, None]
        metric = mu * np.eye(2) + rest * np.linalg.inv(F.transpose(0, 2, 1) @ F) if scene.frozen \
            else mu * F @ F.transpose(0, 2, 1) + rest * np.eye(2)
        return layout.volume, metric.reshape(-1, 4)[:, [0, 1, 3]]

    stretch = max(float(np.linalg.norm(deformed(part)[1], 2, axis=(1, 2)).max()) for part in np.linspace(0, 1, MOMENTS))
    return Body(layout.volume, layout.edges, deformed, (bulk, mu), scene.period, stretch, images, held, stiff)
