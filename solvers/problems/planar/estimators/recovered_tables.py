"""The recovered estimator's operators on a polar lattice, as kernels want them: set-up only, in numpy."""

from __future__ import annotations

import numpy as np

from solvers.estimators.lattice_lines import Line, Rows


def gathered_directions(angle: Line, gather_table: Rows) -> tuple[np.ndarray, np.ndarray]:
    """M e_R and M e_angle at the nodes of the angle (A, 2). Between symmetry planes nothing is along e_angle."""
    theta = angle.particles() / angle.per_point
    c, s = np.cos(theta), np.sin(theta)
    found = [gather_table(wave)[:, :, 0] for wave in (c, s)]
    along = np.stack([wave[:, k % wave.shape[1]] for k, wave in enumerate(found)], axis=1)
    return along, (np.zeros_like(along) if angle.ends == "mirror" else np.stack([-along[:, 1], along[:, 0]], axis=1))


def across_planes(rows: Rows) -> Rows:
    """Weights as (value x, value y, slope x, slope y)."""
    weights = np.broadcast_to(rows.weights[..., :2], (*rows.weights.shape[:2], 2, 2))
    return Rows(rows.first, np.swapaxes(weights, 2, 3).reshape(*weights.shape[:2], 4))


def of_four(rows: Rows) -> Rows:
    """Weights of the one component that a radius has, filled up to four."""
    weights = rows.weights[:, :, 0]
    return Rows(rows.first, np.concatenate([weights, np.zeros((*weights.shape[:2], 4 - weights.shape[2]))], axis=2))
