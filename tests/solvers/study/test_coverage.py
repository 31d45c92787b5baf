"""Runs drawn at random, the bars around their numbers, and how often what is said of them was so."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.commands.dispatch import dispatch
from solvers import BarScene, run
from solvers.problems import PROBLEMS
from solvers.running.goals import ENERGY
from solvers.solver.soundness import OK
from solvers.study.coverage import track_record
from solvers.study.coverage.bets import JUDGES, bets, by_its_word, by_the_record
from solvers.study.coverage.draws import COARSEST, REACH, Draw, coarser
from solvers.study.coverage.grid_convergence import TWO_GRIDS, factor_of_safety, observed_order, three_grids, two_grids
from solvers.study.coverage.measured import BEFORE, IMPOSSIBLE, fault, measure
from solvers.study.coverage.tally import MIDDLE, NORMAL, REGIMES, STAY, interval, regime, tally
from solvers.study.coverage.text import summary
from tests.paths import ROOT

SEED = 7  # not that of assets/coverage.md
SHORT = 50


@pytest.mark.parametrize("problem", PROBLEMS)
def test_a_draw_is_a_run_of_its_own_number(problem):
    """The same however many are drawn; within the bounds that the text gives; with grids twice and four times as wide.
    """
    reach = REACH[problem]
    drawn = [Draw(problem, SEED, number) for number in range(20)]
    scenes = [draw.scene() for draw in drawn]
    assert scenes == [Draw(problem, SEED, number).scene() for number in range(20)] and len(set(scenes)) == 20
    assert len({draw.key for draw in drawn}) == 20
    for draw, scene in zip(drawn, scenes, strict=True):
        assert reach.cells[0] <= scene.cells <= reach.cells[1] and scene.cells % COARSEST == 0
        assert scene.particles * scene.steps <= reach.work and scene.time_step < scene.step_bound
        wide = coarser(scene, 2)
        assert wide.spacing == pytest.approx(2 * scene.spacing) and wide.time_step == pytest.approx(2 * scene.time_step)
        assert draw.point() == Draw(problem, SEED, draw.number).point()


def test_bars_of_numbers_that_converge():
    """f = 1 + c h^p on h, 2h, 4h has the error c h^p: of order 2 the bars are 3 times, 1.25 times and, where observed
    and formal order are the same, 2.45 - .85 = 1.6 times that."""
    second = [1 + 0.01 * h**2 for h in (1, 2, 4)]
    assert observed_order(second) == pytest.approx(2)
    assert [two_grids(second), three_grids(second), factor_of_safety(second)] == pytest.approx([0.03, 0.0125, 0.016])
    first = [1 + 0.01 * h for h in (1, 2, 4)]
    assert observed_order(first) == pytest.approx(1) and three_grids(first) == pytest.approx(1.25 * 0.01)
    assert factor_of_safety(first) == pytest.approx((2.45 - 0.85 / 2) * 0.01)
    third = [1 + 0.01 * h**3 for h in (1, 2, 4)]  # taken for the formal order: a wider bar
    assert three_grids(third) == pytest.approx(1.25 * 0.07 / 3)
    for none in ([1, 2, 1], [1, 1, 1], [1.0, 3.0, 4.0]):
        assert observed_order(none) is three_grids(none) is factor_of_safety(none) is None


def test_the_interval_of_a_share():
    """Wilson's for 95 of 100 at 95 % is 88.8 to 97.8 % (as textbooks have it)."""
    assert interval(95, 100) == pytest.approx((0.888, 0.978), abs=5e-4)
    assert interval(0, 10)[0] == 0 and interval(10, 10)[1] == pytest.approx(1)


@pytest.fixture(scope="module")
def rows():
    return [measure(Draw("bar", SEED, number)) for number in range(SHORT)]


