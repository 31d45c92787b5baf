"""Runs drawn at random, the bars around their numbers, and how often what is said of them was so."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from app.commands.dispatch import dispatch
from solvers import BarScene, run
from solvers.problems import PROBLEMS
from solvers.running.quantities_of_interest import ENERGY
from solvers.solver.soundness import OK
from solvers.study.coverage import estimate_coverage_counts as bars
from solvers.study.coverage import random_runs, track_record_and_bets
from solvers.study.coverage.estimate_coverage_counts import (
    CENTRAL,
    IN_CELL,
    NORMAL,
    ONE_CELL,
    SEVERAL_CELLS,
    TWO_GRIDS,
    motion_regime,
    tally,
    wilson_interval,
)
from solvers.study.coverage.estimate_coverage_tables import coverage_summary
from solvers.study.coverage.random_draw import IDENTITY
from solvers.study.coverage.random_runs import BEFORE, DRAW_RANGES, MEASURED, RandomRun, coarsen, measure
from solvers.study.coverage.track_record_and_bets import (
    JUDGES,
    RunSoFar,
    accurate_run_counts,
    bars_held,
    bet_by_grid_index,
    bet_by_record,
    bets,
)
from solvers.study.row import find_fault
from tests.support.fake_rows import InstantExecutor
from tests.support.paths import ROOT

SEED = 7  # not that of assets/coverage.md
MANY = 50  # runs


@pytest.mark.parametrize("problem", PROBLEMS)
def test_a_draw_is_a_run_of_its_own_number(problem):
    """The same however many are drawn; within the bounds that the text gives; with grids twice and four times as wide.
    """
    reach = DRAW_RANGES[problem]
    drawn = [RandomRun(problem, SEED, number) for number in range(20)]
    scenes = [draw.scene() for draw in drawn]
    assert scenes == [RandomRun(problem, SEED, number).scene() for number in range(20)] and len(set(scenes)) == 20
    assert len({draw.key for draw in drawn}) == 20
    for draw, scene in zip(drawn, scenes, strict=True):
        assert reach.cells[0] <= scene.cells <= reach.cells[1] and scene.cells % random_runs.COARSEST == 0
        assert scene.particles * scene.steps <= reach.work and scene.time_step < scene.step_bound
        wide = coarsen(scene, 2)
        assert wide.spacing == pytest.approx(2 * scene.spacing) and wide.time_step == pytest.approx(2 * scene.time_step)
        assert draw.point_goal_name() == RandomRun(problem, SEED, draw.number).point_goal_name()


def test_bars_of_numbers_that_converge():
    """f = 1 + c h^p on h, 2h, 4h has the error c h^p: of order 2 the bars are 3 times, 1.25 times and, where observed
    and formal order are the same, 2.45 - .85 = 1.6 times that."""
    second = [1 + 0.01 * h**2 for h in (1, 2, 4)]
    assert bars.observed_order(second) == pytest.approx(2)
    said = [bar(second) for bar in (bars.two_grid_gci, bars.three_grid_gci, bars.xing_stern_grid_uncertainty)]
    assert said == pytest.approx([0.03, 0.0125, 0.016])
    first = [1 + 0.01 * h for h in (1, 2, 4)]
    assert bars.observed_order(first) == pytest.approx(1) and bars.three_grid_gci(first) == pytest.approx(1.25 * 0.01)
    assert bars.xing_stern_grid_uncertainty(first) == pytest.approx((2.45 - 0.85 / 2) * 0.01)
    third = [1 + 0.01 * h**3 for h in (1, 2, 4)]  # taken for the formal order: a wider bar
    assert bars.three_grid_gci(third) == pytest.approx(1.25 * 0.07 / 3)
    for none in ([1, 2, 1], [1, 1, 1], [1.0, 3.0, 4.0]):
        assert bars.observed_order(none) is bars.three_grid_gci(none) is bars.xing_stern_grid_uncertainty(none) is None


def test_the_interval_of_a_share():
    """Wilson's for 95 of 100 at 95 % is 88.8 to 97.8 % (as textbooks have it)."""
    assert wilson_interval(95, 100) == pytest.approx((0.888, 0.978), abs=5e-4)
    assert wilson_interval(0, 10)[0] == 0 and wilson_interval(10, 10)[1] == pytest.approx(1)


