"""One session inside an engine: its speed, the beat of its frames and what they say."""

from contextlib import contextmanager
from dataclasses import replace
from multiprocessing.shared_memory import SharedMemory
from types import SimpleNamespace

import numpy as np
import pytest

from solvers.engine import session_stepper
from solvers.engine import shared_frames as memory
from solvers.engine.engine_messages import FRAME_SECONDS, Pace, SessionRequest
from solvers.engine.session_stepper import SessionStepper
from solvers.engine.shared_frames import FrameOptions
from solvers.engine.soundness_monitor import SoundnessMonitor
from solvers.problems.bar.scene import BarScene
from solvers.problems.bar.solver import BarSolver
from solvers.running.quantities_of_interest import ENERGY, STRESS
from solvers.running.run import run
from solvers.scene.estimator_limits import Limit
from solvers.solver import samples

SCENE = BarScene(cells=20, periods=1)


@contextmanager
def one_session(wish):
    """A stepper in this process that serves a wish, with a block of its own."""
    block = SharedMemory(create=True, size=memory.block_bytes(wish.scene))
    session = SessionStepper(replace(wish, memory=block.name))
    try:
        yield session
    finally:
        session.close()
        block.close()
        block.unlink()


@pytest.fixture
def clock(monkeypatch):
    """The clock is the test's own: nothing can be slow."""
    clock = SimpleNamespace(now=100.0)
    monkeypatch.setattr(session_stepper, "perf_counter", lambda: clock.now)
    return clock


def test_numbers_of_the_body_are_looked_at_twice_a_second(clock):
    """While it moves, those of half a second ago at most; where it stands, those of its moment, to the last bit what a
    run of the same steps ends with; and none by who does not hold."""
    scene = replace(SCENE, method="bspline", estimators=("transport", "companion"))
    with one_session(SessionRequest(1, 1, "", scene, Pace(speed=0.5))) as session:
        seen = []
        while clock.now < 101.5:
            memory.mark_as_read(session._block)
            clock.now += 0.05
            session.advance_slice()
            seen.append(session.write_frame().goals[ENERGY]["value"])
        assert 3 <= len(set(seen)) <= 4
        session.accept(replace(session.wish, pace=Pace(playing=False)))
        memory.mark_as_read(session._block)
        report = session.write_frame()
    ended = run(replace(scene, periods=None, t_end=report.time), goals=[ENERGY, STRESS])
    assert report.step == ended.steps and report.goals == ended.goals
    assert report.goals[ENERGY]["bar"]["companion"] is not None and "transport" not in report.goals[ENERGY]["bar"]


def test_playing_keeps_the_asked_speed(clock):
    """Simulated time follows the clock at the speed asked for."""
    with one_session(SessionRequest(1, 1, "", SCENE, Pace(speed=0.8))) as session:
        begun, start = session.write_frame().time, clock.now
        while clock.now < start + 0.5:
            memory.mark_as_read(session._block)
            clock.now += 0.007
            if session.is_behind:
                session.advance_slice()
            if session.frame_is_ready:
                report, at = session.write_frame(), clock.now
    assert (report.time - begun) / (at - start) == pytest.approx(0.8 * SCENE.period, rel=0.02)
    assert report.real_speed == pytest.approx(0.8 * SCENE.period, rel=0.02)


def test_a_frame_is_not_written_over_before_the_page_has_it(clock):
    """Not even one that is asked for; and what the page reads frees the block for the next."""
    with one_session(SessionRequest(1, 1, "", SCENE, Pace(speed=0.5))) as session:
        first = session.write_frame()
        for number in (2, 3):
            clock.now += 1.0
            session.accept(replace(session.wish, number=number, pace=Pace(number == 2, 0.5)))
            assert not (session.is_behind or session.frame_is_ready) and session.next_due < clock.now + 0.1
        memory.read_frame(session._block, SCENE, first.particles)
        assert session.frame_is_ready and session.write_frame().number == 3 and not session.frame_is_ready
        assert session.next_due == float("inf")


