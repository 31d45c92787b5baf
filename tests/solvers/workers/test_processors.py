"""How many processes work side by side unless one says how many."""

import os

import pytest

from app.commands.lenient_flag_types import process_count
from app.commands.study.coverage import Coverage
from app.commands.study.stability_map import StabilityMap
from app.commands.study.sweep import Sweep
from solvers.scene.validation import SceneError
from solvers.workers.cpu_count import MOST_PROCESSES, available_cpus, default_processes


@pytest.mark.parametrize(("there", "used"), [(1, 1), (3, 3), (MOST_PROCESSES + 1, MOST_PROCESSES)])
def test_one_on_each_processor_that_may_be_used(there, used, monkeypatch):
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(there)), raising=False)
    monkeypatch.setattr(os, "cpu_count", lambda: 1000)
    assert available_cpus() == there and default_processes() == process_count(None) == used
    assert process_count(2) == 2


def test_where_nobody_says_what_may_be_used(monkeypatch):
    monkeypatch.delattr(os, "sched_getaffinity", raising=False)
    monkeypatch.setattr(os, "cpu_count", lambda: 7)
    assert available_cpus() == 7
    monkeypatch.setattr(os, "cpu_count", lambda: None)
    assert available_cpus() == 1


@pytest.mark.parametrize("typed", [0, -1, MOST_PROCESSES + 1, "many", 1.5])
def test_what_is_no_number_of_processes_is_refused(typed):
    with pytest.raises(SceneError, match=f"from 1 to {MOST_PROCESSES}"):
        process_count(typed)


def test_rows_that_are_timed_run_alone_unless_one_says_so(monkeypatch):
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(5)), raising=False)
    for study, alone in ((Sweep, True), (StabilityMap, False), (Coverage, False)):
        assert study.__new__(study)._worker_count() == (1 if alone else 5)
