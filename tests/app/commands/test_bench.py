"""The bench: what it measures is there and makes sense, the stripped steps are the solvers' own, nothing is hidden."""

from __future__ import annotations

import json
import math
import os
import signal
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from app.cli import main
from app.commands.bench.text import bench_table
from solvers.bench import example, start
from solvers.bench.measure import QUICK, bare, priced
from solvers.problems import PROBLEMS
from solvers.problems.bar.scene import BarScene
from solvers.problems.ring.scene import RingScene
from solvers.running.run import build
from solvers.running.timing import Stretch, rate, take_turns
from solvers.workers.processes import ProcessDied, ask_fresh
from tests.paths import ROOT
from tests.processes import HANG, wait_for_library

#: What an effect that is off may cost in a quick run beside other work; the bench itself, at rest, shows 0 to 3 %.
TOLERANCE = 0.15


@pytest.fixture(scope="module", params=[("bar",), pytest.param(tuple(PROBLEMS), marks=pytest.mark.slow)], ids="-".join)
def problems(request) -> tuple[str, ...]:
    """Those that are measured: all take a minute."""
    return request.param


@pytest.fixture(scope="module")
def printed(problems) -> dict:
    """The JSON object of a quick bench; that standard output holds it and nothing else."""
    code = "import sys; from solvers.bench import bench; from app.cli import main; " \
        f"bench.PROBLEMS = {{name: bench.PROBLEMS[name] for name in {problems}}}; " \
        "sys.exit(main(['bench', '--quick', '--json', '-']))"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, timeout=HANG)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.count("\n") == 1
    return json.loads(done.stdout, parse_constant=lambda name: pytest.fail(f"{name} is not JSON"))


def test_json_says_what_it_is(printed):
    assert printed["schema"] == "mpm-lab/bench/1" and printed["quick"] is True
    assert {"machine", "arch", "precision", "threads", "unit", "rates", "estimators", "effects", "off", "start",
            "example", "seconds"} < set(printed)
    assert {"system", "processor", "cores", "load", "python", "taichi"} == set(printed["machine"])
    assert (printed["precision"], printed["threads"]) == ("double", 1)


def test_every_problem_method_and_size_has_a_rate(printed, problems):
    wanted = {(problem, method, cells) for problem, scene in ((name, PROBLEMS[name].scene) for name in problems)
              for method in scene.choices("method") for cells in QUICK.cells[PROBLEMS[problem].scene.DIMENSIONS]}
    rows = {(row["problem"], row["method"], row["cells"]): row for row in printed["rates"]}
    assert set(rows) == wanted and len(printed["rates"]) == len(wanted)
    assert all(row["rate"] > 0 and row["particles"] > 0 for row in rows.values())


def test_every_estimator_and_effect_has_a_price(printed, problems):
    estimators = {(row["problem"], row["name"]): row for row in printed["estimators"]}
    assert set(estimators) == {(problem, name) for problem in problems for name in PROBLEMS[problem].estimators}
    for row in estimators.values():
        assert row["not_valid"] or 0.8 < row["ratio"] < 20
    effects = {(row["problem"], row["name"]): row["ratio"] for row in printed["effects"]}
    assert set(effects) == {(problem, name) for problem in problems for name in priced(PROBLEMS[problem].scene)}
    assert all(0.5 < ratio < 20 for ratio in effects.values())


def test_an_effect_that_is_off_costs_next_to_nothing(printed, problems):
    assert [row["problem"] for row in printed["off"]] == list(problems)
    for row in printed["off"]:
        assert row["ratio"] == pytest.approx(1, abs=TOLERANCE)
        assert 0 < row["low"] <= row["high"] and row["same"] > 0
        assert 0 < row["call"] < 0.1 and 0 < row["call_stripped"] < 0.1


def test_start_and_compile_times(printed, problems):
    start = printed["start"]
    assert start["failed"] is None
    assert all(start[name] > 0 for name in ("command", "import", "taichi"))
    assert set(start["cold"]) == set(start["warm"]) == set(problems)
    assert all(0 < start["warm"][problem] < start["cold"][problem] for problem in problems)


def test_the_public_example_runs_and_is_said_to_be_another_thing(printed):
    row = printed["example"]
    assert (row["name"], row["precision"], row["missing"]) == ("mpm99", "single", None)
    assert row["particles"] == 9000 and row["rate"] > 0 and "MLS-MPM" in row["method"]


def test_table_has_every_part(printed):
    table = bench_table(printed)
    for words in ("million particle-steps per second", "price of an estimator", "price of an effect",
                  "an effect that is off", "start, seconds", "cold", "single precision", "not a rival"):
        assert words in table
    assert max(len(line) for line in table.splitlines() if "not valid" not in line) <= 120


def test_table_says_in_words_what_is_missing(printed):
    nothing = {name: None for name in printed["start"]} | {"failed": "ended with status 1"}
    unstable = [{**printed["rates"][0], "rate": None}]
    refused = [{**printed["estimators"][0], "ratio": None, "not_valid": "not valid here: a reason"}]
    table = bench_table({**printed, "start": nothing, "rates": unstable, "estimators": refused,
                         "machine": {**printed["machine"], "load": None},
                         "example": {**printed["example"], "missing": "comes without it"}})
    for words in ("could not be measured: ended with status 1", "unstable", "not valid here: a reason",
                  "mpm99: comes without it"):
        assert words in table


