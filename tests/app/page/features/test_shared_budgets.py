"""Budgets that are computed beside a visitor's run are those of the run itself."""

from dataclasses import replace

import numpy as np
import pytest

from app.page.features.budget.shared_budgets import SharedBudgets
from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.running.run import run
from solvers.solver import budget_shares
from tests.support.processes import wait_until

HATS = BarScene(method="mpm", cells=20, ppc=2, periods=0.25, estimators=())


def test_a_budget_is_that_of_the_run():
    """Of a run that goes on for longer: shares at an instant are the same. The process ends with the last visitor."""
    budgets, time = SharedBudgets(), HATS.end_time
    budgets.open()
    budgets.open()
    assert budgets.find(HATS, time, starts=False) is None and budgets._pool is None
    assert budgets.find(HATS, time, starts=True) is None
    wait_until(lambda: budgets.find(HATS, time, starts=False), "the budget", 120)
    found, own = budgets.find(HATS, time, starts=False), run(replace(HATS, effects=("truth", "crossings", "budget")))
    assert found["time"][-1] == pytest.approx(HATS.period)
    for field in ("x", "v", "F"):
        shares = budget_shares.shares_at(found, field, time)
        assert shares == pytest.approx(budget_shares.shares_at(own.series, field, time), abs=1e-9)
        assert sum(shares.values()) == pytest.approx(1, abs=1e-9)
    budgets.close()
    assert budgets._pool is not None, "somebody is left"
    budgets.close()
    assert budgets._pool is None


def test_where_there_is_none_beside_the_run():
    """In the plane it takes long, and so does a large bar; at t = 0 there is no error to divide."""
    budgets = SharedBudgets()
    for scene in (RingScene(cells=8), BarScene(cells=2000, ppc=8)):
        assert budgets.find(scene, 0.0, starts=True) == {}
    nothing = {"time": np.arange(2.0), **{f"budget/{name}": np.zeros(2) for name in (
        "error_x", *(f"part_x_{cause}" for cause in ("crossings", "coarse_grid", "body_force", "time_step")))}}
    assert budget_shares.shares_at(nothing, "x", 0.0) == {}
