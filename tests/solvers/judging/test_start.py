"""What the judge says of the start: wrong files show at t = 0, and the start alone is no pass."""

from __future__ import annotations

import numpy as np
import pytest

from solvers import judge
from solvers.judging.handout import initial
from solvers.problems import PROBLEMS

CELLS = {"bar": 20, "ring": 12, "vortex": 16}


def at_the_start(problem):
    """The particles of a problem before anything has moved, and its scene."""
    scene = PROBLEMS[problem].scene(cells=CELLS[problem])
    frame = initial(scene)
    return scene, {"t": 0.0, "cells": np.array(scene.cells), "X": frame.material_position, "x": frame.position,
                   "v": frame.velocity}


def says(scene, arrays):
    [grid] = judge(scene, arrays).to_dict()["grids"]
    assert all(grid["error"][q]["max"] is None for q in ("x", "v", "sigma"))  # whatever it is, nothing was computed
    return [check["says"] for check in grid["checks"] if check["verdict"] == "does not hold"]


@pytest.mark.parametrize("problem", CELLS)
def test_the_start_alone_has_no_error_and_nothing_wrong(problem):
    assert says(*at_the_start(problem)) == []


@pytest.mark.parametrize("problem", CELLS)
@pytest.mark.parametrize("key, change, words", [
    ("x", lambda a: a["x"] - a["X"], "x seems to be the displacement"),
    ("x", lambda a: a["x"][np.random.default_rng(0).permutation(len(a["x"]))], "are permuted"),
    ("x", lambda a: 1000 * a["x"], "are not where those of the"),
    ("v", lambda a: 1.2 * a["v"], "it is 1.2 times that")])
def test_what_is_wrong_shows_at_the_start(problem, key, change, words):
    scene, arrays = at_the_start(problem)
    told = says(scene, arrays | {key: change(arrays)})
    assert any(words in sentence for sentence in told), told


def test_another_unit_is_named_where_nothing_is_periodic():
    scene, arrays = at_the_start("ring")
    assert any("another unit" in one or "in mm" in one for one in says(scene, arrays | {"x": 1000 * arrays["x"]}))
