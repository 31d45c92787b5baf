"""What a run of the bar shows of whether the recovered estimator holds."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from solvers.estimators import recovery
from solvers.estimators.recovery import ALONG, SIZE
from solvers.problems.bar.estimators.recovered_tables import FIT
from solvers.problems.bar.scene import BarScene

#: What the fits miss, as parts of the error found, by which that comes out too small or too large: measured on 500 bars
#: of 6 to 120 cells, x and sigma are .9 at the first; up to the second they are good, for it lies across the error.
MOST_MISSED, MOST_ADDED = 0.09, 0.3


def verdict(scene: BarScene, memory: Mapping[str, np.ndarray]) -> str | None:
    """Why not to trust it: the reference's own trouble, or what the fits miss of the motion and count as error."""
    U = memory["recovered_nodes"][:scene.cells, 0]
    if reason := recovery.doubt(memory, np.abs(U).max() / scene.motion_amplitude):
        return reason
    along, size = memory["recovered_numbers"][[ALONG, SIZE]]
    missed = -slope_missed(scene, memory) * along / size if size > 0 else 0.0
    if -MOST_ADDED < missed < MOST_MISSED:
        return None
    return (f"not valid here: what recovered's fits miss of the motion is {abs(missed):.2g} of the error found (and "
            f"may be {MOST_MISSED if missed > 0 else MOST_ADDED:g}); take more cells, or two or more particles per "
            "cell that move with the grid")


def slope_missed(scene: BarScene, memory: Mapping[str, np.ndarray]) -> float:
    """What a fit's slope lacks of u', over the fourth difference of u' from cell to cell: with x in cells, the slope
    that it finds at 0 of x^5/5!, which is flat there."""
    slope = memory[f"{FIT}weights"][:, 3] * scene.spacing
    x = (np.arange(len(slope)) - (len(slope) - 1) / 2) / scene.ppc
    return -float(slope @ x**5) / 120
