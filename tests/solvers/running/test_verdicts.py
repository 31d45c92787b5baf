"""No run is called ok that is off by more than half its motion, and no fine one lost: random scenes."""

import random

import pytest

from solvers.problems import PROBLEMS
from tests.known_runs import SWITCHES, random_runs


@pytest.mark.parametrize("problem", PROBLEMS)
def test_a_few_random_runs_are_judged_rightly(problem):
    """By one kernel, of which some runs are lost: particles of the bar with their own velocity, hat functions."""
    settings = SWITCHES[problem][-1:] if problem == "bar" else SWITCHES[problem][:1]
    outcomes = random_runs(problem, 8, random.Random(20261124), settings)
    assert not [(one.errors, one.scene) for one in outcomes if one.missed or one.false_alarm]
    assert len({one.blind for one in outcomes}) > 1


@pytest.mark.slow
@pytest.mark.parametrize("problem", PROBLEMS)
def test_random_runs_are_judged_rightly(problem):
    """With fresh seeds: what fails is told with its scene."""
    seed = random.SystemRandom().randrange(10**6)
    wrong = [one for one in random_runs(problem, 200, random.Random(seed)) if one.missed or one.false_alarm]
    assert not wrong, f"seed {seed}: {[(one.errors, one.scene) for one in wrong]}"
