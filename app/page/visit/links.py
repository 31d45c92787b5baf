"""Lines that one page asks of the engines."""

import threading
from typing import Any, cast
from weakref import WeakSet

from app.language.spoken import carried, language
from app.page.visit.health import Tally
from solvers.engine.pool import EnginePool, Listener, SessionLink


class _Told:
    """What a listener hears from the engine's thread, in the language in which the line is opened."""

    def __init__(self, listener: Listener):
        self._listener, self._language = listener, language()

    def __getattr__(self, name: str) -> Any:
        said = vars(self)[name] = carried(getattr(self._listener, name), self._language)  # and not asked for again
        return said


class PageLinks:
    """The pool as one page sees it; ``close`` closes all that was opened. ``frames`` counts those of all pages."""

    def __init__(self, pool: EnginePool, frames: Tally | None = None):
        self._pool, self.frames = pool, frames or Tally()
        self._opening, self._closed = threading.Lock(), False
        self._links = WeakSet[SessionLink]()  # one that is closed is nobody's any more, and neither is what hears of it

    def open(self, listener: Listener, beside: SessionLink | None = None) -> SessionLink:
        """A line; where the page is closed already it is closed at once, and nothing comes of it."""
        link = self._pool.open(cast(Listener, _Told(listener)), beside)
        with self._opening:
            self._links.add(link)
            closed = self._closed
        if closed:
            link.close()
        return link

    def close(self) -> None:
        """Once and for all."""
        with self._opening:
            self._closed, links = True, list(self._links)
        for link in links:
            link.close()

    @property
    def playing(self) -> int:
        """The number of stages that move, of all visitors."""
        return self._pool.playing
