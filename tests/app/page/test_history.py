"""Numbers that are worked out from a live run's history: crossings per second, and the speed that is read. No web
server, no engine."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from app.frame.crossings import WINDOW
from app.page.features.own.run import OwnRun
from app.page.panels.readout import readout
from app.page.stage.worst import WorstRegions
from app.page.visit.history import History
from solvers.problems.bar.scene import BarScene
from tests.app.frame.test_view import report_of

#: Three periods of 1/4 s and of 4 s: a number by the period would be wrong by as much, and by its square for over.
QUICK, SLOW = BarScene(modulus=64.0), BarScene(modulus=0.25)


@pytest.mark.parametrize("scene", [QUICK, SLOW], ids=["quick", "slow"])
def test_a_rate_of_crossings_is_per_second(scene):
    """A history made up: 40 crossings a second, then none, then 120; looked at a hundred times a period, and seldom.
    The rate is there a window later, whatever the period is."""
    T = scene.period
    history = History(scene, scene.particles)
    for steps in (300, 15):
        time = np.linspace(0, 3 * T, steps + 1)
        count = np.interp(time, [0, T, 2 * T, 3 * T], np.cumsum([0, 40 * T, 0, 120 * T]))
        at, rate = history.crossings_per_second({"time": time, "crossings": count})
        late = max(WINDOW * T, time[1] * (1 + 1e-9))
        for start, expected in ((0, 40.0), (1, 0.0), (2, 120.0)):
            inside = (at >= start * T + late) & (at <= (start + 1) * T)
            assert inside.sum() >= 4
            np.testing.assert_allclose(rate[inside], expected, rtol=0, atol=1e-9 * 120)


def test_a_rate_of_crossings_in_a_file_is_per_second():
    """7, 3 and 10 particles are elsewhere after a half, a quarter and a second."""
    file = SimpleNamespace(times=np.array([0, 0.5, 0.75, 1.75]), _crossed=np.array([0, 7, 3, 10]))
    at, rate = OwnRun.crossings_per_second(file, {})
    np.testing.assert_array_equal(at, [0.5, 0.75, 1.75])
    np.testing.assert_allclose(rate, [14, 12, 10])


@pytest.mark.parametrize("scene, said", [(QUICK, "1.2 of 1.25 periods/s"), (SLOW, "0.075 of 1.25 periods/s")])
def test_the_speed_is_read_in_periods(scene, said):
    """0.3 simulated seconds a second are 1.2 periods of 1/4 s, or 0.075 of 4 s, and only that is too slow."""
    session = SimpleNamespace(history=SimpleNamespace(series={}, margin=np.nan), speed=1.25, pinned=None, ended=False)
    report = replace(report_of(scene), real_speed=0.3, playing=True)
    html = readout(session, session.history, report, "x", "transport", None, WorstRegions()).html
    assert f"<td>speed</td>\n<td>{said}" in html
    assert ("CAPPED" in html) == (scene is SLOW)
