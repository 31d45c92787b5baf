"""The Cost tab without a browser: rows of live runs, the table and the picture."""

import csv
import io
from dataclasses import replace
from types import SimpleNamespace

import pytest

from app.names_and_units import NOTHING
from app.page.features.cost import cost_answer, cost_texts
from app.page.features.cost.panel import CostTab
from app.page.features.cost.visitor_run_list import (
    LIVE,
    SEARCH,
    SHIPPED,
    SWEEP,
    LiveRunRecorder,
    VisitorRunList,
    csv_bytes,
    live_row,
)
from app.page.visit.history import NormHistory
from solvers.engine.engine_messages import FrameReport
from solvers.engine.soundness_monitor import SoundnessMonitor
from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.running.run import build
from solvers.study.csv_and_markdown_summary import flatten_row
from solvers.study.parameter_grid import task_of
from solvers.study.row import failed_row
from tests.support.fake_rows import fake_row
from tests.support.unsolved_bar import unsolved

SCENE = BarScene(cells=10, periods=1)


def frames(scene, steps=100):
    """A live run's frames as the page hears them: report and history."""
    solver = build(scene)
    solver.compile()
    watch, history, fresh, rows = SoundnessMonitor(scene), NormHistory(scene, scene.particles), True, solver.measure()
    while True:
        history.add(rows)
        watch.check_samples(rows, scene.particles)
        status, reason, since = watch.current_status(solver, {})
        yield FrameReport(session=1, number=1, scene=scene, fresh=fresh, playing=True, particles=scene.particles,
                          step=solver.step, time=solver.time, rows=rows, rate=10.0, real_speed=None, arch=solver.arch,
                          reason=reason, status=status, since=since, not_valid=solver.not_valid(), memory=""), history
        fresh, rows = False, solver.advance(steps) if solver.sound else rows[:0]


def same(one, other):
    """Whether two tables of numbers agree; some may be None in both."""
    return {name: value and pytest.approx(value, rel=1e-9) for name, value in one.items()} == other


@pytest.mark.parametrize("scene", [SCENE, RingScene(cells=12, periods=1)], ids=["bar", "ring"])
def test_live_row_holds_the_errors_of_the_scene(scene, simulate):
    """However far the stage ran beyond the end, the row has what a run of the scene has; and there is one only."""
    follower, result = LiveRunRecorder(), simulate(scene)
    live = frames(scene, 333)
    rows = []
    while len(rows) < 10:
        report, history = next(live)
        row = follower.take_row(report, history)
        assert (row is None) or (report.time > scene.end_time - scene.time_step)
        rows += [row] if row or report.time > scene.end_time else []
    row = rows[0]
    assert rows[1:] == [None] * 9
    for q in ("x", "v", "sigma", "a"):
        assert same(row["error"][q], result.to_dict()["error"][q])
        assert same(row["estimate"]["companion"][q], result.estimate["companion"][q])
        assert same({q: row["index"]["companion"][q]}, {q: result.index["companion"][q]})
    assert row["seconds"]["full"] == pytest.approx(scene.steps * scene.particles * 1e-7)
    assert row["status"] == "ok" and row["key"] == task_of(scene).key
    report, history = next(frames(scene))
    assert follower.take_row(report, history) is None  # begun anew
    assert not follower._done


def run_of(scene, steps=100):
    """What a live run of a scene becomes in the table."""
    follower, runs = LiveRunRecorder(), VisitorRunList()
    runs.add(next(row for report, history in frames(scene, steps) if (row := follower.take_row(report, history))), LIVE)
    return runs.all()[0]


@pytest.mark.parametrize(("status", "steps", "changes", "said"), [
    ("unstable", 50, {"amplitude": 0.1, "cfl": 1.5}, "unstable"), ("lost", 100, {"ppc": 1}, "the run is lost from")])
def test_live_run_that_goes_bad_is_a_row(status, steps, changes, said):
    """Drawn and told under its own name; one that is lost goes to the end of its scene."""
    bad = replace(SCENE, cells=40, **changes)
    run = run_of(bad, steps)
    assert run.row["status"] == status and run.row["reason"] and run.drawable and said in cost_texts.run_sentence(run)
    assert run.row["t"] < bad.end_time if status == "unstable" else run.row["steps"] == bad.steps
    assert f">{status}</td>" in cost_texts.runs_table([run], [], run)


def test_run_that_is_lost_after_its_scene_is_ok():
    """The stage runs on for ever; what happens beyond the end does not count."""
    scene = replace(SCENE, cells=40, ppc=1, periods=0.5)
    assert live_row(*next(frame for frame in frames(scene) if frame[0].status == "lost"))["status"] == "ok"


def test_live_run_without_truth_has_its_estimate():
    run = run_of(unsolved(SCENE))
    assert run.error is None and run.error_or_estimate == run.estimate > 0 and run.drawable
    errors = f"<td>{NOTHING}</td><td>{cost_texts.format_percent(run.estimate)}</td>"
    assert errors in cost_texts.runs_table([run], [], None)


