"""The estimators that the bar has, by the names that scenes use."""

from __future__ import annotations

from solvers.estimators.companion_bar import COMPANION
from solvers.estimators.interface import Estimator
from solvers.estimators.recovered_bar import RECOVERED
from solvers.estimators.transport_bar import TRANSPORT
from solvers.estimators.two_grid_bar import TWO_GRID

ESTIMATORS: dict[str, Estimator] = {"transport": TRANSPORT, "recovered": RECOVERED, "companion": COMPANION,
                                    "two-grid": TWO_GRID}
