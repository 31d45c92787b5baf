"""The recovered estimator of the bar outside kernels: its operators as tables of rows, and its verdict."""

import functools
from collections.abc import Mapping

import numpy as np

from solvers.estimators import recovered_common
from solvers.estimators.lattice_line_operators import LatticeLine, Rows
from solvers.estimators.recovered_common import ALONG, SIZE
from solvers.problems.bar.scene import BarScene
from solvers.translatable_message import Message

DEGREE = 3  # of the fits
PATTERN_CELLS = 12  # on which the operators are found; all cells are alike

#: Tables, with a weight for each component of a field: a fit (value of u, v and a, slope of u), B-splines likewise, M,
#: C, what drives U (M of u and v, D of the fitted slope of u), and D of the slope of B-splines.
TABLES = tuple(f"recovered_{what}_" for what in ("fit", "spread", "gather", "smoothing", "drive", "stiffness"))
FIT, INTERPOLATION, PROJECTION, SMOOTHING, DRIVE, STIFFNESS = TABLES
#: What the fits miss, as parts of the error found, by which that comes out too small or too large: measured on 500 bars
#: of 6 to 120 cells, x and sigma are .9 at the first; up to the second they are good, for it lies across the error.
MOST_MISSED, MOST_ADDED = 0.09, 0.3


def operators(scene: BarScene) -> dict[str, Rows]:
    """Returns the operators as tables of rows, by the names ``TABLES``; callers must not change them."""
    return _lattice_operators(scene.cells, int(scene.ppc), scene.spacing, recovered_common.fit_width(scene))


@functools.lru_cache(maxsize=32)  # scenes that differ in numbers only are often run one after the other
def _lattice_operators(cells: int, per_cell: int, spacing: float, width: int) -> dict[str, Rows]:
    """Returns the operators of so many cells, ``spacing`` m wide, of so many particles, with fits over ``width`` of
    them. Cells are alike, and so are particles to a fit: most have one row of weights."""
    few, particles = min(cells, PATTERN_CELLS), cells * per_cell
    line = LatticeLine(few * per_cell, few, few * spacing, "periodic")
    fit = line.fit_operator(width, DEGREE).repeat_over_cells(cells * per_cell, 1, 1)
    spread = line.interpolation_operator().repeat_over_cells(cells, per_cell, 1)
    gather = line.projection_operator(4, 2).repeat_over_cells(cells, 1, per_cell)
    smoothing = line.smoothing_operator().repeat_over_cells(cells, 1, 1)
    drive, stiffness = np.zeros((particles, 4)), np.zeros((cells, 4))
    for p, (value, slope, _) in zip(gather.first[0] + np.arange(gather.width), gather.weights[0, :, 0], strict=True):
        p = p % particles
        drive[p, :2] += value
        np.add.at(drive[:, 2], (fit.first[p] + np.arange(fit.width)) % len(drive), slope * fit.weights[0, :, 0, 1])
        np.add.at(stiffness[:, 0], (spread.first[p] + np.arange(3)) % cells,
                  slope * spread.weights[p % per_cell, :, 0, 1])
    rows = (estimated_components(fit, 1), estimated_components(spread, 1), estimated_components(gather, 0),
            estimated_components(smoothing, 0), periodic_map(drive, cells), periodic_map(stiffness, cells))
    return dict(zip(TABLES, rows, strict=True))


def estimated_components(rows: Rows, last: int) -> Rows:
    """Returns rows of four weights from rows of a value and a slope: the value for u, v and a, and fourth, for u, the
    one numbered ``last``, 0 or 1."""
    return Rows(rows.first, rows.weights[:, :, 0][:, :, [0, 0, 0, last]])


def periodic_map(weights: np.ndarray, cells: int) -> Rows:
    """Returns the map to ``cells`` nodes from that to node 0, with ``weights`` (n, 4) for the n places of the line."""
    middle = len(weights) // 2
    weights = np.roll(weights, middle, axis=0)
    used = np.flatnonzero(weights.any(axis=1))
    first = used[0] - middle + np.arange(cells) * (len(weights) // cells)
    return Rows((first % len(weights)).astype(np.int32), weights[None, used[0]:used[-1] + 1])


def verdict(scene: BarScene, memory: Mapping[str, np.ndarray]) -> str | None:
    """Returns why the estimate is not to be trusted, as a sentence: a bad reference, or motion that the fits count as
    error; or None. ``memory`` are the estimator's arrays by name."""
    U = memory["recovered_nodes"][:scene.cells, 0]
    if reason := recovered_common.why_not_trusted(memory, np.abs(U).max() / scene.motion_amplitude):
        return reason
    along, size = memory["recovered_numbers"][[ALONG, SIZE]]
    # What a fit's slope lacks of u', over the fourth difference of u' from cell to cell: with x in cells, the slope
    # that it finds at 0 of x^5/5!, which is flat there.
    slope = memory[f"{FIT}weights"][:, 3] * scene.spacing
    x = (np.arange(len(slope)) - (len(slope) - 1) / 2) / scene.ppc
    missed = float(slope @ x**5) / 120 * along / size if size > 0 else 0.0
    if -MOST_ADDED < missed < MOST_MISSED:
        return None
    return Message("not valid here: what recovered's fits miss of the motion is {missed:.2g} of the error found (and "
                   "may be {most:g}); take more cells, or two or more particles per cell that move with the grid",
                   abs(missed), MOST_MISSED if missed > 0 else MOST_ADDED)
