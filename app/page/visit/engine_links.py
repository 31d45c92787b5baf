"""Links of one page to the engines, and the limits of what a visitor may request; sliders stay within them.

Steps per second need no limit: an engine gives every session equal turns, and a run that cannot keep up falls behind
(``solvers.engine.session_stepper``). Memory grows with particles; stored frames have a limit of their own."""

import threading
from time import monotonic
from typing import Any, cast
from weakref import WeakSet

from app.language.translation import current_language, tr, with_language
from solvers.engine.engine_pool import EnginePool, SessionLink, SessionListener
from solvers.scene.scene import Scene
from solvers.study.landscape.error_history import HistoryCache

MOST_WATCHED = 40_000  # particles; browsers show not much more
FASTEST = 1000.0  # periods per second; nothing is visible at such a speed


class EventRateCounter:
    """Thread-safe counter of events per second, over the last whole second."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._second, self._count, self._last = int(monotonic()), 0, 0

    def add(self) -> None:
        with self._lock:
            self._begin_second()
            self._count += 1

    @property
    def events_per_second(self) -> int:
        with self._lock:
            self._begin_second()
            return self._last

    def _begin_second(self) -> None:
        """Begins a new second, if it is time."""
        now = int(monotonic())
        if now != self._second:
            self._last = self._count if now == self._second + 1 else 0
            self._second, self._count = now, 0


def scene_size_refusal(scene: Scene) -> str:
    """Returns why a scene has too many particles to be shown, as a sentence without a full stop; "" if it has not."""
    return tr("{particles:,} particles are too many to watch; at most {most:,} go on the stage",
              particles=scene.particles, most=MOST_WATCHED) if scene.particles > MOST_WATCHED else ""


class _ListenerInLanguage:
    """A listener whose callbacks, on the engine's thread, use the language in which the link was opened."""

    def __init__(self, listener: SessionListener):
        self._listener, self._language = listener, current_language()

    def __getattr__(self, name: str) -> Any:
        said = vars(self)[name] = with_language(getattr(self._listener, name), self._language)  # cached
        return said


class PageEngineLinks:
    """The engines for one page, which opens links to them. ``frames`` counts the frames of all pages."""

    def __init__(self, pool: EnginePool, frames: EventRateCounter | None = None):
        self._pool, self.frames = pool, frames or EventRateCounter()
        self._opening, self._closed = threading.Lock(), False
        self._links = WeakSet[SessionLink]()  # weak: a closed link and its listener are not kept alive

    def open(self, listener: SessionListener, beside: SessionLink | None = None) -> SessionLink:
        """Returns a new link, whose results go to ``listener``, in the engine of ``beside``; closed if the page is."""
        link = self._pool.open_session(cast(SessionListener, _ListenerInLanguage(listener)), beside)
        with self._opening:
            self._links.add(link)
            closed = self._closed
        if closed:
            link.close()
        return link

    def close(self) -> None:
        """Closes all links opened so far, and at once those opened later."""
        with self._opening:
            self._closed, links = True, list(self._links)
        for link in links:
            link.close()

    @property
    def histories(self) -> HistoryCache:
        """The points of landscapes that any visitor has requested."""
        return self._pool.histories

    @property
    def playing(self) -> int:
        """The number of running sessions of all visitors."""
        return self._pool.playing_sessions
