"""The Cost tab without a browser: rows of live runs, jobs in the background, the table and the picture."""

from __future__ import annotations

import csv
import io
import os
import re
import signal
import threading
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from app.page.cost import jobs as jobs_module
from app.page.cost import words
from app.page.cost.jobs import Jobs, JobStatus, Slots, question, search, small_sweep, timings
from app.page.cost.live import LiveRows, live_row
from app.page.cost.picture import Axis, picture
from app.page.cost.quiet import QuietStage
from app.page.cost.runs import LIVE, SWEEP, Runs, csv_bytes
from app.page.history import History
from app.page.page import Page
from app.page.panels.cost import CostTab
from solvers.bar.scene import BarScene
from solvers.engine.messages import FrameReport
from solvers.engine.verdict import Verdict
from solvers.ring.scene import RingScene
from solvers.run import build
from solvers.study.grid import task_of
from solvers.study.jobs import SearchJob
from solvers.study.row import failed
from solvers.study.summary import flat
from tests.processes import has_library, until
from tests.rows import made_up

SCENE = BarScene(cells=10, periods=1)


def frames(scene, steps=100):
    """A live run's frames as the page hears them: report and history."""
    solver = build(scene)
    solver.compile()
    verdict, history, fresh, rows = Verdict(scene), History(scene, scene.particles), True, solver.measure()
    while True:
        history.add(rows)
        verdict.look(rows, scene.particles)
        status, reason, since = verdict.tell(solver, {})
        yield FrameReport(session=1, number=1, scene=scene, fresh=fresh, playing=True, particles=scene.particles,
                          step=solver.step, time=solver.time, rows=rows, rate=10.0, real_speed=None, arch=solver.arch,
                          reason=reason, status=status, since=since, not_valid=solver.not_valid(), memory=""), history
        fresh, rows = False, solver.advance(steps) if solver.sound else rows[:0]


def same(one, other):
    """Whether two tables of numbers agree; some may be None in both."""
    return {name: value and pytest.approx(value, rel=1e-9) for name, value in one.items()} == other


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
    jobs = Jobs(Runs(), Slots(1))
    yield jobs
    jobs.close()


@pytest.mark.parametrize("scene", [SCENE, RingScene(cells=12, periods=1)], ids=["bar", "ring"])
def test_live_row_holds_the_errors_of_the_scene(scene, simulate):
    """However far the stage ran beyond the end, the row has what a run of the scene has; and there is one only."""
    follower, result = LiveRows(), simulate(scene)
    live = frames(scene, 333)
    rows = []
    while len(rows) < 10:
        report, history = next(live)
        row = follower.follow(report, history)
        assert (row is None) or (report.time > scene.end_time - scene.time_step)
        rows += [row] if row or report.time > scene.end_time else []
    row = rows[0]
    assert rows[1:] == [None] * 9
    for q in ("x", "v", "sigma", "a"):
        assert same(row["error"][q], result.to_dict()["error"][q])
        assert same(row["estimate"]["transport"][q], result.estimates("transport")[q])
        assert same({q: row["index"]["transport"][q]}, {q: result.index("transport")[q]})
    assert row["seconds"]["full"] == pytest.approx(scene.steps * scene.particles * 1e-7)
    assert row["status"] == "ok" and row["key"] == task_of(scene).key
    report, history = next(frames(scene))
    assert follower.follow(report, history) is None  # begun anew
    assert not follower._done


def test_live_run_that_goes_unstable_is_a_row():
    follower = LiveRows()
    bad = replace(SCENE, cells=40, amplitude=0.1, cfl=1.5)
    row = next(row for report, history in frames(bad, 50) if (row := follower.follow(report, history)))
    assert row["status"] == "unstable" and row["reason"] and row["t"] < bad.end_time
    runs = Runs()
    runs.add(row, LIVE)
    assert runs.all()[0].drawable and "unstable" in words.sentence(runs.all()[0])


def test_live_run_that_is_lost_is_a_row():
    """It goes to the end of its scene, and is drawn and told like an unstable one under its own name."""
    follower, bad = LiveRows(), replace(SCENE, cells=40, ppc=1)
    row = next(row for report, history in frames(bad) if (row := follower.follow(report, history)))
    assert row["status"] == "lost" and row["reason"].startswith("the run is lost") and row["steps"] == bad.steps
    runs = Runs()
    runs.add(row, LIVE)
    runs.add(made_up(status="lost"), SWEEP)
    assert runs.all()[0].drawable and "the run is lost from" in words.sentence(runs.all()[0])
    drawing, listed = picture(runs.all()), words.table(runs.all())
    assert "</svg> lost</span>" in drawing and listed.count(">lost</td>") == 2
    runs.add(made_up("mpm", status="unstable"), SWEEP)
    assert "unstable or lost" in picture(runs.all())


def test_run_that_is_lost_after_its_scene_is_ok():
    """The stage runs on for ever; what happens beyond the end does not count."""
    scene = replace(SCENE, cells=40, ppc=1, periods=0.5)
    assert live_row(*next(frame for frame in frames(scene) if frame[0].status == "lost"))["status"] == "ok"


