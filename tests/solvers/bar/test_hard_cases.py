"""Where the bar breaks: chosen rows of an independent stability study (N = 40, 4 particles a cell).

The study's table holds the largest stable cfl over 5 periods in steps of 0.1. Next to the edge rounding
decides, so a run two steps inside must be sound and one three steps outside must fail.
"""

from __future__ import annotations

import numpy as np
import pytest

from solvers.problems.bar.scene import BarScene
from solvers.scene.scene import Scene

#: method, linearity preserving, amplitude, largest stable cfl
EDGES = [("ugimp", False, 1e-6, 0.7), ("ugimp", False, 0.025, 0.8), ("ugimp", True, 0.025, 0.8),
         ("ugimp", True, 0.1, 0.5), ("ugimp", True, 0.15, 0.4), ("cpgimp", False, 0.025, 0.8),
         ("cpgimp", False, 0.1, 0.6), ("cpgimp", False, 0.15, 0.4), ("mpm", False, 1e-6, 0.7),
         ("bspline", False, 0.025, 1.2), ("bspline", False, 0.1, 0.8), ("bspline", False, 0.14, 0.7)]


def hard(method: str, linear: bool, amplitude: float, cfl: float, periods: float = 5, cells: int = 40,
         velocity: str = "grid") -> Scene:
    return BarScene(method=method, linearity_preserving=linear, amplitude=amplitude, cfl=cfl, periods=periods,
                 cells=cells, velocity=velocity, estimators=(), effects=("truth",))


@pytest.mark.parametrize(("method", "linear", "amplitude", "edge"), EDGES)
def test_stable_below_the_edge_and_unstable_above(method, linear, amplitude, edge, simulate):
    """Inside, x stays within A/10, the study's measure of a broken run; outside, the run says
    ``unstable``.
    """
    inside = simulate(hard(method, linear, amplitude, round(edge - 0.2, 1)))
    assert inside.status == "ok" and inside.error["x"]["max"] < 0.1 * amplitude
    outside = simulate(hard(method, linear, amplitude, round(edge + 0.3, 1)))
    assert outside.status == "unstable" and outside.reason


@pytest.mark.parametrize(("method", "amplitude"),
                         [("ugimp", 0.1), ("ugimp", 0.15), ("mpm", 0.1), ("bspline", 0.15)])
def test_no_step_is_short_enough(method, amplitude, simulate):
    """Rows marked "none": even cfl 0.1 ends broken within 5 periods, as the mechanism is not the time
    step.
    """
    result = simulate(hard(method, False, amplitude, 0.1))
    assert result.status == "unstable" or result.error["x"]["max"] > 0.1 * amplitude


@pytest.mark.parametrize(("method", "amplitude", "cfl", "periods"), [
    ("ugimp", 0.05, 0.1, 29), ("ugimp", 0.1, 0.1, 3), ("cpgimp", 0.1, 0.1, 30), ("bspline", 0.1, 0.1, 20),
    ("cpgimp", 0.1, 0.3, 40), ("mpm", 0.025, 0.3, 0.4), ("mpm", 0.1, 0.3, 0.3)])
def test_long_runs_break_when_the_study_says(method, amplitude, cfl, periods, simulate):
    """x error first exceeds A/10 after so many periods: within a factor 2.

    The drift that breaks them is linear in time, but grows out of rounding-sensitive crossings.
    """
    result = simulate(hard(method, False, amplitude, cfl, periods=2 * periods))
    broken = np.flatnonzero(~(result.series["error_x"] <= 0.1 * amplitude))
    assert broken.size and periods / 2 <= result.series["time"][broken[0]] / result.scene.period


def test_tiled_domains_outlive_convected_ones(simulate):
    """Domains whose corners move with the grid tile for ever: sound at 100 periods, where cpGIMP broke at 48.

    A = 0.1, cfl 0.3, 20 cells; the study found more than 500 periods for the tiled ones.
    """
    tiled, plain = (simulate(hard("cpgimp", False, 0.1, 0.3, periods=100, cells=20, velocity=velocity))
                    for velocity in ("corners", "grid"))
    assert tiled.status == "ok" and tiled.error["x"]["max"] < 0.01
    assert plain.status == "unstable" or plain.error["x"]["max"] > 0.01