def test_turns_are_shorter_where_many_share_an_engine():
    """Eight thousandths of a second, until fifty are too few for all and their frames; not so short that launches are
    most of it."""
    with one_session(SessionRequest(1, 1, "", SCENE)) as session:
        session._seconds_a_step = 1e-6
        for sessions, frame, steps in ((1, 0, 8000), (6, 0, 8000), (10, 0, 5000), (10, 0.001, 4000), (30, 0.001, 667),
                                       (30, 0.002, 400), (200, 0, 400)):
            session.sessions, session._seconds_a_frame = sessions, frame
            assert session._slice_steps == pytest.approx(steps, abs=1)


@pytest.mark.parametrize("apart", [FRAME_SECONDS, 0.1])
def test_frames_keep_their_beat(clock, apart):
    """Looked after only every 7 ms, and 10 ms late for a turn, frames still come 30 a second, and evenly, or as many as
    are wished.

    Counted each from the one before it, they would be 22."""
    times = []
    with one_session(SessionRequest(1, 1, "", replace(SCENE, cells=8), Pace(speed=1e-6),
                                    frame_seconds=apart)) as session:
        while clock.now < 103.0:
            clock.now += 0.007
            if session.frame_is_ready:
                clock.now += 0.01  # the turn before the frame
                session.write_frame()
                memory.mark_as_read(session._block)
                times.append(clock.now)
    assert len(times) / 3.0 == pytest.approx(1 / apart, rel=0.04)  # one frame more or less of 30
    assert np.diff(times).min() > 0.45 * apart


def test_frames_are_late_when_they_come_too_seldom(clock):
    """At 20 a second instead of 30, and no longer once they come in time; a pause is nobody's fault."""
    with one_session(SessionRequest(1, 1, "", SCENE, Pace(speed=1e-6))) as session:
        def frames(apart, count=20):
            for _ in range(count):
                clock.now += apart
                while not session.frame_is_ready:
                    clock.now += 1e-3
                session.write_frame()
                memory.mark_as_read(session._block)
            return session.frames_are_late

        assert not frames(0.005)
        assert frames(0.05)
        assert not frames(0.005)
        for playing in (False, True):
            session.accept(replace(session.wish, pace=Pace(playing, 1e-6)))
            assert not frames(60.0, 1)


def test_a_session_goes_on_with_a_solver_that_has_been_prepared_for_it(clock):
    """If that is of its scene; it has the state of the one before either way."""
    with one_session(SessionRequest(1, 1, "", SCENE, Pace(False, single_steps=5))) as session:
        session.accept(replace(session.wish, pace=Pace(False, single_steps=12)))
        right, wrong = BarSolver(SCENE), BarSolver(replace(SCENE, cells=24))
        for prepared in (right, wrong, None):
            replacement = SessionStepper.from_state(session.state(), prepared)
            assert (replacement.solver is prepared) == (prepared is right) and replacement.solver.scene == SCENE
            assert replacement.solver.step == session.solver.step == 7
            np.testing.assert_array_equal(replacement.solver.snapshot().position, session.solver.snapshot().position)
            replacement.close()


def test_a_step_taken_apart_can_be_looked_at_from_another_particle_after_a_hand_over(clock):
    """The engine that takes over knows where that step began: else whoever asks waits for ever."""
    first = SessionRequest(1, 1, "", SCENE, Pace(False, single_steps=0), FrameOptions(broken_down=3))
    with one_session(first) as session:
        session.accept(replace(session.wish, pace=Pace(False, single_steps=5)))
        replacement = SessionStepper.from_state(session.state(), None)
        for one in (session, replacement):
            one.accept(replace(one.wish, frame=FrameOptions(broken_down=7)))
        theirs, ours = session.write_frame().breakdown, replacement.write_frame().breakdown
        assert theirs.particle == ours.particle == 7 and theirs.step == ours.step
        np.testing.assert_array_equal(theirs.velocity, ours.velocity)
        replacement.close()


def test_a_lost_run_goes_on_and_says_what_a_plain_run_says(clock):
    """Judged a frame at a time, it is lost from the same sample on, in the same words, and stays so."""
    scene = replace(SCENE, cells=40, ppc=1)
    result = run(scene, prices=False)
    with one_session(SessionRequest(1, 1, "", scene, Pace(speed=0.5))) as session:
        reports = []
        while not reports or reports[-1].time < scene.end_time:
            memory.mark_as_read(session._block)
            clock.now += 0.007
            if session.is_behind:
                session.advance_slice()
            if session.frame_is_ready:
                reports.append(session.write_frame())
    statuses = [report.status for report in reports]
    begun = statuses.index("lost")
    assert statuses == ["ok"] * begun + ["lost"] * (len(statuses) - begun) and reports[-1].playing
    # The page tries what may help; a plain run only names it.
    assert reports[-1].status == result.status and result.reason.startswith(f"{reports[-1].reason}; ")
    assert reports[-1].since == reports[begun].since == result.broken_at <= reports[begun].time


