"""Orders that one can believe, and the reasons where none can be: of errors made up, and in what the judge says."""

import numpy as np
import pytest

from app.cli import main
from app.pictures.cost_and_convergence import error_spacing_figure
from app.pictures.judgement_and_check import order_figure
from solvers.judging import problem_handout
from solvers.judging.judgement import judge
from solvers.problems import PROBLEMS
from solvers.study.convergence_order import fit_order
from solvers.study.csv_and_markdown_summary import summarise_study
from tests.support.fake_rows import fake_row

#: Errors of x on 20, 40 and 80 cells of a motion of 0.025 m, and what is said instead of an order.
UNBELIEVABLE = {(1e-2, 1e-7, 1e-7): "the coarse run is broken: an error of 40 % of the motion",
                (1e-2, 1e-8, 1e-14): "steeper than the method can be: 19.93",
                (1e-3, 1e-3, 1e-3): "the same error on every grid", (3e-17, 2e-17, 4e-17): "round-off",
                (1e-3, 2e-4, 5e-4): "not monotone", (1e-3, 2e-4, 1e-4): "the grids disagree: 1.00 to 2.32"}


def file_of(folder, cells: int, error: float) -> str:
    """The exact particles of the bar but for an error of x, in m, RMS."""
    scene = PROBLEMS["bar"].scene(cells=cells)
    frame = problem_handout.exact_frame(scene, 0.3 * scene.period)
    X, file = frame.material_position, folder / f"{cells}.npz"
    np.savez(file, t=frame.time, X=X, x=frame.position + error * 2**0.5 * np.sin(2 * np.pi * X), cells=cells)
    return str(file)


@pytest.mark.parametrize("errors", UNBELIEVABLE, ids=str)
def test_an_order_that_nobody_should_believe_is_none_and_its_reason_is_given(errors, tmp_path, capsys):
    files = [file_of(tmp_path, cells, error) for cells, error in zip((20, 40, 80), errors, strict=True)]
    judged = judge(PROBLEMS["bar"].scene(), files)
    fit = judged.to_dict()["order"]["x"]
    assert fit["order"] is None and UNBELIEVABLE[errors] in fit["reason"] and len(fit["left_out"]) == 3
    assert judged.to_dict()["order"]["v"] is None  # which is not in the files
    drawn = order_figure(judged)
    assert drawn is not None and any(line.get_markerfacecolor() == "white" for line in drawn.axes[0].lines)
    assert main(["judge", "bar", *files, "--no-compare", "--expect", "order.x > -9"]) == 1
    said = capsys.readouterr()
    assert f"none of x ({UNBELIEVABLE[errors]}" in said.out
    assert f"DOES NOT HOLD (order.x: {UNBELIEVABLE[errors]}" in said.err


def test_grids_that_are_nearly_the_same_keep_their_order_with_a_word(tmp_path, capsys):
    files = [file_of(tmp_path, cells, 0.4 / cells**2) for cells in (20, 21)]
    assert main(["judge", "bar", *files, "--no-compare", "--expect", "order.x > 1.8"]) == 0
    said = capsys.readouterr()
    assert "2.00 of x (the cell sizes differ by a ratio of 1.05 only" in said.out and "ratio of 1.05" in said.err


def test_runs_that_tell_nothing_are_left_out_where_the_others_agree():
    h = 0.1 / 2.0 ** np.arange(5)
    broken = fit_order(h, [0.9, *(h[1:] ** 2)], 1.0)
    assert broken.order == pytest.approx(2) and broken.left_out == (0.1,)
    assert "left out: the coarse run is broken" in broken.remark
    rounded = fit_order(h, [*(h[:3] ** 2), 1e-12, 1e-12], 1.0, 1e-11)
    assert rounded.order == pytest.approx(2) and rounded.left_out == tuple(h[:2:-1])
    assert "2 of 5 errors are round-off" in rounded.remark
    assert fit_order([0.1, 0.1], [1, 2]) is None and fit_order([0.1, 0.2], [None, 1]) is None
    assert "one error alone" in fit_order([0.1, 0.2], [0, 1]).reason


def test_a_sweep_says_why_it_has_no_order_and_draws_such_errors_hollow():
    rows = [fake_row(cells=20, order=2.0), fake_row(cells=40, order=2.0), fake_row(cells=80, order=1.4)]
    text = summarise_study("bar", rows)
    assert "ugimp, x and 2 more: no order, not monotone" in text
    figure = error_spacing_figure(rows)
    assert sum(line.get_markerfacecolor() == "white" for line in figure.axes[0].lines) == 1
    assert [entry.get_text() for entry in figure.axes[0].get_legend().get_texts()] == ["no order: not monotone"]


def test_no_order_of_random_series_is_far_off_without_a_word():
    """Of orders from 0.5 to 4 on two to six grids, with noise of up to 10 %, a floor, or one run broken."""
    chance, lost, sound = np.random.default_rng(614), 0, 0
    for kind in [*("clean", "noise", "floor", "broken") * 50]:
        cells = np.unique(np.round(chance.choice([8, 10, 16, 20])
                                   * chance.choice([1.25, 1.5, 2.0]) ** np.arange(chance.integers(2, 7))))
        h, order = 1 / cells, chance.uniform(0.5, 4)
        error = 10 ** chance.uniform(-4, -1.2) * (h / h[0]) ** order
        error *= np.exp((kind != "clean") * 10 ** chance.uniform(-3, -1) * chance.normal(size=len(h)))
        floor = 10 ** chance.uniform(-12, -6) if kind == "floor" else 0.0
        error += floor * np.abs(chance.normal(size=len(h)))
        if kind == "broken":
            error[chance.integers(len(h))] *= 10 ** (chance.choice([-1, 1]) * chance.uniform(0.2, 3))
        fit = fit_order(h, error, 1.0, 3 * floor)
        assert fit.reason or fit.remark or fit.order == pytest.approx(order, abs=0.3), (kind, order, h, error)
        sound += kind in ("clean", "noise")
        lost += kind in ("clean", "noise") and fit.order is None
    assert sound == 100 and lost <= 1
