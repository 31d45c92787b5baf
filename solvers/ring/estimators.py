"""The estimators that the ring has, by the names that scenes use."""

from __future__ import annotations

from solvers.estimators.companion_ring import COMPANION
from solvers.estimators.interface import Estimator
from solvers.estimators.recovered_ring import RECOVERED
from solvers.estimators.transport_ring import TRANSPORT
from solvers.estimators.two_grid_ring import TWO_GRID

ESTIMATORS: dict[str, Estimator] = {"transport": TRANSPORT, "recovered": RECOVERED, "companion": COMPANION,
                                    "two-grid": TWO_GRID}
