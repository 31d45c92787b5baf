"""Data that the browser stores (``browser_store.js``), state and answers, and its messages (``window.js``)."""

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
from app.viewer.widget_validation import is_number_between, set_max_length

LONGEST = 20_000  # most characters of a message
MOST_KINDS = 40  # most kinds of messages kept until they are handled: a browser may send any number
MARK = "<i class='lab-store'></i>"


class BrowserStore:
    """State and answers that one visitor's browser stores, and messages from it, of which the first has the address
    (``has_answered``). All messages are validated."""

    def __init__(self, gui: viser.GuiApi):
        self.here = ""  # the address at which this browser has opened the lab
        self._listening = self.has_answered = False
        self._link = ""  # the state in the address
        self._pending: tuple[str, str, str] | None = None  # what to store when a change is complete
        self._changing = False
        self.heard: dict[str, Callable[[Any], None]] = {}  # handlers of further messages by key
        self._early: dict[str, Any] = {}  # received before :meth:`listen`, the latest of each kind
        gui.add_html(MARK)
        self._text = gui.add_text(tr("kept by the browser"), "")
        set_max_length(self._text, LONGEST)
        self._mark = gui.add_html("")
        self._waiting: deque[str] = deque(maxlen=MOST_KINDS)  # messages not handled yet
        self._hearing = threading.Lock()
        self._text.on_update(self._receive)
        self._text.on_update(lambda _: self._handle_queued_messages())

    def listen(self, on_link: Callable[[str], None], on_answers: Callable[[str, str], None],
               first: dict[str, Any]) -> None:
        """Handles messages from now on, and earlier ones: ``on_link(state)`` gets the state in the address as text,
        ``on_answers(lesson, answers)`` a lesson's name and its stored answers. The ``first`` message came with the
        request for the page, {} if none did; the browser repeats it."""
        self._on_link, self._on_answers, self._listening = on_link, on_answers, True
        self._dispatch(first | self._early)

    @contextmanager
    def defer_storing(self) -> Iterator[None]:
        """Context manager: stores a change of several parts only when it is complete, so that reloads find them all."""
        self._changing = True
        try:
            yield
        finally:
            self._changing, held, self._pending = False, self._pending, None
            if held:
                self.store(*held)

    def store(self, link: str, lesson: str = "", answers: str = "") -> None:
        """Makes the browser store a state (``link``, as text) and the answers to a lesson, by its name; with "" as
        answers it sends those that it has stored."""
        if self._changing:
            self._pending = link, lesson, answers
            return
        content = f"<i class='lab-kept' data-link='{escape(link)}' data-lesson='{escape(lesson)}' " \
                  f"data-answers='{escape(answers)}'></i>"
        if self._mark.content != content:
            self._mark.content, self._link = content, link

    async def _receive(self, _: viser.GuiEvent) -> None:
        """Queues a message at once, before the next one overwrites it in the text widget."""
        self._waiting.append(self._text.value)

    def _handle_queued_messages(self) -> None:
        """Handles queued messages in order, on one thread at a time."""
        while self._waiting and self._hearing.acquire(blocking=False):
            try:
                with suppress(IndexError):
                    self._on_text(self._waiting.popleft())
            finally:
                self._hearing.release()

    def _on_text(self, text: str) -> None:
        said = parse_message(text)
        if self._listening:
            self._dispatch(said)
        elif len(self._early) < MOST_KINDS:
            self._early |= said

    def _dispatch(self, message: dict[str, Any]) -> None:
        if isinstance(here := message.get("here"), str) and here.startswith(("http://", "https://")):
            self.here = here
        # A browser that rebuilds its widgets sends what it was given to store; that state is already on the stage.
        if isinstance(link := message.get("link"), str) and link and link != self._link:
            self._on_link(link)
        for name in self.heard.keys() & message.keys():
            self.heard[name](message[name])
        if isinstance(lesson := message.get("lesson"), str) and isinstance(answers := message.get("answers"), str):
            self._on_answers(lesson, answers)
        self.has_answered |= bool(message)


def parse_message(text: str) -> dict[str, Any]:
    """Returns a browser's message, JSON of an object, by its keys; nothing of any other text."""
    try:
        said = json.loads(text)
    except (ValueError, RecursionError):
        return {}
    return said if isinstance(said, dict) else {}


WIDEST = 20_000.0  # pixels
LETTERS = 12.0  # usual height of letters on the stage in pixels


@dataclass(frozen=True)
class LayoutMetrics:
    """Layout of the browser's window in pixels: the stage's free box (``width``, ``height``), the space ``left`` of it,
    the plot over time, and the height of letters."""

    width: float = 736.0
    height: float = 358.0
    left: float = 144.0
    plot_width: float = 736.0
    plot_height: float = 62.0
    letters: float = LETTERS


class BrowserWindow:
    """One visitor's window: ``on_change`` receives each new layout, ``on_dark`` whether the theme is dark."""

    def __init__(self, store: BrowserStore, on_change: Callable[[LayoutMetrics], None],
                 on_dark: Callable[[bool], None]):
        self.size, self._dark, self._on_change, self._on_dark = LayoutMetrics(), False, on_change, on_dark
        store.heard["room"] = self._on_size
        store.heard["dark"] = self._set_dark

    def _on_size(self, sizes: Any) -> None:
        if not (isinstance(sizes, list) and len(sizes) == 6
                and all(is_number_between(part, 0, WIDEST) for part in sizes)):
            return
        size = LayoutMetrics(*map(float, sizes))
        if size != self.size:
            self.size = size
            self._on_change(size)

    def _set_dark(self, dark: Any) -> None:
        if isinstance(dark, bool) and dark != self._dark:
            self._dark = dark
            self._on_dark(dark)


def follow_keys(store: BrowserStore, acts: Mapping[str, Callable[[], None]]) -> None:
    """Calls one of the ``acts`` (by name) when the browser sends that name, as ``js/keys.js`` does for keys."""
    def act(said: Any) -> None:
        if isinstance(said, str) and said in acts:
            acts[said]()

    store.heard["act"] = act