def drawn_row(index, true, said, status=OK):
    """A run whose estimates are ``index`` times its errors, and whose energy is off by ``true``, as ``said``."""
    every = dict.fromkeys(("x", "v", "sigma", "a"), index)
    return {"status": status, "by_truth": OK, "moved": 0.1, "scene": {"method": "mpm", "ppc": 2, "cells": 40},
            "estimators": {"companion": {"refused": "", "index": every, "end": every}},
            "goals": {ENERGY: {"true_error": true, "rounding": 1e-12, "estimated_error": {"companion": said},
                               "grids": []}}}


def test_what_is_counted():
    """Factors to both sides, sizes without their signs, and neither errors that are rounding nor runs gone bad."""
    counted = tally("bar", 1, [drawn_row(1.05, 1e-3, -0.6e-3), drawn_row(0.92, -1e-3, 1.2e-3),
                               drawn_row(0.9, 1e-3, 0.4e-3), drawn_row(1.05, 1e-13, 1e-3),
                               drawn_row(1.05, 1e-3, 1e-3, status="lost")])
    found, bars = counted["estimators"]["companion"], counted["goals"][ENERGY]["all"]
    assert counted["status"] == {OK: 4, "lost": 1} and found["all"]["x"]["runs"] == 4
    assert bars["2 x companion"]["of"] == bars["2 x companion"]["runs"] == 3  # whose error is more than rounding
    assert found["all"]["x"]["within"]["1.1"] == found["regime"][IN_CELL]["x"]["within"]["1.1"] == 3
    assert [bars[f"{times} x companion"]["held"] for times in (1, 2)] == [1, 2]
    assert bars["2 x companion"]["width"] == pytest.approx(1.2)
    by_truth = counted["by truth"]
    assert (by_truth["runs"], by_truth["estimators"]["companion"]["x"]["runs"]) == (5, 5)  # the lost one, too
    assert by_truth["goals"][ENERGY]["2 x companion"]["held"] == bars["2 x companion"]["held"] + 1


def test_a_grid_index_is_counted_by_its_order_and_its_coarsest_grid():
    """1 + c h^p on h, 2h, 4h, whose error c three times the two-grid difference holds."""
    def row(order, cells):
        return drawn_row(1.0, 0.01, None) | {"scene": {"method": "mpm", "ppc": 2, "cells": cells}, "goals": {ENERGY: {
            "true_error": 0.01, "rounding": 0.0, "estimated_error": {},
            "grids": [1 + 0.01 * h**order for h in (1, 2, 4)] if order else [1, 2, 1]}}}

    found = bars.count_grid_index([row(2, 64), row(1, 60), row(0.2, 28), row(None, 32)], "GCI, 2 grids")
    assert found["order"] == {"1.5 to 2.5": {"held": 1, "runs": 1}, "another": {"held": 1, "runs": 2},
                              "none": {"held": 1, "runs": 1}}
    assert [one["runs"] for one in found["coarsest"].values()] == [1, 2, 1]
    assert bars.count_grid_index([row(None, 32)], "GCI, 3 grids")["order"]["none"]["runs"] == 0


def test_the_score_of_bars_is_least_for_the_quantile_that_they_promise():
    """Of log-normal errors, 95 % of which are below 10^1.645, no other bar has a lower mean score; a bar that is twice
    the error scores log 2, one that is half of it 19 times that."""
    assert [bars.bar_score(bar, 1.0) for bar in (1.0, 2.0, 0.5, 0.0)] == pytest.approx(
        [0, np.log10(2), 19 * np.log10(2), 19 * bars.MOST_DECADES])
    errors = 10 ** np.random.default_rng(1).normal(size=20_000)
    ends = np.linspace(1.2, 2.1, 19)
    scores = [np.mean([bars.bar_score(10**end, error) for error in errors[:4000]]) for end in ends]
    assert ends[np.argmin(scores)] == pytest.approx(1.645, abs=0.11)