def test_fifty_runs(rows):
    """Of other runs than those that assets/coverage.md counts. The companion's order is 8 or more, so that 1.1 is far;
    recovered was within it in 99 of 100: 45 of 50 or fewer would be 1 chance in 10,000. The GCI held 56 to 79 of 100
    numbers: with 50 runs and three numbers each, all of them would be a counter that does not count."""
    assert [fault(row) for row in rows] == [None] * SHORT
    assert [fault(json.loads(json.dumps(row, allow_nan=False))) for row in rows] == [None] * SHORT
    counted = tally("bar", SEED, rows)
    assert sum(counted["status"].values()) == SHORT and counted["status"][OK] >= 40
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
        assert low < high and ends["runs"] > 20
        outside = [row for row in rows if row["status"] == OK for name, said in row["estimators"].items()
                   if split is counted["estimators"][name] and not said["refused"] and said["end"]["x"] is not None
                   and not low <= said["end"]["x"] <= high]
        assert len(outside) == pytest.approx((1 - MIDDLE) * ends["runs"], abs=2)  # one to either side
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
        scene = Draw("bar", SEED, row["number"]).scene()
        assert name in scene.not_valid and row["goals"][ENERGY]["estimated_error"][name] is None
    counted = tally("bar", SEED, rows)["refusals"]["two-grid"]
    usable = [row for row in rows if row["status"] == OK]
    assert counted[BEFORE]["runs"] == sum(row["estimators"]["two-grid"]["refused"] == BEFORE for row in usable)
    assert 0 < counted[BEFORE]["needless"] < counted[BEFORE]["told"]


def test_what_cannot_run_is_not_run():
    """Recovered has no tables for a lattice that is not polar: asked all the same it would write beyond them."""
    draw = next(draw for number in range(100) if (draw := Draw("ring", SEED, number)).scene().layout == "cartesian")
    row = measure(draw)
    assert fault(row) is None and row["estimators"]["recovered"]["refused"] == IMPOSSIBLE
    assert set(row["estimators"]["recovered"]["index"].values()) == {None}


def test_the_command_keeps_its_rows(tmp_path, capsys):
    """A second call with more runs makes only those that are not there, and counts all. Rows are the same however many
    run side by side."""
    out = str(tmp_path / "coverage")
    assert dispatch(["coverage", "bar", "--runs", "2", "--seed", str(SEED), "--out", out]) == 0
    first = (Path(out) / "rows.jsonl").read_text()
    said = capsys.readouterr()
    assert all(words in said.err for words in ("2/2 run ", "run 0: ", "run 1: ")) and "| companion | x | " in said.out
    alone = str(tmp_path / "alone")
    assert dispatch(["coverage", "bar", "--runs", "2", "--seed", str(SEED), "--workers", "1", "--out", alone]) == 0
    assert "1/2 run 0: " in capsys.readouterr().err
    one, other = ({row["number"]: {**row, "seconds": 0} for row in map(json.loads, text.splitlines())}
                  for text in (first, (Path(alone) / "rows.jsonl").read_text()))
    assert one == other
    assert dispatch(["coverage", "bar", "--runs", "3", "--seed", str(SEED), "--resume", "--out", out]) == 0
    assert (Path(out) / "rows.jsonl").read_text().startswith(first)
    assert "2 of 3 rows are there already" in capsys.readouterr().err
    counted = json.loads((Path(out) / "coverage.json").read_text())
    assert counted["runs"] == 3 and (Path(out) / "coverage.png").stat().st_size > 10_000
    assert (Path(out) / "coverage.md").read_text() == summary(counted, "coverage.png")


@pytest.mark.parametrize("flags, says", [
    (["--runs", "0"], "--runs 0: give a whole number from 1 to 10,000"),
    (["--runs", "many"], "--runs many: give a whole number from 1 to 10,000"),
    (["--seed", "-1"], "--seed -1: give a whole number from 0 to 2,147,483,647"),
    ([], "--out")])
def test_bad_input(flags, says, tmp_path, capsys):
    out = ["--out", str(tmp_path / "new")] if flags else []
    assert dispatch(["coverage", "ring", *flags, *out]) == 2
    assert says in capsys.readouterr().err and not (tmp_path / "new").exists()


