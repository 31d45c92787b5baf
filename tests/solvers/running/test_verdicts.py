"""No run is called ok that is off by more than half its motion, and no fine one lost: random scenes."""

import random

import pytest

from solvers.problems import PROBLEMS
from tests.support.known_runs import SWITCHES, random_runs


@pytest.mark.parametrize("count", [8, pytest.param(200, marks=pytest.mark.slow)])
@pytest.mark.parametrize("problem", PROBLEMS)
def test_random_runs_are_judged_rightly(problem, count):
    """A few by one kernel, of which some runs are lost: particles of the bar with their own velocity, hat functions.
    Many with fresh seeds: what fails is told with its scene."""
    few = count == 8
    seed = 20261124 if few else random.SystemRandom().randrange(10**6)
    settings = () if not few else SWITCHES[problem][-1:] if problem == "bar" else SWITCHES[problem][:1]
    outcomes = random_runs(problem, count, random.Random(seed), settings)
    wrong = [(one.errors, one.scene) for one in outcomes if one.missed or one.false_alarm]
    assert not wrong, f"seed {seed}"
    assert not few or len({one.blind for one in outcomes}) > 1