def test_live_run_without_truth_has_its_estimate():
    follower = LiveRows()
    scene = replace(SCENE, body_force="two-tone")
    row = next(row for report, history in frames(scene) if (row := follower.follow(report, history)))
    runs = Runs()
    runs.add(row, LIVE)
    run = runs.all()[0]
    assert run.error is None and run.size == run.estimate > 0 and picture([run])


def test_runs_keep_their_numbers_and_are_bounded():
    """A scene seen again is no new dot, a live row does not replace a timed one, and the oldest goes."""
    runs = Runs(most=3)
    for cells in (10, 20, 10):
        runs.add(made_up(cells=cells), LIVE)
    runs.add(made_up(cells=20), SWEEP)
    runs.add(made_up(cells=20), LIVE)
    runs.add(made_up(cells=10, status="failed"), SWEEP)
    assert [(run.number, run.source) for run in runs.all()] == [(1, LIVE), (2, SWEEP)]
    assert [task.inputs["cells"] for task in timings(runs.all())] == [10]
    for cells in (30, 40):
        runs.add(made_up(cells=cells), LIVE)
    assert [run.number for run in runs.all()] == [2, 3, 4]
    assert runs.find(3).scene.cells == 30 and runs.find(1) is None


def test_csv_has_every_row_and_input():
    runs = Runs()
    runs.add(made_up(cells=10), SWEEP)
    report_row = failed(task_of(replace(SCENE, cells=30)), "lost")
    runs.add(report_row, SWEEP)
    read = list(csv.DictReader(io.StringIO(csv_bytes(runs.all()).decode())))
    assert [(line["run"], line["source"], line["scene.cells"], line["status"]) for line in read] == [
        ("1", SWEEP, "10", "ok"), ("2", SWEEP, "30", "failed")]
    assert set(read[0]) == {"run", "source", *flat({**runs.all()[0].row, "asked": {}})}


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
    assert jobs.status == JobStatus("sweep", done=2, total=2)
    assert [run.row["asked"]["cells"] for run in jobs._runs.all()] == [10, 20] and not alive(process)
    assert all(run.row["seconds"]["min"] > 0 for run in jobs._runs.all())


def test_cancel_keeps_rows_and_makes_room(jobs):
    """Cancelled between rows: what was measured stays, the process is gone and its place is free."""
    jobs.sweep([*small_sweep(SCENE)[:1], task_of(BarScene(cells=2000, periods=100), repeats=1)])
    other = Jobs(Runs(), jobs._slots)
    other.sweep(small_sweep(SCENE))
    assert "server busy" in words.going(other.status) and not other.status.running
    wait(lambda: jobs.status.done == 1)
    process = jobs.process_id
    jobs.cancel()
    wait(lambda: not jobs.status.running)
    assert not alive(process) and len(jobs._runs.all()) == 1 and jobs.status.trouble is None
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
    assert jobs._slots.taken == 0


def test_process_that_cannot_start_is_said(jobs, monkeypatch):
    def refuse(*_):
        raise OSError(11, "Resource temporarily unavailable")

    monkeypatch.setattr(jobs_module, "BackgroundJob", refuse)
    jobs.sweep(small_sweep(SCENE))
    assert "temporarily unavailable" in words.going(jobs.status) and not jobs.status.running
    assert jobs._slots.taken == 0


def test_visitor_who_leaves_takes_the_process_along(jobs):
    """The page closes its tab, the tab its jobs; after that none begins."""
    jobs.sweep([task_of(BarScene(cells=2000, periods=100))])
    process = jobs.process_id
    page, tab = Page.__new__(Page), CostTab.__new__(CostTab)
    tab.jobs = jobs
    page._closed, page._stands, page._cost = threading.Event(), threading.Event(), tab
    page._drawing, page._refreshing = threading.Lock(), threading.Lock()
    page._session = page._slow = page._player = SimpleNamespace(close=lambda: None)
    page.close()
    wait(lambda: not jobs.status.running)
    assert not alive(process)
    jobs.sweep(small_sweep(SCENE))
    assert not jobs.status.running


def test_search_finds_a_scene_that_can_be_loaded(jobs):
    """It says what it looks at, and the advice is a scene with the truth and the estimate by which it was found."""
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
    assert words.found({**advice, "met": False, "error": None}).startswith("Nothing within reach")


def test_scene_too_large_to_watch_is_not_loaded():
    """It would freeze the visitor's browser: the page gives the command instead."""
    loaded, tab = [], CostTab.__new__(CostTab)
    tab._load, tab._input = loaded.append, tuple
    tab._put(RingScene(cells=396, periods=1), "The advice")
    assert not loaded and "too many to watch" in tab._remark and "mpm-lab run ring" in tab._remark
    tab._put(SCENE, "Run 1")
    assert loaded == [SCENE] and tab._remark == "Run 1 is on the stage."


@pytest.mark.parametrize("text", ["", "abc", "0", "-1", "nan", "inf", "1e999", "61"])
def test_what_is_no_number_is_refused_in_words(text):
    with pytest.raises(words.NoNumber, match="give a number above 0"):
        words.typed("Longest run", text, words.LONGEST_BUDGET)
    assert words.typed("Tolerance", " 1e-4 ") == 1e-4


