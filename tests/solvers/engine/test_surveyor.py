"""The surveyor: points of landscapes come from a fork of the engine, which leaves nothing behind."""

import os
import signal
from dataclasses import replace

import pytest

from solvers.engine import compiling_fork, surveyor
from solvers.engine.engine_messages import Pace, Survey, SurveyPoint
from solvers.problems.bar.scene import BarScene
from solvers.study.landscape.error_history import TRUTH, ErrorHistory
from solvers.study.landscape.history_runner import HistoryRunner
from solvers.study.landscape.parameter_values import history_key
from tests.support.processes import children, has_ended, wait_until
from tests.support.session_listener import SCENE

forked = pytest.mark.skipif(not compiling_fork.CAN_FORK, reason="only Linux can fork a process that runs Taichi")


def points(parameter, *values, level=0, until=0.25):
    return tuple(SurveyPoint(parameter, value, until, level) for value in values)


class Runs:
    """Stands for a runner; ``during`` is called in the middle of each run."""

    def __init__(self):
        self.made, self.during = [], lambda: None

    def run(self, scene, parameter, value, until, goes_on):
        self.made.append((scene.cells, value))
        self.during()
        return ErrorHistory(until) if goes_on() else None


@pytest.fixture
def queue(monkeypatch):
    queue = surveyor.SurveyQueue()
    monkeypatch.setattr(queue, "_runner", Runs())
    return queue


def test_sessions_take_turns_and_coarse_points_come_first(queue):
    one, other = BarScene(cells=10), BarScene(cells=20)
    queue.accept(Survey(1, one, points("cfl", 0.1, 0.2) + points("cfl", 0.3, level=3)))
    queue.accept(Survey(2, other, points("cfl", 0.4, 0.5) + points("cfl", 0.6, level=1)))
    while queue:
        queue.compute_next()
    assert queue._runner.made == [(10, 0.1), (20, 0.4), (10, 0.2), (20, 0.5), (20, 0.6), (10, 0.3)]


def test_the_last_request_of_a_session_counts(queue):
    """A point that is being computed is given up, unless it is requested again; then it is computed once."""
    scene, news = BarScene(), []
    queue._runner.during = lambda: [queue.accept(news.pop()) for _ in news[:1]]
    queue.accept(Survey(1, scene, points("cfl", 0.1, 0.2)))
    news.append(Survey(1, scene, points("cfl", 0.3, 0.1)))
    key, history = queue.compute_next(lambda: None)
    assert key == history_key(scene, "cfl", 0.1) and history.until == 0.25
    news.append(Survey(1, replace(scene, cells=30), points("cfl", 0.3)))
    assert queue.compute_next() is None
    news.append(Survey(1))
    assert queue.compute_next() is None and not queue
    assert queue._runner.made == [(40, 0.1), (40, 0.3), (30, 0.3)]


def test_a_point_that_fails_costs_no_other(queue, monkeypatch, caplog):
    queue.accept(Survey(1, BarScene(), points("cfl", 0.1, 0.2)))
    monkeypatch.setattr(queue._runner, "during", lambda: 1 / 0)
    assert queue.compute_next() is None and "cfl = 0.1 failed" in caplog.text
    monkeypatch.setattr(queue._runner, "during", lambda: None)
    assert queue.compute_next()


def surveyors(pool):
    return children(pool.process_ids[0], "spawn_main")


@forked
def test_points_come_from_a_fork_and_are_those_of_a_runner(pool, session):
    """Of a scene that is compiled. The fork ends with its engine, is replaced if it dies, and serves all sessions."""
    link, listener = session
    listener.frame(link.ask(SCENE, Pace(False)))
    link.survey(SCENE, points("amplitude", 0.01, 0.02))
    key = history_key(SCENE, "amplitude", 0.02)
    wait_until(lambda: pool.histories.get(key), "a point")
    expected = HistoryRunner().run(SCENE, "amplitude", 0.02, 0.25)
    assert pool.histories.get(key).largest_error(TRUTH, "x", 0.25) == expected.largest_error(TRUTH, "x", 0.25)
    first, = surveyors(pool)
    os.kill(first, signal.SIGKILL)
    wait_until(lambda: not os.path.exists(f"/proc/{first}"), "its end")
    link.survey(SCENE, points("amplitude", 0.03))
    wait_until(lambda: pool.histories.get(history_key(SCENE, "amplitude", 0.03)), "a point of another fork")
    second, = surveyors(pool)
    os.kill(pool.process_ids[0], signal.SIGKILL)
    wait_until(lambda: has_ended(second), "the fork ended with its engine")
    listener.wait(lambda: listener.losses == 1)


@forked
def test_a_survey_waits_for_the_compiler(pool, session):
    """What is requested before its kernels are there comes from the fork of the engine that takes over."""
    link, listener = session
    listener.frame(link.ask(SCENE, Pace(False)))
    link.survey(SCENE, points("amplitude", 0.04))
    wait_until(lambda: surveyors(pool), "a fork")
    before, scene = pool.process_ids[0], replace(SCENE, method="mpm", estimators=(), effects=("truth",))
    link.survey(scene, points("amplitude", 0.05))
    listener.frame(link.ask(scene, Pace(False)))
    wait_until(lambda: pool.histories.get(history_key(scene, "amplitude", 0.05)), "a point of the other scene")
    assert pool.process_ids[0] != before


def test_without_forks_the_engine_computes_points_itself(monkeypatch):
    """One a turn, while no session moves."""
    from solvers.engine import engine_server

    monkeypatch.setattr(compiling_fork, "CAN_FORK", False)
    sent = []

    class Pipe:
        def poll(self, _):
            return False

        def send(self, message):
            sent.append(message)

    server = engine_server.EngineServer(Pipe())
    monkeypatch.setattr(server._queue, "_runner", Runs())
    server._surveys[1] = Survey(1, SCENE, points("cfl", 0.1, 0.2))
    assert server._survey(busy=True) and not sent
    assert server._survey(busy=False) and not server._survey(busy=False)
    assert [key for message in sent for key, _ in message.histories] == \
        [history_key(SCENE, "cfl", value) for value in (0.1, 0.2)]
