"""The bench: it measures all that there is, the stripped steps and the C++ do the work, what is missing is said."""

from __future__ import annotations

import json
import math
import os
import sys
from dataclasses import replace

import numpy as np
import pytest

from app.cli import main
from app.commands.bench.command import bench_table
from solvers.bench import all_benchmarks, cpp_reference, solver_benchmarks, start_up
from solvers.bench.solver_benchmarks import QUICK, bare_scene, optional_part_inputs
from solvers.kernels import runtime
from solvers.problems import PROBLEMS
from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.running import repeated_step_timing
from solvers.running.repeated_step_timing import RepeatedSteps, particle_step_rate, time_interleaved
from solvers.running.run import build
from solvers.workers.worker_process import ProcessDied, ask_fresh

#: What an effect that is off may cost in a quick run beside other work; the bench itself, at rest, shows 0 to 3 %.
TOLERANCE = 0.15
CASE = {"method": "ugimp", "cells": 160, "particles": 640, "ratio": 0.84, "low": 0.83, "high": 0.85, "rate": 110.0,
        "limit": 131.0, "seconds": 5.8e-6}


def object_of(capsys) -> dict:
    """The JSON object of a quick bench; that standard output holds it and nothing else."""
    assert main(["bench", "--quick", "--json", "-"]) == 0
    said = capsys.readouterr()
    assert said.err == "" and said.out.count("\n") == 1
    return json.loads(said.out, parse_constant=lambda name: pytest.fail(f"{name} is not JSON"))


@pytest.fixture
def printed(monkeypatch, capsys) -> dict:
    """A bench of everything in which nothing is compiled: each step takes a microsecond."""
    runtime.start()
    monkeypatch.setattr(all_benchmarks, "start_times", lambda command, problems: {
        "command": 0.4, "import": 1.0, "taichi": 0.3, "failed": None,
        "cold": dict.fromkeys(problems, 2.0), "warm": dict.fromkeys(problems, 0.5)})
    monkeypatch.setattr(all_benchmarks, "measure_gpu", lambda quick: {"missing": "no GPU was found"})
    monkeypatch.setattr(all_benchmarks, "measure_ratios", lambda problem, quick: {
        "problem": problem, "missing": None, "cases": [CASE]})
    monkeypatch.setattr(solver_benchmarks, "build", lambda scene: scene)
    monkeypatch.setattr(solver_benchmarks, "particle_step_rate", lambda scene, turns: 100.0)
    monkeypatch.setattr(solver_benchmarks, "time_ratios", lambda pairs, turns: dict.fromkeys(pairs, 1.0))
    monkeypatch.setattr(solver_benchmarks, "measure_inactive_overhead", lambda problem, effort: {
        "problem": problem, "method": "ugimp", "cells": 40, "ratio": 1.01, "low": 1.0, "high": 1.02, "same": 1.0,
        "call": 1e-4, "call_stripped": 1e-4})
    return object_of(capsys)


def test_json_says_what_it_is(printed):
    assert printed["schema"] == "mpm-lab/bench/1" and printed["quick"] is True
    assert {"machine", "arch", "precision", "threads", "unit", "rates", "estimators", "effects", "off", "limit", "gpu",
            "start", "seconds"} < set(printed)
    assert {"system", "processor", "cores", "load", "python", "taichi"} == set(printed["machine"])
    assert (printed["precision"], printed["threads"]) == ("double", 1)


def test_every_problem_method_and_size_has_a_rate_and_all_that_is_optional_a_price(printed):
    wanted = {(problem, method, cells) for problem, scene in ((name, PROBLEMS[name].scene) for name in PROBLEMS)
              for method in scene.choices("method") for cells in QUICK.cells[PROBLEMS[problem].scene.DIMENSIONS]}
    rows = {(row["problem"], row["method"], row["cells"]): row for row in printed["rates"]}
    assert set(rows) == wanted and len(printed["rates"]) == len(wanted)
    estimators = {(row["problem"], row["name"]): row for row in printed["estimators"]}
    assert set(estimators) == {(problem, name) for problem in PROBLEMS for name in PROBLEMS[problem].estimators}
    assert all(row["not_valid"] or row["ratio"] == 1 for row in estimators.values())
    effects = {(row["problem"], row["name"]): row["ratio"] for row in printed["effects"]}
    assert set(effects) == {(problem,
                             name) for problem in PROBLEMS for name in optional_part_inputs(PROBLEMS[problem].scene)}
    assert set(effects.values()) == {1.0}
    assert [row["problem"] for row in printed["off"]] == list(PROBLEMS)


