"""The bound on the ring's time step along the motion ahead (see ``solvers.scene.step_bound``).

For the circles: a change of F by g F with g = v grad S costs mu (g b : g + g^T : g) <= mu (1 + largest eigenvalue of
b = F F^T) |g|^2 per reference volume; in material form, for frozen weights, mu (1 + 1/smallest eigenvalue of b).
"""

import numpy as np

from solvers.problems.planar.layout import particle_layout
from solvers.problems.planar.scene import PlanarScene
from solvers.problems.planar.step_bound import Body, Images, body_bound
from solvers.problems.ring import exact
from solvers.scene.step_bound import StepBound


def critical_time_step(scene: PlanarScene) -> StepBound:
    """The longest step along the ring's motion from one extreme to the other."""
    return body_bound(scene, body_of)


def body_of(scene: PlanarScene) -> Body:
    """What of the ring its bound is made of."""
    layout, mu, row = particle_layout(scene), 0.5 * scene.modulus, 2 * scene.cells
    X, R = layout.position, layout.radii[layout.radius]
    w, slope, _ = exact.shape(R)
    c, s = (X / R[:, None]).T

    def deformed(part: float) -> tuple[np.ndarray, np.ndarray]:
        size = scene.amplitude * np.sin(np.pi * (part - 0.5))
        radial, hoop = 1 + size * slope, 1 + size * w / R
        F = np.stack([radial * c * c + hoop * s * s, (radial - hoop) * c * s, (radial - hoop) * c * s,
                      radial * s * s + hoop * c * c], axis=1).reshape(-1, 2, 2)
        return X if scene.frozen else X * (1 + size * w / R)[:, None], F

    def images(i: np.ndarray, j: np.ndarray) -> Images:
        """From the planes on."""
        return Images(np.abs(i) + row * np.abs(j), np.where(i < 0, -1.0, 1.0), np.where(j < 0, -1.0, 1.0),
                      np.zeros(i.shape, bool))

    def stiff(F: np.ndarray) -> tuple[np.ndarray, None]:
        b = np.linalg.eigvalsh(F @ F.transpose(0, 2, 1))
        return mu * (1 + (1 / b[:, 0] if scene.frozen else b[:, 1])) * layout.volume, None

    stretch = 1 + scene.amplitude * float(np.abs([slope, w / R]).max())
    return Body(layout.volume, layout.edges, deformed, (0.0, mu), 0.5 * scene.period, stretch, images,
                lambda number: (number % row == 0, number < row), stiff)
