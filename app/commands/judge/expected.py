"""What ``--expect`` may ask of a judgement.

    error.x.max < 1e-3                of each grid; last(error.x.max) of the finest
    order.x in 1.8..2.3               of the largest errors over the times that all grids have
    index.companion.x in 0.9..1.1     what the companion says over the truth
    contradictions == 0               things that were compared and do not hold
"""

from collections.abc import Mapping
from typing import Any

from app.commands.expected import Expectable
from app.lessons.claims import NORMS
from solvers.judging.checks.check import OFF
from solvers.judging.measure import QUANTITIES

COMPANION = "companion"
EXPECTABLE = Expectable("grids", {
    "error": (QUANTITIES, NORMS), "order": (QUANTITIES,), "estimate": ((COMPANION,), QUANTITIES, NORMS),
    "index": ((COMPANION,), QUANTITIES), "distance": ((COMPANION,), QUANTITIES), "contradictions": (), "particles": (),
    "scene": (("cells",),)})


def outcomes(values: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """Each grid's part of the report in the shape of a run's JSON object."""
    return [_outcome(grid, values) for grid in values["grids"]]


def _outcome(grid: Mapping[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
    estimate = grid["estimate"]
    orders = values["order"] or {}
    return {"scene": {"cells": grid["cells"], "estimator": [COMPANION]}, "error": grid["error"],
            "estimate": estimate[COMPANION], "index": estimate["index"], "distance": estimate["distance"],
            "order": {q: (orders.get(q) or {}).get("order") for q in QUANTITIES},
            "contradictions": sum(one["verdict"] == OFF for one in grid["checks"]), "particles": grid["particles"]}
