"""``mpm-lab budget``: its JSON object, its table, its picture, and what it refuses; budgets in runs and sweeps."""

import json

import pytest

from app.cli import main
from solvers.scene.error_causes import CAUSES, FIELDS, cause_labels
from solvers.study.csv_and_markdown_summary import csv_text, summarise_study

QUICK = ("bar", "--cells", "8", "--ppc", "2", "--periods", "0.3", "--estimator", "none", "--quiet")
PLANE = ("ring", "--cells", "8", "--ppc", "1", "--periods", "0.05", "--method", "ugimp", "--quiet")


def printed(capfd, *arguments: str) -> dict:
    assert main([*arguments, "--json", "-"]) == 0
    return json.loads(capfd.readouterr().out, parse_constant=lambda name: pytest.fail(f"{name} is not JSON"))


@pytest.mark.parametrize(("amplitude", "words", "crossed"), [("0.0034", "particle sums", False),
                                                             ("0.006", "crossings", True)])
def test_what_crossings_make_before_the_first_is_particle_sums(amplitude, words, crossed, capfd, tmp_path):
    """With 36 cells and four particles each, particles cross from A = h/8 = 3.47 mm on. In all tables and the picture's
    titles; by the same key in JSON, with the number of crossings beside."""
    flags = ("budget", "bar", "--method", "mpm", "--cells", "36", "--amplitude", amplitude, "--periods", "0.25",
             "--estimator", "none", "--quiet", "--take-away", "crossings")
    assert main([*flags]) == 0
    said = capfd.readouterr().out
    other = {"particle sums": "crossings", "crossings": "particle sums"}[words]
    assert f"without {words}" in said and said.count(words) == 2 and other not in said and "-0.000" not in said
    values = printed(capfd, *flags)
    assert (values["grid_crossings"] > 0) == crossed and 0.1 < values["budget"]["x"]["crossings"] < 1
    assert values["take_away"]["again"]["x"] == pytest.approx(values["take_away"]["predicted"]["x"], rel=0.05)


@pytest.mark.parametrize("flags", [QUICK, PLANE], ids=["bar", "ring"])
def test_json_is_the_contracts(flags, capfd, tmp_path):
    file = tmp_path / "budget.png"
    values = printed(capfd, "budget", *flags, "--take-away", "crossings", "--plot", str(file))
    assert set(values) == {"schema", "scene", "reference", "budget", "grid_crossings", "take_away"}
    assert values["schema"] == "mpm-lab/budget/1" and values["reference"] == "exact"
    assert values["scene"].get("take_away", "nothing") == "nothing"  # of the run that has the budget
    for field in FIELDS:
        assert list(values["budget"][field]) == list(values["budget"]["at_end"][field]) == list(CAUSES)
        assert sum(values["budget"][field].values()) == pytest.approx(1, abs=1e-6)
    assert values["take_away"]["class"] == "crossings" and file.read_bytes().startswith(b"\x89PNG")
    assert all(set(values["take_away"][key]) == set(FIELDS) for key in ("before", "predicted", "again"))


def test_a_table_has_both_runs_and_claims_no_sum_where_shares_say_nothing(capfd):
    assert main(["budget", *QUICK, "--take-away", "coarse_grid"]) == 0
    said = capfd.readouterr().out
    assert all(name in said for name in cause_labels(crossed=False).values())
    assert "without coarse grid" in said and "run again" in said
    assert main(["budget", *QUICK, "--motion", "patch"]) == 0
    said = capfd.readouterr().out
    assert "only round-off" in said and "adding up to 1" not in said


def test_rows_and_their_summary_have_the_shares():
    shares = dict.fromkeys(CAUSES, 0.25)
    row = {"status": "ok", "reason": None, "problem": "bar", "asked": {}, "scene": {"method": "mpm", "cells": 8},
           "h": 0.125, "steps": 100, "index": {}, "error": {}, "seconds": {"min": 1.0}, "rate": 1.0,
           "budget": {field: shares for field in FIELDS} | {"reference": "exact"}}
    assert '"budget.v.crossings"' in csv_text([row]).splitlines()[0].split(",")
    assert "crossings: share of v" in summarise_study("bar", [row]) and "0.250" in summarise_study("bar", [row])
    assert "share of" not in summarise_study("bar", [{**row, "budget": None}])
    silent = summarise_study("bar", [{**row, "budget": {**row["budget"], "not_valid": "not valid here: they cancel"}}])
    assert "crossings: share of v" in silent and "0.250" not in silent
