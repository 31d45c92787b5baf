"""The plot of a body's goal: its axis, its band, and what is said of the bar. No web server."""

import json
import re
from html import unescape

import numpy as np
import pytest

from app.frame.goal_curve import GoalCurve, round_levels
from app.page.panels.goal_timeline import LEAST_BAND, GoalTimeline
from app.page.panels.time_axis import TimeAxis, TimelineState
from tests.app.page.panel import Gui


def curve(values, bars):
    return GoalCurve("corner", "y", "m", np.linspace(0, 1, len(values)), np.array(values), np.array(bars), 1.0)


def shown(one, pointed=None):
    """What is said around the curve, and the half height of the band in m."""
    line = GoalTimeline(TimeAxis(Gui()))
    line._axis.pointed = pointed
    line.show(one, TimelineState(1.0, (0.0, 1.0), False))
    said = json.loads(unescape(re.search("data-said='(.*)'", line._axis._html.content)[1]))
    _, high, low, _ = line._plot.data
    return said, 0.5 * (high - low)


def test_numbers_at_the_axis_are_round_and_around_all_of_it():
    assert round_levels(curve([0.5, -3.29], [0.0, np.nan])) == [-4.0, -2.0, 0.0, 2.0]
    assert round_levels(curve([1.0, 1.0], [0.0, 0.0])) == pytest.approx([1.0, 1.5])
    said, _ = shown(curve([0.5, -3.29], [0.0, 0.2]))
    assert [said["zero"], *(text for _, text in said["tops"])] == ["−4 m", "−2 m", "0 m", "2 m"]


def test_a_narrow_band_is_drawn_visibly_and_named_truly():
    """There is none where there is no bar; a broad one is as high as it is."""
    narrow = curve([0.5, -3.29, -3.0], [0.0, 2.3e-3, np.nan])
    said, half = shown(narrow, pointed=0.5 / 1.1)
    assert half[1] * 2 * 62 / 6 == pytest.approx(LEAST_BAND)  # pixels, of a plot 62 high from -4 m to 2 m
    assert half[2] == 0
    assert said["read"] == ["0.5 s", "y = −3.2900 m ± 0.0023 m"]
    assert [name for name, *_ in said["names"]] == ["corner"]
    said, half = shown(curve([0.5, -3.29], [0.0, 0.9]))
    assert half[1] == pytest.approx(0.9)
    assert [name for name, *_ in said["names"]] == ["corner", "± 0.90 m"]
