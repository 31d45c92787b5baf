"""The visitor's window, as the browser tells it (``window.js``): how much of it is free for what is drawn."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from app.page.panels.browser_store import BrowserStore
from app.viewer.widgets import number

WIDEST = 20_000.0  # pixels


@dataclass(frozen=True)
class Size:
    """Pixels of the window: of the box that is free for the stage from x = 0 to 1, of what is left of that, and of the
    plot over time."""

    width: float = 736.0
    height: float = 358.0
    left: float = 144.0
    plot_width: float = 736.0
    plot_height: float = 62.0


class Window:
    """One visitor's. ``on_change`` is called when its size is another one; what the browser says may be anything."""

    def __init__(self, store: BrowserStore, on_change: Callable[[Size], None]):
        self.size, self._on_change = Size(), on_change
        store.heard["room"] = self._hear

    def _hear(self, said: Any) -> None:
        if not (isinstance(said, list) and len(said) == 5 and all(number(part, 0, WIDEST) for part in said)):
            return
        size = Size(*map(float, said))
        if size != self.size:
            self.size = size
            self._on_change(size)
