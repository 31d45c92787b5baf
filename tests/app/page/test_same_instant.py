"""A slider's new run is shown at the instant at which the stage stood, never at t = 0."""

from dataclasses import replace

import numpy as np
import pytest

from app.language.translation import use_language
from app.page.visit import run_session as page
from app.page.visit.first_scene import first_scene
from app.page.visit.recent_frames import RecentFrames
from app.page.visitor_run_source import VisitorRunSource
from solvers.running.run import run
from tests.app.frame.test_view import report_of
from tests.support.page_server import SilentPool
from tests.support.processes import wait_until
from tests.support.session_listener import PATIENCE, SCENE

QUARTER = 0.25 * SCENE.period


class Requests(SilentPool):
    """A pool without engines, and its link, which keeps the paces that are asked for."""

    def __init__(self):
        self.paces = []

    def open(self, listener, beside=None):
        return self

    def ask(self, scene, pace, frame):
        self.paces.append(pace)
        return len(self.paces)


def show(visit, step):
    """As if a frame that answers the visit's last request had come."""
    visit.report = replace(report_of(visit.scene), number=visit._number, step=step, time=step * visit.scene.time_step)


@pytest.fixture
def visit(pool):
    """A session of the page whose run is paused a quarter of a period after its start, and the frames that come."""
    frames = []
    one = page.RunSession(page.PageEngineLinks(pool), SCENE, lambda report, arrays: frames.append(report), speed=5.0)
    wait_until(lambda: one.report and one.report.time > QUARTER, "a quarter of a period", PATIENCE)
    one.play(False)
    wait_until(lambda: not one.report.playing, "a pause", PATIENCE)
    yield one, frames
    one.close()


def answered(visit, frames, ask):
    """The first frame that answers a request."""
    ask()
    number = visit._number
    wait_until(lambda: any(report.number >= number for report in frames), "an answer", PATIENCE)
    return next(report for report in frames if report.number >= number)


def test_a_slider_keeps_the_instant(visit):
    """The first frame after a change is at the step next to it, with the errors of a plain run to there and all its
    samples; with another modulus, and so another period, it is at the same phase."""
    one, frames = visit
    periods = one.report.time / SCENE.period
    for change in ({"amplitude": 0.02}, {"modulus": 16.0}, {"cells": 32}):
        report = answered(one, frames, lambda: one.set_scene_fields(**change))  # noqa: B023
        scene = report.scene
        assert scene == one.scene and report.fresh and not report.playing
        assert report.step == round(periods * scene.period / scene.time_step)
        plain = run(replace(scene, periods=None, t_end=report.time), mid_run=False)
        wait_until(lambda: len(one.history.series["time"]) == len(plain.series["time"]), "all samples",  # noqa: B023
                   PATIENCE)
        np.testing.assert_array_equal(one.history.series["error_sigma"], plain.series["error_sigma"])


def test_a_restart_and_another_scene_begin_at_zero(visit):
    """Also if it is the same scene."""
    one, frames = visit
    for ask in (one.reset, lambda: one.set_scene(replace(SCENE, amplitude=0.02), speed=0.01)):
        report = answered(one, frames, ask)
        assert report.fresh and report.time < 0.5 * QUARTER


def test_another_problem_rests_at_the_same_phase(silent):
    """Of its first period, so that it is soon there; and at its end, not at its start, after whole ones."""
    one, paces = silent
    period = round(SCENE.period / SCENE.time_step)
    for step, phase in ((50, 50 / period), (2 * period + 50, 50 / period), (2 * period, 1.0), (0, 0.0)):
        one.set_scene(SCENE)
        show(one, step)
        one.play(False)
        one.set_scene(first_scene("square"), rests=True)
        assert paces[-1].begin_at == pytest.approx(phase) and not paces[-1].playing


