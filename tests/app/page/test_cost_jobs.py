"""Jobs of the Cost tab, in the background: sweeps and searches, and what gives way to what."""

from __future__ import annotations

import os
import signal
import subprocess
import threading
from dataclasses import replace
from types import SimpleNamespace

import pytest

from app.page.features.cost import words
from app.page.features.cost.front import cheapest, question
from app.page.features.cost.jobs import CostStatus, Jobs, QuietStage, search, small_sweep
from app.page.features.cost.kept import HOLDS, MOST_POINTS, MOST_QUESTIONS, KeptPoints
from app.page.features.cost.panel import CostTab
from app.page.features.cost.ready import Ready
from app.page.features.cost.runs import Runs
from app.page.page import Page
from solvers.problems.bar.scene import BarScene
from solvers.problems.ring.scene import RingScene
from solvers.study.grid import task_of
from solvers.study.jobs import SearchJob
from solvers.workers.pool import Slots
from tests.app.page.test_cost import SCENE
from tests.processes import has_library, until


def wait(condition):
    until(condition, "what a job was waited for")


def alive(process_id):
    try:
        os.kill(process_id, 0)
    except ProcessLookupError:
        return False
    return True


@pytest.fixture
def jobs():
    jobs = Jobs(Runs(), Slots(1), KeptPoints())
    yield jobs
    jobs.close()


@pytest.mark.parametrize("scene", [
    SCENE, BarScene(method="cpgimp", velocity="corners", effects=(), periods=1), RingScene(periods=1, dt=1e-5)],
    ids=["bar", "corners", "ring"])
def test_small_sweep_is_valid_and_like_the_scene(scene):
    tasks = small_sweep(scene)
    assert len(tasks) == 16 == len({task.key for task in tasks})
    for task in tasks:
        other = task.scene()
        assert (other.amplitude, other.dt, other.periods) == (scene.amplitude, scene.dt, scene.periods)
        assert other.has("truth") and (other.has("estimate") or other.not_valid)
    assert task_of(scene).scene() == scene


def test_sweep_runs_in_a_process_that_ends(jobs):
    tasks = small_sweep(SCENE)[:2]
    jobs.sweep(tasks)
    process = jobs.process_id
    jobs.sweep(tasks)  # while one runs nothing else begins
    assert jobs.process_id == process
    wait(lambda: not jobs.status.running)
    assert jobs.status == CostStatus("sweep", done=2, total=2)
    assert [run.row["asked"]["cells"] for run in jobs.runs.all()] == [10, 20] and not alive(process)
    assert all(run.row["seconds"]["min"] > 0 for run in jobs.runs.all())


def test_cancel_keeps_rows_and_makes_room(jobs):
    """Cancelled between rows: what was measured stays, the process is gone and its place is free."""
    jobs.sweep([*small_sweep(SCENE)[:1], task_of(BarScene(cells=2000, periods=100), repeats=1)])
    other = Jobs(Runs(), jobs.slots)
    other.sweep(small_sweep(SCENE))
    assert "server busy" in words.going(other.status) and not other.status.running
    wait(lambda: jobs.status.done == 1)
    process = jobs.process_id
    jobs.cancel()
    wait(lambda: not jobs.status.running)
    assert not alive(process) and len(jobs.runs.all()) == 1 and jobs.status.trouble is None
    assert "cancelled" in words.going(jobs.status)
    other.search(SearchJob(task_of(SCENE).to_dict(), (), (2,), (0.5,), "x", 1.0, 1.0))
    wait(lambda: not other.status.running)
    assert "no method" in words.going(other.status)


def test_process_that_dies_is_said(jobs):
    jobs.sweep([task_of(BarScene(cells=2000, periods=100))])
    wait(lambda: has_library(jobs.process_id, "taichi"))  # it has read what to do, else another would do it
    os.kill(jobs.process_id, signal.SIGKILL)
    wait(lambda: not jobs.status.running)
    assert "SIGKILL" in words.going(jobs.status)
    assert jobs.slots.taken == 0


def test_process_that_cannot_start_is_said(jobs, monkeypatch):
    def refuse(*_, **options):
        raise OSError(11, "Resource temporarily unavailable")

    monkeypatch.setattr(subprocess, "Popen", refuse)
    jobs.sweep(small_sweep(SCENE))
    wait(lambda: not jobs.status.running)
    assert "temporarily unavailable" in words.going(jobs.status) and not jobs.status.running
    assert jobs.slots.taken == 0