def test_a_finding_of_an_estimator_that_does_not_hold_counts_no_longer():
    """Found at first, dropped once the estimator is found not to hold, and no later one is missed for it."""
    scene = replace(SCENE, estimators=("recovered",))
    solver = BarSolver(scene)
    names = samples.column_names(scene.active_estimators, scene.active_effects)
    row = np.full((2, len(names)), np.nan)
    row[:, 0] = 10, 20
    row[0, names.index("recovered/estimate_x")] = 4 * SCENE.amplitude**2
    watch = SoundnessMonitor(scene)
    watch.check_samples(row[:1], 4)
    assert watch.current_status(solver, {})[0] == "lost" and "recovered" in watch.current_status(solver, {})[1]
    assert watch.current_status(solver, {"recovered": "it rains"}) == ("ok", None, None)
    row[1, names.index("neighbour_gap")] = SCENE.amplitude
    watch.check_samples(row[1:], 4)
    assert watch.current_status(solver, {"recovered": "it rains"})[2] == pytest.approx(20 * SCENE.time_step)
    assert watch.current_status(solver, {})[2] == pytest.approx(10 * SCENE.time_step)


def test_frames_say_what_is_not_valid(monkeypatch):
    """Known beforehand or found out in the run: a frame has the sentence, and loses it again half a period later, for
    an estimator that has broken down seems to hold at moments."""
    found = {"companion": "not valid here: it rains"}
    doubting = replace(BarSolver.HOOKS["companion"], verdict=lambda scene, memory: found.get("companion"))
    monkeypatch.setattr(BarSolver, "HOOKS", {"companion": doubting})
    with one_session(SessionRequest(1, 1, "", SCENE, Pace(False))) as session:
        assert session.write_frame().not_valid == found
        broken = dict(found)
        found.clear()
        half = 0.5 * SCENE.period / SCENE.time_step
        session._advance(int(0.98 * half))
        assert session.write_frame().not_valid == broken
        session._advance(int(0.04 * half))
        assert session.write_frame().not_valid == {}
        monkeypatch.setattr(BarScene, "LIMITS", (Limit("companion", "cells", least=17, why="it snows"),))
        session.accept(replace(session.wish, number=2, scene=replace(SCENE, cells=16)))
        assert session.write_frame().not_valid == {"companion": "not valid here: it snows"}


def test_a_run_is_read_at_its_very_end(clock):
    """Also where a sample was due a few steps before, in the same turn: the last numbers are those of a plain run."""
    scene = BarScene(cells=20, amplitude=0.01, cfl=0.1, periods=0.25, sample_every=15)
    plain = run(scene, prices=False).series["error_x"]
    assert scene.steps % 15
    with one_session(SessionRequest(1, 1, "", scene, Pace(speed=0.8, ends=True))) as session:
        rows = [session.write_frame().rows]
        while session.running:
            memory.mark_as_read(session._block)
            clock.now += 0.2
            if session.is_behind:
                session.advance_slice()
            if session.frame_is_ready:
                rows.append(session.write_frame().rows)
        memory.mark_as_read(session._block)
        report = session.write_frame()
        rows.append(report.rows)
    every = np.concatenate(rows)
    assert report.step == scene.steps and every[-1, samples.column_index("step")] == scene.steps
    errors = samples.read_rows(every, scene, scene.particles)["error_x"]
    assert errors[-1] == pytest.approx(plain[-1], rel=1e-12)
    assert (np.diff(every[:, samples.column_index("step")]) > 0).all()