def test_picture_has_a_button_a_run():
    """Every run that has an error and a time is a numbered dot; sweeps are joined; an unstable one is at the top."""
    runs = Runs()
    for cells in (10, 20, 40):
        runs.add(made_up(cells=cells), SWEEP)
    runs.add(made_up("mpm", status="unstable"), SWEEP)
    runs.add(made_up("bspline"), LIVE)
    runs.add(failed(task_of(SCENE), "lost <b>"), SWEEP)
    drawing = picture(runs.all())
    assert drawing.count("class='lab-dot'") == 5 and drawing.count("class='lab-number'") == 5
    assert "unstable" in drawing and "as timed on the stage" in drawing and "data-run='6'" not in drawing
    assert drawing.count("<polyline") == 1
    listed = words.table(runs.all())
    assert listed.count("<button") == 6 and "lost <b>" not in listed
    assert picture([]) == "" and words.table([]) == ""


@pytest.mark.parametrize("values", [[1e-3], [1e-9, 1e3], [0.02, 0.021], []])
def test_axis_holds_its_values_and_has_ticks(values):
    axis = Axis(values, 40, 318)
    assert all(40 <= axis.at(value) <= 318 for value in values)
    assert len(axis.ticks()) >= 1 and np.all(np.diff([axis.at(value) for value, _ in axis.ticks()]) > 0)


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


def test_tab_says_what_disturbs_the_times_and_gives_way_to_it():
    tab, ways = CostTab.__new__(CostTab), []
    tab.jobs = SimpleNamespace(status=JobStatus("sweep", running=True), others=False, give_way=lambda: ways.append(1))
    tab._session = Stage()
    tab._quiet = QuietStage(tab._session)
    tab._quiet.follow(True)
    assert "paused" in tab._stage_word(tab.jobs.status) and not ways and "paused" in tab.notice().sentence
    tab._session.others_playing = True
    assert "Other visitors" in tab._stage_word(tab.jobs.status) and ways
    tab._session.play(True)
    tab._quiet.follow(True)
    assert tab._stage_word(tab.jobs.status).startswith("Your stage runs") and tab.notice() is None
    tab.jobs.status = JobStatus("sweep")
    assert tab._stage_word(tab.jobs.status) == ""


def test_job_gives_way_when_told_to(jobs):
    jobs.sweep([task_of(BarScene(cells=2000, periods=100))])
    before = os.getpriority(os.PRIO_PROCESS, jobs.process_id)
    assert before == os.getpriority(os.PRIO_PROCESS, 0) and not jobs.others
    jobs.give_way()
    assert os.getpriority(os.PRIO_PROCESS, jobs.process_id) > before or before == 19
    assert Jobs(Runs(), jobs._slots).others


def box(value):
    return SimpleNamespace(value=value)


def test_advice_goes_when_what_was_asked_changes():
    """What the search itself chooses, as when its advice is loaded, changes nothing; a remark goes with its input."""
    tab = CostTab.__new__(CostTab)
    tab.jobs, tab._session, tab._tolerance, tab._budget = Jobs(Runs(), Slots(1)), Stage(), box("1e-2"), box("10")
    tab.jobs.status, tab._asked = JobStatus("search", advice={"met": True}), tab._question()
    tab._say("Run 1 is on the stage.")
    tab._drop_what_is_old()
    assert tab.jobs.status.advice and tab._remark
    tab._session.scene = replace(SCENE, method="cpgimp", cells=28, ppc=3, cfl=0.5, effects=(), estimators=())
    tab._drop_what_is_old()
    assert tab.jobs.status.advice and not tab._remark
    tab._tolerance.value = "1e-3"
    tab._drop_what_is_old()
    assert tab.jobs.status == JobStatus()
    for change in ({"amplitude": 0.01}, {"modulus": 8.0}, {"body_force": "none"}, {"periods": 2.0}):
        assert question(replace(SCENE, **change)) != question(SCENE)


def test_search_ends_when_what_was_asked_changes(jobs):
    tab = CostTab.__new__(CostTab)
    tab.jobs, tab._session, tab._tolerance, tab._budget, tab._remark = jobs, Stage(), box("1e-2"), box("10"), ""
    jobs.search(search(SCENE, 1e-2, 10.0))
    tab._asked = tab._question()
    tab._session.scene = replace(SCENE, amplitude=0.01)
    tab._drop_what_is_old()
    wait(lambda: not jobs.status.running)
    tab._drop_what_is_old()
    assert words.going(jobs.status) == "The search was cancelled." and tab._remark == "What it was to find has changed."


def test_label_of_the_errors_crosses_no_tick():
    """It stands above the highest of them."""
    runs = Runs()
    runs.add(made_up(), SWEEP)
    drawing = picture(runs.all())
    label = re.search(r"<text x='4' y='(\d+)'>error of x / A", drawing)
    heights = [float(y) for y in re.findall(r"y='([\d.]+)' text-anchor='end'", drawing)]
    assert heights and int(label[1]) < min(heights) - 10 and "rotate" not in drawing
