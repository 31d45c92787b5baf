"""The bound on the bar's time step along the motion ahead (see ``solvers.scene.step_bound``): tangent modulus E F^2
V0."""

import numpy as np

from solvers.problems.bar import patch
from solvers.scene.remedies import PIECES
from solvers.scene.scene import Scene
from solvers.scene.step_bound import INSTANTS, bound, stencil

MOST_PARTICLES = 20_000  # of the bar that is looked at; a finer one has the same cells, only more of them


def critical_time_step(scene: Scene, stretch: float, velocity: float) -> float:
    """The smallest bound, in seconds, over the bar's motion from one extreme to the other. A patch test, which does not
    swing, begins with this ``stretch``, no unit, and this ``velocity`` in m/s."""
    if not scene.swings:
        return _of_patch(scene, stretch, velocity)
    ppc = int(scene.ppc)
    cells = max(8, min(scene.cells, MOST_PARTICLES // ppc))
    X = (np.arange(cells * ppc) + 0.5) / (cells * ppc)
    sizes = scene.motion_amplitude * np.linspace(-1, 1, INSTANTS)
    return min(_at(scene, cells, X, size) for size in sizes) * cells / scene.cells


def _of_patch(scene: Scene, stretch: float, velocity: float) -> float:
    """The smallest bound of a patch test while its particles pass through a cell; all spacings stay as they are."""
    cells, particles = patch.group(scene)
    times = max(1, min(scene.cells // cells, MOST_PARTICLES // particles))
    cells, particles = times * cells, times * particles
    X = (np.arange(particles) + 0.5) / particles
    shifts = np.linspace(0, 1, INSTANTS) / cells if velocity and not scene.frozen else [0.0]
    return min(_grid_bound(scene, cells, X + shift, np.ones_like(X), stretch) for shift in shifts) * cells / scene.cells


def _at(scene: Scene, cells: int, X: np.ndarray, size: float) -> float:
    """The bound where the displacement is ``size`` sin 2 pi X."""
    x = X if scene.frozen else X + size * np.sin(2 * np.pi * X)
    return _grid_bound(scene, cells, x, 1 + 2 * np.pi * size * np.cos(2 * np.pi * X))


def _grid_bound(scene: Scene, cells: int, x: np.ndarray, F: np.ndarray, stretch: float = 1.0) -> float:
    """The bound with particles at x (P,) in metres, which have deformed by F (P,) since the start."""
    volume = 1 / len(x)
    half_width = np.full_like(x, 0.5 / scene.ppc)
    if scene.method == "cpgimp" and not scene.frozen:
        half_width = np.minimum(half_width * F, 0.5)
    first, S, dS = stencil(scene.method, x * cells, half_width)
    nodes = (first[:, None] + np.arange(3)) % cells
    mass = np.bincount(nodes.ravel(), (scene.density / stretch * volume * S).ravel(), cells)
    if PIECES in scene.remedies:
        nodes, parting = _pieces(scene.method, cells, x)
        return bound(nodes, np.abs(parting), np.full_like(x, scene.modulus * stretch / volume), mass)
    tangent = np.ones_like(F) if scene.frozen else F * F
    return bound(nodes, np.abs(dS) * cells, scene.modulus * stretch * tangent * volume, mass)


def _pieces(method: str, cells: int, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (P, 5) of the pieces around particles at x, and by how much each piece pulls at them for its stress: the
    difference of the base functions at its corners (see ``method.pieces``)."""
    P = len(x)
    _, first, B = corner_functions(method, cells, x)
    apart = np.minimum(np.diff(first), 2)
    parting = np.zeros((P, 5))
    parting[:, :3] -= B[:-1]
    for k in range(3):
        parting[np.arange(P), apart + k] += B[1:, k]
    return (first[:-1, None] + np.arange(5)) % cells, parting


def corner_functions(method: str, cells: int, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Corners of the pieces around particles at x, from the first to that a period behind it (P + 1,), in metres; the
    first of the three nodes each, from 0 at x = 0, and the base functions there (P + 1, 3)."""
    P = len(x)
    around = np.concatenate([x[-2:] - 1, x, x[:2] + 1])
    corners = (9 * (around[1:P + 2] + around[2:P + 3]) - around[:P + 1] - around[3:]) / 16
    first, B, _ = stencil("bspline" if method == "bspline" else "mpm", corners * cells, np.zeros(P + 1))
    return corners, first, B
