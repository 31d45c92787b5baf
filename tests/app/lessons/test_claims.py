"""Claims of lessons: what they mean, and what means nothing."""

import pytest

from app.lessons.claims import (
    ClaimError,
    ClaimNamespace,
    RunOutcome,
    check_claim,
    decide_claim,
    evaluate_expression,
    runs_needed,
)

FINE = {"scene": {"estimator": ["recovered"], "cells": 40, "amplitude": 0.1}, "not_valid": {}, "status": "ok",
        "error": {"x": {"final": 1e-4, "max": 2e-4, "mean": None}}, "index": {"x": 0.98}, "grid_crossings": 12,
        "budget": {"v": {"crossings": 0.87, "coarse_grid": None}, "rms": {"v": 2e-3},
                                                                   "predicted": {"v": {"crossings": 1e-4}}}}
COARSE = {**FINE, "scene": {**FINE["scene"], "cells": 20}, "error": {"x": {"final": 4e-4, "max": 8e-4, "mean": 1e-4}}}
LOST = {**FINE, "status": "lost", "scene": {"estimator": ["recovered", "transport"]},
        "not_valid": {"transport": "not valid here"}, "index": {"recovered": {"x": 1.1}, "transport": {"x": None}}}
SCOPE = ClaimNamespace({"fine": RunOutcome([FINE]), "grids": RunOutcome([COARSE, FINE], "cells"),
                        "gone": RunOutcome([LOST])}, "fine")


@pytest.mark.parametrize("claim, holds", [
    ("error.x.final < 1e-3", True), ("error.x.final > 1e-3", False), ("fine.error.x.final == 1e-4", True),
    ("order(grids.error.x.final) in 1.99..2.01", True), ("order(grids.error.x.max) in 2.1..3", False),
    ("first(grids.error.x.final) / last(grids.error.x.final) in 3.9..4.1", True),
    ("max(grids.error.x.max) <= 8e-4", True),
    ("-error.x.max + 2 * fine.error.x.final in -1e-9..1e-9", True), ("status == ok", True),
    ("grids.status == ok", True), ("grids.error.x.max < 5e-4", False),
    ("gone.status == lost", True),
    ("gone.status != ok", True), ("index.recovered.x in 0.9..1.1", True), ("gone.index.recovered.x >= 1.1", True),
    ("gone.valid.transport == no", True), ("valid.recovered == yes", True),
    ("error.x.max / scene.amplitude < 0.01", True),
    ("budget.v.crossings in 0.8..0.9", True), ("fine.predicted.v.crossings < 0.1 * rms.v", True),
    ("grid_crossings == 12", True)])
def test_a_claim_is_judged(claim, holds):
    check_claim(claim, SCOPE.outcomes, SCOPE.main)
    assert decide_claim(claim, SCOPE).holds is holds


@pytest.mark.parametrize("claim, said", [
    ("error.x.final", "claims nothing"), ("error.x < 1", "after error.x give one of final, max, mean"),
    ("error.q.max < 1", "after error give one of x"), ("eror.x.max < 1", "neither a run nor part of a result"),
    ("slow.error.x.max < 1", "neither a run nor part"), ("error.x.max.more < 1", "nothing comes after error.x.max"),
    ("budget.sigma.crossings < 1", "after budget give one of x, v, F"),
    ("budget.v.gravity < 1", "one of crossings"), ("rms.v.crossings < 1", "nothing comes after rms.v"),
    ("index.oracle.x < 1", "after index give one of"), ("error.x.max <", "claims nothing"),
    ("(error.x.max < 1", "cannot be read"),
    ("__import__('os') < 1", "means nothing here"), ("error.x.max[0] < 1", "means nothing here"),
    ("mean(grids.error.x.max) < 1", "give order(…)"), ("order() < 1", "give order(…)"), ("fine < 1", "a run alone")])
def test_what_claims_nothing_is_told(claim, said):
    with pytest.raises(ClaimError) as told:
        check_claim(claim, SCOPE.outcomes, SCOPE.main)
    assert said in str(told.value)


@pytest.mark.parametrize("text, said", [
    ("grids.error.x.max", "has 2 values"), ("error.x.mean", "is not known"), ("index.transport.x", "does not run"),
    ("gone.index.transport.x", "is not known"), ("order(error.x.max)", "several values"),
    ("budget.v.coarse_grid", "is not known"), ("status + 1", "is no number"),
    ("error.x.max / 0", "has no value")])
def test_what_has_no_value_is_told(text, said):
    with pytest.raises(ClaimError) as told:
        evaluate_expression(text, SCOPE)
    assert said in str(told.value)


def test_a_claim_needs_the_runs_that_it_names():
    assert runs_needed("error.x.max < 1", SCOPE.outcomes, "fine") == {"fine"}
    assert runs_needed("order(grids.error.x.max) in 1..2", SCOPE.outcomes, "fine") == {"grids"}
    assert runs_needed("gone.error.x.max / grids.error.x.max > 2", SCOPE.outcomes, "fine") == {"gone", "grids"}
