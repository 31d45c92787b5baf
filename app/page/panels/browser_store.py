"""What the browser keeps for its visitor (``browser_store.js``): the state in its address, and answers to lessons."""

import json
from collections.abc import Callable
from html import escape
from typing import Any

import viser

from app.viewer.widgets import allow

LONGEST = 20_000  # characters that a browser may tell at once
MOST_KINDS = 40  # of things that are remembered until somebody listens: a browser may invent any number
MARK = "<i class='lab-store'></i>"


class BrowserStore:
    """One visitor's. What the browser says is believed in nothing: it may be anything."""

    def __init__(self, gui: viser.GuiApi):
        self.here = ""  # the address under which this browser has found the lab
        self._listening = False
        self._kept = ""  # the state that the address has
        self.heard: dict[str, Callable[[Any], None]] = {}  # what is done with further things that the browser says
        self._early: dict[str, Any] = {}  # said before anybody listened, the latest of each kind
        gui.add_html(MARK)
        self._text = gui.add_text("kept by the browser", "")
        allow(self._text, LONGEST)
        self._mark = gui.add_html("")
        self._text.on_update(lambda _: self._hear(self._text.value))

    def listen(self, on_link: Callable[[str], None], on_answers: Callable[[str, str], None]) -> None:
        """From now on, and to what has been said before: to the state that the address has, and to a lesson's name and
        its kept answers."""
        self._on_link, self._on_answers, self._listening = on_link, on_answers, True
        self._act(self._early)

    def keep(self, link: str, lesson: str = "", answers: str = "") -> None:
        """Have the browser keep a state, and the answers to a lesson; without answers it tells those that it has."""
        content = f"<i class='lab-kept' data-link='{escape(link)}' data-lesson='{escape(lesson)}' " \
                  f"data-answers='{escape(answers)}'></i>"
        if self._mark.content != content:
            self._mark.content, self._kept = content, link

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
