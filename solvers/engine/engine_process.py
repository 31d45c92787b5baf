"""EngineProcess: the page's handle of one engine: a process, a reader thread and a writer thread.

The writer is a thread of its own, so that a callback of the page never waits for an engine that is compiling, and only
a session's newest request is sent.
"""

import logging
import multiprocessing
import os
import threading
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext, suppress
from multiprocessing.connection import Connection
from time import monotonic, sleep
from typing import Protocol

from solvers.engine import engine_messages
from solvers.engine.engine_messages import FrameReport, SessionClosed, SessionRequest, Survey
from solvers.engine.shared_frames import FrameArrays
from solvers.scene.scene import Scene
from solvers.study.landscape.error_history import HistoryCache
from solvers.translatable_message import Message
from solvers.workers import worker_process

FIRST_PAUSE = 0.5  # seconds before the next start when an engine dies before it is ready; doubles every time
LONGEST_PAUSE = 10.0
FAILURES_ALLOWED = 6  # engines in a row that die before they are ready, until none is started any more
REAP_SECONDS = 2.0  # seconds until a killed process is gone
CANNOT_START = Message("the simulation process cannot be started; see the terminal")


class SessionListener(Protocol):
    """Callbacks of a session, called from the engine's reader thread, so that they must be quick: a frame has arrived,
    the request of this number is being compiled, an error in a sentence for the visitor, the engine has ended."""

    def on_frame(self, report: FrameReport, arrays: FrameArrays) -> None: ...
    def on_compiling(self, number: int) -> None: ...
    def on_error(self, sentence: str) -> None: ...
    def on_engine_lost(self) -> None: ...


class SessionLinkProtocol(Protocol):
    """Interface of a session's connection for its engine; see :class:`~solvers.engine.engine_pool.SessionLink`."""

    listener: SessionListener
    wish: SessionRequest | None

    def receive(self, report: FrameReport) -> None: ...
    def engine_lost(self, had_worked: bool) -> None: ...
    def close(self) -> None: ...


def run_engine_process(pipe: Connection, warm_up: Scene, usual: Sequence[Scene]) -> None:
    """Runs an engine process, which speaks to the page through ``pipe``: it first compiles the scene ``warm_up``, later
    the ``usual`` scenes. Only here is Taichi imported: the page's process stays light."""
    from solvers.engine import engine_server

    engine_server.serve_engine(pipe, warm_up, usual)


