"""``mpm-lab run ring``: what differs from the bar in its flags, its JSON object, its warnings and its table."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import fields

import pytest

from app.cli import main
from app.commands import commands
from app.commands.run.command import Output
from app.commands.run.text import run_table
from solvers.problems.ring.scene import RingScene
from tests.paths import ROOT
from tests.processes import HANG

RunBar, RunRing = commands()["run", "bar"], commands()["run", "ring"]

QUICK = ["--cells", "12", "--periods", "0.1"]
QUANTITIES = {"x", "v", "sigma", "a"}
NOTHING = {"final": None, "max": None, "mean": None}


def ring(*flags: str) -> subprocess.CompletedProcess:
    """Run ``python -m app run ring`` as a person would."""
    return subprocess.run([sys.executable, "-m", "app", "run", "ring", *flags], cwd=ROOT, capture_output=True,
                          text=True, timeout=HANG)


@pytest.fixture(scope="module")
def printed() -> dict:
    """The JSON object of a quick run; that standard output holds it and nothing else."""
    done = ring(*QUICK, "--json", "-")
    assert (done.returncode, done.stderr, done.stdout.count("\n")) == (0, "", 1)
    return json.loads(done.stdout, parse_constant=lambda name: pytest.fail(f"{name} is not JSON"))


def test_json_has_exactly_the_contracts_keys(printed):
    assert set(printed) == {"schema", "scene", "status", "reason", "t", "steps", "particles", "error", "estimate",
                            "index", "distance", "grid_crossings", "energy", "angular_momentum", "budget",
                            "effects", "bytes", "seconds", "rate", "arch", "threads", "plan", "not_valid", "goals",
                            "soundness", "step", "life", "checked", "not_checked", "as_large_as_itself", "rounding"}
    assert (printed["schema"], printed["status"], printed["plan"]) == ("mpm-lab/run/1", "ok", "serial")
    assert set(printed["seconds"]) == {"setup", "compile", "run", "estimate", "estimators"}


def test_json_scene_has_every_flag_with_its_default(printed):
    flags = {field.name for field in fields(RunRing)} - {field.name for field in fields(Output)}
    assert set(printed["scene"]) == flags | {"problem"}
    assert None not in printed["scene"].values()
    assert printed["scene"]["problem"] == "ring"
    assert (printed["scene"]["method"], printed["scene"]["layout"], printed["scene"]["plan"]) \
        == ("cpdi", "polar", "auto")


def test_json_errors_have_the_rings_own(printed):
    assert set(printed["error"]) == QUANTITIES | {"a_nodes"}
    for values in printed["error"].values():
        assert 0 < values["mean"] <= values["max"] and values["final"] <= values["max"]


def test_json_says_nothing_about_what_is_not_estimated(printed):
    assert set(printed["estimate"]) == set(printed["index"]) == set(printed["distance"]) == QUANTITIES
    assert printed["estimate"]["sigma"] == NOTHING
    assert printed["index"]["sigma"] is None and printed["distance"]["sigma"] is None
    for quantity in QUANTITIES - {"sigma"}:
        assert printed["estimate"][quantity]["max"] > 0
        assert printed["index"][quantity] > 0 and printed["distance"][quantity] > 0


def test_table_has_units_and_a_dash_for_what_is_not_estimated(printed):
    lines = run_table(printed).splitlines()
    assert lines[0].startswith("ring, cpdi, 12 cells, 2 × 2 particles per cell")
    assert any(line.startswith("a_nodes (m/s²) ") for line in lines)
    assert [line.split()[2:] for line in lines if line.startswith("sigma (Pa)")][1] == ["-"] * 5
    assert "serial plan" in lines[-1]


def test_flags_left_out_are_the_scenes_defaults():
    assert RunRing().scene() == RingScene()


def test_flags_reach_the_scene(monkeypatch):
    seen = []
    monkeypatch.setattr(RunRing, "execute", lambda self: seen.append(self.scene()) or 0)
    assert main(["run", "ring", "--method", "ugimp", "--cells", "16", "--ppc", "3", "--amplitude", "0.05",
                 "--modulus", "1e6", "--density", "900", "--cfl", "0.1", "--t-end", "0.01", "--body-force", "none",
                 "--velocity", "particle", "--layout", "cartesian", "--plan", "parallel", "--estimator", "none",
                 "--effects", "truth", "--threads", "2", "--sample-every", "7"]) == 0
    assert seen == [RingScene(method="ugimp", cells=16, ppc=3, amplitude=0.05, modulus=1e6,
                              density=900.0, cfl=0.1, t_end=0.01, body_force="none", velocity="particle",
                              layout="cartesian", plan="parallel", estimators=(), effects=("truth",), threads=2,
                              sample_every=7)]


BAD = [
    (["--amplitude", "0.386"], "--amplitude 0.386:", "turns inside out"),
    (["--amplitude", "0"], "--amplitude 0:", "below 0.386"),
    (["--cells", "7"], "--cells 7:", "from 8 to"),
    (["--cells", "20000", "--ppc", "1"], "--", "at most"),
    (["--ppc", "7"], "--ppc 7:", "from 1 to 6"),
    (["--method", "bspline"], "--method bspline:", "ugimp, cpgimp, cpdi, mpm"),
    (["--body-force", "node"], "--body-force node:", "material, none"),
    (["--velocity", "corners"], "--velocity corners:", "grid, particle"),
    (["--layout", "hexagonal"], "--layout hexagonal:", "polar, cartesian"),
    (["--plan", "both"], "--plan both:", "auto, serial, parallel"),
    (["--plan", "serial", "--threads", "2"], "--threads 2:", "parallel or auto"),
    (["--linearity-preserving"], "--linearity-preserving True:", "not offered for the ring"),
    (["--laoyut", "polar"], "--laoyut:", "did you mean --layout?"),
]


@pytest.mark.parametrize(("flags", "names", "allows"), BAD, ids=[" ".join(bad[0])[:30] for bad in BAD])
def test_bad_input_is_one_line_that_names_the_flag(flags, names, allows, capsys, monkeypatch):
    monkeypatch.setattr("app.commands.run.command._run", lambda *_: pytest.fail("it ran before it had checked"))
    assert main(["run", "ring", *flags]) == 2
    seen = capsys.readouterr()
    assert seen.out == "" and seen.err.count("\n") == 1
    assert seen.err.startswith(f"mpm-lab: {names}") and allows in seen.err


def test_flags_of_the_ring_are_not_flags_of_the_bar(capsys):
    assert main(["run", "bar", "--layout", "polar"]) == 2
    assert "--layout: is not a flag of mpm-lab run bar" in capsys.readouterr().err
    assert {field.name for field in fields(RunRing)} - {field.name for field in fields(RunBar)} == {"layout", "plan"}


def test_large_amplitude_is_a_warning_and_quiet_is_quiet(capsys):
    large = ["run", "ring", *QUICK, "--amplitude", "0.2", "--effects", "none"]
    assert main(large) == 0
    said = capsys.readouterr().err
    assert said.startswith("mpm-lab: warning: amplitude 0.2: from 0.115 on") and said.count("\n") == 1
    assert main([*large, "--quiet"]) == 0
    assert capsys.readouterr().err == ""


def test_unstable_run_exits_3_and_still_prints_its_json():
    done = ring("--cells", "12", "--cfl", "1.2", "--json", "-")
    values = json.loads(done.stdout, parse_constant=lambda name: pytest.fail(f"{name} is not JSON"))
    assert done.returncode == 3 and values["status"] == "unstable"
    warning, reason = done.stderr.splitlines()
    assert "above the" in warning and "--dt auto" in warning and values["reason"] in reason


def test_picture_and_json_are_whole(tmp_path):
    done = ring(*QUICK, "--json", str(tmp_path / "run.json"), "--plot", str(tmp_path / "run.png"))
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert json.loads((tmp_path / "run.json").read_text())["status"] == "ok"
    assert (tmp_path / "run.png").read_bytes().startswith(b"\x89PNG")


def test_help_shows_the_rings_defaults(capsys):
    assert main(["run", "ring", "--help"]) == 0
    shown = " ".join(capsys.readouterr().out.replace("│", " ").split())
    for text in ("--layout {polar,cartesian}", "--plan {auto,serial,parallel}", "(default: 10000000)",
                 f"(default: {RingScene.DEFAULT_PERIODS:g} without --t-end)",
                 f"about {RingScene.SAMPLES_A_PERIOD} samples a period"):
        assert text in shown


def test_an_estimator_that_does_not_hold_says_so_and_no_number(capsys):
    """A sentence in the JSON object and in the table, alone and beside another; nulls where numbers would be."""
    from app.cli import main
    for others in ([], ["companion"]):
        words = ["run", "ring", *QUICK, "--method", "ugimp", "--estimator", "two-grid", *others, "--quiet"]
        assert main([*words, "--json", "-"]) == 0
        result = json.loads(capsys.readouterr().out)
        assert result["not_valid"]["two-grid"].startswith("not valid here: the boxes")
        index = result["index"]["two-grid"] if others else result["index"]
        assert index == dict.fromkeys(QUANTITIES)
        table = run_table(result)
        assert result["not_valid"]["two-grid"] in table and ("estimate: companion" in table) == bool(others)
