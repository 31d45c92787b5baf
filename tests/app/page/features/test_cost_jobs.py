"""Jobs of the Cost tab, in the background: sweeps and searches, and what gives way to what."""

from __future__ import annotations

import threading
from concurrent.futures import Future
from dataclasses import replace
from types import SimpleNamespace
from typing import ClassVar

import pytest

from app.page.features import background_job
from app.page.features.cost import cost_texts
from app.page.features.cost import jobs as cost_jobs
from app.page.features.cost.jobs import CostJobs, CostJobStatus, SearchCache, WarmWorker, search_job, sweep_tasks
from app.page.features.cost.panel import CostTab
from app.page.features.cost.visitor_run_list import VisitorRunList, advice_key, cheapest_run, run_key
from app.page.visit.first_scene import first_scene
from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.study.parameter_grid import task_of
from solvers.study.sweep_and_search_worker import READY
from solvers.workers.worker_pool import Slots
from solvers.workers.worker_process import ProcessDied
from tests.app.page.features.test_cost import SCENE
from tests.app.page.panel import Gui
from tests.support.fake_rows import fake_row
from tests.support.processes import wait_until


class Pool:
    """A pool whose process says what a test has it say."""

    made: ClassVar[list[Pool]] = []

    def __init__(self, work, processes=1):
        self.work, self.ways, self.closed, self.killed, self.process_ids = work, 0, False, False, [1]
        self.made.append(self)

    def submit(self, question, hear=None, patience=None):
        self.question, self.hear, self.future = question, hear, Future()
        return self.future

    def lower_priority(self):
        self.ways += 1

    def kill(self):
        """From another thread the future learns it, as ever."""
        if not self.killed:
            self.killed = True
            threading.Thread(target=self.end, args=[ProcessDied("was closed")]).start()

    def close(self):
        self.closed = True

    def end(self, error=None):
        """The job ends, well or not."""
        self.future.set_exception(error) if error else self.future.set_result({})


@pytest.fixture
def pools(monkeypatch):
    """The pools that were made, the last one last."""
    monkeypatch.setattr(Pool, "made", [])
    monkeypatch.setattr(background_job, "WorkerPool", Pool)
    monkeypatch.setattr(cost_jobs, "WorkerPool", Pool)
    return Pool.made


@pytest.fixture
def jobs():
    jobs = CostJobs(VisitorRunList(), Slots(1), SearchCache())
    yield jobs
    jobs.close()


def few(tolerance):
    """A search among two families."""
    return replace(search_job(SCENE, "x", tolerance, 5.0), methods=(("ugimp", False), ("mpm", False)), ppc=(2,),
                   courant_numbers=(0.5,))


@pytest.mark.parametrize("scene", [
    SCENE, BarScene(method="cpgimp", velocity="corners", effects=(), periods=1), RingScene(periods=1, dt=1e-5)],
    ids=["bar", "corners", "ring"])
def test_a_sweep_is_valid_and_like_the_scene(scene):
    """It begins with the scene itself, and has every grid of every method."""
    tasks = sweep_tasks(scene)
    assert len({task.key for task in tasks}) == len(tasks) >= 16 and run_key(tasks[0].scene()) == run_key(scene)
    for task in tasks:
        other = task.scene()
        assert (other.amplitude, other.dt, other.periods) == (scene.amplitude, scene.dt, scene.periods)
        assert other.has("truth") and (other.has("estimate") or other.not_valid)
    assert task_of(scene).scene() == scene


def test_a_sweep_and_a_search_in_processes_of_their_own(jobs):
    """Each of a search's runs is a row as soon as it is made, with an estimate, no true error, and a scene to watch;
    the advice is a scene with the truth and the estimate by which it was found. Another visitor's search for the same
    makes none of them again."""
    jobs.start_sweep(sweep_tasks(SCENE)[:1])
    wait_until(lambda: not jobs.status.running, "the end of a sweep")
    [run] = jobs.runs.all()
    assert jobs.status == CostJobStatus("sweep", done=1, total=1) and run.row["seconds"]["min"] > 0
    searcher, other = (CostJobs(VisitorRunList(), jobs.slots, jobs._kept) for _ in range(2))
    for one in (searcher, other):
        one.start_search(few(1e-2))
        wait_until(lambda one=one: not one.status.running, "the end of a search")
    advice, found = searcher.status.advice, searcher.runs.all()
    assert advice["met"] and advice["error"] <= 1e-2 * SCENE.amplitude
    said = cost_texts.job_status_text(searcher.status)
    assert said.startswith("Take uGIMP") and "estimate" in said
    assert len(found) == advice["looks"] == searcher.status.done and searcher.status.known == 0
    assert {(run.source, run.error, run.estimator) for run in found} == {("search", None, "companion")}
    assert all(run.drawable for run in found)
    taken = cheapest_run(found, 1e-2)
    assert taken.row["asked"] == advice["task"]["inputs"] and taken.scene.has("truth")
    assert taken.seconds == advice["seconds"] and taken.error_or_estimate == advice["error"] / SCENE.amplitude
    assert cost_texts.advice_text({**advice, "met": False, "error": None}, "x").startswith("No run within the limits")
    assert other.status.known == other.status.done == searcher.status.done and other.status.task is None
    assert other.status.advice == advice and [run.row for run in other.runs.all()] == [run.row for run in found]
    assert f"{other.status.known} of them had been made by earlier searches" in cost_texts.job_status_text(other.status)
    searcher.close()
    other.close()


