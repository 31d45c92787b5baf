"""The scripts of the lessons run, and what each shows is so."""

from __future__ import annotations

import itertools
import math
import os
import re
import runpy

import pytest

from app.cli import main
from tests.support.paths import ROOT
from tests.support.processes import run_python

SCRIPTS = ROOT / "lessons" / "scripts"
NUMBER = r"-?\d+(?:\.\d+)?(?:e[+-]\d+)?"


@pytest.fixture
def printed(tmp_path, monkeypatch, capsys):
    """What a script prints, run in this process in an empty directory."""
    monkeypatch.chdir(tmp_path)

    def run(name: str) -> str:
        runpy.run_path(str(SCRIPTS / f"{name}.py"), run_name="__main__")
        return capsys.readouterr().out

    return run


def numbers(text: str) -> list[float]:
    return [float(word) for word in re.findall(NUMBER, text)]


def test_every_script_is_tested_and_short():
    tests = "".join(globals())
    for path in SCRIPTS.glob("*.py"):
        assert f"test_{path.stem}_" in tests, path.name
        code = path.read_text().split('"""\n', 2)[-1]
        assert len(list(filter(str.strip, code.splitlines()))) <= 30, path.name
        assert f"uv run python lessons/scripts/{path.name}" in path.read_text()


def test_order_of_splines_is_two(printed):
    """Of second order in h and of first in dt, which goes with h but is small: 0.15 holds both sides."""
    orders = [numbers(line)[-1] for line in printed("order").splitlines()[2:]]
    assert len(orders) == 2 and orders == pytest.approx([2, 2], abs=0.15)


def test_own_estimator_is_right_in_order(tmp_path):
    """An index that h does not change is that of an estimate of the same order as the error; its size, 1.9, is not 1,
    for the error of a run is more than that of one interpolation. In a process of its own: it must come first."""
    done = run_python(str(SCRIPTS / "own_estimator.py"), cwd=tmp_path)
    index = [numbers(line)[-1] for line in done.stdout.splitlines() if "index of bend" in line]
    assert len(index) == 3, done.stderr
    assert max(index) < 1.05 * min(index) and 1 < min(index) < max(index) < 3


#: What commands make of the problem from outside, in one process that is told of it.
COMMANDS = """
from app.cli import main
from app.problems.views import VIEWS
assert main(["sweep", "breathing", "--cells", "8", "--cfl", "0.2", "--repeats", "1", "--out", "sweep"]) == 0
assert main(["problem", "breathing", "--cells", "8", "--out", "files"]) == 0
assert main(["judge", "breathing", "files/exact.csv", "--cells", "8", "--out", "judged", "--quiet"]) in (0, 3)
assert VIEWS["breathing"].suggestions(None) and len(VIEWS["breathing"].prices) == 0
assert VIEWS["square"].formula and VIEWS["breathing"].formula is None  # which has no displacement to type
"""


def test_own_problem_is_of_second_order_and_known_everywhere(tmp_path):
    """By itself as a script; and where it is named as an extension to every command and to the page."""
    path = SCRIPTS / "own_problem.py"
    assert len(path.read_text().splitlines()) <= 60
    done = run_python(str(path), cwd=tmp_path)
    rows = [numbers(line) for line in done.stdout.splitlines()]
    assert len(rows) == 3, done.stderr
    errors, indices = [row[1] for row in rows], [row[2] for row in rows]
    assert indices == pytest.approx([1, 1, 1], abs=0.01)
    assert [math.log2(coarse / fine) for coarse, fine in itertools.pairwise(errors)] == pytest.approx([2, 2], abs=0.15)
    told = {"PYTHONPATH": os.pathsep.join((str(ROOT), str(SCRIPTS))), "MPM_LAB_EXTENSIONS": "own_problem"}
    done = run_python("-c", COMMANDS, cwd=tmp_path, **told)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "sweep" / "table.csv").exists()
    assert (tmp_path / "judged" / "report.md").exists()


def test_sweep_shows_what_crossings_cost(printed, tmp_path):
    """Up to A = h/8 no particle crosses a cell; splines have no kink that would tell."""
    found = {line.split()[0]: numbers(line.partition(":")[2]) for line in printed("sweep").splitlines()
             if "over A" in line}
    hats, splines = found["mpm"], found["bspline"]
    assert max(splines) < 1.3 * min(splines)
    assert hats[1] < 2 * hats[0] and min(hats[3:]) > 10 * hats[0]
    assert (tmp_path / "sweep.png").read_bytes().startswith(b"\x89PNG")


def test_judge_finds_the_order_of_differences(printed):
    """Central differences are of order 2; their error is that of their frequency, which theory gives exactly."""
    *grids, order = printed("judge").splitlines()
    assert numbers(order)[-1] == pytest.approx(2, abs=0.05)
    A, c, end = 0.025, 2.0, 0.2
    w = math.pi * c
    for line in grids:
        points, true, estimated = numbers(line)
        own = 2 * c * points * math.sin(math.pi / points)  # the frequency of a free wave of the differences
        driven = 3 * w**2 * A / (own**2 - w**2)  # and what the force, and the start, make of it
        u = driven * math.sin(w * end) + (A - driven) * w / own * math.sin(own * end)
        time_too = 0.3  # of the error may be that of the time step, half of the longest
        assert true == pytest.approx(abs(u - A * math.sin(w * end)) / math.sqrt(2), rel=time_too)
        assert estimated == pytest.approx(true, rel=0.01)


def test_remedies_keep_a_run_right(printed):
    """Measured: 0.4 periods without and 500 with them (assets/stability.md)."""
    plain, mended = printed("remedies").splitlines()
    assert "for all 5 periods" in mended and numbers(mended)[-1] < 0.1
    assert numbers(plain.partition("right for")[2])[0] < 1


def test_ring_with_cpdi_is_judged_well(printed, tmp_path):
    """On 24 cells CPDI's error is 1 % of A, and the companion's index 1.00 (assets/estimates.md)."""
    text = printed("ring")
    assert "ok: 800 steps" in text and (tmp_path / "ring.png").exists()
    true, estimated = (numbers(line)[1] for line in text.splitlines() if line.startswith("x (m)"))
    assert true < 0.02 * 0.1 and estimated == pytest.approx(true, rel=0.02)


def test_bar_is_judged_well(printed, tmp_path):
    """The companion's index of the bar is 1.00 (assets/estimates.md)."""
    true, estimated = (numbers(line)[1] for line in printed("bar").splitlines() if line.startswith("x (m)"))
    assert estimated == pytest.approx(true, rel=0.02) and (tmp_path / "bar.png").exists()


def test_scripts_and_notebooks_are_copied_as_they_are(tmp_path):
    assert main(["lesson", "scripts", "--out", str(tmp_path / "new")]) == 0
    there = {path.name: path.read_bytes() for path in (tmp_path / "new").iterdir()}
    assert {"bar.py", "own_estimator.py", "taichi_mpm99_bar.py", "crossing.py"} <= there.keys()
    assert there["bar.py"] == (ROOT / "lessons" / "scripts" / "bar.py").read_bytes()
    assert main(["lesson", "scripts", "--out", str(tmp_path / "new")]) == 2 and main(["lesson", "scripts"]) == 2
