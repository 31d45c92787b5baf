"""What the plots over time draw of an estimate that has lost its way."""

import numpy as np
import pytest

from app.frame.colour_scale import BEYOND
from app.names_and_units import power_of_ten
from app.page.panels.time_plots import _time_unit, clip_estimate
from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene


def test_a_lost_estimate_is_drawn_at_the_edge():
    """Left out, its low moments would be joined by lines through where it was high."""
    true, estimated = np.array([1.0, 2.0, 1.0]), np.array([0.5, 5000.0, 3.0])
    assert clip_estimate(estimated, true).tolist() == [0.5, BEYOND * 2.0, 3.0]
    assert np.array_equal(clip_estimate(estimated, np.zeros(3)), estimated)


def test_what_is_not_known_stays_so():
    """Not a number is nowhere, also beside a lost one."""
    assert np.array_equal(clip_estimate(np.array([np.nan, np.inf]), np.ones(2)), [np.nan, BEYOND], equal_nan=True)


@pytest.mark.parametrize(("largest", "power"), [(0.0, 0), (0.02, -2), (0.25, 0), (999.0, 0), (6000.0, 3), (2e5, 5)])
def test_a_power_of_ten_goes_where_digits_would_not(largest, power):
    """Three digits say enough: 6000 as 6 times 10^3, which three digits alone would write 6e+03."""
    assert power_of_ten(largest) == power and "e" not in f"{largest / 10.0**power:.3g}"


@pytest.mark.parametrize("end", [0.0, 2e-6, 4e-5, 2e-3, 0.02, 1.0, 300.0])
def test_an_axis_of_time_tells_its_numbers_apart(end):
    """It has three digits after the point, and some five numbers."""
    unit, second = _time_unit(end, BarScene(motion="patch"))
    assert second == {"t / s": 1, "t / ms": 1e3, "t / µs": 1e6}[unit]
    numbers = {f"{second * end * k / 5:.3f}" for k in range(6)}
    assert len(numbers) == 6 or end == 0


def test_an_axis_counts_periods_where_something_swings():
    ring = RingScene()
    assert _time_unit(0.02, ring) == ("t in periods", 1 / ring.period)
