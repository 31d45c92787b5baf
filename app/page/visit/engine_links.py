"""Lines that one page asks of the engines, and what a visitor may ask of the server. Sliders reach no
further; a browser of one's own making might.

Steps a second need no limit of their own: an engine gives every session turns of the same length, and a run that cannot
keep up with its clock falls behind (``solvers.engine.session_stepper``). Memory goes with particles; that of frames to
look back at has a bound of its own (``app.page.visit.frame_buffer``).
"""

import threading
from time import monotonic
from typing import Any, cast
from weakref import WeakSet

from app.language.translation import current_language, tr, with_language
from solvers.engine.engine_pool import EnginePool, Listener, SessionLink
from solvers.scene.scene import Scene

MOST_WATCHED = 40_000  # particles; browsers show not much more
FASTEST = 1000.0  # periods a second; nobody sees anything of one run at such a speed


class SessionCount:
    """Counts what happens, from any thread, and knows how often it happened in the last whole second."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._second, self._count, self._last = int(monotonic()), 0, 0

    def add(self) -> None:
        with self._lock:
            self._turn()
            self._count += 1

    @property
    def a_second(self) -> int:
        with self._lock:
            self._turn()
            return self._last

    def _turn(self) -> None:
        """Begin a new second, if it is time."""
        now = int(monotonic())
        if now != self._second:
            self._last = self._count if now == self._second + 1 else 0
            self._second, self._count = now, 0


def too_many(scene: Scene) -> str:
    """Why the stage cannot show a scene, or nothing."""
    return tr("{particles:,} particles are too many to watch; at most {most:,} go on the stage",
              particles=scene.particles, most=MOST_WATCHED) if scene.particles > MOST_WATCHED else ""


class _Told:
    """What a listener hears from the engine's thread, in the language in which the line is opened."""

    def __init__(self, listener: Listener):
        self._listener, self._language = listener, current_language()

    def __getattr__(self, name: str) -> Any:
        said = vars(self)[name] = with_language(getattr(self._listener, name), self._language)  # not asked for again
        return said


class PageLinks:
    """The pool as one page sees it; ``close`` closes all that was opened. ``frames`` counts those of all pages."""

    def __init__(self, pool: EnginePool, frames: SessionCount | None = None):
        self._pool, self.frames = pool, frames or SessionCount()
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
