"""A feature is a class and one line in a list: the page builds it, hears for it, refreshes it and closes it."""

import json

from app.page.feature import Feature
from app.page.features import all_features
from app.page.features.opening_tour import OPENING, QUARTER
from tests.app.page.test_opening_tour import frame
from tests.support.page_server import start_server
from tests.support.processes import wait_until
from tests.support.raw_client import RawClient


class Counter(Feature):
    """Counts what the page has called."""

    def __init__(self, page):
        self.page, self.calls = page, []
        self.messages = {"count": lambda said: self.calls.append(f"heard {said}")}
        self.shortcuts = {"count on": lambda: self.calls.append("key")}
        with page.tabs["explore"]:
            page.gui.add_button("Count")

    @classmethod
    def build(cls, page):
        cls.last = cls(page)
        return cls.last

    def on_frame(self, report):
        self.calls.append(f"frame of {report.scene.problem}")

    def refresh(self, view):
        self.calls.append(f"alone {view.has_stage}")

    def leave_stage(self):
        self.calls.append("left")

    def close(self):
        self.calls.append("closed")


class Missing(Feature):
    """Some pages do not have it."""

    @classmethod
    def build(cls, page):
        return None


def test_a_feature_is_one_line(monkeypatch):
    monkeypatch.setattr(all_features, "FEATURES", (Missing, *all_features.FEATURES, Counter))
    with start_server() as (_, address):
        with RawClient(address) as visitor:
            assert visitor.find("Count")
            calls = Counter.last.calls
            wait_until(lambda: "alone True" in calls, "the first refresh")  # then frames are passed on, too
            Counter.last.page.session.on_frame(*frame(OPENING.scene, 0.0))
            assert "frame of bar" in calls
            store = visitor.find("kept by the browser")
            visitor.set(store, json.dumps({"count": 3}))
            visitor.set(store, json.dumps({"act": "count on"}))
            wait_until(lambda: {"heard 3", "key"} <= set(calls), "what the browser says")
            Counter.last.page.show_run_on_stage()
            assert "left" in calls and "closed" not in calls
        wait_until(lambda: "closed" in calls, "the end")


def test_a_link_opens_on_its_own_frame():
    """Nothing is said, and so seen, of what a page begins with: not before the browser has said what it was opened
    with, and not while that is on its way."""
    with start_server() as (one, address), RawClient(address) as visitor:
        store = visitor.find("kept by the browser")
        wait_until(lambda: any(one.visitors._pages.values()), "the page")
        (page,) = one.visitors._pages.values()
        session, said = page._context.session, page._context.stage._headline._html
        session.on_frame(*frame(OPENING.scene, QUARTER))
        page._refresh()
        assert said.content == ""
        visitor.set(store, json.dumps({"link": "bar;cells=20"}))
        wait_until(lambda: session.scene.cells == 20, "the link's scene")
        page._refresh()
        assert said.content == ""
        session.on_frame(*frame(session.scene, QUARTER))
        wait_until(lambda: "lab-says" in said.content, "the link's own frame")
