"""What the browser keeps (``browser_store.js``), state and answers, and says (``window.js``): free room and keys."""

import json
import threading
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from html import escape
from typing import Any

import viser

from app.language.translation import tr
from app.viewer.widgets import is_number_between, set_max_length

LONGEST = 20_000  # characters that a browser may tell at once
MOST_KINDS = 40  # of things that are remembered until somebody hears them: a browser may say any number
MARK = "<i class='lab-store'></i>"


class BrowserStore:
    """One visitor's. What the browser says is believed in nothing: it may be anything."""

    def __init__(self, gui: viser.GuiApi):
        self.here = ""  # the address under which this browser has found the lab
        self._listening = False
        self._kept = ""  # the state that the address has
        self._held: tuple[str, str, str] | None = None  # what is to be kept when a change is complete
        self._changing = False
        self.heard: dict[str, Callable[[Any], None]] = {}  # what is done with further things that the browser says
        self._early: dict[str, Any] = {}  # said before anybody listened, the latest of each kind
        gui.add_html(MARK)
        self._text = gui.add_text(tr("kept by the browser"), "")
        set_max_length(self._text, LONGEST)
        self._mark = gui.add_html("")
        self._waiting: deque[str] = deque(maxlen=MOST_KINDS)  # what it has said and nobody has heard yet
        self._hearing = threading.Lock()
        self._text.on_update(self._take)
        self._text.on_update(lambda _: self._hear_all())

    def listen(self, on_link: Callable[[str], None], on_answers: Callable[[str, str], None]) -> None:
        """Listens from now on, and to what was said before: the address's state, a lesson's name and kept answers."""
        self._on_link, self._on_answers, self._listening = on_link, on_answers, True
        self._act(self._early)

    @contextmanager
    def keep_after(self) -> Iterator[None]:
        """Keeps nothing of the states within a change of several parts, which a reload would otherwise bring back."""
        self._changing = True
        try:
            yield
        finally:
            self._changing, held, self._held = False, self._held, None
            if held:
                self.keep(*held)

    def keep(self, link: str, lesson: str = "", answers: str = "") -> None:
        """Have the browser keep a state, and the answers to a lesson; without answers it tells those that it has."""
        if self._changing:
            self._held = link, lesson, answers
            return
        content = f"<i class='lab-kept' data-link='{escape(link)}' data-lesson='{escape(lesson)}' " \
                  f"data-answers='{escape(answers)}'></i>"
        if self._mark.content != content:
            self._mark.content, self._kept = content, link

    async def _take(self, _: viser.GuiEvent) -> None:
        """Handles a message in its very turn, before the next one can take its place in the text."""
        self._waiting.append(self._text.value)

    def _hear_all(self) -> None:
        """Hear what waits, in its order: one thread at a time, and whoever comes meanwhile leaves his to it."""
        while self._waiting and self._hearing.acquire(blocking=False):
            try:
                with suppress(IndexError):
                    self._hear(self._waiting.popleft())
            finally:
                self._hearing.release()

    def _hear(self, text: str) -> None:
        try:
            said = json.loads(text)
        except (ValueError, RecursionError):
            return
        if not isinstance(said, dict):
            return
        if self._listening:
            self._act(said)
        elif len(self._early) < MOST_KINDS:
            self._early |= said

    def _act(self, said: dict[str, Any]) -> None:
        if isinstance(here := said.get("here"), str) and here.startswith(("http://", "https://")):
            self.here = here
        # A browser that makes its widgets anew says again what it was told to keep: that is what is there.
        if isinstance(link := said.get("link"), str) and link and link != self._kept:
            self._on_link(link)
        for name in self.heard.keys() & said.keys():
            self.heard[name](said[name])
        if isinstance(lesson := said.get("lesson"), str) and isinstance(answers := said.get("answers"), str):
            self._on_answers(lesson, answers)


WIDEST = 20_000.0  # pixels
LETTERS = 12.0  # pixels, as high as letters on the stage usually are


@dataclass(frozen=True)
class LayoutMetrics:
    """Pixels of the window: the free box of the stage, what is left of it, the plot over time, and letters."""

    width: float = 736.0
    height: float = 358.0
    left: float = 144.0
    plot_width: float = 736.0
    plot_height: float = 62.0
    letters: float = LETTERS


class Window:
    """One visitor's window: ``on_change`` gets a new size, ``on_dark`` dark or light; the browser may say anything."""

    def __init__(self, store: BrowserStore, on_change: Callable[[LayoutMetrics], None],
                 on_dark: Callable[[bool], None]):
        self.size, self._dark, self._on_change, self._on_dark = LayoutMetrics(), False, on_change, on_dark
        store.heard["room"] = self._hear
        store.heard["dark"] = self._shade

    def _hear(self, said: Any) -> None:
        if not (isinstance(said, list) and len(said) == 6 and all(is_number_between(part, 0, WIDEST) for part in said)):
            return
        size = LayoutMetrics(*map(float, said))
        if size != self.size:
            self.size = size
            self._on_change(size)

    def _shade(self, dark: Any) -> None:
        if isinstance(dark, bool) and dark != self._dark:
            self._dark = dark
            self._on_dark(dark)


def follow_keys(store: BrowserStore, acts: Mapping[str, Callable[[], None]]) -> None:
    """Does one of the ``acts`` when the browser says its name (``js/keys.js``)."""
    def act(said: Any) -> None:
        if isinstance(said, str) and said in acts:
            acts[said]()

    store.heard["act"] = act
