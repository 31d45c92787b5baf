"""The bound on the vortex's time step along the motion ahead (see ``solvers.step_bound``).

For P = mu (F - F^-T) + lambda ln J F^-T a change of F by g F with g = v grad S costs
mu g b : g + (mu - lambda ln J) g^T : g + lambda (tr g)^2 <= (mu s + mu + lambda) |g|^2 per reference volume where
J = 1, s the largest eigenvalue of b = F F^T; in material form, for frozen weights, mu + (mu + lambda) s with s that of
its inverse, which is the same: shear g makes s = ((sqrt(4 + g^2) + g)/2)^2.
"""

from dataclasses import replace

import numpy as np

from solvers.planar.layout import box_stretch
from solvers.planar.step_bound import boxes, corners
from solvers.step_bound import INSTANTS, bound
from solvers.vortex import exact
from solvers.vortex.layout import particle_layout
from solvers.vortex.scene import VortexScene

MOST_PARTICLES = 10_000  # of the ring that is looked at; a finer one meets the grid in the same ways


def least(scene: VortexScene) -> float:
    """The smallest bound, in seconds, over the motion from rest to the largest turn; the other way is its mirror."""
    fine = scene
    while scene.particles > MOST_PARTICLES and scene.cells > scene.FEWEST_CELLS:
        scene = replace(scene, cells=max(scene.cells // 2, scene.FEWEST_CELLS))
    quarter = 0.25 * scene.period
    return min(_at(scene, t) for t in np.linspace(0, quarter, INSTANTS)) * fine.spacing / scene.spacing


def _at(scene: VortexScene, t: float) -> float:
    """The bound at the time t of the exact motion."""
    layout, (lam, mu) = particle_layout(scene), exact.lame(scene)
    R = layout.radii[layout.radius]
    shear = np.abs(R * exact.turn(scene, R, t).slope)
    squared = (0.5 * (np.sqrt(4 + shear**2) + shear)) ** 2
    X = layout.position
    if scene.frozen:
        x, F, stiffness = X, np.tile(np.eye(2), (len(X), 1, 1)), mu + (mu + lam) * squared
    else:
        x, F = exact.position(scene, X, t), exact.deformation_gradient(scene, X, t)
        stiffness = mu * squared + mu + lam

    def number(place: np.ndarray) -> np.ndarray:
        return place + scene.cells

    if scene.method == "cpdi":
        nodes, S, gradients = corners(scene, x, F.reshape(-1, 4), layout.edges, number)
    else:
        nodes, S, gradients = boxes(scene, x, box_stretch(scene.method, F), number)
    mass = np.bincount(nodes.ravel(), (scene.density * layout.volume[:, None] * S).ravel())
    return bound(nodes, gradients, stiffness * layout.volume, mass)
