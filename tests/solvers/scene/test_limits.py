"""Rows that say where an estimator does not hold, each kind of limit for itself. What the rows of the problems refuse,
tests/solvers/estimators/test_refusals.py has in words."""

from types import SimpleNamespace

import pytest

from solvers.problems import PROBLEMS
from solvers.problems.bar.scene import BarScene
from solvers.scene.estimator_limits import Limit, reason

SCENE = SimpleNamespace(cells=12, ppc=3, force="node", remedies=("a", "b"), end=6.0, period=2.0)


@pytest.mark.parametrize(("quantity", "given", "why", "said"), [
    ("cells", {"least": 12}, "", None), ("cells", {"least": 13}, "{scene.cells}, not {least}", "12, not 13"),
    ("cells", {"most": 12}, "", None), ("cells", {"most": "ppc"}, "above {most}", "above 3"),
    ("cells", {"below": 13}, "", None), ("cells", {"below": 12}, "as many", "as many"),
    ("cells", {"most": lambda scene: 2 * scene.ppc}, "above {most}", "above 6"),
    (lambda scene: scene.cells * scene.ppc, {"most": 35}, "{value}", "36"),
    ("end", {"most": 3, "of": "period"}, "", None), ("end", {"most": 2, "of": "period"}, "{value}", "3.0"),
    ("force", {"allowed": ("node", "none")}, "", None), ("force", {"allowed": ("none",)}, "{value}", "node"),
    ("remedies", {"allowed": ("a", "b", "c")}, "", None), ("remedies", {"allowed": ("c",)}, "no {names}", "no a and b"),
    ("cells", {"most": 1, "where": {"force": "none"}}, "", None),
    ("cells", {"most": 1, "where": {"force": "node"}}, "so", "so"),
    ("cells", {"most": 1, "where": {"force": ("node", "none"), "ppc": 3}}, "so", "so"),
    ("cells", {"most": 1, "above": ("ppc", 3)}, "", None), ("cells", {"most": 1, "above": ("ppc", 2)}, "{above}", "2"),
    ("cells", {"most": 5, "give": {"enough": lambda scene, value: value * scene.ppc}}, "{enough}", "36")])
def test_a_row_refuses_what_is_beyond_its_limit(quantity, given, why, said):
    limit = Limit("mine", quantity, why=why, **given)
    assert limit.reason(SCENE) == said == reason([limit], "mine", SCENE) and reason([limit], "other", SCENE) is None


def test_the_first_row_that_is_broken_speaks():
    rows = [Limit("mine", "cells", most=most, why="above {most}") for most in (20, 11, 10)]
    assert reason(rows, "mine", SCENE) == "above 11"


def test_an_estimator_from_outside_may_have_limits(monkeypatch):
    monkeypatch.setattr(BarScene, "LIMITS", (*BarScene.LIMITS, Limit("recovered", "ppc", least=5, why="give {least}")))
    assert BarScene(estimators=("recovered",)).not_valid == {"recovered": "not valid here: give 5"}


@pytest.mark.parametrize("problem", PROBLEMS)
def test_rows_are_of_estimators_and_quantities_that_a_scene_has(problem):
    scene = PROBLEMS[problem].scene()
    for row in scene.LIMITS:
        quantities = (row.quantity, row.least, row.most, row.below, row.of, row.above[0], *row.where)
        assert row.estimator in scene.choices("estimators")
        assert all(hasattr(scene, name) for name in quantities if isinstance(name, str))