@pytest.mark.parametrize("problem", PROBLEMS)
def test_the_text_quotes_what_was_counted(problem):
    """Every table of assets/coverage.md is that of the counts beside it."""
    counted, text = track_record.counted(problem), (ROOT / "assets/coverage.md").read_text(encoding="utf-8")
    made = [block for block in summary(counted).split("\n\n") if block.startswith("|")]
    assert counted["runs"] == 1000 and len(made) == 6
    assert [table for table in made if table not in text] == []


def test_a_track_record_is_that_of_runs_alike():
    """By method and by how far particles move; none of a scene that no drawn one is like, or of a handful."""
    scene = BarScene(cells=40, ppc=4, amplitude=1e-3, method="bspline")
    assert regime(scene.motion_amplitude / scene.spacing, scene.ppc) == STAY
    split = track_record.counted("bar")["estimators"]["companion"]["method and regime"]["bspline"]
    assert track_record.right(scene, "companion") == (split[STAY]["x"]["within"]["1.1"], split[STAY]["x"]["runs"])
    assert track_record.right(replace(scene, amplitude=0.1), "companion") != track_record.right(scene, "companion")
    assert track_record.held(scene, ENERGY, "companion") is not None
    assert track_record.held(scene, "displacement@0.25", "companion") is not None
    for unlike in (replace(scene, remedies=("null-space-filter",)), BarScene(motion="patch"),
                   replace(scene, body_force="two-tone")):
        assert track_record.right(unlike, "companion") is None
    assert track_record.right(scene, "transport") is None  # it refuses all B-splines
    assert track_record.right(scene, "companion", "a") is None


def test_a_judge_bets_by_its_record_and_the_index_by_its_word():
    """The ratios of estimated to true error are turned round. Of normal errors of which the index holds 95 of 100, its
    bet holds 80, as many below as above: of 200,000 to four standard deviations, .0036."""
    low, high = track_record.middle("bar", "two-grid", "x")
    assert by_the_record("bar", "two-grid", "x", 3e-6) == (3e-6 / high, 3e-6 / low)
    assert by_the_record("bar", "two-grid", "x", None) is by_the_record("vortex", "transport", "x", 1.0) is None
    assert by_the_record("bar", "nobody", "x", 1.0) is by_the_record("bar", "two-grid", "a", 1.0) is None
    sizes = np.abs(np.random.default_rng(1).normal(size=200_000))
    least, most = by_its_word(NORMAL / TWO_GRIDS)  # so that a standard deviation is 1
    assert np.mean(sizes < least) == pytest.approx(0.1, abs=0.0036)
    assert np.mean(sizes > most) == pytest.approx(0.1, abs=0.0036)
    assert by_its_word(None) is None


def test_bets_on_a_run():
    """Whoever is not valid does not bet, but for the index, which is asked of every run."""
    scene = BarScene(cells=16, ppc=1, amplitude=0.05, periods=0.2, estimators=("companion",))
    said, result = bets(scene), run(scene, prices=False)
    assert set(said) == {"x", "v", "sigma"} and all(list(judged) == list(JUDGES) for judged in said.values())
    assert said["x"]["two-grid"] is None and said["x"]["GCI"] is not None
    low, high = said["x"]["companion"]
    assert low == pytest.approx(high, rel=1e-3) and low == pytest.approx(result.error["x"]["final"], rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("problem", PROBLEMS)
def test_the_thousand_runs_again(problem, tmp_path):
    """The command as assets/coverage.md gives it finds the counts that stand there."""
    out = tmp_path / "coverage"
    assert dispatch(["coverage", problem, "--runs", "1000", "--workers", "2", "--quiet", "--out", str(out)]) == 0
    again, kept = json.loads((out / "coverage.json").read_text()), track_record.counted(problem)
    assert again["status"] == kept["status"] and math.isclose(again["runs"], 1000)
    assert {name: split["all"]["x"] for name, split in again["estimators"].items()} \
        == {name: split["all"]["x"] for name, split in kept["estimators"].items()}
    assert [*again["goals"][ENERGY]["regime"]] == list(REGIMES)
