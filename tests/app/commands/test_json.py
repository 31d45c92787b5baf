"""The contract of ``mpm-lab run --json``, key by key and problem by problem, and the table that is made of it."""

from __future__ import annotations

import json
from dataclasses import fields

import pytest

from app.cli import main
from app.commands import commands
from app.commands.output import json_text
from app.commands.run.command import OutputFlags
from app.commands.run.text_summary import run_table
from solvers.problems import PROBLEMS
from solvers.scene.effects import EFFECTS

KEYS = {"schema", "scene", "status", "reason", "t", "steps", "particles", "error", "estimate", "index", "distance",
        "goals", "soundness", "step", "life", "grid_crossings", "energy", "angular_momentum", "budget", "effects",
        "bytes", "seconds", "rate", "arch", "threads", "plan", "not_valid", "checked", "not_checked",
        "as_large_as_itself", "rounding", "advice", "corrected", "refused"}
SCENE = {"problem", "method", "cells", "ppc", "amplitude", "modulus", "density", "dt", "cfl", "t_end", "periods",
         "body_force", "linearity_preserving", "velocity", "estimator", "effects", "remedies", "arch", "threads",
         "sample_every"}
QUANTITIES = {"x", "v", "sigma", "a"}
NOTHING = {"final": None, "max": None, "mean": None}
#: A quick run of each problem, as it is typed; what only its scene has, what of that is null, and its own error norm.
RUNS = {"bar": ("--cells 8 --ppc 2 --periods 0.2", {"motion", "stretch", "initial_velocity", "take_away",
                "displacement"}, {"stretch", "initial_velocity"}, "sigma_log"),
        "ring": ("--cells 12 --periods 0.1", {"layout", "plan"}, set(), "a_nodes"),
        "vortex": ("--cells 12 --ppc 2 --amplitude 0.25 --t-end 0.2", {"layout", "plan", "poisson_ratio", "frequency"},
                   set(), "a_nodes"),
        "square": ("--method mpm --cells 10 --cfl 0.2 --periods 0.1 --estimator transport",
                   {"plan", "poisson_ratio", "law", "displacement"}, set(), "a_nodes")}


@pytest.fixture(scope="module")
def printed(tmp_path_factory):
    """The JSON object of each problem's quick run."""
    path = tmp_path_factory.mktemp("json") / "run.json"

    def run(problem: str) -> dict:
        assert main(["run", problem, *RUNS[problem][0].split(), "--json", str(path), "--quiet"]) == 0
        return json.loads(path.read_text(), parse_constant=lambda name: pytest.fail(f"{name} is not JSON"))

    return {problem: run(problem) for problem in PROBLEMS}


@pytest.mark.parametrize("problem", PROBLEMS)
def test_a_run_has_exactly_the_contracts_keys(printed, problem):
    found = printed[problem]
    assert set(found) == KEYS
    assert [found[key] for key in ("schema", "status", "reason", "threads", "plan")] == [
        "mpm-lab/run/1", "ok", None, 1, "serial"]
    assert found["t"] == pytest.approx(found["steps"] * found["scene"]["dt"])
    assert set(EFFECTS) <= set(found["effects"]) and found["bytes"] > 0 and found["grid_crossings"] >= 0
    assert set(found["energy"]) == {"initial", "final", "drift"}
    seconds = found["seconds"]
    assert set(seconds) == {"setup", "compile", "run", "estimate", "estimators"}
    assert seconds["estimate"] == sum(seconds["estimators"].values()) >= 0
    assert found["rate"] == pytest.approx(1e-6 * found["particles"] * found["steps"] / seconds["run"])


@pytest.mark.parametrize("problem", PROBLEMS)
def test_the_scene_has_every_flag_with_its_default(printed, problem):
    typed, own, without, _ = RUNS[problem]
    scene = printed[problem]["scene"]
    assert set(scene) == SCENE | own and {name for name, value in scene.items() if value is None} == without
    flags = {field.name for field in fields(commands()["run", problem])} - {field.name for field in fields(OutputFlags)}
    assert set(scene) == flags | {"problem"} | without
    kind, given = PROBLEMS[problem].scene, {word.removeprefix("--") for word in typed.split()[::2]}
    alike = {"method", "amplitude", "modulus", "body_force", "velocity", "arch", "motion", "layout"} - given
    assert [scene[name] for name in alike & set(scene)] == [getattr(kind, name) for name in alike & set(scene)]
    assert scene["estimator"] == (["transport"] if "estimator" in given else list(kind.estimators))


