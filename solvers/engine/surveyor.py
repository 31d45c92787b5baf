"""Surveyor: computes the points of landscapes beside an engine, in a fork that has the engine's compiled kernels.

A fork takes a few milliseconds and compiles nothing. It has a low priority, uses no more than half a processor in the
long run, rests for most of the time while its engine's frames are late, and reads requests between two launches, so
that outdated points are given up. Where processes cannot be forked, the engine computes one point a turn itself while
no session moves.
"""

import gc
import logging
import multiprocessing
import os
from collections.abc import Callable, Hashable, Sequence
from contextlib import suppress
from multiprocessing.connection import Connection
from time import perf_counter, thread_time

from solvers.engine.engine_messages import Survey, SurveyPoint, SurveyResults
from solvers.engine.forked_child import ForkedChild
from solvers.scene.scene import Scene
from solvers.study.landscape.error_history import ErrorHistory
from solvers.study.landscape.history_runner import HistoryRunner
from solvers.study.landscape.parameter_values import history_key
from solvers.workers import worker_process

NICENESS = 10
SHARE, MOST_CREDIT = 0.5, 3.0  # of a processor in the long run; seconds that may be used at once
BATCH_SECONDS = 1 / 30  # between two messages with results
REST_SECONDS = 0.1  # until the share is looked at again

Result = tuple[Hashable, ErrorHistory]


class SurveyQueue:
    """Queue of the points that sessions have requested; the last request of a session counts."""

    def __init__(self) -> None:
        self._waiting: dict[int, tuple[Scene, list[SurveyPoint]]] = {}  # the session served last at the end
        self._current: tuple[int, Scene, SurveyPoint] | None = None  # None also if it is outdated
        self._runner = HistoryRunner()

    def __bool__(self) -> bool:
        return bool(self._waiting)

    def accept(self, survey: Survey) -> None:
        """Replaces the points of a session, but for the one that is being computed."""
        self._waiting.pop(survey.session, None)
        points = [point for point in survey.points if (survey.session, survey.scene, point) != self._current]
        if self._current and self._current[0] == survey.session and len(points) == len(survey.points):
            self._current = None
        if survey.scene and points:
            self._waiting[survey.session] = survey.scene, points

    def compute_next(self, read_requests: Callable[[], None] = lambda: None) -> Result | None:
        """Computes the first point of one session: coarse points of all sessions come first, and sessions take turns.
        Returns its key and history; None if it failed, or if it was outdated by what ``read_requests`` accepted, which
        is called after each launch."""
        session = min(self._waiting, key=lambda session: self._waiting[session][1][0].level)
        scene, points = self._waiting.pop(session)
        point, *others = points
        if others:
            self._waiting[session] = scene, others
        self._current = session, scene, point

        def goes_on() -> bool:
            read_requests()
            return self._current is not None

        try:
            history = self._runner.run(scene, point.parameter, point.value, point.until, goes_on)
        except Exception:
            logging.getLogger(__name__).exception("%s = %s failed in %s", point.parameter, point.value, scene)
            history = None
        self._current = None
        return (history_key(scene, point.parameter, point.value), history) if history else None


class Surveyor:
    """An engine's handle of its surveyor, which is forked for the first points that are requested, and again if it has
    died: what was requested is then requested again."""

    def __init__(self) -> None:
        self.child: ForkedChild | None = None

    def request(self, survey: Survey, inherited: Sequence[Connection]) -> ForkedChild | None:
        """Passes a survey on; returns the child if one was forked for it, which closes the ``inherited`` pipes."""
        forked = fork_surveyor(inherited) if survey.points and not self.child else None
        self.child = self.child or forked
        if self.child:
            with suppress(ConnectionError):  # it has died, which is noticed soon
                self.child.pipe.send(survey)
        return forked

    def read_results(self) -> list[bytes]:
        """Returns the messages with results that have arrived, in bytes as they are to be passed on."""
        messages = list[bytes]()
        try:
            while self.child and self.child.pipe.poll(0):
                messages.append(self.child.pipe.recv_bytes())
        except (EOFError, ConnectionResetError):
            self.terminate()
        return messages

    def terminate(self) -> None:
        """Kills the child, if there is one."""
        if self.child:
            self.child.terminate()
        self.child = None


def fork_surveyor(inherited: Sequence[Connection]) -> ForkedChild:
    """Forks a surveyor, which closes the ``inherited`` pipes, and returns its handle. The child does not return."""
    ours, theirs = multiprocessing.Pipe()
    parent = os.getpid()
    process_id = os.fork()
    if process_id:
        theirs.close()
        return ForkedChild(process_id, ours)
    try:
        for pipe in (ours, *inherited):
            pipe.close()
        worker_process.die_with_parent(True)
        if os.getppid() == parent:
            os.nice(NICENESS)
            gc.freeze()  # pages that are not written to stay the engine's
            serve_surveys(theirs)
    except (ConnectionError, EOFError):  # the engine has ended
        os._exit(0)
    except BaseException:
        logging.getLogger(__name__).exception("the surveyor failed")
    os._exit(1)


def serve_surveys(pipe: Connection) -> None:
    """Computes points of the surveys that arrive in a pipe, and sends their results, until EOFError."""
    queue, results = SurveyQueue(), list[Result]()
    credit, sent, before, worked = MOST_CREDIT, perf_counter(), perf_counter(), thread_time()

    def read_requests(wait: float | None = 0.0) -> None:
        while pipe.poll(wait):
            queue.accept(pipe.recv())
            wait = 0.0

    while True:
        now, work = perf_counter(), thread_time()
        credit = min(MOST_CREDIT, credit + SHARE * (now - before)) - (work - worked)
        before, worked = now, work
        if results and (not queue or credit <= 0 or now - sent > BATCH_SECONDS):
            pipe.send(SurveyResults(tuple(results)))
            results, sent = [], now
        read_requests(None if not queue else REST_SECONDS if credit <= 0 else 0.0)
        if queue and credit > 0 and (result := queue.compute_next(read_requests)):
            results.append(result)
