"""Two runs side by side: an engine keeps partners together in periods, whatever each costs and whatever happens."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from app.names_and_units import difference_text
from app.page.panels.time_plots import pinned_curves
from app.page.visit import run_session as page
from app.page.visit.first_scene import first_scene
from solvers.engine import compiling_fork
from solvers.engine.engine_messages import FRAME_SECONDS, Pace
from solvers.engine.session_stepper import MOST_APART
from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from tests.support.processes import wait_until
from tests.support.session_listener import PATIENCE, SCENE, Listener, assert_same

CHEAP, COSTLY = SCENE, replace(SCENE, cells=160, ppc=8, modulus=16.0)  # half the period, and 400 times the work


@pytest.fixture
def pair(pool, session):
    """Two sessions, the second the partner of the first; each with what it hears."""
    link, listener = session
    other = Listener()
    partner = pool.open_session(other, link)
    yield link, listener, partner, other
    partner.close()


def play(link, scene, speed, playing=True, restarts=0, steps=0):
    """Ask for a scene at a speed in periods a second."""
    return link.ask(scene, Pace(playing, speed, restarts, steps))


def periods(listener):
    report = listener.frames[-1][0]
    return report.time / report.scene.period


def moved(listener):
    """Periods from the frame before the one before the last to the last."""
    times = [report.time / report.scene.period for report, _ in listener.frames[-3:]]
    return max(times) - min(times)


@pytest.mark.parametrize(("order", "speed"), [(1, 0.5), (-1, 10.0)],
                         ids=["cheap first, at ease", "costly first, beyond what it can"])
def test_both_come_to_the_same_number_of_periods(pair, order, speed):
    """However different their costs and periods are. One may be so far ahead, and the frames compared are of two
    moments: what either has moved in two frames is allowed for. Left to themselves they would be whole periods
    apart after a second at the higher speed."""
    link, listener, partner, other = pair
    one, two = (CHEAP, COSTLY)[::order]
    play(link, one, speed)
    other.frame(play(partner, two, speed))
    for k in range(1, 60):
        other.wait(lambda: len(other.frames) > k)  # noqa: B023
        gap, lead = abs(periods(listener) - periods(other)), min(speed * FRAME_SECONDS, MOST_APART)
        assert gap < lead + moved(listener) + moved(other)
    assert periods(other) > 0.1


def test_nobody_waits_for_ever(pair):
    """A frame's worth may be less than a step of either: the one behind takes one all the same, then the other."""
    link, listener, partner, other = pair
    scenes = replace(SCENE, cells=8, cfl=0.5), replace(SCENE, cells=10, cfl=0.4)
    assert all(0.3 * FRAME_SECONDS * scene.period < scene.time_step for scene in scenes)
    for one, scene in zip((link, partner), scenes, strict=True):
        play(one, scene, 0.3)
    for hears in (listener, other):
        hears.wait(lambda: hears.frames and hears.frames[-1][0].step > 10)  # noqa: B023


def test_both_begin_again_together(pair):
    """A partner that comes, another scene of either and a reset begin both at t = 0."""
    link, listener, partner, other = pair
    listener.frame(play(link, CHEAP, 0.5), lambda r: r.time > 0.1)
    other.frame(play(partner, SCENE, 0.5), lambda r: r.time > 0.1)
    listener.wait(lambda: sum(r.fresh for r, _ in listener.frames) == 2)
    for restarts, scene in ((0, replace(SCENE, cells=24)), (1, replace(SCENE, cells=24))):
        listener.frame(play(link, scene, 0.5, restarts=restarts), lambda r: r.fresh)
        other.wait(lambda: sum(r.fresh for r, _ in other.frames) == 2 + restarts)  # noqa: B023
    assert sum(r.fresh for r, _ in listener.frames) == 4


@pytest.mark.parametrize("how", ["unstable", "gone"])
def test_the_other_goes_on_when_one_stops(pair, how):
    """A partner that has become unstable, or has left, holds nobody."""
    link, listener, partner, other = pair
    play(link, SCENE, 2.0)
    bad = replace(SCENE, cfl=1.5) if how == "unstable" else COSTLY
    other.frame(play(partner, bad, 2.0), lambda r: how == "gone" or r.status == "unstable")
    if how == "gone":
        partner.close()
    then = periods(listener)
    listener.wait(lambda: periods(listener) > then + 1.0)


