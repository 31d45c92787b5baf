"""A run of the bar kept step by step, in numpy: what the way back through it needs (see ``trace``).

Nodes are counted from 0 here, without images; a mapping between particles and nodes is a pair (nodes, weights), each
(P, k).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from solvers.problems.bar.method.nodes import DEGENERATE, EMPTY
from solvers.problems.bar.scene import BarScene
from solvers.problems.bar.solver import BarSolver

#: Particles times steps that can be kept, about 100 bytes each.
MOST_KEPT = 5_000_000


@dataclass(frozen=True)
class RecordedStep:
    """A step from time t in s on: ``position`` and ``F`` (P,) of the particles before it, weights and gradients
    (P, 3) at three nodes each, the nodes' sum of S, of linearity preservation ``mean`` and ``scale`` as
    ``nodes.divergence_form`` has them, and the nodes' volume (N,)."""

    t: float
    position: np.ndarray
    F: np.ndarray
    nodes: np.ndarray
    S: np.ndarray
    dS: np.ndarray
    weight: np.ndarray
    mean: np.ndarray
    scale: np.ndarray
    volume: np.ndarray


@dataclass(frozen=True)
class Recorded:
    """All steps of a run, the ``position`` (P,) in which they left the particles, and true errors (3, P) of x in m, v
    in m/s and F there, F counted from the start."""

    scene: BarScene
    steps: list[RecordedStep]
    position: np.ndarray
    error: np.ndarray
    numbers: Numbers


@dataclass(frozen=True)
class Numbers:
    """Of the body: see ``method.body``; X (P,)."""

    X: np.ndarray
    dt: float
    modulus: float
    density: float
    volume: float
    unstretched: float
    half_width: float


def record(scene: BarScene, on_progress: Callable[[float], None] | None = None) -> Recorded | None:
    """Run a scene whose exact solution is known to its end; None where it goes bad."""
    solver, steps = BarSolver(scene), []
    a = solver._arrays
    numbers = Numbers(a.material_position.copy(), *(float(getattr(a, name)) for name in (
        "dt", "modulus", "density", "volume", "unstretched", "half_width")))
    for k in range(scene.steps):
        t, x, F = solver.time, a.position.copy(), a.deformation_gradient.copy()
        solver.advance(1)
        if not solver.sound:
            return None
        steps.append(_step(scene, solver, t, x, F))
        if on_progress and k % 100 == 0:
            on_progress(k / scene.steps)
    error = solver.snapshot().error
    assert error is not None  # the scene has the effect truth
    return Recorded(scene, steps, a.position.copy(), error[:, :3].T / np.array([[1.0], [1.0], [numbers.modulus]]),
                    numbers)


def _step(scene: BarScene, solver: BarSolver, t: float, x: np.ndarray, F: np.ndarray) -> RecordedStep:
    """The step that the solver has just taken."""
    a, N = solver._arrays, scene.cells
    left, right, slope_left, slope_right = a.weights.T
    weight = a.node_sums[1:N + 1, 0].copy()
    mean, scale, volume = np.zeros(N), np.ones(N), np.zeros(N)
    if scene.linearity_preserving:  # as ``nodes.divergence_form``
        moments, volume = a.node_moments[1:N + 1], a.node_volume[1:N + 1].copy()
        tilt = moments[:, 0] / np.maximum(weight, EMPTY)
        share = moments[:, 1] - tilt * moments[:, 2]
        whole = (share > DEGENERATE * volume) & (volume > DEGENERATE * scene.spacing)
        mean, scale = np.where(whole, tilt, 0.0), np.where(whole, volume / np.where(whole, share, 1.0), 1.0)
    return RecordedStep(
        t, x, F, (a.first_node[:, None] + np.arange(3) - 1) % N, np.stack([left, 1 - left - right, right], axis=1),
        np.stack([slope_left, -slope_left - slope_right, slope_right], axis=1), weight, mean, scale, volume)
