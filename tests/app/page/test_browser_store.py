"""What the browser keeps, and what it says before the page can hear it."""

from __future__ import annotations

import json
from types import SimpleNamespace

import pytest

from app.page.panels.browser_store import BrowserStore


class Gui:
    """Makes one text, and html that only holds what it shows."""

    def add_html(self, content):
        return SimpleNamespace(content=content)

    def add_text(self, label, value):
        self.text = SimpleNamespace(label=label, value=value)
        self.text.on_update = lambda act: setattr(self, "changed", act)
        return self.text

    def says(self, **what):
        """The browser says something."""
        self.text.value = json.dumps(what)
        self.changed(None)


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
    kept.listen(lambda link: heard.append(("link", link)), lambda *lesson: heard.append(lesson))
    assert heard == [("link", "bar;cells=20"), 11, ("01-first", "those that it has")]
    assert kept.here == "http://lab"


def test_what_a_browser_invents_is_not_hoarded(store):
    gui, kept = store
    for number in range(1000):
        gui.says(**{f"thing {number}": number})
    assert len(kept._early) <= 40
    gui.says(window=1)
    gui.text.value = "no JSON"
    gui.changed(None)
    gui.text.value = "[1, 2]"
    gui.changed(None)
    kept.listen(lambda link: None, lambda *lesson: None)