def test_a_missing_example_is_said(monkeypatch, tmp_path):
    monkeypatch.setattr(example, "NAME", "no_such_example")
    row = example.example()
    assert row["rate"] is None and "without this example" in row["missing"]


def test_an_example_that_fails_is_said(monkeypatch):
    monkeypatch.setattr(example, "WORK", "solvers.no_such_module:measure")
    row = example.example()
    assert row["rate"] is None and "could not be run" in row["missing"] and "no_such_module" in row["missing"]


def test_a_process_that_fails_or_hangs_is_one_line(monkeypatch):
    with pytest.raises(ProcessDied, match="status 3"):
        start.seconds([sys.executable, "-c", "raise SystemExit(3)"])
    monkeypatch.setattr(start, "PATIENCE", 0.2)
    with pytest.raises(ProcessDied, match="timed out"):
        start.seconds([sys.executable, "-c", "import time; time.sleep(60)"])
    with pytest.raises(ProcessDied, match="no answer within"):
        ask_fresh("solvers.bench.start:measure", patience=0.2)


@pytest.mark.parametrize("problem", PROBLEMS)
def test_the_stripped_step_is_the_solvers_own(problem):
    scene = bare(problem, 16)
    solvers = [kind(scene) for kind in (PROBLEMS[problem].solver, PROBLEMS[problem].baseline)]
    for solver in solvers:
        solver.advance(200)
    ours, stripped = (solver.snapshot() for solver in solvers)
    for name in ("position", "velocity", "deformation_gradient"):
        np.testing.assert_allclose(getattr(stripped, name), getattr(ours, name), rtol=1e-12, atol=1e-15)
    assert not np.array_equal(ours.position, ours.material_position)


@pytest.mark.parametrize("problem", PROBLEMS)
def test_bare_scenes_hold_nothing_optional(problem):
    scene = bare(problem, 16)
    assert not any(scene.has(effect) for effect in ("truth", "estimate", "crossings", "energy", "acceleration"))
    assert scene.method == PROBLEMS[problem].scene.method


def test_a_stretch_is_whole_rounds_and_leaves_the_state_as_it_was():
    scene = replace(bare("bar", 8), effects=("estimate",), estimators=("companion",))
    stretch = Stretch(build(scene), 1e-3)
    assert stretch.steps % scene.sample_interval == 0 and stretch.steps % scene.estimate_interval == 0
    stretch.time()
    once = stretch.solver.snapshot().position
    stretch.time()
    assert np.array_equal(once, stretch.solver.snapshot().position)
    assert take_turns([stretch, stretch], 3).shape == (3, 2)


def test_what_is_compared_takes_the_same_steps():
    """From the same step on, and whole rounds of looks at the margin, which cost as much as some ten steps: a stretch
    with one more of them than the other would make an estimator of a few per cent cost half of the run."""
    scene = RingScene(cells=24, method="ugimp", dt=2e-5, estimators=("companion",))
    solver = build(scene)
    solver.advance(scene.margin_interval + 1)
    stretch = Stretch(solver, 1e-3)
    bare = Stretch(solver.without_estimators(), steps=stretch.steps)
    assert solver.step == bare.solver.step == scene.margin_interval + 1
    assert bare.steps == stretch.steps and stretch.steps % scene.margin_interval == 0
    assert stretch.steps % bare.solver.scene.margin_interval == 0


def test_a_run_that_goes_bad_has_no_rate():
    assert math.isnan(rate(build(BarScene(cells=8, cfl=1.5, effects=(), estimators=())), 2))


@pytest.mark.parametrize(("flags", "names"), [
    (["--json", "no/such/directory/x.json"], "--json no/such/directory/x.json:"),
    (["--json"], "--json (no value):"),
    (["--cells", "4"], "--cells: is not a flag of mpm-lab bench"),
    (["quick"], "quick: is not expected"),
])
def test_bad_input_is_one_line(flags, names, capsys, monkeypatch):
    monkeypatch.setattr("solvers.bench.bench.bench", lambda *_: pytest.fail("it ran before it had checked"))
    assert main(["bench", *flags]) == 2
    seen = capsys.readouterr()
    assert seen.out == "" and seen.err.count("\n") == 1 and seen.err.startswith(f"mpm-lab: {names}")


def test_help_and_bad_input_import_nothing_heavy():
    code = "import sys; from app.cli import main; main(['bench', '--help']); sys.exit('taichi' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, timeout=HANG).returncode == 0


@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
def test_interrupt_is_one_line_and_130(tmp_path):
    path = tmp_path / "a.json"
    run = subprocess.Popen([sys.executable, "-m", "app", "bench", "--json", str(path)], cwd=ROOT,
                           stderr=subprocess.PIPE, text=True)
    wait_for_library(run, "taichi")
    run.send_signal(signal.SIGINT)
    _, said = run.communicate(timeout=HANG)
    assert (run.returncode, said) == (130, "mpm-lab: interrupted\n")
    assert list(tmp_path.iterdir()) == []
