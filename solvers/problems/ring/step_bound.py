"""The bound on the ring's time step along the motion ahead (see ``solvers.scene.step_bound``).

For P = mu (F - F^-T) a change of F by g F with g = v grad S costs mu (g b : g + g^T : g) <= mu (1 + largest eigenvalue
of b = F F^T) |g|^2 per reference volume; in material form, for frozen weights, mu (1 + 1/smallest eigenvalue of b).
"""

import numpy as np

from solvers.problems.planar.layout import particle_layout
from solvers.problems.planar.scene import PlanarScene
from solvers.problems.planar.step_bound import body_bound, coarsened
from solvers.problems.ring import exact
from solvers.scene.step_bound import INSTANTS


def critical_time_step(scene: PlanarScene) -> float:
    """The smallest bound, in seconds, over the ring's motion from one extreme to the other."""
    fine, scene = scene, coarsened(scene)
    layout = particle_layout(scene)
    sizes = scene.amplitude * np.linspace(-1, 1, INSTANTS)
    return min(_at(scene, layout, size) for size in sizes) * fine.spacing / scene.spacing


def _at(scene: PlanarScene, layout, size: float) -> float:
    """The bound where the radial displacement is ``size`` w(R)."""
    X, R = layout.position, layout.radii[layout.radius]
    w, slope, _ = exact.shape(R)
    radial, hoop = 1 + size * slope, 1 + size * w / R
    if scene.frozen:
        x, F, stretch = X, np.tile(np.eye(2), (len(X), 1, 1)), 1 / np.minimum(radial, hoop)
    else:
        c, s = (X / R[:, None]).T
        F = np.stack([radial * c * c + hoop * s * s, (radial - hoop) * c * s, (radial - hoop) * c * s,
                      radial * s * s + hoop * c * c], axis=1).reshape(-1, 2, 2)
        x, stretch = X * (1 + size * w / R)[:, None], np.maximum(radial, hoop)

    def number(i: np.ndarray, j: np.ndarray) -> np.ndarray:
        """From the planes on, so that mirror images have one number."""
        return np.abs(i) + 2 * scene.cells * np.abs(j)

    stiffness = 0.5 * scene.modulus * (1 + stretch**2) * layout.volume
    return body_bound(scene, x, F, layout.edges, layout.volume, stiffness, number)
