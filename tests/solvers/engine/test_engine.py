"""The engine: frames come, the latest wish wins, a killed engine is replaced and a bad run is reported."""

import os
import signal
import subprocess
import sys
from dataclasses import replace
from multiprocessing.shared_memory import SharedMemory
from time import thread_time

import numpy as np
import pytest

from solvers.engine.engine_messages import Pace, SessionRequest
from solvers.engine.engine_server import FAILED
from solvers.engine.shared_frames import FrameOptions
from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.running.run import build
from solvers.solver import samples
from solvers.workers.worker_process import descendants
from tests.support.processes import RunningTime, stop_processes
from tests.support.session_listener import PATIENCE, SCENE, Listener, assert_same


class Deadly(BarScene):
    """Ends the process that unpickles it: a scene that kills its engine every time."""

    def __reduce__(self):
        return os._exit, (1,)


class Failing(BarScene):
    """Cannot be built."""

    def __reduce__(self):
        return str, ("no scene",)


def test_page_process_stays_free_of_taichi():
    """A kernel launch would hold the lock that the web server needs: the page never even imports Taichi."""
    code = "import sys, app.page.page, app.page.page_server, solvers.engine.engine_pool\n" \
        "sys.exit('taichi' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


def test_frames_carry_the_solvers_numbers(session):
    """A paused session after n single steps shows what the solver has after n steps."""
    link, listener = session
    first = link.ask(SCENE, Pace(False))
    listener.frame(first)
    report, arrays = listener.frame(link.ask(SCENE, Pace(False, single_steps=7)), lambda r: r.step == 7)
    assert report.scene == SCENE and report.time == 7 * SCENE.time_step
    assert_same(arrays, SCENE, 7)


def test_latest_wish_wins_and_asking_never_waits(pool, session):
    """400 wishes in a burst to an engine that takes nothing, as one that compiles: none holds up a callback of the
    page, and the last is answered at once, not after 400 rebuilds."""
    link, listener = session
    listener.frame(link.ask(SCENE))
    begun = thread_time()
    with stop_processes(pool.process_ids):
        for k in range(400):
            number = link.ask(replace(SCENE, amplitude=0.01 + 1e-4 * k))
        asked = thread_time() - begun
        assert listener.frames[-1][0].number < number
        watch = RunningTime(pool.process_ids[0])
    report, _ = listener.frame(number)
    assert report.scene.amplitude == pytest.approx(0.01 + 1e-4 * 399)
    assert asked < 0.5 and watch.seconds < 1.0
    assert sum(r.fresh for r, _ in listener.frames) < 200


def test_slider_to_first_new_frame(pool, session):
    """The promise is 150 ms from a changed number to its first frame, other work on the machine not counted."""
    link, listener = session
    listener.frame(link.ask(SCENE))
    waits = []
    for cells in range(30, 130, 10):
        watch = RunningTime(pool.process_ids[0])
        report, arrays = listener.frame(link.ask(replace(SCENE, cells=cells)))
        waits.append(watch.seconds)
        assert len(arrays.position) == 4 * cells == report.scene.particles
    assert sorted(waits)[5] < 0.15


def test_killed_engine_comes_back(pool, session):
    """The process is replaced, the session is told, and its scene begins again without being asked."""
    link, listener = session
    number = link.ask(SCENE)
    listener.frame(number)
    old = pool.process_ids[0]
    family = {old, *descendants(old)}
    os.kill(old, signal.SIGKILL)
    listener.wait(lambda: listener.losses == 1)
    assert not family & set(descendants(os.getpid()))  # no zombie either, before another engine says something
    report, _ = listener.frame(number + 1, lambda r: r.fresh)
    assert report.scene == SCENE and report.time < SCENE.period
    assert pool.process_ids[0] != old
    assert pool.wait_ready(PATIENCE)


def test_a_scene_that_keeps_killing_is_given_up(pool, session):
    """After four deaths without a frame between them the visitor is told, and a new wish is served again."""
    link, listener = session
    listener.frame(link.ask(SCENE, Pace(False)))
    link.ask(Deadly(cells=20, periods=1), Pace(False))
    for losses in (1, 2, 3):
        listener.wait(lambda losses=losses: listener.losses >= losses)
    listener.wait(lambda: listener.troubles)
    assert listener.losses == 3 and "change a setting" in listener.troubles[0]
    report, _ = listener.frame(link.ask(replace(SCENE, cells=24), Pace(False)))
    assert report.scene.cells == 24
    assert pool.wait_ready(PATIENCE)


def test_unstable_run_ends_with_a_reason(session):
    """A step beyond the stability limit ends the run in words, and the session lives on."""
    link, listener = session
    number = link.ask(replace(SCENE, cfl=1.5), Pace(speed=5.0))
    report, _ = listener.frame(number, lambda r: r.status == "unstable")
    assert "went unstable" in report.reason and not report.playing and report.since <= report.time
    report, _ = listener.frame(link.ask(SCENE))
    assert (report.status, report.reason, report.since) == ("ok", None, None)


