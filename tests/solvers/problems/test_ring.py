"""What only the ring has: energy, resonance, the amplitudes that it bears. The independent program's table and orders
are in tests/solvers/estimators/test_accuracy.py."""

import math

import numpy as np
import pytest

from solvers.problems.ring import RingScene
from solvers.problems.ring_estimator_limits import expected_life
from solvers.scene.validation import SceneError
from tests.closed_forms import ring
from tests.ring_growth import disturbance_growth, growth_table
from tests.support.paths import ROOT

METHODS = ["ugimp", "cpgimp", "cpdi"]


@pytest.mark.parametrize("method", METHODS)
def test_energy_balance(method, simulate):
    """Kinetic + strain - work keeps its start to 5 % at 24 cells; a missing term would show as a fifth or more."""
    series = simulate(RingScene(method=method, cells=24, cfl=0.05)).series
    balance = series["kinetic"] + series["strain"] - series["work"]
    assert np.abs(balance / balance[0] - 1).max() < 0.05
    assert np.ptp(series["strain"]) > 0.2 * balance[0] and np.ptp(series["work"]) > 0.2 * balance[0]


def test_resonance_growth_and_expected_life():
    """The factors by linearised theory, and the periods that CPDI lasts at A = 0.15 on 24, 48 and 96 cells."""
    for A in (0.1, 0.12, 0.13, 0.14, 0.15):
        assert RingScene(amplitude=A).disturbance_growth == pytest.approx(disturbance_growth(A, 2), abs=6e-3)
    large = RingScene(amplitude=0.15)
    for first, periods in ((1.07e-3, 5.8), (1.64e-4, 7.8), (2.26e-5, 9.9)):
        assert expected_life(large, first) == pytest.approx(periods, abs=0.05)
    assert expected_life(RingScene(amplitude=0.1)) == math.inf
    assert "grows 2.57-fold a period or faster" in RingScene(amplitude=0.16).warnings()[0]


def test_the_table_of_growth_is_what_its_program_prints():
    assert growth_table().strip() in (ROOT / "assets/stability.md").read_text(encoding="utf-8")


def test_amplitude_rules():
    """Inversion from 0.386 on is refused, resonance from 0.115 and wrinkling above 0.198 only told."""
    assert RingScene(amplitude=0.114).warnings() == []
    assert "parametric resonance" in RingScene(amplitude=0.115).warnings()[0]
    assert "wrinkles" not in RingScene(amplitude=0.19).warnings()[0]
    assert "wrinkles" in RingScene(amplitude=0.2).warnings()[0]
    for value in (0.386, 0.5, 0.0, -0.1, math.nan):
        with pytest.raises(SceneError, match="amplitude"):
            RingScene(amplitude=value)
    R = np.linspace(ring.INNER, ring.OUTER, 10_001)
    w, slope, _ = ring.shape(R)
    assert 1 / max(np.abs(slope).max(), (w / R).max()) == pytest.approx(0.386, abs=1e-3)
