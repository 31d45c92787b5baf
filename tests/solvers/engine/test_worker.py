"""The sessions of one engine, and what it does for all of them: no pipe, no page and no other process."""

import gc
from dataclasses import replace
from types import SimpleNamespace

import pytest

from solvers.engine import engine_server
from solvers.engine.engine_messages import SessionClosed, SessionRequest
from solvers.engine.engine_server import EngineServer
from tests.support.session_listener import SCENE


class Pipe:
    """Brings what it is given, and keeps what is sent."""

    def __init__(self, *messages):
        self.messages, self.sent = list(messages), []

    def poll(self, _):
        return bool(self.messages)

    def recv(self):
        return self.messages.pop(0)

    def send(self, message):
        self.sent.append(message)


def wish(session, number=1):
    return SessionRequest(session, number, "", SCENE)


def test_when_many_wish_at_once_some_wait_for_the_next_round(monkeypatch):
    """The oldest wishes come first, and of a session only the last; so stages move between them. Who leaves wishes
    nothing."""
    clock, done = SimpleNamespace(now=0.0), []
    monkeypatch.setattr(engine_server, "perf_counter", lambda: clock.now)

    def accept(wished):
        clock.now += 0.4 * engine_server.WISHES_SECONDS
        done.append((wished.session, wished.number))

    pipe = Pipe(*map(wish, range(1, 8)), wish(2, 2))
    engine = EngineServer(pipe)
    monkeypatch.setattr(engine, "_accept_request", accept)
    rounds = []
    for late_messages in ([], [wish(5, 2), SessionClosed(6)], []):
        pipe.messages += late_messages
        engine._read_messages()
        engine._act_on_requests()
        rounds.append(done[:])
        done.clear()
    assert rounds == [[(1, 1), (2, 2), (3, 1)], [(4, 1), (5, 2), (7, 1)], []]


@pytest.mark.parametrize(("turn", "together"), [
    (0.0, [[1, 2, 3, 4], [5, 6, 7]]), (0.5, [[1, 2], [3, 4], [5, 6], [7]]), (2.0, [[k] for k in range(1, 8)])])
def test_frames_of_a_round_go_together_but_none_waits_long(turn, together, monkeypatch):
    """Nor for the turn of a session that would take longer than a frame may wait. A turn is in units of that time here,
    and a frame takes two fifths of it to make."""
    clock, pipe = SimpleNamespace(now=0.0), Pipe()
    monkeypatch.setattr(engine_server, "perf_counter", lambda: clock.now)

    def passing(part, what=None):
        clock.now += part * engine_server.TOGETHER_SECONDS
        return what

    def stepper(session):
        return SimpleNamespace(is_behind=True, frame_is_ready=True, turn_seconds=turn * engine_server.TOGETHER_SECONDS,
                               wish=wish(session), advance_slice=lambda: passing(turn),
                               write_frame=lambda: passing(0.4, session))

    engine = EngineServer(pipe)
    for session in range(1, 8):
        engine._run_session_turn(stepper(session))
    engine._send_frames()
    assert [list(message.reports) for message in pipe.sent] == together
    engine._send_frames()
    assert len(pipe.sent) == len(together)  # nothing is said where there is nothing


def test_a_successor_has_solvers_in_place_for_what_it_will_get(monkeypatch):
    """It keeps those of scenes that have not changed since it forked, builds the others, and leaves out one that cannot
    be built: whoever asks for that again will be told."""
    other, bad, closed = replace(SCENE, cells=24), replace(SCENE, cells=25), []
    monkeypatch.setattr(gc, "freeze", lambda: None)  # nothing of the test's process

    def build(scene):
        assert scene != bad
        return SimpleNamespace(scene=scene)

    monkeypatch.setattr(engine_server, "build", build)
    engine, kept = EngineServer(Pipe()), SimpleNamespace(scene=SCENE)
    engine._steppers = {session: SimpleNamespace(solver=solver, close=lambda: closed.append(1))
                        for session, solver in ((1, kept), (2, SimpleNamespace(scene=SCENE)), (3, kept))}
    engine._prepare_solvers({1: SCENE, 2: other, 4: bad})
    assert engine._prepared[1] is kept and engine._prepared[2].scene == other and engine._prepared.keys() == {1, 2}
    assert not engine._steppers and len(closed) == 3


@pytest.mark.parametrize(("late", "all_late"), [((), False), ((False,), False), ((True,), True),
                                                ((True, False, None), False), ((True, True, False, None), True)])
def test_frames_are_late_when_those_of_most_stages_that_move_are(late, all_late):
    """None is a stage that stands."""
    engine = EngineServer(Pipe())
    engine._steppers = {k: SimpleNamespace(moving=is_late is not None, frames_are_late=bool(is_late), wish=wish(k))
                        for k, is_late in enumerate(late)}
    engine._update_partners()
    assert engine._late is all_late


@pytest.mark.parametrize(("late", "waits", "compiled", "rests"), [
    (True, False, (), [False, False, True]),  # in the first fifth of each second it works all the same
    (False, False, (), [False] * 3), (True, True, (), [False] * 3), (True, False, (SCENE,), [False] * 3)])
def test_what_nobody_waits_for_is_compiled_in_what_time_is_left(late, waits, compiled, rests, monkeypatch):
    """A successor that compiles what is usual rests while frames are late; not one that a visitor waits for, nor one
    that is about to take over."""
    clock, told = SimpleNamespace(now=0.0), []
    monkeypatch.setattr(engine_server, "perf_counter", lambda: clock.now)
    engine = EngineServer(Pipe())
    engine._late, engine._waiting = late, {1: wish(1)} if waits else {}
    engine._successor = SimpleNamespace(scenes=[SCENE], compiled=compiled, pause=told.append)
    for clock.now in (7.0, 7.0 + 0.9 * engine_server.BACKGROUND_SHARE, 7.0 + 1.1 * engine_server.BACKGROUND_SHARE):
        assert not engine._compile_in_fork()
    assert told == rests


@pytest.mark.parametrize(("late", "rests"), [(True, [False, False, True]), (False, [False] * 3)])
def test_landscapes_rest_while_frames_are_late(late, rests, monkeypatch):
    """They go on for a fifth of each second."""
    clock, paused = SimpleNamespace(now=0.0), []
    monkeypatch.setattr(engine_server, "perf_counter", lambda: clock.now)
    engine = EngineServer(Pipe())
    engine._late = late
    engine._surveyor.child = SimpleNamespace(pause=paused.append, pipe=Pipe())
    for clock.now in (7.0, 7.0 + 0.9 * engine_server.BACKGROUND_SHARE, 7.0 + 1.1 * engine_server.BACKGROUND_SHARE):
        engine._survey(True)
    assert paused == rests


def test_what_is_wanted_lets_a_successor_finish_that_is_about_to_take_over():
    """Though what it has compiled is something else, and nobody waits for that."""
    ends, other = [], replace(SCENE, estimators=("companion",))
    engine = EngineServer(Pipe())
    engine._waiting = {1: wish(1)}
    engine._successor = SimpleNamespace(scenes=[other], compiled=(other,), pause=lambda _: None,
                                        terminate=lambda: ends.append(1))
    assert not engine._compile_in_fork() and not ends