def test_a_refusal_is_needless_if_every_quantity_was_right():
    """Within a factor of 1.5, of those whose index is known; without any nothing can be told."""
    rows = [drawn_row(1.0, 1e-3, 1e-3) for _ in range(4)]
    for row, index in zip(rows, ({"x": 1.1, "v": 1.4}, {"x": 1.1, "v": 1.6}, {"x": 1.1, "v": None}, {"x": None}),
                          strict=True):
        row["estimators"]["companion"] |= {"refused": BEFORE, "index": {**dict.fromkeys(("x", "v", "sigma")), **index}}
    assert tally("bar", 1, rows)["refusals"]["companion"][BEFORE] == {"runs": 4, "told": 3, "needless": 2}


def test_a_ratio_at_the_end_is_of_the_last_moment():
    """And that over the run of all, the start with them; none where the last error is only rounding."""
    def ratios(*true):
        series = {f"error_{q}": np.array(true) for q in ("x", "v", "sigma")}
        said = {f"companion/estimate_{q}": np.array([0.0, 4.0, 3.0]) for q in ("x", "v", "sigma")}
        return random_runs._ratios(SimpleNamespace(scene=BarScene(), steps=100, series=series | said), "companion")

    assert ratios(0.0, 8.0, 2.0) == {"index": dict.fromkeys(("x", "v", "sigma"), 0.7),
                                     "end": dict.fromkeys(("x", "v", "sigma"), 1.5)}
    assert ratios(0.0, 8.0, 1e-15)["end"] == dict.fromkeys(("x", "v", "sigma"))


@pytest.fixture(scope="module", params=[pytest.param(MANY, marks=pytest.mark.slow)])
def rows(request):
    return [measure(RandomRun("bar", SEED, number)) for number in range(request.param)]


def test_what_is_said_of_some_runs(rows):
    """Of other runs than those that assets/coverage.md counts. The companion's order is 8 or more, so that 1.1 is far;
    recovered was within it in 99 of 100: nine of ten or fewer would be 1 chance in 10,000. The GCI held 56
    to 79 of 100 numbers: with three numbers a run, all of them would be a counter that does not count."""
    assert {find_fault(json.loads(json.dumps(row, allow_nan=False)), MEASURED, IDENTITY) for row in rows} == {None}
    counted = tally("bar", SEED, rows)
    assert sum(counted["status"].values()) == len(rows) and counted["status"][OK] >= 0.8 * len(rows)
    for q in ("x", "v", "sigma"):
        found = counted["estimators"]["companion"]["all"][q]
        assert found["within"]["1.1"] == found["runs"] > 0
        found = counted["estimators"]["recovered"]["all"][q]
        assert found["within"]["1.1"] > 0.9 * found["runs"]
    bars = counted["goals"][ENERGY]["all"]
    assert bars["2 x companion"]["held"] == bars["2 x companion"]["runs"]
    assert bars["1 x companion"]["held"] < bars["2 x companion"]["held"]
    assert 0 < bars["GCI, 2 grids"]["held"] < bars["GCI, 2 grids"]["runs"]
    for split in counted["estimators"].values():
        ends = split["all"]["x"]["at the end"]
        low, high = ends["middle"]
        assert low < high and ends["runs"] > 0
        outside = [row for row in rows if row["status"] == OK for name, said in row["estimators"].items()
                   if split is counted["estimators"][name] and not said["refused"] and said["end"]["x"] is not None
                   and not low <= said["end"]["x"] <= high]
        assert len(outside) == pytest.approx((1 - CENTRAL) * ends["runs"], abs=2)  # one to either side
    for split in (*counted["estimators"].values(), *counted["goals"].values()):
        for group in ("regime", "method"):
            for key, all_runs in split["all"].items():
                assert sum(part[key]["runs"] for part in split[group].values()) == all_runs["runs"]