def test_a_job_is_told_of_and_makes_room(jobs, pools):
    """While one runs nothing else begins, and no other visitor's; cancelled it keeps its rows; what ends it is said."""
    jobs.start_sweep(sweep_tasks(SCENE))
    jobs.start_search(few(1e-2))
    assert (
        len(pools) == 1
        and pools[0].work == "solvers.study.sweep_and_search_worker:sweep"
        and len(pools[0].question) == 25
    )
    other = CostJobs(VisitorRunList(), jobs.slots)
    other.start_sweep(sweep_tasks(SCENE))
    assert "server busy" in cost_texts.job_status_text(other.status) and not other.status.running and other.others_busy
    pools[0].hear({"row": fake_row()})
    assert cost_texts.job_status_text(jobs.status) == "Sweep: 1 of 25 runs."
    jobs.cancel()
    wait_until(lambda: not jobs.status.running, "the end of a job that was cancelled")
    assert (
        "cancelled" in cost_texts.job_status_text(jobs.status)
        and jobs.status.trouble is None
        and len(jobs.runs.all()) == 1
    )
    for error, said in ((ProcessDied("was ended by SIGKILL"), "SIGKILL"),
                        (OSError(11, "Resource temporarily unavailable"), "temporarily unavailable")):
        jobs.start_sweep(sweep_tasks(SCENE))
        pools[-1].end(error)
        assert said in cost_texts.job_status_text(jobs.status) and not jobs.status.running and jobs.slots.taken == 0
    other.start_search(few(1e-2))
    pools[-1].hear({"look": 1, "certain": 2, "task": task_of(SCENE).to_dict()})
    assert cost_texts.job_status_text(other.status).startswith("Search, run 1 of at least 2: uGIMP")
    pools[-1].hear({"trouble": "no method makes a valid scene with these settings"})
    pools[-1].end()
    assert "no method" in cost_texts.job_status_text(other.status) and pools[0].closed


def test_visitor_who_leaves_takes_the_process_along(jobs, pools):
    """After that none begins. That the page closes its jobs is seen in ``tests/browser/features/test_cost.py``."""
    jobs.start_sweep(sweep_tasks(SCENE))
    jobs.close()
    wait_until(lambda: not jobs.status.running and pools[0].closed, "the end of the job")
    jobs.start_sweep(sweep_tasks(SCENE))
    assert not jobs.status.running and len(pools) == 1


def test_a_search_is_told_what_is_known_and_times_only_as_they_were_taken(jobs, pools):
    """Of the same motion, whatever the tolerance; a time that was disturbed is no time where nothing disturbs."""
    for tolerance, quiet, rate in ((1e-2, False, None), (3e-3, True, None), (1e-2, False, 2e-9)):
        jobs.start_search(few(tolerance), quiet)
        known = pools[-1].question["known"]
        assert [point.get("rate") for point in known.values()] == ([rate] if pools[1:] else [])
        point = {"error": 1e-3, "rate": 2e-9, "status": "ok", "reason": None}
        pools[-1].hear({"row": fake_row(), "known": bool(known), "point": point})
        assert jobs.status.known == len(known) and jobs.status.done == 1
        pools[-1].end()
    jobs.start_search(replace(few(1e-2), base=task_of(replace(SCENE, amplitude=0.01)).to_dict()))
    assert pools[-1].question["known"] == {}


@pytest.fixture
def ready(pools):
    ready = WarmWorker("solvers.study.sweep_and_search_worker:search", Slots(1))
    yield ready
    ready.end()


