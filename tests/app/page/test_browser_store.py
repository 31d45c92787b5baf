"""What the browser keeps, and what it says before the page can hear it."""

import asyncio
import inspect
import json
from types import SimpleNamespace

import pytest

from app.page.panels.browser_store_and_window import BrowserStore


class Gui:
    """Makes one text, and html that only holds what it shows."""

    def __init__(self):
        self.acts, self.later = [], []

    def add_html(self, content):
        return SimpleNamespace(content=content)

    def add_text(self, label, value):
        self.text = SimpleNamespace(label=label, value=value)
        self.text.on_update = self.acts.append
        return self.text

    def comes(self, text):
        """A message comes: what wants to know at once is told, the rest when a thread is free."""
        self.text.value = text
        for act in self.acts:
            if inspect.iscoroutinefunction(act):
                asyncio.run(act(None))
            else:
                self.later.append(act)

    def turn(self):
        """The threads come to their turn."""
        while self.later:
            self.later.pop(0)(None)

    def says(self, **what):
        """The browser says something, and is heard."""
        self.comes(json.dumps(what))
        self.turn()


@pytest.fixture
def store():
    gui = Gui()
    return gui, BrowserStore(gui)


def test_nothing_said_before_the_page_is_made_is_lost(store):
    """On a busy server a browser says many sizes of its window before anybody listens; its lesson is heard, too."""
    gui, kept = store
    heard = []
    gui.says(link="bar;cells=20", here="http://lab")
    gui.says(lesson="01-first", answers="those that it has")
    for width in range(12):
        gui.says(window=width)
    kept.heard["window"] = heard.append
    kept.listen(lambda link: heard.append(("link", link)), lambda *lesson: heard.append(lesson), {})
    assert heard == [("link", "bar;cells=20"), 11, ("01-first", "those that it has")]
    assert kept.here == "http://lab"


@pytest.mark.parametrize("first", [{}, {"link": "bar", "dark": True}])
def test_what_came_with_the_request_is_heard_like_a_message(store, first):
    """A page without one waits for the first."""
    gui, kept = store
    heard = []
    kept.heard["dark"] = heard.append
    kept.listen(heard.append, lambda *lesson: None, first)
    assert heard == [*first.values()] and kept.has_answered == bool(first)
    gui.says(link="", here="http://lab")
    assert kept.has_answered


def test_what_a_browser_invents_is_not_hoarded(store):
    gui, kept = store
    for number in range(1000):
        gui.says(**{f"thing {number}": number})
    assert len(kept._early) <= 40
    gui.says(window=1)
    for text in ("no JSON", "[1, 2]"):
        gui.comes(text)
        gui.turn()
    kept.listen(lambda link: None, lambda *lesson: None, {})


def test_what_comes_while_no_thread_is_free_is_heard_in_its_order(store):
    """The viewer keeps only the last value of a text, and calls from any thread."""
    gui, kept = store
    heard = []
    kept.heard["spark"] = heard.append
    kept.listen(heard.append, lambda *lesson: heard.append(lesson), {})
    for said in ({"link": "bar"}, {"spark": 2}, {"lesson": "05", "answers": "all"}, {"spark": 1}):
        gui.comes(json.dumps(said))
    gui.turn()
    assert heard == ["bar", 2, ("05", "all"), 1]
