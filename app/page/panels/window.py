"""The visitor's window, as the browser tells it (``window.js``): how much of it is free for what is drawn, and what its
keys ask for."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from app.page.panels.browser_store import BrowserStore
from app.viewer.widgets import number

WIDEST = 20_000.0  # pixels
LETTERS = 12.0  # pixels, as high as letters on the stage usually are


@dataclass(frozen=True)
class Size:
    """Pixels of the window: of the box that is free for the stage from x = 0 to 1, of what is left of that, of the plot
    over time, and of the stage's letters."""

    width: float = 736.0
    height: float = 358.0
    left: float = 144.0
    plot_width: float = 736.0
    plot_height: float = 62.0
    letters: float = LETTERS


class Window:
    """One visitor's. ``on_change`` is called when its size is another one, ``on_dark`` when it is to be dark or light;
    what the browser says may be anything."""

    def __init__(self, store: BrowserStore, on_change: Callable[[Size], None], on_dark: Callable[[bool], None]):
        self.size, self._dark, self._on_change, self._on_dark = Size(), False, on_change, on_dark
        store.heard["room"] = self._hear
        store.heard["dark"] = self._shade

    def _hear(self, said: Any) -> None:
        if not (isinstance(said, list) and len(said) == 6 and all(number(part, 0, WIDEST) for part in said)):
            return
        size = Size(*map(float, said))
        if size != self.size:
            self.size = size
            self._on_change(size)

    def _shade(self, dark: Any) -> None:
        if isinstance(dark, bool) and dark != self._dark:
            self._dark = dark
            self._on_dark(dark)


def follow_keys(store: BrowserStore, acts: Mapping[str, Callable[[], None]]) -> None:
    """Do one of the ``acts`` when the browser says its name, for keys that no button stands for (``js/keys.js``); what
    else it says means nothing."""
    def act(said: Any) -> None:
        if isinstance(said, str) and said in acts:
            acts[said]()

    store.heard["act"] = act