def test_what_is_refused_runs_all_the_same(rows):
    """So that a needless refusal is seen: it has an index, and decides nothing of the run's status."""
    refused = [(row, name) for row in rows for name, said in row["estimators"].items() if said["refused"] == BEFORE]
    assert {name for _, name in refused} == {"transport", "two-grid"}
    assert any(row["estimators"][name]["index"]["x"] is not None for row, name in refused)
    for row, name in refused:
        scene = RandomRun("bar", SEED, row["number"]).scene()
        assert name in scene.not_valid and row["goals"][ENERGY]["estimated_error"][name] is None
    counted = tally("bar", SEED, rows)["refusals"]["two-grid"]
    usable = [row for row in rows if row["status"] == OK]
    assert counted[BEFORE]["runs"] == sum(row["estimators"]["two-grid"]["refused"] == BEFORE for row in usable)
    assert 0 < counted[BEFORE]["needless"] < counted[BEFORE]["told"]


@pytest.mark.slow
def test_what_cannot_run_is_not_run():
    """Recovered has no tables for a lattice that is not polar: asked all the same it would write beyond them."""
    draw = next(draw for number in range(100) if (draw := RandomRun("ring", SEED,
                                                                    number)).scene().layout == "cartesian")
    row = measure(draw)
    assert find_fault(row, MEASURED, IDENTITY) is None
    assert row["estimators"]["recovered"]["refused"] == random_runs.IMPOSSIBLE
    assert set(row["estimators"]["recovered"]["index"].values()) == {None}


@pytest.fixture(scope="module")
def three():
    """The first rows, of a run each."""
    return [measure(RandomRun("bar", SEED, number)) for number in range(3)]


def test_the_command_keeps_its_rows(three, tmp_path, monkeypatch, capsys):
    """A second call with more runs makes only those that are not there, and counts all."""
    out, place = tmp_path / "coverage", InstantExecutor(lambda draw: three[draw.number])
    words = ["coverage", "bar", "--seed", str(SEED), "--out", str(out)]
    assert dispatch([*words, "--runs", "1"]) == 0
    first = (out / "rows.jsonl").read_text()
    [kept] = map(json.loads, first.splitlines())
    assert {**kept, "seconds": 0} == {**three[0], "seconds": 0}
    said = capsys.readouterr()
    assert "1/1 run 0: ok" in said.err and "| companion | x | " in said.out
    monkeypatch.setattr("solvers.study.executors.LocalExecutor", place)
    assert dispatch([*words, "--runs", "3", "--resume"]) == 0
    assert (out / "rows.jsonl").read_text().startswith(first) and [draw.number for draw in place.asked] == [1, 2]
    said = capsys.readouterr()
    assert "3 rows, 1 of them there already" in said.err and "3/3 run 2: " in said.err
    counted = json.loads((out / "coverage.json").read_text())
    assert counted["runs"] == 3 and (out / "coverage.png").stat().st_size > 10_000
    assert (out / "coverage.md").read_text() == coverage_summary(counted, "coverage.png")


@pytest.mark.parametrize("problem", PROBLEMS)
def test_the_text_quotes_what_was_counted(problem):
    """Every table of assets/coverage.md is that of the counts beside it."""
    counted, text = (track_record_and_bets.load_counts(problem),
                     (ROOT / "assets/coverage.md").read_text(encoding="utf-8"))
    made = [block for block in coverage_summary(counted).split("\n\n") if block.startswith("|")]
    assert counted["runs"] == 1000 and len(made) == 8
    assert [table for table in made if table not in text] == []


@pytest.mark.parametrize(("moved", "ppc", "regime"), [
    (0.12, 4, IN_CELL), (0.13, 4, ONE_CELL), (0.49, 1, IN_CELL), (0.51, 1, ONE_CELL), (1.0, 4, ONE_CELL),
    (1.01, 4, SEVERAL_CELLS)])
def test_a_particle_passes_an_edge_that_is_half_its_piece_away(moved, ppc, regime):
    assert motion_regime(moved, ppc) == regime


