"""An estimator and an effect that one problem alone has, each registered once, from outside (``tests/outside.py``).

All that knows effects and estimators must take them as its own, and the other problems must run as before. In a process
of its own, because this one has compiled its solvers without them.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys

import pytest

from solvers.scene.extensions import EXTENSIONS
from tests.paths import ROOT
from tests.processes import HANG

CODE = """
import json
from app.commands.run.text import run_table
from app.lessons import claims
from app.page.panels.readout import _found
from solvers import run, sweep
from solvers.problems import PROBLEMS
from solvers.scene.effects import told

found = {}
for name, problem in PROBLEMS.items():
    scene = problem.scene(cells=16, ppc=2, periods=0.02, estimators=problem.estimators[-1:],
                          effects=problem.scene.choices("effects"))
    result = run(scene)
    values = json.loads(json.dumps(result.to_dict()))
    line = told(lambda effect: effect.readout)["strain"]
    found[name] = {"offered": [problem.estimators, scene.choices("effects")], "result": values,
                   "asked": result.strain,
                   "text": run_table(values), "readout": _found("strain", line, result.series) if name == "bar" else "",
                   "seen": max(abs(result.final.deformation_gradient.ravel() - 1)) if name == "bar" else 0.0}
scope = claims.Scope({"it": claims.Outcome([found["bar"]["result"]])}, "it")
found["claims"] = [claims.decide(text, scope).holds for text in ("strain.largest > 0", "strain.samples < 0")]
found["row"] = sweep("bar", cells=16, ppc=2, periods=0.02, effects=["strain"], estimators=[], repeats=0)[0]
print(json.dumps(found))
"""


@pytest.fixture(scope="module")
def found() -> dict:
    done = subprocess.run([sys.executable, "-c", CODE], cwd=ROOT, capture_output=True, text=True, timeout=HANG,
                          env={**os.environ, EXTENSIONS: "tests.outside"})
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def test_only_the_problem_that_it_is_for_has_it(found):
    assert ["loud" in found[name]["offered"][0] for name in ("bar", "ring", "vortex")] == [False, True, False]
    assert ["strain" in found[name]["offered"][1] for name in ("bar", "ring", "vortex")] == [True, False, False]


def test_a_naive_estimator_loses_no_run(found):
    """It puts the error of x at many amplitudes, and the truth knows better."""
    ring = found["ring"]["result"]
    assert ring["scene"]["estimator"] == ["loud"] and ring["estimate"]["x"]["max"] == 1.0 and ring["index"]["x"] > 1e3
    assert {found[name]["result"]["status"] for name in ("bar", "ring", "vortex")} == {"ok"}


def test_a_number_declared_once_is_told_everywhere(found):
    """JSON, text, the page's readout, rows of a sweep and claims of lessons."""
    bar, largest = found["bar"], found["bar"]["result"]["strain"]["largest"]
    assert 0 < largest == pytest.approx(bar["seen"]) and bar["result"]["strain"]["samples"] >= 2
    assert found["ring"]["result"]["strain"] is found["vortex"]["result"]["strain"] is None
    assert {name: found[name]["asked"] for name in found if "asked" in found[name]} == {
        name: found[name]["result"]["strain"] for name in ("bar", "ring", "vortex")}
    line = f"largest {largest:.4g}, samples {bar['result']['strain']['samples']}"
    assert f"largest strain  {line}\n" in bar["text"] and "strain" not in found["ring"]["text"]
    assert bar["readout"] == f"largest {largest:.3g}, samples {bar['result']['strain']['samples']}"
    assert found["row"]["strain.largest"] == pytest.approx(largest) and found["claims"] == [True, False]
