"""Lessons make claims; here they are run."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from solvers.bar.scene import BarScene
from solvers.run import run

LESSON = Path(__file__).parents[1] / "lessons" / "who-is-to-blame.md"
ROW = re.compile(r"^\|\s*(\d+)\s*\|\s*(\S+)\s*\|\s*(\d+)\s*\|\s*(\S+)\s*\|\s*(\d+)\s*\|$", re.MULTILINE)
ROWS = ROW.findall(LESSON.read_text(encoding="utf-8"))


def test_the_table_is_there():
    assert [int(row[0]) for row in ROWS] == [20, 40, 80, 160]


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row[0])
def test_who_is_to_blame(row):
    """Every number of the table, to the three digits printed (1 %); crossings to 0.1 %, since a particle on a
    boundary may fall either way on another processor."""
    for force, error, crossings in (("node", row[1], row[2]), ("material", row[3], row[4])):
        result = run(BarScene(linearity_preserving=True, body_force=force, cells=int(row[0]), modulus=1000.0,
                           amplitude=0.025, dt=2.5e-5, t_end=1.0, estimators=()))
        assert result.errors()["x"]["max"] == pytest.approx(float(error), rel=0.01)
        assert result.to_dict()["grid_crossings"] == pytest.approx(int(crossings), rel=1e-3)