class EngineProcess:
    """Handle of an engine process: starts it, with the scene ``warm_up`` to compile first, restarts it when it dies,
    and passes messages to and from ``links``, by session number, and error histories to ``histories``. A child may
    replace the process (:class:`~solvers.engine.engine_messages.EngineReplacedByFork`) on the same pipe. Frames that
    arrive at once are passed on within a context that ``together()`` returns."""

    def __init__(self, warm_up: Scene, histories: HistoryCache):
        self.histories = histories
        self.together: Callable[[], AbstractContextManager] = nullcontext
        self.ready = threading.Event()
        self.given_up = False  # whether it kept dying before it was ready, and is no longer restarted
        self.links: dict[int, SessionLinkProtocol] = {}
        self._failures = 0
        self._leaving: list[int] = []  # processes that were engines, or will end soon
        self._forks: list[int] = []  # processes that the engine has forked
        self._warm_up = warm_up
        self._usual: tuple[Scene, ...] = ()
        self._closing = False
        self._news = threading.Condition()
        self._outbox: deque[SessionClosed | engine_messages.Prewarm] = deque()
        self._wishes: dict[int, SessionRequest] = {}
        self._surveys: dict[int, Survey] = {}
        self._start()
        for work in (self._read_messages, self._write_messages):
            threading.Thread(target=work, name=f"engine{work.__name__}", daemon=True).start()

    def prewarm(self, usual: Sequence[Scene]) -> None:
        """Lets the process, and any replacement, compile the ``usual`` scenes, in this order, beside its work."""
        with self._news:
            self._usual = tuple(usual)
            self._outbox.append(engine_messages.Prewarm(self._usual))
            self._news.notify_all()

    def send(self, message: SessionRequest | SessionClosed | Survey) -> None:
        """Queues a message for the engine and returns at once; a session's newer request replaces one in the queue."""
        with self._news:
            if self.given_up:
                return
            if isinstance(message, SessionRequest):
                self._wishes[message.session] = message
            elif isinstance(message, Survey):
                self._surveys[message.session] = message
            else:
                self._outbox.append(message)
            if isinstance(message, SessionClosed):  # a wish sent after it would bring the session back
                self._wishes.pop(message.session, None)
                self._surveys.pop(message.session, None)
            self._news.notify_all()

    @property
    def stop_requested(self) -> bool:
        """Whether the process should stop, or has stopped, for good."""
        return self._closing

    def request_stop(self) -> None:
        """Requests that the process stops, and returns at once; a second call does nothing."""
        with self._news:
            if not self._closing:
                self._leaving.append(self.process_id)
            self._closing = True
            self._news.notify_all()  # the writer sends None, at which the process ends

    def close(self, patience: float) -> None:
        """Stops the process and its children and waits for their end; after ``patience`` s they are killed."""
        self.request_stop()
        self._wait_for_stopped_processes(patience)
        for process_id in self._leaving:
            with suppress(OSError):  # it has ended
                os.kill(process_id, worker_process.KILL_SIGNAL)
        self._wait_for_stopped_processes(REAP_SECONDS)

    def _read_messages(self) -> None:
        while not (self._closing or self.given_up):
            try:
                message = self._pipe.recv()
            except (EOFError, OSError):
                if not self._closing:
                    self._restart()
                continue
            _notify(self._dispatch, message)

    def _write_messages(self) -> None:
        while True:
            with self._news:
                self._news.wait_for(lambda: self._closing or self._outbox or self._wishes or self._surveys)
                queued = [None] if self._closing else [*self._outbox, *self._wishes.values(), *self._surveys.values()]
                self._clear_queues()
                pipe = self._pipe
            with suppress(OSError):  # the process died; the reader notices, restarts it and sends the wishes again
                for message in queued:
                    pipe.send(message)
            if self._closing:
                return

    def _clear_queues(self) -> None:
        for queue in (self._outbox, self._wishes, self._surveys):
            queue.clear()

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")  # a fork would copy the locks of the page's threads
        ours, theirs = context.Pipe()
        process = context.Process(None, run_engine_process, "mpm-lab-engine", (theirs, self._warm_up, self._usual),
                                  daemon=True)
        process.start()
        theirs.close()
        self._pipe, self._process, self.process_id = ours, process, process.pid or 0  # it is started at once

    def _restart(self) -> None:
        """Starts a new process in place of a dead one: at once if that had been ready, otherwise after a pause, until
        too many in a row have failed; informs all links."""
        self._leaving.append(self.process_id)
        self._wait_for_stopped_processes(REAP_SECONDS)  # only then its children are this process's to bury
        for fork in self._forks:
            with suppress(ChildProcessError):  # it had ended before
                if os.waitpid(fork, os.WNOHANG) == (0, 0):
                    self._leaving.append(fork)
        self._forks.clear()
        self._wait_for_stopped_processes(REAP_SECONDS)
        had_worked = self.ready.is_set()
        self.ready.clear()
        self._failures += not had_worked
        if self._failures >= FAILURES_ALLOWED:
            return self._give_up()
        pause = min(LONGEST_PAUSE, FIRST_PAUSE * 2 ** (self._failures - 1)) if self._failures else 0.0
        with self._news:
            if self._news.wait_for(lambda: self._closing, pause):
                return  # a process started now would outlive the pool
            self._clear_queues()
            try:
                self._start()
            except OSError:  # the old pipe stays and fails again: one more failure, and a longer pause
                logging.getLogger(__name__).exception("the simulation process could not be started")
        for link in list(self.links.values()):
            _notify(link.engine_lost, had_worked)

    def _give_up(self) -> None:
        with self._news:
            self.given_up = True
            self._clear_queues()
        logging.getLogger(__name__).error("%d simulation processes in a row ended before they were ready; "
                                          "no more are started", self._failures)
        for link in list(self.links.values()):
            _notify(link.listener.on_error, CANNOT_START)

    def _reap_stopped_processes(self) -> list[int]:
        """Returns the ids of processes that were stopped and still exist, and reaps those that have ended. An engine's
        children become the page's own once the engine has ended, where the system supports that."""
        def is_running(process_id: int) -> bool:
            if process_id == self._process.pid:
                return self._process.is_alive()
            try:
                return os.waitpid(process_id, os.WNOHANG) == (0, 0)
            except ChildProcessError:  # its parent has not quite ended, or buries it
                return os.path.exists(f"/proc/{process_id}")

        self._leaving = [process_id for process_id in self._leaving if is_running(process_id)]
        return self._leaving

    def _wait_for_stopped_processes(self, seconds: float) -> None:
        """Waits, at most so many seconds, until all processes that were stopped have ended, and reaps them."""
        end = monotonic() + seconds
        while self._reap_stopped_processes() and monotonic() < end:
            sleep(0.01)

    def _dispatch(self, message: engine_messages.FrameBatch
                  | engine_messages.CompilePending
                  | engine_messages.EngineForked
                  | engine_messages.SurveyResults
                  | engine_messages.EngineReplacedByFork
                  | engine_messages.EngineError
                  | engine_messages.EngineReady) -> None:
        if self._leaving:
            self._reap_stopped_processes()
        if isinstance(message, engine_messages.FrameBatch):
            with self.together():
                for report in message.reports:
                    if link := self.links.get(report.session):
                        _notify(link.receive, report)
        elif isinstance(message, engine_messages.EngineReady):
            self._failures = 0
            self.ready.set()
        elif isinstance(message, engine_messages.EngineReplacedByFork):
            self._leaving.append(self.process_id)
            self.process_id = message.process_id
            self._forks.clear()
        elif isinstance(message, engine_messages.EngineForked):
            self._forks.append(message.process_id)
        elif isinstance(message, engine_messages.SurveyResults):
            self.histories.put(message.histories)
        elif link := self.links.get(message.session):
            if isinstance(message, engine_messages.CompilePending):
                link.listener.on_compiling(message.number)
            else:
                link.listener.on_error(message.sentence)


def _notify(callback: Callable, message: object) -> None:
    """Calls a session's callback and logs its exceptions: a page that fails to draw must not stop others' frames."""
    try:
        callback(message)
    except Exception:
        logging.getLogger(__name__).exception("a session could not take a message")
