"""``mpm-lab judge --expect``: a judgement as a test in somebody's own CI."""

import numpy as np
import pytest

from app.cli import main
from app.commands.judge.command import EXPECTABLE
from solvers import BarScene
from solvers.judging.problem_handout import exact_frame
from tests.support.faults import as_files


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Particles on two grids, 10 and 20 cells, whose error is of second order in the size of a cell."""
    folder = tmp_path_factory.mktemp("files")
    paths = [str(folder / f"{cells}.npz") for cells in (10, 20)]
    for path, cells in zip(paths, (10, 20), strict=True):
        scene = BarScene(cells=cells, amplitude=0.001)
        start = as_files(scene, [exact_frame(scene, part * scene.period) for part in (0.1, 0.2, 0.3, 0.4, 0.5)])
        shape = 1 + 2 * scene.spacing**2
        np.savez(path, **start | {"x": start["X"] + (start["x"] - start["X"]) * shape, "v": start["v"] * shape})
    return paths


def judged(files, capsys, *claims):
    """Exit status and what standard error says."""
    expect = [word for claim in claims for word in ("--expect", claim)]
    status = main(["judge", "bar", *files, "--amplitude", "0.001", "--no-compare", "--quiet", *expect])
    return status, capsys.readouterr().err


def test_what_is_expected_is_held_against_the_report(files, capsys):
    status, said = judged(files, capsys, "order.x in 1.5..2.5", "error.x.max < 1e-3",
                          "order(error.x.max) in 1.5..2.5", "index.companion.x in 0.99..1.01", "contradictions == 0",
                          "last(error.x.max) < first(error.x.max) / 2")
    assert (status, said.count("holds ("), said.count("DOES NOT")) == (0, 6, 0)


def test_what_does_not_hold_are_the_lines_that_failed(files, capsys):
    claims = ("error.x.max < 1e-9", "order.x > 3", "first(error.x.max) < last(error.x.max)", "contradictions > 0",
              "distance.companion.v > 1", "scene.cells == 10")
    status, said = judged(files, capsys, *claims, "error.x.max > 0")  # which decides no more than the others
    lines = [line for line in said.splitlines() if "DOES NOT HOLD" in line]
    assert status == 1 and len(lines) == len(claims)
    assert all(f"expected {claim}: DOES NOT HOLD (" in line for claim, line in zip(claims, lines, strict=True))


def test_what_has_no_value_here_does_not_hold(files, capsys):
    status, said = judged(files[:1], capsys, "order.x > 1")
    assert status == 1 and "expected order.x > 1: DOES NOT HOLD (" in said


@pytest.mark.parametrize(("claim", "names"), [
    ("fine", "claims nothing"), ("order.y > 1", "after order give one of x, v, sigma"),
    ("error.x < 1", "give one of final, max, mean"),
    ("budget.v.crossings > 0.8", "give one of grids, error, order"),
    ("__import__('os') == 1", "means nothing here"), ("error.x.max < \x1b[31m1", "cannot be read"),
    ("", "claims nothing")])
def test_what_no_judgement_can_decide_is_refused_before_anything_is_read(claim, names, tmp_path, capsys):
    status = main(["judge", "bar", "not-there.npz", "--out", str(tmp_path / "out"), "--expect", claim])
    said = capsys.readouterr().err
    assert status == 2 and "--expect" in said and names in said and "\x1b" not in said
    assert said.count("\n") == 1 and not (tmp_path / "out").exists()


def test_every_path_can_be_asked_for():
    for first, levels in EXPECTABLE.vocabulary.items():
        EXPECTABLE.validate_claims([f"{'.'.join([first, *(level[0] for level in levels)])} > 0"])