@pytest.mark.skipif(not compiling_fork.CAN_FORK, reason="only Linux can fork a process that runs Taichi")
def test_a_pair_outlives_its_engine_to_the_bit(pool, pair):
    """Another visitor asks for what must be compiled: the pair, paused at step 7, goes on in the new process, both are
    after 5 more steps what twelve steps are, and they are still partners: a reset begins both again."""
    scenes, hearers, links = (SCENE, replace(SCENE, cells=24)), pair[1::2], pair[::2]
    for steps in (0, 7):
        for link, hears, scene in zip(links, hearers, scenes, strict=True):
            hears.frame(play(link, scene, 0.5, False, steps=steps), lambda r: r.step == steps)  # noqa: B023
    before, visitor, since = pool.process_ids[0], Listener(), {hears: len(hears.frames) for hears in hearers}
    asking = pool.open_session(visitor)
    visitor.frame(asking.ask(replace(SCENE, method="bspline", estimators=())))
    asking.close()
    assert pool.process_ids[0] != before
    for link, hears, scene in zip(links, hearers, scenes, strict=True):
        _, arrays = hears.frame(play(link, scene, 0.5, False, steps=12), lambda r: r.step == 12)
        assert_same(arrays, scene, 12)
        assert not any(r.fresh for r, _ in hears.frames[since[hears]:]) and not hears.losses
    count = len(hearers[1].frames)
    play(links[0], scenes[0], 0.5, False, restarts=1)
    hearers[1].wait(lambda: any(r.fresh for r, _ in hearers[1].frames[count:]))


@pytest.fixture
def visit(pool):
    """A session of the page, with what it draws."""
    drawn = []
    one = page.RunSession(page.PageEngineLinks(pool), SCENE, lambda report, arrays: drawn.append(report))
    wait_until(lambda: one.report is not None, "a frame", PATIENCE)
    yield one
    one.close()


def test_a_pinned_run_stays_while_the_session_changes(visit):
    """It keeps the scene that was shown, has frames and a history of its own, follows pauses, and goes when unpinned or
    when another problem is chosen."""
    news = []
    visit.pin(lambda: news.append(1))
    assert visit.pinned_scene == SCENE
    run = visit.pinned
    visit.set_scene_fields(cells=24)
    wait_until(lambda: run.last and run.last[0].time > 0.1 and visit.report.scene.cells == 24, "both under way",
               PATIENCE)
    assert news and run.last[0].scene == run.scene == SCENE
    assert abs(run.last[0].time - visit.report.time) < 0.5 * SCENE.period
    assert not visit.others_playing
    view = run.view("x", "recovered", False)
    assert view.left.by == "by companion" and view.right.sizes.shape == (SCENE.particles,)
    series = visit.history.series
    norm, estimate = pinned_curves(run, visit.history, series, "x", "companion", False)[0]
    assert len(norm) == len(estimate) == len(series["time"]) and np.isfinite(norm[:3]).all()
    visit.play(False)
    wait_until(lambda: not run.last[0].playing, "a pinned run paused", PATIENCE)
    visit.set_scene(first_scene("ring"))
    assert visit.pinned is None
    visit.report = replace(visit.report, number=visit._number)  # as if the ring were there
    assert visit._urgent_notice(False).sentence.startswith("Unpinned: ")
    link = run._link
    assert link.ask(SCENE) == link.wish.number  # closed: nothing is asked any more


def test_grey_curves_are_put_at_the_same_number_of_periods():
    """A run of half the period is drawn at twice its times, interpolated, and not beyond its end."""
    def history(scene, end):
        time = np.linspace(0, end * scene.period, 41)
        names = ("error_x", "companion/estimate_x", "companion/index_x")
        return SimpleNamespace(scene=scene, crossings_per_second=lambda series: (time, time),
                               series={"time": time, **{name: time / scene.period for name in names}})

    live, fast = history(SCENE, 2.0), history(replace(SCENE, modulus=16.0), 1.0)
    run = SimpleNamespace(history=fast, estimator=lambda drawn: drawn)
    (norm, estimate), (index,), (crossings,) = pinned_curves(run, live, live.series, "x", "companion", False)
    periods = live.series["time"] / SCENE.period
    there = periods <= 1.0
    for curve in (norm, estimate, index):
        np.testing.assert_allclose(curve[there], periods[there], atol=1e-12)  # rounding
        assert np.isnan(curve[periods > 1.06]).all()
    assert np.isnan(crossings[-1])
    assert pinned_curves(None, live, live.series, "x", "companion", False) == [[], [], []]


def test_a_caption_names_what_differs():
    """In words, once each, and nothing that both have."""
    assert difference_text(BarScene(method="mpm", amplitude=0.01), BarScene()) == "MPM (hat functions), A = 10 mm"
    assert difference_text(BarScene(), BarScene(method="mpm", amplitude=0.01)) == "uGIMP, A = 25 mm"
    assert difference_text(BarScene(dt="auto", estimators=()), BarScene()) == "no estimator, auto step"
    assert difference_text(RingScene(layout="cartesian", ppc=3), RingScene()) \
        == "3 × 3 particles per cell, layout Cartesian"
    assert difference_text(BarScene(periods=3), BarScene()) == ""
