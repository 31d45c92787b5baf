"""Nobody waits for a compiler: an engine has a fork of itself compile, goes on, and then hands everything over. That
runs of others go on there to the bit is in tests/app/page/test_pinned.py."""

import logging
import os
import signal
from dataclasses import replace
from pathlib import Path

import pytest

from solvers.engine import compiling_fork
from solvers.engine.engine_messages import Pace
from solvers.engine.engine_pool import EnginePool
from solvers.engine.engine_server import FAILED
from solvers.problems.ring import RingScene
from tests.support.processes import children, has_ended, process_state, stop_processes, wait_until
from tests.support.session_listener import PATIENCE, SCENE, Listener

pytestmark = pytest.mark.skipif(not compiling_fork.CAN_FORK, reason="only Linux can fork a process that runs Taichi")
#: Each compiled by one test only: the engines of this file have one more combination after each.
OTHERS = iter([replace(SCENE, method=method, estimators=("companion",), effects=effects)
               for method in ("mpm", "ugimp", "cpgimp", "bspline")
               for effects in (("truth", "estimate"), ("truth", "estimate", "energy"))])


def compilers(pool):
    """Ids of the successors at work."""
    return children(pool.process_ids[0], "spawn_main")


def test_the_scene_before_goes_on_and_the_process_is_another(pool, session):
    """Held still, the compiler is at work as long as the test likes: frames of the scene before come all the while, and
    what concerns that scene, such as its speed, is acted on."""
    link, listener = session
    first = link.ask(SCENE, Pace(speed=0.5))
    listener.frame(first)
    before, wanted = pool.process_ids[0], next(OTHERS)
    number = link.ask(wanted, Pace(speed=0.5))
    listener.wait(lambda: listener.compilings == [number])
    wait_until(lambda: compilers(pool), "a successor")
    with stop_processes(compilers(pool)):
        count = len(listener.frames)
        listener.wait(lambda: len(listener.frames) > count + 20)
        assert {(r.scene, r.number) for r, _ in listener.frames} == {(SCENE, first)}
        number = link.ask(wanted, Pace(False))
        listener.wait(lambda: not listener.frames[-1][0].playing)
    report, _ = listener.frame(number)
    assert report.scene == wanted and report.fresh and not report.playing
    assert pool.process_ids[0] != before
    link.ask(wanted, Pace(speed=0.5))
    wait_until(lambda: not os.path.exists(f"/proc/{before}"), "the process before gone, and buried")


def test_two_who_wait_are_both_served(pool, session):
    """Two visitors ask for different combinations at once; then each for the other's, which needs no compiler."""
    wanted, (link, listener), other = (next(OTHERS), next(OTHERS)), session, Listener()
    links = link, pool.open_session(other)
    for one, hears, scene in zip(links, (listener, other), wanted, strict=True):
        hears.number = one.ask(scene)
    for hears, scene in ((listener, wanted[0]), (other, wanted[1])):
        assert hears.frame(hears.number)[0].scene == scene
    there = pool.process_ids
    for one, hears, scene in zip(links, (listener, other), reversed(wanted), strict=True):
        assert hears.frame(one.ask(scene))[0].scene == scene
    assert pool.process_ids == there
    links[1].close()


def test_a_later_wish_does_not_wait_for_an_earlier_one(pool, session):
    """Who changes twice gets the last: what was begun for the first is given up."""
    link, listener = session
    listener.frame(link.ask(SCENE))
    link.ask(next(OTHERS))
    wait_until(lambda: compilers(pool), "a successor")
    with stop_processes(compilers(pool)):  # for ever, as it were
        last = next(OTHERS)
        assert listener.frame(link.ask(last))[0].scene == last
        assert listener.frame(link.ask(SCENE))[0].scene == SCENE


def test_a_compiler_that_dies_costs_one_wish(pool, session):
    """Its visitor is told; the scene before runs on, in the same process; and the wish can be had when asked again."""
    link, listener = session
    listener.frame(link.ask(SCENE, Pace(speed=0.5)))
    before, wanted = pool.process_ids, next(OTHERS)
    link.ask(wanted, Pace(speed=0.5))
    wait_until(lambda: compilers(pool), "a successor")
    os.kill(compilers(pool)[0], signal.SIGKILL)
    listener.wait(lambda: listener.troubles == [FAILED])
    count = len(listener.frames)
    listener.wait(lambda: len(listener.frames) > count + 5)
    assert listener.frames[-1][0].scene == SCENE and pool.process_ids == before
    assert listener.frame(link.ask(wanted, Pace(speed=0.5)))[0].scene == wanted