def test_visitor_who_leaves_takes_the_process_along(jobs):
    """The page closes its tab, the tab its jobs; after that none begins."""
    jobs.sweep([task_of(BarScene(cells=2000, periods=100))])
    process = jobs.process_id
    page, tab = Page.__new__(Page), CostTab.__new__(CostTab)
    tab.jobs = jobs
    page._closed, page._stands, page._cost = threading.Event(), threading.Event(), tab
    page._budget, page._board = SimpleNamespace(jobs=tab.jobs), None
    page._drawing, page._refreshing = threading.Lock(), threading.Lock()
    page._session = page._slow = page._player = page._own = page._links = SimpleNamespace(close=lambda: None)
    page.close()
    wait(lambda: not jobs.status.running)
    assert not alive(process)
    jobs.sweep(small_sweep(SCENE))
    assert not jobs.status.running


def test_search_finds_a_scene_that_can_be_loaded(jobs):
    """It says what it looks at, and the advice is a scene with the truth and the estimate by which it was found. Each
    of its runs is a row as soon as it is made, with an estimate, no true error, and a scene to watch."""
    job = replace(search(SCENE, 1e-2, 5.0), methods=(("ugimp", False), ("mpm", False)), ppc=(2,),
                  courant_numbers=(0.5,))
    jobs.search(job)
    wait(lambda: jobs.status.task or not jobs.status.running)
    assert "Search, run" in words.going(jobs.status)
    wait(lambda: not jobs.status.running)
    advice = jobs.status.advice
    assert advice["met"] and advice["error"] <= 1e-2 * SCENE.amplitude
    text = words.going(jobs.status)
    assert text.startswith("Take uGIMP") and "estimate" in text
    found = jobs.runs.all()
    assert len(found) == advice["looks"] == jobs.status.done
    assert {(run.source, run.error, run.estimator) for run in found} == {("search", None, "companion")}
    assert all(run.drawable for run in found)
    taken = cheapest(found, 1e-2)
    assert taken.row["asked"] == advice["task"]["inputs"] and taken.scene.has("truth")
    assert taken.seconds == advice["seconds"] and taken.size == advice["error"] / SCENE.amplitude
    assert words.found({**advice, "met": False, "error": None}).startswith("Nothing within reach")


def few(tolerance):
    """A search among two families."""
    return replace(search(SCENE, tolerance, 5.0), methods=(("ugimp", False), ("mpm", False)), ppc=(2,),
                   courant_numbers=(0.5,))


def test_what_a_search_has_measured_is_not_run_again(jobs):
    """For another visitor, nor for another tolerance of the same motion; another motion is begun anew. What is known is
    a row as if it had been made."""
    jobs.search(few(1e-2))
    wait(lambda: not jobs.status.running)
    assert jobs.status.known == 0 < jobs.status.done
    other = Jobs(Runs(), jobs.slots, jobs._kept)
    other.search(few(1e-2))
    wait(lambda: not other.status.running)
    assert other.status.known == other.status.done == jobs.status.done and other.status.task is None  # no run began
    assert other.status.advice == jobs.status.advice
    assert [run.row for run in other.runs.all()] == [run.row for run in jobs.runs.all()]
    assert f"{other.status.known} of them had been made by earlier searches" in words.going(other.status)
    other.search(few(3e-3))
    wait(lambda: not other.status.running)
    assert 2 <= other.status.known < other.status.done and other.status.advice["error"] <= 3e-3 * SCENE.amplitude
    another = replace(few(1e-2), base=task_of(replace(SCENE, amplitude=0.01)).to_dict())
    other.search(another)
    wait(lambda: not other.status.running)
    assert other.status.known == 0 < other.status.done
    other.close()


def test_a_time_that_was_disturbed_is_taken_anew_where_nothing_disturbs(jobs):
    """The run itself is not made again."""
    jobs.search(few(1e-2), quiet=False)
    wait(lambda: not jobs.status.running)
    about, keys = jobs._about, [run.row["key"] for run in jobs.runs.all()]
    assert all("rate" not in point for point in jobs._kept.known(about, quiet=True).values())
    assert all(point["rate"] > 0 for point in jobs._kept.known(about, quiet=False).values())
    jobs.search(few(1e-2), quiet=True)
    wait(lambda: not jobs.status.running)
    # Which runs are looked at may follow the new times; those that were known are none that begin.
    assert jobs.status.known >= 2 and jobs._about == about
    timed = [key for key, point in jobs._kept.known(about, quiet=True).items() if "rate" in point]
    assert set(timed) & set(keys)


