"""What the rows of a sweep say: orders, fronts and balances, in tables, a summary and pictures."""

import csv
import io

import matplotlib.image
import numpy as np
import pytest

from app.pictures.cost_and_convergence import (
    FIGURES,
    error_run_time_figure,
    error_spacing_figure,
    error_time_step_figure,
)
from app.pictures.run_errors import png_bytes
from app.pictures.study_parts import UNSTABLE_LOOK, stability_map_figure
from solvers.study import convergence_analysis, row
from solvers.study import csv_and_markdown_summary as table
from solvers.study.convergence_order import fit_order
from solvers.study.parameter_grid import Task
from tests.support.fake_rows import fake_row

# ---- what rows say ----------------------------------------------------------------------------------------


def test_slopes_front_and_balance_of_known_data():
    h = np.array([0.1, 0.05, 0.025])
    found = fit_order(h, 3 * h**1.7)
    assert (found.order, found.factor, found.points) == (pytest.approx(1.7), pytest.approx(3), 3)
    assert found.pairwise == pytest.approx((1.7, 1.7))
    assert convergence_analysis.pareto([1, 2, 3, 4], [4, 2, 3, 1]) == [0, 1, 3]
    dt = np.geomspace(1e-4, 1e-2, 7)
    for power in (1, 2):
        found = convergence_analysis.fit_space_time(dt, 1e-3 * (1 + (dt / 2e-3) ** power))
        assert (found.power, found.dt) == (power, pytest.approx(2e-3)) and found.misfit < 1e-9
    assert (
        convergence_analysis.fit_space_time(dt, np.full(7, 2.0)).dt is None
        and convergence_analysis.fit_space_time(dt, np.full(7, 2.0)).space_dominates
    )
    assert (
        not convergence_analysis.fit_space_time(dt, dt).space_dominates
        and convergence_analysis.fit_space_time(dt[:2], dt[:2]) is None
    )


def test_the_brink_of_stability_is_no_time_error():
    dt = np.geomspace(1e-4, 6.4e-3, 7)
    error = 1e-3 * (1 + dt / 1e-3)
    error[-1] *= 1000
    assert convergence_analysis.fit_space_time(dt, error).dt == pytest.approx(1e-3)


def test_series_are_alike_but_for_one_input():
    rows = [fake_row(method, cells, cfl) for method in ("ugimp", "bspline") for cells in (40, 20) for cfl in (0.1, 0.2)]
    lines = convergence_analysis.group_series(rows)
    assert [(line.method, line.inputs["cfl"]) for line in lines] == [
        (method, cfl) for method in ("ugimp", "bspline") for cfl in (0.1, 0.2)]
    assert [row["scene"]["cells"] for row in lines[0].rows] == [20, 40]
    assert next(line.inputs for line in convergence_analysis.group_series(rows, "dt")) == {"method": "ugimp",
                                                                                           "cells": 40}
    assert all(entry["orders"]["x"]["order"] == pytest.approx(2) for entry in convergence_analysis.fit_orders(rows))


def test_unstable_rows_are_not_fitted():
    rows = [fake_row(cells=20), fake_row(cells=40), fake_row(cells=80, order=-3, status="unstable")]
    assert convergence_analysis.fit_orders(rows)[0]["orders"]["x"]["points"] == 2


def test_the_table_has_a_column_for_everything():
    refusal = row.refused_row(task := Task("bar", {"amplitude": 0.2}), task.refusal())
    lines = list(csv.DictReader(io.StringIO(table.csv_text([refusal, fake_row(), fake_row(cells=40)]))))
    assert [line["status"] for line in lines] == ["refused", "ok", "ok"]
    assert lines[0]["scene.amplitude"] == "0.2" and lines[0]["error.x.max"] == ""
    assert float(lines[2]["error.x.max"]) == 40**-2 and float(lines[1]["index.transport.x"]) == 1.1


def test_a_corrected_result_is_a_way_of_its_own_with_its_own_time():
    """It takes the time of run and estimator; of the companion's result, which holds no MPM, there is none."""
    left = {q: {"max": 1e-9} for q in ("x", "v", "sigma")}
    prices = {"min": 1.0, "full": 2.0, "estimators": {"recovered": 0.25, "companion": 0.1}, "effects": {}}
    one = fake_row(corrected={"recovered": left, "companion": left}, seconds=prices)
    broken = {**one, "status": "lost"}
    [way] = convergence_analysis.corrected_rows([broken, one])
    assert (way["corrected_by"], way["seconds"]["min"], way["error"]["x"]["max"]) == ("recovered", 1.25, 1e-9)
    said = table.summarise_study("bar", [one])
    assert "ugimp, corrected by recovered | 20 | 1.000e-09 | 1.25" in said and "no MPM is left" in said
    panel = error_run_time_figure([one]).axes[0]
    assert sorted(line.get_fillstyle() for line in panel.lines if len(line.get_xdata()) == 1) == ["full", "none"]


