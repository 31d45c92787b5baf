"""The recovered estimator in the plane outside of kernels: its operators on a polar lattice as tables of rows, and
what a run shows of whether it holds."""

from collections.abc import Mapping

import numpy as np

from solvers.estimators import recovery
from solvers.estimators.lattice_lines import Line, Rows
from solvers.estimators.recovery import SHORT, SHORTEST, SIZE
from solvers.problems.planar.estimators import recovered_operators as op
from solvers.problems.planar.scene import PlanarScene

#: The part of the error found that are waves of a few cells: what smoothing takes from it less what it takes from that
#: again, which leaves noise from node to node. So much may it be for each cell along a side, for fits are the narrower
#: the more there are, and so much on any. Measured on 460 vortices of 14 to 80 cells: x, v and sigma within .9 to 1.1
#: in 9 of 10 below, in 1 of 5 above, where they are .6 to .9.
FEW_PER_CELL, LEAST_FEW = 0.0025, 0.08
UNEVEN_FEW = 1.5  # times that where particles move with their own velocity, whose noise is as short


def gathered_directions(angle: Line, gather_table: Rows) -> tuple[np.ndarray, np.ndarray]:
    """M e_R and M e_angle at the nodes of the angle (A, 2). Between symmetry planes nothing is along e_angle."""
    theta = angle.particles() / angle.per_point
    c, s = np.cos(theta), np.sin(theta)
    found = [gather_table(wave)[:, :, 0] for wave in (c, s)]
    along = np.stack([wave[:, k % wave.shape[1]] for k, wave in enumerate(found)], axis=1)
    return along, (np.zeros_like(along) if angle.ends == "mirror" else np.stack([-along[:, 1], along[:, 0]], axis=1))


def over_planes(rows: Rows, swapped: bool = False) -> Rows:
    """Weights as (value x, value y, slope x, slope y), of a line along x; ``swapped`` along y, between walls."""
    weights = np.broadcast_to(rows.weights[..., :2], (*rows.weights.shape[:2], 2, 2))[:, :, ::-1 if swapped else 1]
    return Rows(rows.first, np.swapaxes(weights, 2, 3).reshape(*weights.shape[:2], 4))


def of_four(rows: Rows) -> Rows:
    """Weights of the one component that a radius has, filled up to four."""
    weights = rows.weights[:, :, 0]
    return Rows(rows.first, np.concatenate([weights, np.zeros((*weights.shape[:2], 4 - weights.shape[2]))], axis=2))


def verdict(scene: PlanarScene, memory: Mapping[str, np.ndarray]) -> str | None:
    """Why not to trust it: the reference's own trouble, or an error that is too short for fits and error grid."""
    U = memory["recovered_nodes"].reshape(op.NODE_BLOCKS, -1, 4)[op.MOTION, :, :2]
    if reason := recovery.doubt(memory, np.abs(U).max() / scene.motion_amplitude):
        return reason
    size, short, shortest = np.sqrt(memory["recovered_numbers"][[SIZE, SHORT, SHORTEST]])
    few = (short - shortest) / size if size > 0 else 0.0
    most = max(LEAST_FEW, FEW_PER_CELL * scene.cells) * (UNEVEN_FEW if scene.velocity == "particle" else 1.0)
    return None if few <= most else (
        f"not valid here: {few:.2g} of the error found are waves of a few cells (and may be {most:.2g}), which "
        "recovered's fits over four cells see in part; take more cells")