@pytest.fixture
def ready():
    ready = Ready("solvers.study.jobs:search", Slots(1))
    yield ready
    ready.end()


def test_a_search_takes_the_process_that_is_ready(jobs, ready):
    """It is asked to get ready once, says nothing, and is the one that searches, and that searches again; a sweep ends
    it."""
    jobs._ready = ready
    jobs.prepare(few(1e-2), quiet=True)
    [process] = ready._pool.process_ids
    jobs.prepare(few(1e-2), quiet=True)
    assert ready._pool.process_ids == [process] and ready._places.taken == 1
    jobs.search(few(1e-2))
    assert jobs.process_id == process and ready._pool is None and ready._places.taken == 0
    wait(lambda: not jobs.status.running)
    assert jobs.status.advice and jobs.status.done == jobs.status.advice["looks"]
    assert ready._pool.process_ids == [process]
    jobs.search(few(3e-3))
    assert jobs.process_id == process
    jobs.beside()
    wait(lambda: not jobs.status.running)
    assert ready._pool is None and not alive(process)  # it would give way for ever
    jobs.prepare(few(1e-2), quiet=True)
    [process] = ready._pool.process_ids
    jobs.sweep(small_sweep(SCENE)[:1])
    assert jobs.process_id != process
    wait(lambda: not alive(process) and not jobs.status.running)


def test_few_processes_are_ready_and_none_for_ever(ready):
    """A second visitor gets none while the first one's is there; who leaves, or takes too long, takes it along."""
    first, second = (Jobs(Runs(), Slots(1), KeptPoints()) for _ in range(2))
    first._ready, second._ready = ready, Ready("solvers.study.jobs:search", ready._places, rests=0.1)
    first.prepare(few(1e-2), quiet=False)
    [process] = ready._pool.process_ids
    assert os.getpriority(os.PRIO_PROCESS, process) > os.getpriority(os.PRIO_PROCESS, 0)
    second.prepare(few(1e-2), quiet=True)
    assert second._ready._pool is None
    first.close()
    wait(lambda: not alive(process))
    first.prepare(few(1e-2), quiet=True)
    assert ready._pool is None
    second.prepare(few(1e-2), quiet=True)
    wait(lambda: second._ready._pool is None and ready._places.taken == 0)


def test_who_opens_the_tab_has_a_process_made_ready(tab):
    asked = []
    tab.jobs.prepare = lambda job, quiet: asked.append((job, quiet))
    tab.open(True)
    tab.stage.others_playing = True
    tab.open({"what": "ever"})
    tab.stage.scene = BarScene(motion="patch")
    tab.open(True)
    assert [quiet for _, quiet in asked] == [True, False] and asked[0][0] == search(SCENE, 1e-3, 10.0)


def test_what_is_kept_is_bounded_and_times_hold_for_an_hour():
    now = [0.0]
    kept = KeptPoints(lambda: now[0])
    point = {"error": 1e-3, "rate": 1e-8, "status": "ok", "reason": None}
    for k in range(MOST_POINTS + 1):
        kept.keep("a", f"{k}", point, True)
    assert len(kept.known("a", True)) == MOST_POINTS and "0" not in kept.known("a", True)
    assert kept.known("a", True)["1"] == point
    now[0] = HOLDS
    kept.keep("a", "2", {**point, "rate": None}, True)  # a run that goes bad when it is timed
    known = kept.known("a", True)
    assert "rate" not in known["1"] and known["1"]["error"] == 1e-3 and known["2"]["rate"] is None
    for k in range(MOST_QUESTIONS):
        kept.keep(f"question {k}", "1", point, True)
    assert kept.known("a", True) == {} and kept.known("question 0", True)


class Stage:
    """As much of a session as a job takes note of."""

    def __init__(self, playing=True, others=False):
        self.scene, self.playing, self.others_playing = SCENE, playing, others

    def play(self, playing):
        self.playing = playing


def test_stage_stands_still_while_a_job_runs():
    """It goes on afterwards if it moved before, and is left alone once its visitor has pressed Play."""
    stage = Stage()
    quiet = QuietStage(stage)
    for running, playing in [(False, True), (True, False), (True, False), (False, True)]:
        quiet.follow(running)
        assert stage.playing == playing and quiet.paused == (running and not playing)
    quiet.follow(True)
    stage.play(True)  # by the visitor
    quiet.follow(True)
    assert stage.playing and not quiet.paused
    stage.play(False)
    quiet.follow(False)
    assert not stage.playing
    quiet.follow(True)
    quiet.follow(False)
    assert not stage.playing  # it did not move before