def test_a_search_takes_the_process_that_is_ready(jobs, ready, pools):
    """It is asked to get ready once, and is the one that searches, and that searches again, until it has given way: it
    would for ever. A sweep ends it."""
    jobs._ready = ready
    for _ in range(2):
        jobs.prepare(few(1e-2), undisturbed=True)
    first = pools[0]
    assert first.question[READY] and ready._pool is first and ready._places.taken == 1
    jobs.start_search(few(1e-2))
    assert jobs._pool is first and ready._pool is None and ready._places.taken == 0 and READY not in first.question
    first.end()
    assert ready._pool is first and not first.closed
    jobs.start_search(few(3e-3))
    first.hear({"row": fake_row()})
    jobs.share_cpu()
    first.end()
    assert first.ways == 1 and ready._pool is None and first.closed
    jobs.prepare(few(1e-2), undisturbed=True)
    second = ready._pool
    jobs.start_sweep(sweep_tasks(SCENE)[:1])
    assert jobs._pool is not second
    wait_until(lambda: second.closed, "the end of what was ready")


def test_few_processes_are_ready_and_none_for_ever(ready, pools):
    """A second visitor gets none while the first one's is there; who leaves, or takes too long, takes it along."""
    first, second = (CostJobs(VisitorRunList(), Slots(1), SearchCache()) for _ in range(2))
    first._ready, second._ready = ready, WarmWorker("solvers.study.sweep_and_search_worker:search", ready._places, 0.1)
    first.prepare(few(1e-2), undisturbed=False)
    mine = ready._pool
    assert mine.ways == 1
    second.prepare(few(1e-2), undisturbed=True)
    assert second._ready._pool is None
    first.close()
    wait_until(lambda: mine.closed, "the end of the first one's")
    first.prepare(few(1e-2), undisturbed=True)
    assert ready._pool is None
    second.prepare(few(1e-2), undisturbed=True)
    wait_until(lambda: second._ready._pool is None and ready._places.taken == 0, "the end of the second one's")


def test_who_opens_the_tab_has_a_process_made_ready(tab):
    asked = []
    tab.jobs.prepare = lambda job, undisturbed: asked.append((job, undisturbed))
    tab.open(True)
    tab.stage.others_playing = True
    tab.open({"what": "ever"})
    tab.stage.scene = BarScene(motion="patch")
    tab.open(True)
    assert [quiet for _, quiet in asked] == [True, False] and asked[0][0] == search_job(SCENE, "x", 1e-3, 10.0)


def test_what_is_kept_is_bounded_and_times_hold_for_an_hour():
    now = [0.0]
    kept = SearchCache(lambda: now[0])
    point = {"error": 1e-3, "rate": 1e-8, "status": "ok", "reason": None}
    for k in range(cost_jobs.MOST_POINTS + 1):
        kept.add_point("a", f"{k}", point, True)
    assert len(kept.recent_points("a", True)) == cost_jobs.MOST_POINTS and "0" not in kept.recent_points("a", True)
    assert kept.recent_points("a", True)["1"] == point
    now[0] = cost_jobs.HOLDS
    kept.add_point("a", "2", {**point, "rate": None}, True)  # a run that goes bad when it is timed
    known = kept.recent_points("a", True)
    assert "rate" not in known["1"] and known["1"]["error"] == 1e-3 and known["2"]["rate"] is None
    for k in range(cost_jobs.MOST_QUESTIONS):
        kept.add_point(f"question {k}", "1", point, True)
    assert kept.recent_points("a", True) == {} and kept.recent_points("question 0", True)


class Stage:
    """As much of a session as a job takes note of."""

    def __init__(self, playing=True, others=False):
        self.scene, self.playing, self.others_playing, self.report = SCENE, playing, others, None

    def play(self, playing):
        self.playing = playing


def test_stage_stands_still_while_a_job_runs():
    """It goes on afterwards if it moved before, and is left alone once its visitor has pressed Play."""
    stage = Stage()
    quiet = cost_jobs.StagePauser(stage)
    for running, playing in [(False, True), (True, False), (True, False), (False, True)]:
        quiet.set_job_running(running)
        assert stage.playing == playing and quiet.paused == (running and not playing)
    quiet.set_job_running(True)
    stage.play(True)  # by the visitor
    quiet.set_job_running(True)
    assert stage.playing and not quiet.paused
    stage.play(False)
    quiet.set_job_running(False)
    assert not stage.playing
    quiet.set_job_running(True)
    quiet.set_job_running(False)
    assert not stage.playing  # it did not move before