def test_another_problem_is_named_in_place_of_the_old_verdict_until_its_first_frame_comes(silent):
    one, _ = silent
    source = VisitorRunSource(one, RecentFrames(), None, None, None, None)
    show(one, 50)
    assert not one.awaits_problem
    one.set_scene(first_scene("ring"))
    for code, said in (("en", "Expanding ring: being prepared … A "), ("de", "Sich weitender Ring: wird vorb")):
        with use_language(code):
            assert str(source.sentence(None, None)).startswith(said)
    show(one, 0)
    assert not one.awaits_problem


def test_a_pinned_run_comes_along(visit):
    """To the same number of periods, whatever the other's modulus is; and it comes there when it is pinned."""
    one, frames = visit
    periods = one.report.time / SCENE.period
    one.pin(lambda: None)
    step = round(periods * SCENE.period / SCENE.time_step)
    wait_until(lambda: one.pinned.last and one.pinned.last[0].step == step, "the pinned run's", PATIENCE)
    report = answered(one, frames, lambda: one.set_scene_fields(modulus=16.0))
    scene = report.scene
    assert report.fresh and report.step == round(periods * scene.period / scene.time_step)
    wait_until(lambda: one.pinned.last[0].step == round(periods * SCENE.period / SCENE.time_step), "the pinned run's",
               PATIENCE)


def test_a_run_by_another_method_follows_every_change(visit):
    """It has the visitor's scene but for the method, at the same instant; where its method does not allow a change, it
    stays as it is; a scene that is put on the stage is followed, too."""
    one, frames = visit
    one.pin(lambda: None, method="mpm")
    assert one.pinned.scene == replace(SCENE, method="mpm") and one.pinned_scene is None
    for change in ({"cells": 32}, {"modulus": 16.0}, {"method": "bspline"}):
        report = answered(one, frames, lambda: one.set_scene_fields(**change))  # noqa: B023
        wanted = replace(report.scene, method="mpm")
        assert report.step > 0
        wait_until(lambda: one.pinned.last and (one.pinned.last[0].scene, one.pinned.last[0].step)
                   == (wanted, report.step), "the same change at the same instant", PATIENCE)  # noqa: B023
    one.set_scene(replace(SCENE, amplitude=0.01))
    assert one.pinned.scene == replace(SCENE, amplitude=0.01, method="mpm")


@pytest.fixture
def silent():
    """A session without an engine, and the paces that it asks for."""
    pool = Requests()
    return page.RunSession(pool, SCENE, lambda *_: None), pool.paces


def test_the_instant_does_not_drift_and_survives_what_is_on_its_way(silent):
    """It is not rounded to steps again and again, and neither frames on the way to it nor runs that break before change
    it; playing on does."""
    one, paces = silent
    show(one, 50)
    asked = []
    for step, change in ((50, {"amplitude": 0.02}), (None, {"amplitude": 0.021}), (3, {"cells": 33}),
                         (0, {"cells": 34}), ("there", {"cells": 35}), ("there", {"modulus": 9.0}),
                         ("on", {"modulus": 10.0})):
        if step is not None:
            show(one, {"there": one._pace.first_step(one.scene), "on": 200}.get(step, step))
        at = one.report.time / one.report.scene.period
        one.set_scene_fields(**change)
        asked.append(paces[-1].begin_at)
    assert asked[:-1] == [50 * SCENE.time_step / SCENE.period] * 6 and asked[-1] == at > asked[0]
    one.reset()
    one.set_scene_fields(cells=20)
    assert [pace.begin_at for pace in paces[-2:]] == [0.0, 0.0]


def test_a_run_beyond_its_end_stays_there(silent):
    """And one that has ended there stays at its end."""
    one, paces = silent
    one.set_scene(SCENE, ends=True)
    show(one, SCENE.steps)
    one.set_scene_fields(amplitude=0.02)
    assert paces[-1].ends and paces[-1].begin_at == pytest.approx(1.0)
    show(one, one.scene.steps)
    one.play(True)
    show(one, 2 * one.scene.steps)
    one.set_scene_fields(amplitude=0.03)
    assert not paces[-1].ends and paces[-1].begin_at == pytest.approx(2.0)
