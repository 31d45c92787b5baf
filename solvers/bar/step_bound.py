"""The bound on the bar's time step along the motion ahead (see ``solvers.step_bound``): tangent modulus E F^2 V0."""

import numpy as np

from solvers.bar.scene import BarScene
from solvers.step_bound import INSTANTS, bound, stencil

MOST_PARTICLES = 20_000  # of the bar that is looked at; a finer one has the same cells, only more of them


def least(scene: BarScene) -> float:
    """The smallest bound, in seconds, over the bar's motion from one extreme to the other."""
    cells = max(8, min(scene.cells, MOST_PARTICLES // scene.ppc))
    X = (np.arange(cells * scene.ppc) + 0.5) / (cells * scene.ppc)
    sizes = scene.motion_amplitude * np.linspace(-1, 1, INSTANTS)
    return min(_at(scene, cells, X, size) for size in sizes) * cells / scene.cells


def _at(scene: BarScene, cells: int, X: np.ndarray, size: float) -> float:
    """The bound where the displacement is ``size`` sin 2 pi X."""
    F, volume = 1 + 2 * np.pi * size * np.cos(2 * np.pi * X), 1 / (cells * scene.ppc)
    x = X if scene.frozen else X + size * np.sin(2 * np.pi * X)
    half_width = np.full_like(X, 0.5 / scene.ppc)
    if scene.method == "cpgimp" and not scene.frozen:
        half_width = np.minimum(half_width * F, 0.5)
    first, S, dS = stencil(scene.method, x * cells, half_width)
    nodes = (first[:, None] + np.arange(3)) % cells
    mass = np.bincount(nodes.ravel(), (scene.density * volume * S).ravel(), cells)
    tangent = np.ones_like(F) if scene.frozen else F * F
    return bound(nodes, np.abs(dS) * cells, scene.modulus * tangent * volume, mass)
