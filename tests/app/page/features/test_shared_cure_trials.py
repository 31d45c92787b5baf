"""What the page offers of a broken run was tried in a process of its own."""

from concurrent.futures import Future
from dataclasses import replace
from types import SimpleNamespace

import pytest

from app.page.features import shared_answers
from app.page.features.shared_cure_trials import SharedCureTrials, scene_to_try
from solvers.problems.bar.scene import BarScene
from tests.support.processes import wait_until

LONELY = BarScene(ppc=1, periods=2, cfl=0.2, estimators=(), effects=("truth", "soundness"))


def test_what_held_is_known_a_while_later_and_kept():
    """Two changes, neither of them an earlier end, which a stage does not have."""
    trials = SharedCureTrials()
    trials.open()
    assert trials.answer(LONELY) is None
    wait_until(lambda: trials.answer(LONELY) is not None, "the trials", 120)
    assert [cure["change"] for cure in trials.answer(LONELY)] == [{"ppc": 2}, {"ppc": 3}]
    assert trials.answer(replace(LONELY, cells=4000, periods=50)) == []  # takes too long
    trials.close()


@pytest.mark.parametrize("visitors", [1, 2])
def test_trials_give_way_to_the_stages_of_others(visitors, monkeypatch):
    trials, priorities = SharedCureTrials(), []
    monkeypatch.setattr(shared_answers, "WorkerPool", lambda work: SimpleNamespace(
        submit=lambda *_, **__: Future(), lower_priority=lambda idle: priorities.append(idle), close=lambda: None))
    for _ in range(visitors):
        trials.open()
    assert trials.answer(LONELY) is None and priorities == [visitors > 1]


def test_nothing_is_begun_beside_another_trial_or_many_stages(monkeypatch):
    """What is on no stage any more when its turn would come is never tried."""
    trials, asked, stages = SharedCureTrials(), [], [100]
    monkeypatch.setattr(shared_answers, "available_cpus", lambda: 2)
    monkeypatch.setattr(shared_answers, "WorkerPool", lambda work: SimpleNamespace(
        submit=lambda *_, **__: asked.append(Future()) or asked[-1], lower_priority=lambda idle: None,
        close=lambda: None))
    trials.open(lambda: stages[0])
    assert trials.answer(LONELY) is None and not asked
    stages[0] = 4
    other = replace(LONELY, cells=20)
    assert trials.answer(LONELY) is trials.answer(other) is None and len(asked) == 1
    asked[0].set_result({"held": []})
    assert trials.answer(LONELY) == [] and trials.answer(other) is None and len(asked) == 2


def test_a_run_that_broke_beyond_its_scenes_end_is_tried_for_longer():
    report = SimpleNamespace(scene=LONELY, since=1.0, time=1.5)
    assert scene_to_try(report) is LONELY
    report.since = 3.0
    assert scene_to_try(report).end_time == pytest.approx(6.0)
