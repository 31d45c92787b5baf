"""A visitor's landscapes: what is requested of the engine, in which order, and what is given up."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from app.page.visit import landscapes
from app.page.visit.landscapes import Landscapes
from solvers.engine.engine_messages import Pace
from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.running.run import run
from solvers.solver.soundness import OK, UNSTABLE
from solvers.study.landscape.error_history import TRUTH, ErrorHistory, HistoryCache
from solvers.study.landscape.landscape import COSTLY, PENDING
from solvers.study.landscape.parameter_values import history_key
from tests.support.processes import wait_until
from tests.support.session_listener import SCENE

BAR = BarScene(method="mpm", amplitude=0.0034, estimators=("recovered",), periods=1)
ALL = ["amplitude", "cells", "ppc", "cfl", "modulus"]


class Link:
    """Stands for the link to an engine; ``compute`` answers what was requested last."""

    def __init__(self, histories):
        self.histories, self.sent = histories, []

    def survey(self, scene, points=()):
        self.sent.append((scene, list(points)))

    def compute(self, count, status):
        scene, points = self.sent[-1]
        for point in points[:count]:
            phase = np.array([0.5, 1.0]) * point.until
            errors = np.array(4 * [[0.5, 1.0]])
            broken_at = 0.0 if status(point) != OK else math.inf
            history = ErrorHistory(point.until, phase, {TRUTH: errors, "recovered": errors}, np.full(4, 10.0),
                                   status(point), broken_at, 3e7)
            self.histories.put([(history_key(scene, point.parameter, point.value), history)])


@pytest.fixture
def visit():
    """A visitor's session without an engine, and its landscapes."""
    histories = HistoryCache()
    session = SimpleNamespace(scene=BAR, playing=False, link=Link(histories))
    return session, Landscapes(session, histories, lambda: None)


def sound(_):
    return OK


def request(its, hand=None, until=0.25, **options):
    its.request(hand, until, "sigma", "recovered", **options)
    return its.curves()


def test_coarse_points_come_first_and_the_slider_in_hand_before_all(visit):
    session, its = visit
    curves = request(its)
    (scene, points), = session.link.sent
    assert [*curves] == ALL and scene == BAR and len(points) > 50
    assert all(status == PENDING for curve in curves.values() for status in curve.status)
    assert [point.level > 0 for point in points] == sorted(point.level > 0 for point in points)
    request(its, "ppc")
    points = session.link.sent[-1][1]
    assert {point.value for point in points[:8]} == set(range(1, 9)) and {p.parameter for p in points[:8]} == {"ppc"}
    assert points[8].parameter != "ppc" and points[8].level == 0


def test_what_comes_is_shown_until_all_is_there(visit):
    session, its = visit
    request(its)
    session.link.compute(5, sound)
    curves = request(its)
    assert sum(status == OK for curve in curves.values() for status in curve.status) >= 5
    assert len(session.link.sent) == 1  # the engine has the others already
    session.link.compute(None, sound)
    curves = request(its)
    assert all(curve.complete for curve in curves.values()) and len(session.link.sent) == 1
    assert curves["amplitude"].true == tuple(0.1 for _ in curves["amplitude"].values)
    assert curves["amplitude"].seconds[0] == pytest.approx(160 * 400 / 3e7) and curves["modulus"].flat
    assert request(its) is curves  # nothing has changed


def test_whoever_rests_is_told_of_the_points_that_were_missing():
    """Not of others' points, nor while the run plays, as its numbers are refreshed anyway, nor after the visit."""
    told, histories = [], HistoryCache()
    session = SimpleNamespace(scene=BAR, playing=False, link=Link(histories))
    its = Landscapes(session, histories, lambda: told.append(len(told)))
    request(its)
    histories.put([("another run", ErrorHistory(1.0))])
    session.playing = True
    session.link.compute(1, sound)
    assert not told
    session.playing = False
    request(its)
    session.link.compute(2, sound)
    assert told == [0]  # of the second point, as the first is known
    its.close()
    session.link.compute(5, sound)
    assert told == [0]