def test_runs_keep_their_numbers_and_are_bounded():
    """A run seen again is no new dot, whatever was estimated beside it; a live row does not replace a timed one, and
    the oldest goes."""
    runs = VisitorRunList(most=3)
    for cells in (10, 20, 10):
        runs.add(fake_row(cells=cells), LIVE)
    bare = fake_row(cells=10)
    runs.add({**bare, "key": "another", "asked": {**bare["asked"], "effects": [], "estimator": ["companion"]}}, LIVE)
    runs.add(fake_row(cells=20), SWEEP)
    runs.add(fake_row(cells=20), LIVE)
    runs.add(fake_row(cells=10, status="failed"), SWEEP)
    assert [(run.number, run.source) for run in runs.all()] == [(1, LIVE), (2, SWEEP)]
    for cells in (30, 40):
        runs.add(fake_row(cells=cells), LIVE)
    assert [run.number for run in runs.all()] == [2, 3, 4]
    assert runs.find(3).scene.cells == 30 and runs.find(1) is None


def test_csv_has_every_row_and_input():
    runs = VisitorRunList()
    runs.add(fake_row(cells=10), SWEEP)
    runs.add(failed_row(task_of(replace(SCENE, cells=30)), "lost"), SWEEP)
    read = list(csv.DictReader(io.StringIO(csv_bytes(runs.all()).decode())))
    assert [(line["run"], line["source"], line["scene.cells"], line["status"]) for line in read] == [
        ("1", SWEEP, "10", "ok"), ("2", SWEEP, "30", "failed")]
    assert set(read[0]) == {"run", "source", *flatten_row({**runs.all()[0].row, "asked": {}})}


def test_scene_too_large_to_watch_is_not_loaded():
    """It would freeze the visitor's browser: the page gives the command instead."""
    loaded, tab = [], CostTab.__new__(CostTab)
    tab._load, tab._entered_values = loaded.append, tuple
    tab._load_scene(RingScene(cells=396, periods=1), "The advice is on the stage.")
    assert not loaded and "too many to watch" in tab._remark and "mpm-lab run ring" in tab._remark
    tab._load_scene(SCENE, "Run 1 is on the stage.")
    assert loaded == [SCENE] and tab._remark == "Run 1 is on the stage."


@pytest.mark.parametrize("text", ["", "abc", "0", "-1", "nan", "inf", "1e999", "61"])
def test_what_is_no_number_is_refused_in_words(text):
    with pytest.raises(cost_texts.InvalidNumber, match="give a number above 0"):
        cost_texts.parse_positive("Longest run", text, cost_texts.LONGEST_BUDGET)
    assert cost_texts.parse_positive("Tolerance", " 1e-4 ") == 1e-4


def test_row_that_says_most_is_kept():
    """A search knows less of a run than a sweep, and more of its time than a stage; the number stays."""
    runs = VisitorRunList()
    for source, kept in ((LIVE, LIVE), (SHIPPED, SHIPPED), (LIVE, SHIPPED), (SEARCH, SEARCH), (SHIPPED, SEARCH),
                         (SWEEP, SWEEP), (SEARCH, SWEEP)):
        runs.add(fake_row(), source)
        assert [(run.number, run.source) for run in runs.all()] == [(1, kept)]


@pytest.mark.parametrize(("part", "text"), [(0.005, "0.5"), (0.12, "12"), (0.0123, "1.2"), (1.0, "100"), (0.999, "100"),
                                            (22.0, "2200"), (1e-5, "0.001"), (3.14e-9, "3.1 × 10⁻⁷")])
def test_parts_are_said_in_percent(part, text):
    assert cost_texts.format_percent(part) == f"{text}\N{NO-BREAK SPACE}%"


def test_table_is_bounded_and_says_what_is_left_out():
    """It is made anew with every run that a search makes."""
    runs = VisitorRunList()
    for cells in range(10, 10 + cost_texts.MOST_LINES + 3):
        runs.add(fake_row(cells=cells), SEARCH)
    runs.add(failed_row(task_of(SCENE), "lost <b>"), SEARCH)
    listed = cost_texts.runs_table(runs.all(), [], None)
    assert listed.count("<button") == cost_texts.MOST_LINES and "4 more are on the chart" in listed
    assert "lost <b>" not in listed and cost_texts.runs_table([], [], None) == ""


def test_table_has_the_own_run_and_its_shipped_neighbours():
    """All of them would be too many; each is in the chart."""
    runs = VisitorRunList()
    for method, cells in (("ugimp", 20), ("bspline", 20), ("ugimp", 30), ("ugimp", 40)):
        runs.add(fake_row(method, cells), SHIPPED)
    own, *_, best = runs.all()
    listed = cost_texts.runs_table(runs.all(), [best], own)
    assert [f"load run {run.number}'" in listed for run in runs.all()] == [True, True, False, True]
    assert "uGIMP, 20 (yours)" in listed and listed.count("lab-marked") == 1 and "4 runs, measured on the" in listed
    assert "1 more are on the chart" in listed
    runs.add(fake_row("mpm"), SWEEP)
    assert "They are hollow" in cost_texts.runs_table(runs.all(), [best], own)


@pytest.mark.parametrize(("text", "share"), [("0.5 %", 0.005), ("0,5%", 0.005), ("5e-3", 0.005), (" 12 % ", 0.12)])
def test_a_tolerance_is_a_part_or_per_cent(text, share):
    assert cost_texts.parse_tolerance(text) == pytest.approx(share, rel=1e-15)


def test_ones_own_run_is_known_once_it_has_not_broken(monkeypatch):
    for broken in (False, True):
        run = SimpleNamespace(broken=broken)
        monkeypatch.setattr(cost_answer.visitor_run_list, "run_of_scene", lambda *_, run=run: run)
        assert cost_answer.own_run([run], SCENE) is (None if broken else run)
