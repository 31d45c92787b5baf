"""What one page asks of the engines."""

from contextlib import ExitStack, closing

from app.page.visit.health import Tally
from solvers.engine.pool import EnginePool, Listener, SessionLink


class PageLinks(ExitStack):
    """The pool as one page sees it; ``close`` closes all that was opened. ``frames`` counts those of all pages."""

    def __init__(self, pool: EnginePool, frames: Tally | None = None):
        super().__init__()
        self._pool, self.frames = pool, frames or Tally()

    def open(self, listener: Listener, beside: SessionLink | None = None) -> SessionLink:
        return self.enter_context(closing(self._pool.open(listener, beside)))

    @property
    def playing(self) -> int:
        """The number of stages that move, of all visitors."""
        return self._pool.playing
