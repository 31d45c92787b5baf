"""What ``--expect`` asks of a judgement, in the language of the lessons' claims.

    error.x.max < 1e-3                of each grid; last(error.x.max) of the finest
    order.x in 1.8..2.3               of the largest errors over the times that all grids have
    index.companion.x in 0.9..1.1     what the companion says over the truth
    contradictions == 0               things that were compared and do not hold
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from app.commands.flags import BadInput
from app.lessons.claims import NORMS, ClaimError, Outcome, Scope, Vocabulary, check_claim, decide
from solvers.judging.checks.check import OFF
from solvers.judging.measure import QUANTITIES

COMPANION = "companion"
VOCABULARY: Vocabulary = {
    "error": (QUANTITIES, NORMS), "order": (QUANTITIES,), "estimate": ((COMPANION,), QUANTITIES, NORMS),
    "index": ((COMPANION,), QUANTITIES), "distance": ((COMPANION,), QUANTITIES), "contradictions": (), "particles": (),
    "scene": (("cells",),)}
GRIDS = "grids"  # the one outcome, which no claim has to name


def check(claims: Sequence[str]) -> None:
    """Refuse a claim that no judgement can decide."""
    for claim in claims:
        try:
            check_claim(claim, {GRIDS: None}, GRIDS, VOCABULARY)
        except ClaimError as error:
            raise BadInput("expect", claim, str(error)) from None


def decided(claims: Sequence[str], values: Mapping[str, Any]) -> Iterator[tuple[str, bool, str]]:
    """Each claim, whether it holds of the report, and what was found; one that has no value here does not hold."""
    grids = [_outcome(grid, values) for grid in values["grids"]]
    scope = Scope({GRIDS: Outcome(grids, "cells" if len(grids) > 1 else "")}, GRIDS, VOCABULARY)
    for claim in claims:
        try:
            found = decide(claim, scope)
            yield claim, found.holds, ", ".join(dict.fromkeys(found.found.split(", ")))  # an order is of all grids
        except ClaimError as error:
            yield claim, False, str(error)


def _outcome(grid: Mapping[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """A grid's part of the report in the shape of a run's JSON object."""
    estimate = grid["estimate"]
    orders = values["order"] or {}
    return {"scene": {"cells": grid["cells"], "estimator": [COMPANION]}, "error": grid["error"],
            "estimate": estimate[COMPANION], "index": estimate["index"], "distance": estimate["distance"],
            "order": {q: (orders.get(q) or {}).get("order") for q in QUANTITIES},
            "contradictions": sum(one["verdict"] == OFF for one in grid["checks"]), "particles": grid["particles"]}