class Widgets:
    """A panel of widgets that nobody sees: a test sets and clicks them by their labels, and reads what is said."""

    def __init__(self):
        self.by_label, self._texts = {}, []

    def __getattr__(self, kind):
        def add(label, value="", **_):
            widget = SimpleNamespace(value=value, content="", on_update=lambda act: None)
            widget.on_click = lambda act: setattr(widget, "click", lambda: act(None))
            self._texts.append(widget)
            self.by_label[label] = widget
            return widget

        return add

    @property
    def said(self):
        return " ".join(widget.content for widget in self._texts)


@pytest.fixture
def tab():
    """The Cost tab of a visitor on ``tab.stage``, with the ``tab.widgets`` it has made."""
    stage, widgets = Stage(), Widgets()
    tab = CostTab(SimpleNamespace(gui=widgets), stage, lambda scene: setattr(stage, "scene", scene))
    tab.stage, tab.widgets = stage, widgets
    yield tab
    tab.jobs.close()


def test_tab_says_what_disturbs_the_times_and_gives_way_to_it(tab):
    ways = []
    tab.jobs.status, tab.jobs.give_way = CostStatus("sweep", running=True), lambda: ways.append(1)

    def said():
        tab.refresh()
        return tab.widgets.said

    assert "paused" in said() and not ways and "paused" in tab.notice().sentence
    tab.stage.others_playing = True
    assert "Other visitors" in said() and ways
    tab.stage.play(True)
    assert "<p>Your stage runs" in said() and tab.notice() is None
    tab.jobs.status = CostStatus("sweep")
    assert "Your stage" not in said() and "Other visitors" not in said() and "paused" not in said()


def test_job_gives_way_when_told_to(jobs):
    jobs.sweep([task_of(BarScene(cells=2000, periods=100))])
    before = os.getpriority(os.PRIO_PROCESS, jobs.process_id)
    assert before == os.getpriority(os.PRIO_PROCESS, 0) and not jobs.others
    jobs.give_way()
    assert os.getpriority(os.PRIO_PROCESS, jobs.process_id) > before or before == 19
    assert Jobs(Runs(), jobs.slots).others


def test_a_search_gives_way_once_it_has_shown_a_run(jobs):
    """A sweep does at once: nobody waits for its first row in particular."""
    ways = []
    jobs.give_way = lambda: ways.append(jobs.status.kind)
    for status in (CostStatus("search"), CostStatus("search", done=1), CostStatus("sweep")):
        jobs.status = status
        jobs.beside()
    assert ways == ["search", "sweep"]


SEARCH = "Find the cheapest run"
FOUND = {"met": True, "task": task_of(SCENE).to_dict(), "error": None, "measured": False, "seconds": 1.0, "why": "",
         "looks": 1}


def test_advice_goes_when_what_was_asked_changes(tab):
    """What the search itself chooses, as when its advice is loaded, changes nothing; a remark goes with its input."""
    tab.jobs.search = lambda job, quiet: None
    tab.widgets.by_label[SEARCH].click()
    tab.jobs.status = CostStatus("search", advice=FOUND)
    tab.widgets.by_label["Load this scene"].click()
    tab.refresh()
    assert tab.jobs.status.advice and "advice is on the stage." in tab.widgets.said
    tab.stage.scene = replace(SCENE, method="cpgimp", cells=28, ppc=3, cfl=0.5, effects=(), estimators=())
    tab.refresh()
    assert tab.jobs.status.advice and "advice is on the stage" not in tab.widgets.said
    tab.widgets.by_label["Tolerance / A"].value = "1e-2"
    tab.refresh()
    assert tab.jobs.status == CostStatus()
    for change in ({"amplitude": 0.01}, {"modulus": 8.0}, {"body_force": "none"}, {"periods": 2.0}):
        assert question(replace(SCENE, **change)) != question(SCENE)


def test_search_ends_when_what_was_asked_changes(tab):
    tab.widgets.by_label[SEARCH].click()
    assert tab.jobs.status.running
    tab.stage.scene = replace(SCENE, amplitude=0.01)
    tab.refresh()
    wait(lambda: not tab.jobs.status.running)
    tab.refresh()
    assert words.going(tab.jobs.status) == "The search was cancelled."
    assert "What it was to find has changed." in tab.widgets.said