def test_growing_scene_gets_a_larger_block(session):
    """Frames stay right while the shared memory block is replaced by a larger one."""
    link, listener = session
    for cells in (8, 500, 12, 2000):
        scene = replace(SCENE, cells=cells)
        report, arrays = listener.frame(link.ask(scene, Pace(False)))
        assert report.scene == scene
        X = (np.arange(scene.particles) + 0.5) / scene.particles
        np.testing.assert_allclose(arrays.position[:, 0], X, atol=1e-6)  # single precision near 1


def test_leaving_frees_the_memory(pool):
    """A closed session's block is gone, and the engine serves others."""
    listener = Listener()
    link = pool.open_session(listener)
    listener.frame(link.ask(SCENE))
    name = link.wish.memory
    link.close()
    with pytest.raises(FileNotFoundError):
        SharedMemory(name)


ORPHANED = """
import os, signal
from multiprocessing import resource_tracker
from multiprocessing.shared_memory import SharedMemory
from solvers.engine.shared_frames import remove_block

block = SharedMemory(create=True, size=64)
tracker = resource_tracker._resource_tracker._pid
os.kill(tracker, signal.SIGKILL)
os.waitid(os.P_PID, tracker, os.WEXITED | os.WNOWAIT)
remove_block(block)
"""


def test_a_block_goes_quietly_where_its_tracker_was_killed():
    ended = subprocess.run([sys.executable, "-c", ORPHANED], capture_output=True, text=True, timeout=PATIENCE)
    assert ended.returncode == 0 and "Traceback" not in ended.stderr


def test_wish_of_a_visitor_who_has_left_is_dropped(pool, session):
    """A wish may wait until its block is gone. Nobody is told, and the engine lives on for the others."""
    link, listener = session
    listener.frame(link.ask(SCENE, Pace(False)))
    engines, leaver = pool.process_ids, Listener()
    gone = pool.open_session(leaver)
    pool._engines[0].send(SessionRequest(gone.session, 1, "mpm-lab-no-such-block", SCENE))
    report, _ = listener.frame(link.ask(SCENE, Pace(False, restarts=1)), lambda r: r.fresh)
    gone.close()
    assert report.scene == SCENE and pool.process_ids == engines
    assert not (listener.troubles or listener.losses or leaver.troubles or leaver.losses)


def test_failing_session_is_told_and_comes_back(pool, session):
    """An exception costs its session alone, not the engine; the next wish is served."""
    link, listener = session
    listener.frame(link.ask(SCENE, Pace(False)))
    engines = pool.process_ids
    link.ask(Failing(cells=20, periods=1), Pace(False))
    listener.wait(lambda: listener.troubles)
    assert listener.troubles == [FAILED]
    report, _ = listener.frame(link.ask(SCENE, Pace(False)), lambda r: r.fresh)
    assert report.scene == SCENE
    assert pool.process_ids == engines and not listener.losses


def test_asking_after_closing_does_nothing(pool):
    """A slider that moves while its visitor leaves must not open a session that nobody closes."""
    listener = Listener()
    link = pool.open_session(listener)
    number = link.ask(SCENE)
    listener.frame(number)
    link.close()
    wish = link.wish
    assert link.ask(SCENE, Pace(restarts=1)) == number
    assert link.wish is wish and not link._blocks
    link.close()


def test_goodbye_overtakes_a_wish_that_waits(pool):
    """A wish still in the queue when its session leaves is never sent: it would bring the session back."""
    engine = pool._engines[0]
    with engine._news:  # holds the writer; a condition's lock may be taken again by the same thread
        link = pool.open_session(Listener())
        link.ask(SCENE)
        link.close()
        assert link.session not in engine._wishes


@pytest.mark.parametrize("scene", [SCENE, RingScene(cells=12, periods=1)], ids=["bar", "ring"])
def test_what_is_asked_for_comes_and_no_more(pool, scene):
    """One quantity of the particles and its deviation; and the size of estimate minus truth, which is the distance of
    the samples. A paused session answers."""
    listener, steps = Listener(), 4 * scene.sample_interval
    link = pool.open_session(listener)
    report, arrays = listener.frame(link.ask(scene, Pace(False)))
    assert report.holds.plotted is None and arrays.plotted.shape == (scene.particles, 0)
    assert arrays.difference == {} and not report.holds.differences
    number = link.ask(scene, Pace(False, single_steps=steps), FrameOptions(differences=True))
    report, arrays = listener.frame(number, lambda r: r.step == steps)
    (sizes,) = arrays.difference.values()
    assert report.holds.differences and sizes.shape == (scene.particles, 4)
    series = samples.read_rows(report.rows, scene, scene.particles)
    norm = np.sqrt(np.mean(sizes.astype(float) ** 2, axis=0))
    for column, quantity in enumerate(("x", "v")):
        assert norm[column] == pytest.approx(series[f"companion/difference_{quantity}"][-1], rel=1e-5)
    solver = build(scene)
    solver.advance(steps)
    for quantity in ("v", "sigma") if scene.DIMENSIONS == 1 else ():  # in the plane only errors are plotted
        number = link.ask(scene, Pace(False, single_steps=steps), FrameOptions(plotted=quantity))
        report, arrays = listener.frame(number)
        assert report.holds.plotted == quantity and arrays.difference == {}
        np.testing.assert_array_equal(arrays.plotted, solver.snapshot(plotted=quantity).plotted.astype(np.float32))
    link.close()
