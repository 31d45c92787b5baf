"""EnginePool: the page's side of the engines. Starts them and gives each visitor a line to one."""

from __future__ import annotations

import itertools
import threading
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from dataclasses import replace
from multiprocessing.shared_memory import SharedMemory
from time import monotonic

from solvers.engine import shared_frames
from solvers.engine.engine_messages import FRAME_SECONDS, FrameReport, Pace, SessionClosed, SessionRequest
from solvers.engine.engine_process import CANNOT_START, EngineProcess, SessionListener
from solvers.engine.shared_frames import FrameOptions
from solvers.message import Message
from solvers.scene.scene import Scene
from solvers.workers.worker_process import adopt_orphans

PATIENCE = 2.0  # seconds that engines may take to end
DEATHS_ALLOWED = 3  # engines a session may lose without a frame in between before its scene is given up


class EnginePool:
    """A fixed number of engine processes and the sessions they serve.

    Parameters
    ----------
    warm_up
        The scene that they compile before they are ready.
    engines
        How many there are.
    frame_seconds : float, s
        Between two frames of a session, if they can be had.
    """

    def __init__(self, warm_up: Scene, engines: int = 1, frame_seconds: float = FRAME_SECONDS):
        self._numbers, self._frame_seconds = itertools.count(1), frame_seconds
        adopt_orphans()
        self._engines = [EngineProcess(warm_up) for _ in range(engines)]

    def prewarm(self, usual: Sequence[Scene]) -> None:
        """Have every engine compile what is ``usual`` beside its work, the first first."""
        for engine in self._engines:
            engine.prewarm(usual)

    def deliver_within(self, together: Callable[[], AbstractContextManager]) -> None:
        """From now on sessions hear of frames that come at once in one context that this gives."""
        for engine in self._engines:
            engine.together = together

    def open(self, listener: SessionListener, beside: SessionLink | None = None) -> SessionLink:
        """A new session, on the engine that has fewest; on one that has been given up only if all have.

        Parameters
        ----------
        listener
            What hears of frames and trouble, from a thread of the engine's.
        beside
            A session on whose engine this one shall be, as its partner
            (:class:`~solvers.engine.engine_messages.SessionRequest`).
        """
        engine = beside.engine if beside else min(self._engines, key=lambda e: (e.given_up, len(e.links)))
        return SessionLink(next(self._numbers), engine, listener, beside.session if beside else None,
                           self._frame_seconds)

    def wait_ready(self, timeout: float) -> bool:
        """Wait until every engine has compiled the first page's kernels; False when ``timeout`` in s is up."""
        return all(engine.ready.wait(timeout) for engine in self._engines)

    @property
    def playing(self) -> int:
        """The number of sessions that are to move."""
        links = [link for engine in self._engines for link in list(engine.links.values())]
        return sum(link.wish is not None and link.wish.pace.playing for link in links)

    @property
    def process_ids(self) -> list[int]:
        return [engine.process_id for engine in self._engines]

    def request_stop(self) -> None:
        """Have all engines end, and do not wait for that."""
        for engine in self._engines:
            engine.request_stop()

    def close(self, patience: float = PATIENCE) -> None:
        """End all lines and all engines, after so many seconds by force. The pool cannot be used afterwards."""
        self.request_stop()
        for link in [link for engine in self._engines for link in list(engine.links.values())]:
            link.close()
        end = monotonic() + patience
        for engine in self._engines:
            engine.close(max(0.0, end - monotonic()))


class SessionLink:
    """One session's line to its engine. Thread-safe; a wish replaces the one before. The engine's reader thread calls
    :meth:`receive` and :meth:`engine_lost`."""

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
        if engine.stop_requested:  # whoever opens it now opens it for nobody
            self.close()

    def ask(self, scene: Scene, pace: Pace = Pace(), frame: FrameOptions = FrameOptions()) -> int:
        """Say what is wanted from now on; never waits.

        Parameters
        ----------
        scene, pace, frame
            What runs, how it moves, and what its frames hold beside the particles.

        Returns
        -------
        int
            The wish's number, which comes back in frames; after :meth:`close`, when nothing is wanted, the last one.
        """
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

    def close(self) -> None:
        """Leave. Frames still on their way are dropped. A second call does nothing."""
        with self._lock:
            if self._closed:
                return
            self._closed = True
            self._free_all_but(0)
        self.engine.links.pop(self.session, None)
        self.engine.send(SessionClosed(self.session))

    def receive(self, report: FrameReport) -> None:
        """Copy a frame out of the block, free the block for the next and hand the copy on."""
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
                self._free_all_but(1)
        self.listener.on_frame(report, arrays)

    def engine_lost(self, had_worked: bool) -> None:
        """The engine died: ask the new one for the same scene from the start, unless it keeps dying of it. One that
        never came to work (``had_worked``) has not read the scene: that cannot be the cause."""
        self._deaths += had_worked
        if self._deaths > DEATHS_ALLOWED:
            self.listener.on_error(Message("the simulation process keeps ending with this scene; change a setting"))
            return
        self.listener.on_engine_lost()
        with self._lock:
            if self.wish and not self._closed:
                self.wish = replace(self.wish, number=self.wish.number + 1)
                self.engine.send(self.wish)

    def _free_all_but(self, last: int) -> None:
        while len(self._blocks) > last:
            block = self._blocks.pop(0)
            block.close()
            block.unlink()
