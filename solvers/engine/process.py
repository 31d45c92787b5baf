"""EngineProcess: one engine as the page sees it: a process, a thread that reads and a thread that writes.

Writing has a thread of its own, so that a callback of the page never waits for an engine that is compiling,
and only a session's newest wish is sent.
"""

from __future__ import annotations

import logging
import multiprocessing
import threading
from collections import deque
from typing import Protocol

from solvers.engine import entry
from solvers.engine.messages import FrameReport, Goodbye, Ready, Seen, Trouble, Wish
from solvers.scene import Scene


class Link(Protocol):
    """What an engine knows of a session."""

    session: int

    def receive(self, report: FrameReport) -> None: ...

    def trouble(self, sentence: str) -> None: ...

    def engine_lost(self) -> None: ...


class EngineProcess:
    """Starts the process, restarts it when it dies, and passes messages."""

    def __init__(self, warm_up: Scene):
        self.ready = threading.Event()
        self._warm_up = warm_up
        self._links: dict[int, Link] = {}
        self._closing = False
        self._news = threading.Condition()
        self._outbox: deque[Seen | Goodbye] = deque()
        self._wishes: dict[int, Wish] = {}
        self._start()
        for work in (self._read, self._write):
            threading.Thread(target=work, name=f"engine{work.__name__}", daemon=True).start()

    @property
    def process_id(self) -> int:
        return self._process.pid

    @property
    def load(self) -> int:
        """Sessions served."""
        return len(self._links)

    def add(self, link: Link) -> None:
        self._links[link.session] = link

    def remove(self, session: int) -> None:
        self._links.pop(session, None)

    def send(self, message: Wish | Seen | Goodbye) -> None:
        """Queue a message; never waits. A newer wish of a session takes the place of an older one."""
        with self._news:
            if isinstance(message, Wish):
                self._wishes[message.session] = message
            else:
                self._outbox.append(message)
            self._news.notify()

    def close(self) -> None:
        with self._news:
            self._closing = True
            self._news.notify()  # the writer sends None, at which the process ends
        self._process.join(2)
        if self._process.is_alive():
            self._process.kill()
            self._process.join(2)

    # ---- threads ------------------------------------------------------------------------------------------

    def _read(self) -> None:
        while not self._closing:
            try:
                message = self._pipe.recv()
            except (EOFError, OSError):
                if not self._closing:
                    self._restart()
                continue
            try:
                self._dispatch(message)
            except Exception:  # a page that fails to draw must not stop the others' frames
                logging.getLogger(__name__).exception("a session could not take a message")

    def _write(self) -> None:
        while True:
            with self._news:
                self._news.wait_for(lambda: self._closing or self._outbox or self._wishes)
                messages = [None] if self._closing else [*self._outbox, *self._wishes.values()]
                self._outbox.clear()
                self._wishes.clear()
                pipe = self._pipe
            try:
                for message in messages:
                    pipe.send(message)
            except OSError:
                pass  # the process died; the reader notices, restarts it and sends the wishes again
            if self._closing:
                return

    # ---- inside -------------------------------------------------------------------------------------------

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")  # a fork would copy the locks of the page's threads
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(target=entry.main, args=(theirs, self._warm_up), daemon=True,
                                        name="mpm-lab-engine")
        self._process.start()
        theirs.close()

    def _restart(self) -> None:
        self._process.join(1)
        self.ready.clear()
        with self._news:
            self._outbox.clear()
            self._wishes.clear()
            self._start()
        for link in list(self._links.values()):
            link.engine_lost()

    def _dispatch(self, message: FrameReport | Trouble | Ready) -> None:
        if isinstance(message, Ready):
            self.ready.set()
            return
        link = self._links.get(message.session)
        if link and isinstance(message, FrameReport):
            link.receive(message)
        elif link:
            link.trouble(message.sentence)