def test_a_ratio_is_the_median_over_turns_and_each_scene_is_measured_once(monkeypatch):
    runtime.start()
    measured = []
    monkeypatch.setattr(repeated_step_timing, "RepeatedSteps", lambda solver: solver.scene)
    monkeypatch.setattr(repeated_step_timing, "time_interleaved",
                        lambda scenes, turns: measured.append((scenes, turns)) or np.array([[2.0, 1.0], [6.0, 2.0],
                                                                                            [5.0, 1.0]]))
    one, other = BarScene(cells=8), BarScene(cells=16)
    assert repeated_step_timing.time_ratios({"dear": (one, other), "same": (other, other)},
                                            3) == {"dear": 3.0, "same": 1.0}
    assert measured == [([one, other], 3)] and repeated_step_timing.time_ratios({}, 3) == {}


def test_table_has_every_part(printed):
    table = bench_table(printed)
    for words in ("million particle-steps per second", "price of an estimator", "price of an effect",
                  "an effect that is off", "hand-written C++", "0.840", "start, seconds", "cold"):
        assert words in table
    assert max(len(line) for line in table.splitlines() if "not valid" not in line) <= 120


def test_table_says_in_words_what_is_missing(printed):
    nothing = {name: None for name in printed["start"]} | {"failed": "ended with status 1"}
    unstable = [{**printed["rates"][0], "rate": None}]
    refused = [{**printed["estimators"][0], "ratio": None, "not_valid": "not valid here: a reason"}]
    table = bench_table({**printed, "start": nothing, "rates": unstable, "estimators": refused,
                         "machine": {**printed["machine"], "load": None},
                         "limit": [{"problem": "bar", "missing": "there is no C++ compiler", "cases": []}]})
    for words in ("could not be measured: ended with status 1", "unstable", "not valid here: a reason",
                  "bar: there is no C++ compiler"):
        assert words in table


@pytest.mark.slow
def test_what_is_measured_makes_sense(monkeypatch, capsys):
    """Of the bar alone: all problems take a minute."""
    monkeypatch.setattr(all_benchmarks, "PROBLEMS", {"bar": PROBLEMS["bar"]})
    found = object_of(capsys)
    assert all(row["rate"] > 0 and row["particles"] > 0 for row in found["rates"])
    assert all(row["not_valid"] or 0.8 < row["ratio"] < 20 for row in found["estimators"])
    assert all(0.5 < row["ratio"] < 20 for row in found["effects"])
    [off] = found["off"]
    assert off["ratio"] == pytest.approx(1, abs=TOLERANCE)
    assert 0 < off["low"] <= off["high"] and off["same"] > 0
    assert 0 < off["call"] < 0.1 and 0 < off["call_stripped"] < 0.1
    times = found["start"]
    assert times["failed"] is None and all(times[name] > 0 for name in ("command", "import", "taichi"))
    assert 0 < times["warm"]["bar"] < times["cold"]["bar"]


@pytest.fixture(scope="module")
def bar(tmp_path_factory) -> cpp_reference.CppProgram:
    try:
        return cpp_reference.CppProgram("bar", tmp_path_factory.mktemp("limit"))
    except cpp_reference.CppMissing as why:
        return (pytest.fail if os.environ.get("CI") else pytest.skip)(f"{why}: with one this test runs")


def test_the_limit_does_the_work(bar):
    """It is fast because it is written so, not because it leaves something out."""
    (rate, coarse), (_, fine) = bar.run(80, 20_000), bar.run(160, 20_000)
    assert rate > 1 and 0 < fine < 0.01 and 1.8 < math.log2(coarse / fine) < 2.2  # uGIMP is of second order