def test_the_summary_says_what_went_wrong_once_for_each_reason():
    rows = [fake_row(cells=20), *(fake_row(cells=cells, status="unstable") for cells in (40, 80))]
    text = table.summarise_study("bar", rows)
    assert "1 ok, 2 unstable" in text and text.count("too long") == 1 and "and 1 more" in text
    assert "Nothing to fit" in text and "Nothing to fit" not in table.summarise_study("bar",
                                                                                      [fake_row(), fake_row(cells=40)])


# ---- pictures ---------------------------------------------------------------------------------------------

MANY = [fake_row(method, cells, cfl) for method in ("mpm", "ugimp", "cpgimp", "bspline") for cells in (20, 40, 80)
        for cfl in (0.05, 0.1, 0.2)]
STATES = {"many": MANY, "one": [fake_row()], "none": [], "no truth": [fake_row(error={q: {} for q in "xva"})],
          "no estimate": [fake_row(estimate=None), fake_row(cells=40, estimate=None)],
          "all unstable": [fake_row(cells=cells, status="unstable") for cells in (20, 40)],
          "beyond numbers": [fake_row(), fake_row(cells=40, status="unstable", error={"x": {"max": None}, "v": {"max":
                                                                                           1e300}, "sigma": {}})],
          "refused": [row.refused_row(task := Task("bar", {"amplitude": 0.2}), task.refusal())]}


@pytest.mark.parametrize(("name", "state"), [
    pytest.param(name, state, marks=() if state in ("many", "beyond numbers") or name == next(iter(FIGURES))
                 else pytest.mark.slow) for name in FIGURES for state in STATES])  # every picture, and every state
def test_there_is_a_picture_of_every_state(name, state):
    content = png_bytes(FIGURES[name](STATES[state]))
    assert matplotlib.image.imread(io.BytesIO(content)).shape[0] > 100


@pytest.mark.parametrize("name", FIGURES)
def test_nothing_to_show_is_said(name):
    assert any("nothing to show" in text.get_text() for text in FIGURES[name]([]).axes[0].texts)


def test_unstable_runs_are_crosses_and_not_dropped():
    rows = [fake_row(cells=20), fake_row(cells=40), fake_row(cells=80, status="unstable", error={"x": {"max": None}})]
    for figure in (error_run_time_figure(rows), error_spacing_figure(rows)):
        crosses = [line for line in figure.axes[0].get_lines() if line.get_marker() == UNSTABLE_LOOK["marker"]]
        assert len(crosses) == 1


def test_orders_and_balance_are_shown():
    shown = error_spacing_figure(MANY[:1] + MANY[3:4]).axes[0].get_legend().get_texts()
    assert [text.get_text() for text in shown] == ["order 2.00"]
    rows = [fake_row(cells=20, cfl=cfl, error={"x": {"max": 1 + cfl / 0.1}}) for cfl in (0.025, 0.05, 0.1, 0.2)]
    stars = [line for line in error_time_step_figure(rows).axes[0].get_lines() if line.get_marker() == "*"]
    assert stars[0].get_xdata()[0] == pytest.approx(rows[2]["scene"]["dt"])


def test_the_stability_map_is_narrow_and_names_what_it_shows():
    """A column per method; treatments in words; periods without prefixes."""
    rows = [fake_row(method, life={"accurate": 0.3, "sound": 0.3, "first_period": None})
            for method in ("mpm", "ugimp", "cpgimp", "bspline")]
    for row_of in rows[2:]:
        row_of["scene"] |= {"linearity_preserving": True, "remedies": ["zero-drift"]}
    figure = stability_map_figure(rows)
    figure.draw_without_rendering()
    assert figure.get_figwidth() < 13
    assert {axes.get_title(loc="left") for axes in figure.axes} >= {"MPM", "uGIMP", "cpGIMP", "B-spline"}
    assert any("zero drift" in axes.get_ylabel() for axes in figure.axes)
    assert figure.axes[-1].xaxis.get_major_formatter()(0.1) == "0.1"