def test_an_engine_killed_while_it_compiles_takes_its_successor_along(pool, session):
    """Nothing is left that holds the pipe: the page notices, and the wish is met by a new engine."""
    link, listener = session
    listener.frame(link.ask(SCENE))
    wanted = next(OTHERS)
    number = link.ask(wanted)
    wait_until(lambda: compilers(pool), "a successor")
    child = compilers(pool)[0]
    began = begun(child)
    with stop_processes([child]):
        os.kill(pool.process_ids[0], signal.SIGKILL)
        wait_until(lambda: has_ended(child), "the successor killed as well")
    assert listener.frame(number + 1)[0].scene == wanted
    assert listener.losses == 1
    assert pool.wait_ready(PATIENCE)
    wait_until(lambda: begun(child) != began, "nothing left of it")


def begun(process):
    """When a process began, by the system's clock; None where there is none. Its number may soon be another's."""
    try:
        return Path(f"/proc/{process}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()[19]
    except OSError:
        return None


def test_what_is_usual_is_compiled_unasked():
    """After a while every usual scene is there without a compiler, ring and bar; one that cannot be is left out."""
    usual = [replace(SCENE, estimators=(), effects=()), RingScene(cells=12, estimators=(), effects=()),
             replace(SCENE, method="mpm", estimators=(), effects=())]
    pool, listener = EnginePool(SCENE), Listener()
    try:
        assert pool.wait_ready(PATIENCE)
        first = pool.process_ids
        pool.prewarm(usual)
        # An engine that has something left to compile is never asleep without a successor at work.
        wait_until(
            lambda: pool.process_ids != first and process_state(pool.process_ids[0]) == "S" and not compilers(pool),
            "all compiled",
            PATIENCE,
            pause=0.2,
        )
        link = pool.open_session(listener)
        for scene in usual:
            assert listener.frame(link.ask(scene))[0].scene == scene
        assert not listener.compilings
    finally:
        last = pool.process_ids[0]
        pool.close()
    assert not os.path.exists(f"/proc/{last}")


def test_a_successor_that_rests_takes_over_all_the_same(monkeypatch):
    """It has compiled two scenes of three and prepared for what was announced; then it stands still when it is told,
    goes on when it is told, and does not keep its parent waiting."""
    monkeypatch.setattr(compiling_fork, "_compile_scenes", lambda scenes: 2)
    prepared = []
    replacement = compiling_fork.fork_to_compile([SCENE] * 3, asked_for=False, prepare=prepared.append)
    if not isinstance(replacement, compiling_fork.CompilingFork):  # the child
        os._exit(int(prepared == ["coming"] and replacement == "all"))
    wait_until(lambda: replacement.can_take_over(lambda: "coming"), "its preparations")
    assert replacement.compiled == [SCENE] * 2 and prepared == []
    for rests in (True, False, True):
        replacement.pause(rests)
        wait_until(lambda rests=rests: (process_state(replacement.process_id) == "T") == rests, "obedience")
    replacement.hand_over("all")
    assert os.waitstatus_to_exitcode(os.waitpid(replacement.process_id, 0)[1]) == 1
    replacement.pipe.close()


@pytest.mark.parametrize("answered", [False, True])
def test_a_successor_whose_parent_has_ended_says_nothing(answered, monkeypatch, capfd):
    """As Ctrl-C while the server warms up leaves one: it ends, without a word, also if it had answered unheard."""
    monkeypatch.setattr(compiling_fork, "_compile_scenes", len)
    log = logging.getLogger(compiling_fork.__name__)
    monkeypatch.setattr(log, "exception", lambda *_: os.write(2, b"what it would log"))  # elsewhere in a test
    left = compiling_fork.fork_to_compile([SCENE], asked_for=True, prepare=str)
    if answered:
        wait_until(left.pipe.poll, "its answer")
    left.pipe.close()
    wait_until(lambda: has_ended(left.process_id), "its end")
    os.waitpid(left.process_id, 0)
    assert capfd.readouterr().err == ""