@pytest.fixture
def tab():
    """The Cost tab of a visitor on ``tab.stage``, with the ``tab.widgets`` it has made."""
    stage, gui = Stage(), Gui()
    tab = CostTab(SimpleNamespace(gui=gui), stage, lambda scene: setattr(stage, "scene", scene))
    tab.stage, tab.widgets = stage, gui
    tab.jobs.prepare = lambda job, undisturbed: None
    yield tab
    tab.jobs.close()


def test_tab_says_what_disturbs_the_times_and_gives_way_to_it(tab):
    ways = []
    tab.open(True)
    tab.jobs.status, tab.jobs.lower_priority = CostJobStatus("sweep", running=True), lambda: ways.append(1)

    def said():
        tab.refresh()
        return tab.widgets.said

    assert "paused" in said() and not ways and "paused" in tab.notice().sentence
    tab.stage.others_playing = True
    assert "Other visitors" in said() and ways
    tab.stage.play(True)
    assert "<p>Your stage is running" in said() and tab.notice() is None
    tab.jobs.status = CostJobStatus("sweep")
    assert "Your stage" not in said() and "Other visitors" not in said() and "paused" not in said()


def test_tab_opens_with_shipped_runs_and_follows_the_error_of_the_own_one(tab):
    """Until the visitor sets another tolerance; where the stage goes on after the scene, it names the chart's end."""
    tab.stage.scene = first_scene("bar")
    tab.refresh()
    assert not tab.runs.all() and "cost" not in tab.widgets.said  # nothing is worked out for a tab that stays closed
    tab.open(True)
    tolerance = tab.widgets.by_label["Tolerance"]
    assert "is as accurate in less time" in tab.widgets.said and "Load the better" in tab.widgets.said
    assert tolerance.value == "0.5\N{NO-BREAK SPACE}%" and "the stage has gone on" not in tab.widgets.said
    tab.stage.scene = replace(tab.stage.scene, method="mpm")
    tab.stage.report = SimpleNamespace(scene=tab.stage.scene, step=tab.stage.scene.steps + 1)
    tab.refresh()
    assert tolerance.value == "10\N{NO-BREAK SPACE}%" and "until t = 1 s" in tab.widgets.said
    tolerance.value = "2 %"
    tab.stage.scene = first_scene("bar")
    tab.refresh()
    assert tolerance.value == "2 %" and "For an error of <b>2" in tab.widgets.said


def test_a_search_gives_way_once_it_has_shown_a_run(jobs):
    """A sweep does at once: nobody waits for its first row in particular."""
    ways = []
    jobs.lower_priority = lambda: ways.append(jobs.status.kind)
    for status in (CostJobStatus("search"), CostJobStatus("search", done=1), CostJobStatus("sweep")):
        jobs.status = status
        jobs.share_cpu()
    assert ways == ["search", "sweep"]


SEARCH = "Find the cheapest run"
FOUND = {"met": True, "task": task_of(SCENE).to_dict(), "error": None, "measured": False, "seconds": 1.0, "why": "",
         "looks": 1}


def test_advice_goes_when_what_was_asked_changes(tab):
    """What the search itself chooses, as when its advice is loaded, changes nothing; a remark goes with its input."""
    tab.jobs.start_search = lambda job, undisturbed: None
    tab.open(True)
    tab.widgets.by_label[SEARCH].click()
    tab.jobs.status = CostJobStatus("search", advice=FOUND)
    tab.widgets.by_label["Load this scene"].click()
    tab.refresh()
    assert tab.jobs.status.advice and "advice is on the stage." in tab.widgets.said
    tab.stage.scene = replace(SCENE, method="cpgimp", cells=28, ppc=3, cfl=0.5, effects=(), estimators=())
    tab.refresh()
    assert tab.jobs.status.advice and "advice is on the stage" not in tab.widgets.said
    tab.widgets.by_label["Tolerance"].value = "1e-2"
    tab.refresh()
    assert tab.jobs.status == CostJobStatus()
    for change in ({"amplitude": 0.01}, {"modulus": 8.0}, {"body_force": "none"}, {"periods": 2.0}):
        assert advice_key(replace(SCENE, **change)) != advice_key(SCENE)


def test_search_ends_when_what_was_asked_changes(tab, pools):
    tab.open(True)
    tab.widgets.by_label[SEARCH].click()
    assert tab.jobs.status.running
    tab.stage.scene = replace(SCENE, amplitude=0.01)
    tab.refresh()
    wait_until(lambda: not tab.jobs.status.running, "the end of the search")
    tab.refresh()
    assert cost_texts.job_status_text(tab.jobs.status) == "The search was cancelled."
    assert "The goal of the search has changed." in tab.widgets.said