def test_our_rate_over_the_limits(bar, monkeypatch):
    """One method, one turn, and C++ that is compiled."""
    monkeypatch.setattr(cpp_reference, "QUICK_TURNS", 1)
    monkeypatch.setattr(cpp_reference, "SECONDS", 0.01)
    monkeypatch.setattr(cpp_reference, "comparison_cases",
                        lambda problem: [cpp_reference.ComparisonCase("ugimp", 16, (16, 2000))])
    monkeypatch.setattr(cpp_reference, "CppProgram", lambda problem, folder: bar)
    found = cpp_reference.measure_ratios("bar", quick=True)
    [case] = found["cases"]
    assert found["missing"] is None and case["seconds"] > 0
    assert case["low"] == case["ratio"] == case["high"] == pytest.approx(case["rate"] / case["limit"])


def test_what_is_missing_or_fails_is_said(monkeypatch):
    monkeypatch.setenv("CXX", "no-such-compiler")
    found = cpp_reference.measure_ratios("bar", quick=True)
    assert found["cases"] == [] and "no C++ compiler (no-such-compiler)" in found["missing"]


def test_a_process_that_fails_or_hangs_is_one_line(monkeypatch):
    with pytest.raises(ProcessDied, match="status 3"):
        start_up.time_command([sys.executable, "-c", "raise SystemExit(3)"])
    monkeypatch.setattr(start_up, "PATIENCE", 0.2)
    with pytest.raises(ProcessDied, match="timed out"):
        start_up.time_command([sys.executable, "-c", "import time; time.sleep(60)"])
    with pytest.raises(ProcessDied, match="no answer within"):
        ask_fresh("solvers.bench.start_up:measure_own_start", patience=0.2)


@pytest.mark.parametrize("problem", PROBLEMS)
def test_the_stripped_step_is_the_solvers_own_and_bare_scenes_hold_nothing_optional(problem):
    scene = bare_scene(problem, 16)
    assert scene.method == PROBLEMS[problem].scene.method
    assert not any(scene.has(effect) for effect in ("truth", "estimate", "crossings", "energy", "acceleration"))
    solvers = [kind(scene) for kind in (PROBLEMS[problem].solver, PROBLEMS[problem].baseline)]
    for solver in solvers:
        solver.advance(200)
    ours, stripped = (solver.snapshot() for solver in solvers)
    for name in ("position", "velocity", "deformation_gradient"):
        np.testing.assert_allclose(getattr(stripped, name), getattr(ours, name), rtol=1e-12, atol=1e-15)
    assert not np.array_equal(ours.position, ours.material_position)


def test_a_stretch_is_whole_rounds_and_leaves_the_state_as_it_was():
    scene = replace(bare_scene("bar", 8), effects=("estimate",), estimators=("companion",))
    stretch = RepeatedSteps(build(scene), 1e-3)
    assert stretch.steps % scene.sample_interval == 0 and stretch.steps % scene.estimate_interval == 0
    stretch.seconds_per_step()
    once = stretch.solver.snapshot().position
    stretch.seconds_per_step()
    assert np.array_equal(once, stretch.solver.snapshot().position)
    assert time_interleaved([stretch, stretch], 3).shape == (3, 2)


def test_what_is_compared_takes_the_same_steps():
    """From the same step on, and whole rounds of looks at the margin, which cost as much as some ten steps: a stretch
    with one more of them than the other would make an estimator of a few per cent cost half of the run."""
    scene = RingScene(cells=24, method="ugimp", dt=2e-5, estimators=("companion",))
    solver = build(scene)
    solver.advance(scene.margin_interval + 1)
    stretch = RepeatedSteps(solver, 1e-3)
    bare = RepeatedSteps(solver.without_estimators(), steps=stretch.steps)
    assert solver.step == bare.solver.step == scene.margin_interval + 1
    assert bare.steps == stretch.steps and stretch.steps % scene.margin_interval == 0
    assert stretch.steps % bare.solver.scene.margin_interval == 0


def test_a_run_that_goes_bad_has_no_rate():
    assert math.isnan(particle_step_rate(build(BarScene(cells=8, cfl=1.5, effects=(), estimators=())), 2))
