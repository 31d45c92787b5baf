"""What the player says of a run, made by what makes the page's words: numbers alone are still to come."""

from collections.abc import Collection, Mapping
from typing import Any

from app.frame.captions import (
    captions,
    field_words,
    marks_note,
    not_estimated,
    why_no_estimate,
    why_no_numbers,
    why_no_truth,
)
from app.frame.sentence import error_words
from app.problems.views import VIEWS
from solvers.scene.scene import Scene


def texts(scene: Scene, not_valid: Mapping[str, str], silent: Mapping[str, Collection[str]],
          difference: bool) -> dict[str, Any]:
    """By quantity: why a row of the readout has no number, words of the field plot, and by
    estimator ("" for none) the captions of both halves, side by side and, if wanted, as ``difference``, and what is
    said of the errors. ``silent`` are the estimators by quantity that have no number of it."""
    component = VIEWS[scene.problem].stage.PLOT.component
    return {key: {"rows": why_no_numbers(scene, not_valid, key, silent[key]),
                  "field": vars(field_words(scene, component, key)),
                  "by": {name: _by(scene, not_valid, key, name, silent[key], difference)
                         for name in scene.estimators or ("",)}} for key in silent}


def notes(scene: Scene, every: int) -> dict[str, str]:
    """What stands at the stage, on which one particle in ``every`` is marked where it crosses."""
    stage = VIEWS[scene.problem].stage
    return {"note": stage.note(scene), "marks": marks_note(stage.MARKED, every)}


def _by(scene: Scene, not_valid: Mapping[str, str], quantity: str, name: str, silent: Collection[str],
        difference: bool) -> dict[str, Any]:
    estimator, no_truth = name or None, why_no_truth(scene, quantity)
    no_estimate = why_no_estimate(scene, not_valid, estimator, quantity) \
        or f"{name} {not_estimated(quantity)}" * (name in silent)
    return {"captions": [vars(captions(quantity, estimator, apart, no_estimate, no_truth))
                         for apart in (False, True)[:1 + difference]],
            "errors": vars(error_words(scene, quantity, estimator, no_estimate, no_truth))}
