"""Whose errors the stage shows: each problem's as it was left, and one that says something of the quantity."""

from types import SimpleNamespace

import numpy as np
import pytest

from app.page.panels.quantity_and_estimator_widgets import QuantityAndEstimatorWidgets
from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from tests.app.page.panel import Gui

BAR, RING = BarScene(estimators=("recovered", "transport")), RingScene(estimators=("transport", "companion"))


@pytest.fixture
def choice():
    session = SimpleNamespace(scene=BAR, set_frame_options=lambda **_: None)
    made = QuantityAndEstimatorWidgets(Gui(), session, SimpleNamespace(reset=lambda: None), lambda: None)
    made.set_estimators(BAR.estimators)

    def put(scene):
        made.restore_last_estimator(scene.problem)
        session.scene = scene
        made.set_estimators(scene.estimators)

    return made, put


def frame(silent):
    """Estimates of two particles, of which transport's lack a quantity."""
    estimate = {name: np.ones((2, 4)) for name in ("transport", "companion")}
    estimate["transport"][:, silent] = np.nan
    return SimpleNamespace(estimate=estimate)


def test_each_problem_keeps_its_own(choice):
    made, put = choice
    assert made.estimator == "recovered"
    put(RING)
    made.show_estimator("companion")
    put(BAR)
    assert made.estimator == "recovered"
    made.show_estimator("transport")
    put(RING)
    assert made.estimator == "companion"
    put(BAR)
    assert made.estimator == "transport"


def test_one_that_says_nothing_gives_way_unless_it_was_asked_for(choice):
    made, put = choice
    put(RING)
    assert made.estimator == "transport"
    made.show_quantity("sigma")
    made.ensure_estimator_has_values(BAR, frame(2))  # of the problem before
    assert made.estimator == "transport"
    made.ensure_estimator_has_values(RING, frame(2))
    assert made.estimator == "companion"
    made.show_estimator("transport")
    made.ensure_estimator_has_values(RING, frame(2))
    assert made.estimator == "transport"  # its silence is what is to be seen
    made.show_quantity("x")
    made.ensure_estimator_has_values(RING, frame(2))
    assert made.estimator == "transport"
