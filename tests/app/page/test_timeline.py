"""The error over time: its axes, what is said round the curves, and finding a frame by its time. No web server."""

import json
import re
from html import unescape
from types import SimpleNamespace

import numpy as np
import pytest

from app.page.panels.browser_store_and_window import BrowserWindow, LayoutMetrics
from app.page.panels.error_timeline import BINS, ErrorTimeline
from app.page.panels.time_axis import TimeAxis, TimelineState
from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from tests.app.page.panel import Gui
from tests.app.page.test_frame_buffer import frame, recent_of, shown

SCENE = BarScene()


class Past:
    """A run until ``end``: an error that grows evenly to 100 µm in a second, 0.4 % of the amplitude; a particle changes
    its cell at 0.3 s, and one at 0.5 s."""

    def __init__(self, end, scene=SCENE):
        time = np.linspace(0, end, 200)
        self.scene = scene
        self.series = self.latest_periods_series = {"time": time, "error_x": 1e-4 * time,
                                                    "transport/estimate_x": 2e-4 * time,
                                                    "crossings": 1.0 * (time > 0.3) + (time > 0.5)}


@pytest.fixture
def line():
    line = ErrorTimeline(TimeAxis(Gui()))
    line.set_lines(("transport",), False)
    return line


def said(line):
    return json.loads(unescape(re.search("data-said='(.*)'", line._axis._html.content)[1]))


def ends(line):
    """Of the axes of time and of the error."""
    return tuple(line._plot.scales[axis]["range"] for axis in "xy")


def show(line, end, now=None, scene=SCENE):
    line.show(Past(end, scene), ("transport",), "x", False, None, "transport",
              now or TimelineState(end, (0.5 * end, end), True))
    return said(line)


def test_axes_only_grow_within_a_run_and_end_at_round_numbers(line):
    """Twice an error of 0.4 % a second, with room for the curves' names; in another run they begin anew."""
    show(line, 0.8)
    assert ends(line) == ([0.0, 1.0], [0.0, pytest.approx(0.008)])
    show(line, 1.2)
    assert ends(line) == ([0.0, 1.5], [0.0, pytest.approx(0.01)])
    show(line, 0.3)
    assert line._plot.scales["x"]["range"] == [0.0, 1.5]
    show(line, 0.25, scene=BarScene(cells=20))
    assert line._plot.scales["x"]["range"] == [0.0, pytest.approx(0.3)]


def test_what_is_said_round_the_curves(line):
    """Places are parts of the axis, errors in per cent of the largest exact value; the unit of time is said once."""
    at = show(line, 0.8)
    assert at["tops"] == [[0.0, "0.8 %"], [0.5, "0.4 %"]] and at["start"] == "0"
    assert at["ticks"] == [[0.5, "0.5"], [1.0, "1 period"]]
    assert at["now"] == 0.8 and at["reach"] == [0.4, 0.8] and at["lost"] is None and at["clock"] == "0.8 s"
    assert at["names"] == [["true", "truth", 0.6], ["transport", "transport", 0.2]]
    assert at["changes"] == [pytest.approx(moment, abs=1 / BINS) for moment in (0.3, 0.5)]
    assert at["many"] == "2 cell changes so far"


def test_times_are_counted_in_periods_where_something_swings(line):
    """The ring's last a fiftieth of a second; of a patch test's nobody speaks."""
    ring, patch_test = RingScene(), BarScene(motion="patch")
    line._axis.pointed = 0.5
    at = show(line, 2.4 * ring.period, scene=ring)
    assert [text for _, text in at["ticks"]] == ["1", "2", "3 periods"]
    assert line._plot.scales["x"]["range"] == [0.0, pytest.approx(3 * ring.period)]
    assert at["read"][0] == "30 ms = 1.5 periods"
    at = show(line, 0.9, scene=patch_test)
    assert [text for _, text in at["ticks"]] == ["0.5", "1 s"]


def test_a_lost_run_says_since_when(line):
    at = show(line, 0.8, TimelineState(0.8, (0.0, 0.8), False, 0.6))
    assert (at["lost"], at["says"], at["playing"]) == (0.6, "lost from 0.6 s on", False)
    at = show(line, 0.8, TimelineState(0.8, (0.0, 0.8), False, 0.6, unstable=True))
    assert at["says"] == "unstable from 0.6 s on"
    later = show(line, 0.8, TimelineState(1.5, (0.0, 1.5), False, 1.5, unstable=True))  # than the last sample
    assert 0.7 < later["now"] < 0.9


def test_a_frame_is_found_by_its_time():
    recent = recent_of(20)
    step = recent.shown_frame[0].scene.time_step
    assert recent.seek(7.4 * step) and shown(recent) == 7
    assert recent.seek(0.0) and shown(recent) == 0
    assert recent.seek(1e9) and shown(recent) == 20
    assert recent.span == (0.0, 20 * step)


def test_while_it_moves_a_frame_is_shown_as_soon_as_the_run_stands():
    recent = recent_of(20)
    recent.add(*frame(21))
    step = recent.shown_frame[0].scene.time_step
    assert not recent.seek(7 * step) and shown(recent) == 21
    recent.add(*frame(22, playing=False))
    assert shown(recent) == 7


@pytest.mark.parametrize("wrong", [None, [], [1, 2, 3, 4, 5], [1, 2, 3, 4, 5, "6"], [1, 2, 3, 4, 5, -1],
                                   [1, 2, 3, 4, 5, 1e9], [1, 2, 3, 4, 5, float("nan")], [True] * 6, {"a": 1}])
def test_what_a_browser_says_of_its_window_is_believed_in_nothing(wrong):
    store, sizes = SimpleNamespace(heard={}), []
    window = BrowserWindow(store, sizes.append, sizes.append)
    store.heard["room"](wrong)
    store.heard["dark"]("yes")
    assert not sizes and window.size == LayoutMetrics()
    store.heard["room"]([700, 300, 144, 700, 60, 12])
    store.heard["dark"](True)
    assert sizes == [LayoutMetrics(700.0, 300.0, 144.0, 700.0, 60.0, 12.0), True]


def test_what_the_curves_are_under_the_pointer(line):
    """Between two samples in a straight line; nothing beyond the run, and nothing once the pointer has left."""
    line._axis.pointed = 0.5
    assert show(line, 0.8)["read"] == ["500 ms = 0.5 periods", "true 0.2 %", "transport 0.4 %"]
    line._axis.pointed = 0.95
    assert show(line, 0.9)["read"] == []
    line._axis.pointed = None
    assert show(line, 0.9)["read"] == []