def test_a_track_record_is_that_of_runs_alike():
    """By method and by how far particles move; of an estimator that refuses all, none."""
    scene = BarScene(cells=40, ppc=4, amplitude=1e-3, method="bspline", periods=1)
    assert motion_regime(scene.motion_amplitude / scene.spacing, scene.ppc) == IN_CELL
    split = track_record_and_bets.load_counts("bar")["estimators"]["companion"]["method and regime"]["bspline"]
    this, further = (RunSoFar(one, OK, one.end_time) for one in (scene, replace(scene, amplitude=0.1)))
    assert accurate_run_counts(this, "companion") == (split[IN_CELL]["x"]["within"]["1.1"], split[IN_CELL]["x"]["runs"])
    assert accurate_run_counts(further, "companion") != accurate_run_counts(this, "companion")
    assert bars_held(this, ENERGY, "companion") is not None
    assert bars_held(this, "displacement@0.25", "companion") is not None
    assert accurate_run_counts(this, "transport") is None  # it refuses all B-splines
    assert accurate_run_counts(this, "companion", "a") is None


@pytest.mark.parametrize(("changes", "said"), [
    ({"remedies": ("null-space-filter",)}, "with remedies"), ({"motion": "patch"}, "with motion"),
    ({"displacement": "A*sin(2*pi*X)*sin(w*t)"}, "with displacement"), ({"body_force": "none"}, "body force none"),
    ({"cells": 12}, "16 to 128 cells"), ({"ppc": 8}, "particles per cell"), ({"amplitude": 0.13}, "amplitude"),
    ({"periods": 3.1}, "periods"), ({"periods": 0.05}, "periods")])
def test_a_run_that_none_was_like_has_no_track_record(changes, said):
    """The record is of ok runs within the ranges of the draw; the reason names what differs."""
    scene = replace(BarScene(ppc=4, periods=1), **changes)
    this = RunSoFar(scene, OK, scene.end_time)
    assert said in this.why_not_counted
    assert accurate_run_counts(this, "companion") is bars_held(this, ENERGY, "companion") is None
    assert not RunSoFar(BarScene(periods=1), OK, 2.0).why_not_counted
    assert bars_held(RunSoFar(BarScene(periods=1), "lost", 2.0), ENERGY, "companion") is None


def test_a_judge_bets_by_its_record_and_the_index_by_its_word():
    """The ratios of estimated to true error are turned round. Of normal errors of which the index holds 95 of 100, its
    bet holds 80, as many below as above: of 200,000 to four standard deviations, .0036."""
    low, high = track_record_and_bets.central_ratios("bar", "two-grid", "x")
    assert bet_by_record("bar", "two-grid", "x", 3e-6) == (3e-6 / high, 3e-6 / low)
    assert bet_by_record("bar", "two-grid", "x", None) is bet_by_record("vortex", "transport", "x", 1.0) is None
    assert bet_by_record("bar", "nobody", "x", 1.0) is bet_by_record("bar", "two-grid", "a", 1.0) is None
    sizes = np.abs(np.random.default_rng(1).normal(size=200_000))
    least, most = bet_by_grid_index(NORMAL / TWO_GRIDS)  # so that a standard deviation is 1
    assert np.mean(sizes < least) == pytest.approx(0.1, abs=0.0036)
    assert np.mean(sizes > most) == pytest.approx(0.1, abs=0.0036)
    assert bet_by_grid_index(None) is None


def test_bets_on_a_run():
    """Whoever is not valid does not bet, but for the index, which is asked of every run."""
    scene = BarScene(cells=16, ppc=1, amplitude=0.05, periods=0.2, estimators=("companion",))
    said, result = bets(scene), run(scene, prices=False)
    assert set(said) == {"x", "v", "sigma"} and all(list(judged) == list(JUDGES) for judged in said.values())
    assert said["x"]["two-grid"] is None and said["x"]["GCI"] is not None
    low, high = said["x"]["companion"]
    assert low == pytest.approx(high, rel=1e-3) and low == pytest.approx(result.error["x"]["final"], rel=0.01)
