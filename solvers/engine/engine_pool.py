"""EnginePool: the page's side of the engines, which starts them and connects each visitor to one."""

from __future__ import annotations

import itertools
import threading
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import replace
from multiprocessing.shared_memory import SharedMemory
from time import monotonic

from solvers.engine import shared_frames
from solvers.engine.engine_messages import (
    FRAME_SECONDS,
    FrameReport,
    Pace,
    SessionClosed,
    SessionRequest,
    Survey,
    SurveyPoint,
)
from solvers.engine.engine_process import CANNOT_START, EngineProcess, SessionListener
from solvers.engine.shared_frames import FrameOptions
from solvers.scene.scene import Scene
from solvers.study.landscape.error_history import HistoryCache
from solvers.translatable_message import Message
from solvers.workers.worker_process import adopt_orphans

PATIENCE = 2.0  # seconds that engines may take to end
DEATHS_ALLOWED = 3  # engines a session may lose without a frame in between before its scene is given up


class EnginePool:
    """Pool of so many engine processes, with their sessions: all compile the scene ``warm_up`` before they are ready;
    two frames of a session are at least ``frame_seconds`` s apart. ``histories`` are the points of landscapes that any
    session has requested."""

    def __init__(self, warm_up: Scene, engines: int = 1, frame_seconds: float = FRAME_SECONDS):
        self._numbers, self._frame_seconds = itertools.count(1), frame_seconds
        adopt_orphans()
        self.histories = HistoryCache()
        self._engines = [EngineProcess(warm_up, self.histories) for _ in range(engines)]

    def prewarm(self, usual: Sequence[Scene]) -> None:
        """Lets every engine compile the ``usual`` scenes beside its work, in this order."""
        for engine in self._engines:
            engine.prewarm(usual)

    def set_delivery_context(self, together: Callable[[], AbstractContextManager]) -> None:
        """Sets the function that returns the context manager in which sessions receive frames that arrive at once."""
        for engine in self._engines:
            engine.together = together

    def open_session(self, listener: SessionListener, beside: SessionLink | None = None) -> SessionLink:
        """Returns a new session, on the engine with the fewest, or on that of the session ``beside`` it, whose partner
        it becomes (:class:`~solvers.engine.engine_messages.SessionRequest`). The ``listener`` receives frames and
        errors, from a thread of the engine's."""
        engine = beside.engine if beside else min(self._engines, key=lambda e: (e.given_up, len(e.links)))
        return SessionLink(next(self._numbers), engine, listener, beside.session if beside else None,
                           self._frame_seconds)

    def wait_ready(self, timeout: float) -> bool:
        """Waits until every engine is ready; returns False if one is not within ``timeout`` s."""
        return all(engine.ready.wait(timeout) for engine in self._engines)

    @property
    def playing_sessions(self) -> int:
        """Number of sessions whose request is to play."""
        links = [link for engine in self._engines for link in list(engine.links.values())]
        return sum(link.wish is not None and link.wish.pace.playing for link in links)

    @property
    def process_ids(self) -> list[int]:
        return [engine.process_id for engine in self._engines]

    def request_stop(self) -> None:
        """Requests that all engines stop, without waiting."""
        for engine in self._engines:
            engine.request_stop()

    def close(self, patience: float = PATIENCE) -> None:
        """Closes all sessions and stops all engines for good; after ``patience`` s they are killed."""
        self.request_stop()
        for link in [link for engine in self._engines for link in list(engine.links.values())]:
            link.close()
        end = monotonic() + patience
        for engine in self._engines:
            engine.close(max(0.0, end - monotonic()))


class SessionLink:
    """Connection of the session of this number to its engine; ``partner`` is the number of a synchronised session or
    None. Thread-safe. The engine's reader thread calls :meth:`receive` and :meth:`engine_lost`."""

    def __init__(self, session: int, engine: EngineProcess, listener: SessionListener, partner: int | None,
                 frame_seconds: float):
        self.session, self.engine, self.listener = session, engine, listener
        self.wish: SessionRequest | None = None
        self._partner, self._frame_seconds = partner, frame_seconds
        self._lock = threading.Lock()
        self._scene: Scene | None = None  # of the last frame
        self._blocks: list[SharedMemory] = []  # the last is in use; the engine may still be writing to outgrown ones
        self._deaths = 0
        self._closed = False
        engine.links[session] = self
        if engine.stop_requested:  # a new session would get no frames
            self.close()

    def ask(self, scene: Scene, pace: Pace = Pace(), frame: FrameOptions = FrameOptions()) -> int:
        """Requests a scene, its pace, and optional contents of its frames, in place of the request before; returns at
        once the number of the request, which its frames have too (of the last request after :meth:`close`)."""
        with self._lock:
            last = 0 if self.wish is None else self.wish.number
            if self._closed:
                return last
            number, need = last + 1, shared_frames.block_bytes(scene)
            if not self._blocks or self._blocks[-1].size < need:
                self._blocks.append(SharedMemory(create=True, size=2 * need))
            self.wish = SessionRequest(self.session, number, self._blocks[-1].name, scene, pace, frame, self._partner,
                                       self._frame_seconds)
            self._deaths = 0
            self.engine.send(self.wish)
        if self.engine.given_up:
            self.listener.on_error(CANNOT_START)
        return number

    def survey(self, scene: Scene | None, points: Sequence[SurveyPoint] = ()) -> None:
        """Requests points of landscapes of a scene, in place of those before; their histories come to the pool."""
        with self._lock:
            if not self._closed:
                self.engine.send(Survey(self.session, scene, tuple(points)))

    def close(self) -> None:
        """Closes the session and frees its memory. Frames on their way are dropped; a second call does nothing."""
        with self._lock:
            if self._closed:
                return
            self._closed = True
            self._free_older_blocks(0)
        self.engine.links.pop(self.session, None)
        self.engine.send(SessionClosed(self.session))

    def receive(self, report: FrameReport) -> None:
        """Copies the reported frame out of its memory block, which is then free for the next, and passes report and
        copy to the listener."""
        with self._lock:
            self._deaths = 0
            if report.scene == self._scene:  # the same object, so that what has been worked out for it is there
                report.scene = self._scene
            self._scene = report.scene
            block = next((b for b in self._blocks if b.name == report.memory), None)
            if block is None:  # it is closed, or that was for a wish that a later one has overtaken
                return
            arrays = shared_frames.read_frame(block, report.scene, report.particles, report.holds)
            if block is self._blocks[-1]:
                self._free_older_blocks(1)
        self.listener.on_frame(report, arrays)

    def engine_lost(self, had_worked: bool) -> None:
        """Requests the same scene from the start after the engine died, unless the scene keeps killing engines: then
        reports an error. ``had_worked`` is whether the engine was ready, so that the scene may be the cause."""
        self._deaths += had_worked
        if self._deaths > DEATHS_ALLOWED:
            self.listener.on_error(Message("the simulation process keeps ending with this scene; change a setting"))
            return
        self.listener.on_engine_lost()
        with self._lock:
            if self.wish and not self._closed:
                self.wish = replace(self.wish, number=self.wish.number + 1)
                self.engine.send(self.wish)

    def _free_older_blocks(self, last: int) -> None:
        while len(self._blocks) > last:
            block = self._blocks.pop(0)
            block.close()
            shared_frames.remove_block(block)
