"""No run is called ok that is off by more than half its motion, and no fine one lost: random scenes and a search.

The whole of it, with counts: ``python -m tests.verdict_search --runs 1000 --search 1000``.
"""

from __future__ import annotations

import random

import pytest

from solvers.problems import PROBLEMS
from solvers.solver.soundness import MOST_ERROR
from tests.verdict_search import BETWEEN, random_runs, search, told


@pytest.mark.slow
@pytest.mark.parametrize("problem", PROBLEMS)
def test_random_runs_are_judged_rightly(problem):
    """With fresh seeds: what fails is told with its scene."""
    seed = random.SystemRandom().randrange(10**6)
    outcomes = random_runs(problem, 200, random.Random(seed))
    wrong = [one for one in outcomes if one.missed or one.false_alarm]
    assert not wrong, f"seed {seed}: {told(outcomes)}: {[(one.errors, one.scene) for one in wrong]}"


@pytest.mark.slow
@pytest.mark.parametrize("problem", PROBLEMS)
@pytest.mark.parametrize(("quantity", "most"), [("x", BETWEEN * MOST_ERROR), ("v", 1.0), ("sigma", 1.0)])
def test_a_search_finds_nothing_wrong_that_is_called_right(problem, quantity, most):
    """x without the truth, v and sigma (in their own RMS) with it."""
    seed = random.SystemRandom().randrange(10**6)
    best = search(problem, quantity, 200, random.Random(seed))
    assert best.wrong(quantity) <= most, f"seed {seed}: {best}"


@pytest.mark.parametrize("problem", PROBLEMS)
def test_a_few_random_runs_are_judged_rightly(problem):
    outcomes = random_runs(problem, 8, random.Random(20261124))
    assert not [one for one in outcomes if one.missed or one.false_alarm], told(outcomes)
