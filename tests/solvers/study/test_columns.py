"""Columns of a sweep's rows, as a user of Python asks for them."""

from __future__ import annotations

import numpy as np
import pytest

from solvers import SceneError, sweep
from solvers.study.columns import Rows

ROWS = Rows([{"cells": 10, "error": 0.5, "method": "mpm", "on": True, "reason": None},
             {"cells": 20, "error": None, "method": "ugimp", "on": False, "reason": "lost"}])


def test_a_name_gives_a_column():
    assert ROWS["cells"].dtype.kind == "i" and ROWS["cells"].tolist() == [10, 20]
    assert ROWS["error"].dtype == float and ROWS["error"][0] == 0.5 and np.isnan(ROWS["error"][1])
    assert (ROWS["method"] == "mpm").tolist() == [True, False]
    assert ROWS["on"].tolist() == [True, False] and ROWS["reason"].tolist() == [None, "lost"]


def test_it_is_still_a_list_of_rows():
    assert ROWS[0]["cells"] == 10 and ROWS[-1] == ROWS[1] and len(ROWS) == 2
    assert isinstance(ROWS[:1], Rows) and ROWS[:1]["cells"].tolist() == [10]
    assert Rows(row for row in ROWS if row["on"])["cells"].tolist() == [10]
    assert ROWS.columns == ["cells", "error", "method", "on", "reason"] and Rows().columns == []


@pytest.mark.parametrize(("rows", "name", "says"), [
    (ROWS, "eror", "did you mean error"), (ROWS, "x", "they have cells, error, method"), (Rows(), "cells", "none")])
def test_a_column_that_there_is_not(rows, name, says):
    with pytest.raises(SceneError, match=says):
        rows[name]


def test_a_sweep_has_columns():
    rows = sweep("bar", cells=[5, 10], method=["mpm", "bspline"], periods=0.1, estimators=(), repeats=0)
    second_order = rows["error.x.max"][rows["scene.method"] == "bspline"]
    assert rows["scene.cells"].tolist() == [5, 5, 10, 10] and second_order[1] < second_order[0] / 3
    assert np.isnan(rows["seconds.min"]).sum() == 0 and set(rows["status"]) == {"ok"}