def test_points_of_an_earlier_scene_are_given_up_and_a_held_slider_begins_none(visit):
    session, its = visit
    request(its, "cells")
    session.scene = replace(BAR, cells=50)
    curves = request(its, "cells", held=True)
    assert session.link.sent[-1] == (session.scene, []) and 50 in curves["cells"].values
    session.scene = replace(BAR, cells=60)
    request(its, "cells", held=True)
    assert len(session.link.sent) == 2
    request(its, "cells")
    assert session.link.sent[-1][0] == session.scene and session.link.sent[-1][1]


def test_what_another_visitor_or_slider_has_requested_is_there_at_once(visit):
    session, its = visit
    request(its)
    session.link.compute(None, sound)
    other = SimpleNamespace(scene=replace(BAR, amplitude=0.00306), playing=False, link=Link(session.link.histories))
    curves = request(Landscapes(other, session.link.histories, lambda: None))
    assert curves["amplitude"].complete and OK in curves["cells"].status  # the stage's own run


def test_a_playing_run_gets_coarse_points_that_last(visit):
    """They are of a later time, so that few are computed again; those of the slider in hand are complete."""
    session, its = visit
    session.playing = True
    request(its, "ppc", until=0.3)
    points = session.link.sent[-1][1]
    assert {point.until for point in points} == {1.0}
    assert {point.parameter for point in points if point.level} == {"ppc"}
    session.link.compute(None, sound)
    request(its, "ppc", until=0.4)
    assert len(session.link.sent) == 1
    # Beyond that time what is known stays until it is known better.
    assert request(its, "ppc", until=1.6)["ppc"].true[0] == 0.1 and len(session.link.sent) == 2


def test_cliffs_get_two_points_more(visit):
    session, its = visit
    before = len(request(its)["cfl"].values)
    for _ in range(4):
        session.link.compute(None, lambda point: UNSTABLE if point.parameter == "cfl" and point.value > 0.66 else OK)
        curve = request(its)["cfl"]
    assert len(curve.values) == before + 2 and curve.complete
    last_sound = max(value for value, status in zip(curve.values, curve.status, strict=True) if status == OK)
    assert last_sound <= 0.66 < 1.1 * last_sound


def test_dear_points_are_left_out(visit):
    session, its = visit
    session.scene = RingScene(cells=48)
    curves = request(its, until=1.0)
    assert COSTLY in curves["cells"].status and PENDING in curves["cells"].status
    dear = {value for value, status in zip(curves["cells"].values, curves["cells"].status, strict=True)
            if status == COSTLY}
    assert dear and not dear & {point.value for point in session.link.sent[-1][1] if point.parameter == "cells"}


def test_points_that_do_not_come_are_requested_again(visit, monkeypatch):
    """Their engine may have been replaced."""
    session, its = visit
    request(its)
    monkeypatch.setattr(landscapes, "PATIENCE", -1.0)
    request(its)
    assert session.link.sent[0] == session.link.sent[1]


def test_runs_that_no_fork_can_compute_have_none(visit):
    session, its = visit
    session.scene = RingScene(plan="parallel", threads=2)
    assert request(its) == {} and not session.link.sent


def test_a_real_engine_computes_them(pool, session):
    """All points, among them the run on the stage."""
    link, listener = session
    listener.frame(link.ask(SCENE, Pace(False)))
    its = Landscapes(SimpleNamespace(scene=SCENE, playing=False, link=link), pool.histories, lambda: None)
    wait_until(lambda: (curves := request(its)) and all(curve.complete for curve in curves.values()), "all points")
    result = run(replace(SCENE, periods=0.25))
    largest = np.max(result.series["error_sigma"]) / SCENE.size_of("sigma")
    for name, curve in its.curves().items():
        present = curve.values.index(0.05 if name == "cfl" else getattr(SCENE, name))
        assert curve.true[present] == pytest.approx(largest, rel=1e-12), name
        assert curve.seconds[present] > 0