def test_a_run_that_is_paused_is_read_where_it_stands(clock):
    """Between two samples, too, and once: what is said of the moment and what the table says of it are the same."""
    scene = BarScene(cells=20, amplitude=0.01, cfl=0.1, sample_every=50)
    with one_session(SessionRequest(1, 1, "", scene, Pace(speed=0.3))) as session:
        rows = [session.write_frame().rows]
        for number, playing in ((2, False), (3, True), (4, False)):
            memory.mark_as_read(session._block)
            if session.running:
                clock.now += 0.1
                session.advance_slice()
            session.accept(replace(session.wish, number=number, pace=replace(session.wish.pace, playing=playing)))
            report = session.write_frame()
            rows.append(report.rows)
        every = np.concatenate(rows)[:, samples.column_index("step")]
    assert report.step % 50 and every[-1] == report.step and (np.diff(every) > 0).all()


def until_frame(session, clock, apart=0.001):
    """The next frame of a session whose turns take so many seconds each."""
    while not session.frame_is_ready:
        assert session.is_behind and session.moving
        session.advance_slice()
        clock.now += apart
    report = session.write_frame()
    memory.mark_as_read(session._block)
    return report


@pytest.mark.parametrize("playing", [False, True])
@pytest.mark.parametrize("changes", [{"amplitude": 0.02}, {"modulus": 16.0}, {"cells": 33, "method": "ugimp"}], ids=str)
def test_another_scene_begins_where_it_is_asked_to(clock, changes, playing):
    """At the step next to that many periods, with all samples on the way and the errors of a plain run there; a run
    that plays goes on from there, at the speed asked for."""
    scene, at = replace(SCENE, **changes), 0.25
    step = round(at * scene.period / scene.time_step)
    with one_session(SessionRequest(1, 1, "", SCENE, Pace(playing))) as session:
        session.write_frame()
        memory.mark_as_read(session._block)
        assert session.accept(replace(session.wish, number=2, scene=scene, pace=Pace(playing, begin_at=at)))
        report = until_frame(session, clock)
        assert (report.step, report.number, report.fresh, report.playing) == (step, 2, True, playing)
        clock.now += 0.1
        assert session._steps_wanted() == (pytest.approx(0.1 * scene.period / scene.time_step, abs=1))
        assert session.is_behind == session.moving == playing
    plain = run(replace(scene, periods=None, t_end=report.time), mid_run=False)
    series = samples.read_rows(report.rows, scene, scene.particles)
    np.testing.assert_array_equal(report.rows[:, 0], [*range(0, step, scene.sample_interval), step][:len(report.rows)])
    for name in ("error_x", "error_v", "error_sigma", "companion/estimate_x"):
        np.testing.assert_array_equal(series[name], plain.series[name], err_msg=name)


def test_frames_show_the_way_to_an_instant_that_is_far(clock, monkeypatch):
    """After 0.15 s, also while the run is paused; the last of them is at the instant."""
    with one_session(SessionRequest(1, 1, "", SCENE, Pace(False, begin_at=3.0))) as session:
        monkeypatch.setattr(SessionStepper, "_slice_steps", 8)
        begun, reports = clock.now, [until_frame(session, clock, 0.008)]
        assert 0.15 <= clock.now - begun < 0.17 and 0 < reports[0].step < round(3 * SCENE.period / SCENE.time_step)
        while session.moving:
            reports.append(until_frame(session, clock, 0.008))
        assert reports[-1].step == round(3 * SCENE.period / SCENE.time_step) and session.next_due == float("inf")
    steps = np.concatenate([report.rows[:, 0] for report in reports])
    assert len(reports) > 3 and (np.diff(steps) > 0).all() and steps[-1] == reports[-1].step


def test_a_run_that_breaks_before_its_instant_stops_there(clock):
    """And says why, at once."""
    scene = replace(SCENE, amplitude=0.1, cfl=3.0)
    with one_session(SessionRequest(1, 1, "", scene, Pace(False, begin_at=0.9))) as session:
        report = until_frame(session, clock)
        assert report.status == "unstable" and report.reason and not session.moving
        assert 0 < report.time < 0.9 * scene.period


def test_an_instant_beyond_the_end_is_the_end(clock):
    """Of a run that ends; and one that is handed over on its way comes there too."""
    with one_session(SessionRequest(1, 1, "", SCENE, Pace(True, ends=True, begin_at=1.7))) as session:
        session.advance_slice()
        replacement = SessionStepper.from_state(session.state(), None)
        for one in (session, replacement):
            assert until_frame(one, clock).step == SCENE.steps and not one.moving
        replacement.close()
