"""What is said under the control that was changed last: that its wish is compiled, or why it cannot be met."""

import re
from types import SimpleNamespace

import pytest

from app.page.panels import scene_widgets
from app.page.panels.scene_widgets import REST, TO_BE_READ, WidgetStatusMessage
from tests.support.processes import wait_until
from tests.support.raw_client import RawClient


@pytest.fixture
def clock():
    """Time that goes on when the test says so."""
    return SimpleNamespace(now=0.0)


@pytest.fixture
def said(clock):
    """The answers, with a page that keeps what it shows."""
    html = SimpleNamespace(content="")
    told = WidgetStatusMessage(SimpleNamespace(add_html=lambda _: html), lambda: clock.now)
    told.shown = lambda: tuple(re.findall(r"data-(?:of|kind|says)='([^']*)'", html.content))
    return told


def widget(name):
    return SimpleNamespace(_impl=SimpleNamespace(removed=False, uuid=name))


def test_compiling_stands_under_the_last_control_and_goes(said):
    method, cells = widget("method"), widget("cells")
    said.refresh(compiling=True)  # what compiles is the first scene
    assert said.shown() == ()
    said.record_change(method)
    said.refresh(compiling=True)
    assert said.shown() == ("method", "compiling", "compiling …")
    said.record_change(cells)
    said.refresh(compiling=True)
    assert said.shown()[0] == "cells"
    said.refresh(compiling=False)
    assert said.shown() == ()


def test_a_refused_control_goes_back_once_the_hand_rests(said, clock):
    """A slider that is dragged further is not put back under the hand; the sentence stays to be read."""
    amplitude, back = widget("amplitude"), []
    for _ in range(3):
        said.record_change(amplitude)
        said.refuse(amplitude, "too much", lambda: back.append(clock.now))
        clock.now += 0.8 * REST
        said.refresh(compiling=False)
        assert back == [] and said.shown() == ("amplitude", "refused", "Too much.")
    clock.now += 0.3 * REST
    said.refresh(compiling=False)
    said.refresh(compiling=False)
    assert len(back) == 1 and said.shown()
    clock.now += TO_BE_READ
    said.refresh(compiling=False)
    said.refresh(compiling=False)
    assert said.shown() == ()


def test_a_removed_control_is_left_alone(said, clock):
    """Those of a problem go with it."""
    method, back = widget("method"), []
    said.record_change(method)
    said.refuse(method, "no", lambda: back.append(0))
    method._impl.removed = True
    clock.now += 2 * REST
    said.refresh(compiling=True)
    assert said.shown() == () and back == []


def test_what_is_refused_goes_back_on_the_page(here, monkeypatch):
    """An amplitude beyond the exact bar, as a slider and as text, and text that is no number: slider and text show what
    runs, and under the control it says why."""
    monkeypatch.setattr(scene_widgets, "REST", 0.05)
    with RawClient(here[1]) as visitor:
        slider, text = visitor.find("Amplitude A"), visitor.find("Amplitude A, typed")
        at, words = (visitor.widgets[one]["value"] for one in (slider, text))
        for one, value, why in ((slider, visitor.widgets[slider]["props"]["max"], "0.159"), (text, "0.3 m", "0.159"),
                                (text, "a lot", "is not a number above 0 in m")):
            (visitor.set if one == slider else visitor.enter)(one, value)
            wait_until(lambda w=why: any("lab-answer" in html and w in html for html in visitor.html.values()), why)
            wait_until(lambda: visitor.widgets[text]["value"] == words, "the text from before")
            wait_until(lambda: visitor.widgets[slider]["value"] == pytest.approx(at), "the slider from before")
        visitor.widgets[text]["value"] = ""
        visitor.set(text, "")
        visitor.enter(text, "")
        wait_until(lambda: visitor.widgets[text]["value"] == words, "the number of a field left empty")
        assert not any("no value" in html for html in visitor.html.values())
        visitor.enter(text, "24mm")
        wait_until(lambda: visitor.widgets[slider]["value"] != pytest.approx(at), "another amplitude")