@pytest.mark.parametrize("problem", PROBLEMS)
def test_errors_estimates_and_their_ratios(printed, problem):
    """Of what an estimator does not estimate there is nothing: nulls."""
    found, silent = printed[problem], {"sigma"} if problem == "square" else set()
    assert set(found["error"]) == QUANTITIES | {RUNS[problem][3]}
    assert set(found["estimate"]) == set(found["index"]) == set(found["distance"]) == QUANTITIES
    for quantity, values in [*found["error"].items(), *((q, found["estimate"][q]) for q in QUANTITIES - silent)]:
        assert set(values) == set(NOTHING), quantity
        assert 0 < values["mean"] <= values["max"] and values["final"] <= values["max"]
    for quantity in QUANTITIES:
        if quantity in silent:
            assert found["estimate"][quantity] == NOTHING
        ratios = found["index"][quantity], found["distance"][quantity]
        assert ratios == (None, None) if quantity in silent else min(ratios) > 0


def test_angular_momentum_and_the_margin_of_the_step(printed):
    assert printed["bar"]["angular_momentum"] is printed["ring"]["angular_momentum"] is None
    momentum = printed["vortex"]["angular_momentum"]
    assert set(momentum) == {"initial", "final", "drift", "error"} and abs(momentum["drift"]) < 0.01
    assert all(found["step"]["margin"] < 1 for found in printed.values())


def test_the_table_has_units_and_a_dash_for_what_is_not_estimated(printed):
    lines = run_table(printed["ring"]).splitlines()
    assert lines[0].startswith("ring, cpdi, 12 cells, 2 × 2 particles per cell")
    assert any(line.startswith("a_nodes (m/s²) ") for line in lines) and "serial plan" in lines[-1]
    square = run_table(printed["square"]).splitlines()
    assert [line.split()[2:] for line in square if line.startswith("sigma (Pa)")][1] == ["-"] * 5
    said = run_table(printed["vortex"])
    assert "amplitude 0.25 rad" in said and "angular momentum off its balance by" in said


def test_the_table_of_nothing(printed):
    values = printed["bar"]
    bare = {**values, "error": dict.fromkeys(values["error"], NOTHING), "energy": None, "grid_crossings": None,
            "effects": [], "rate": None, "seconds": {"compile": 0.0, "run": 0.0, "estimate": None}}
    assert "estimate:" not in run_table(bare) and "energy drift    -" in run_table(bare)


def test_an_estimator_that_does_not_hold_says_so_and_no_number(capsys):
    """A sentence in the JSON object and in the table, alone and beside another; nulls where numbers would be. What it
    would have said is kept apart where it ran and found by itself that it does not hold."""
    for others in ([], ["companion"]):
        words = ["run", "ring", *RUNS["ring"][0].split(), "--method", "ugimp", "--estimator", "two-grid", *others]
        assert main([*words, "--quiet", "--json", "-"]) == 0
        result = json.loads(capsys.readouterr().out)
        assert result["not_valid"]["two-grid"].startswith("not valid here: the boxes")
        index = result["index"]["two-grid"] if others else result["index"]
        assert index == dict.fromkeys(QUANTITIES)
        table = run_table(result)
        assert result["not_valid"]["two-grid"] in table and ("estimate: companion" in table) == bool(others)
        assert result["refused"] == {}
    assert main(["run", "ring", *RUNS["ring"][0].split(), "--estimator", "transport", "--quiet", "--json", "-"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["index"] == dict.fromkeys(QUANTITIES) and result["not_valid"].keys() == {"transport"}
    assert result["refused"]["transport"]["index"]["x"] > 0 and result["refused"]["transport"]["distance"]["x"] > 0.5
    assert set(result["refused"]["transport"]["estimate"]["x"]) == set(NOTHING)


def test_what_json_has_not_is_refused():
    with pytest.raises(ValueError, match="not JSON compliant"):
        json_text({"rate": float("nan")})


def test_a_broken_run_says_what_was_tried_and_what_held(capsys):
    """In the JSON object and in the line on standard error."""
    words = "run bar --ppc 1 --cfl 0.2 --periods 2 --effects truth,soundness --estimator none --json -"
    assert main(words.split()) == 3
    printed = capsys.readouterr()
    found = json.loads(printed.out)
    for cure in found["advice"]:
        assert set(cure) == {"change", "text", "tried", "held"} and set(cure["change"]) <= set(found["scene"])
    held = [cure for cure in found["advice"] if cure["held"]]
    assert len(held) == 1 and held[0]["tried"] and held[0]["change"] == {"ppc": 2}
    assert found["reason"].endswith("; with 2 particles per cell it holds (tried)") and found["reason"] in printed.err
