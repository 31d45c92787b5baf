"""Widgets that are made anew while callbacks of the old ones still run, which the viewer calls side by side."""

import json
import math
from types import SimpleNamespace
from typing import get_type_hints
from zipfile import ZipFile

import viser
from viser._messages import GuiSliderProps

from app.page.features.opening_tour import BAR, BESIDE, OpeningTour
from app.viewer import viser_patches, widget_validation
from tests.support.page_server import start_server
from tests.support.processes import wait_until
from tests.support.raw_client import RawClient

TURNS = 40  # before callbacks took turns, 60 of them left 11 complaints in a browser's console


class Listener(RawClient):
    """It also keeps what is said of widgets that have gone."""

    def __init__(self, address):
        self.gone, self.ghosts = set(), []
        super().__init__(address)

    def cells(self, length):
        """The slider of the cells across this length, once it is there."""
        return self._labels().get(f"grid cells across {length} m")

    def pin(self):
        """The button that pins a run, or lets it go."""
        return self._labels().get("Pin this run") or self._labels().get("Unpin")

    def _hear(self, message):
        if message["type"] == "GuiUpdateMessage" and message["uuid"] in self.gone:
            self.ghosts.append(message["updates"])
        elif message["type"] == "GuiRemoveMessage":
            self.gone.add(message["uuid"])
        super()._hear(message)


def test_nothing_is_said_of_widgets_that_have_gone(caplog):
    """A slider is moved and a run is pinned at the moment at which another problem is chosen."""
    with start_server() as (_, address), Listener(address) as visitor:
        problem = visitor.find("Problem")
        for turn in range(TURNS):
            name, length, others = ("expanding ring", "1", "1.2") if turn % 2 == 0 else ("vibrating bar", "1.2", "1")
            wait_until(lambda of=length: visitor.cells(of) and visitor.pin(), "the widgets")
            cells = visitor.cells(length)
            visitor.set(cells, math.log10(30 + turn))
            if turn % 3 == 0:
                visitor.set(visitor.pin(), True)
            visitor.set(problem, name)
            visitor.set(cells, math.log10(31 + turn))
            wait_until(lambda of=others: visitor.cells(of), name)
        assert visitor.ghosts == []
    assert "Traceback" not in caplog.text and visitor.gone


def test_the_story_begins_on_the_widgets_that_are_there():
    """A page is made with what the story begins on: a newcomer's run starts anew, and no widget. Where something else
    is on the stage by then, they are made for the opening again."""
    with start_server() as (one, address), Listener(address) as visitor:
        wait_until(lambda: visitor.cells("1"), "the widgets")
        wait_until(lambda: any(one.visitors._pages.values()), "the page")
        (page,) = one.visitors._pages.values()
        session = page._context.session
        (story,) = (feature for feature in page._features if isinstance(feature, OpeningTour))
        store, begun = visitor.find("kept by the browser"), session.playback_request_key[1]
        for known, cells in ((True, 40), (False, 30)):
            visitor.set(visitor.cells("1"), math.log10(cells))
            wait_until(lambda of=cells: session.scene.cells == of, "the choice")
            story.beat = 0
            visitor.set(store, json.dumps({"story": "play", "known": known}))  # another text each time
            wait_until(lambda: story.beat == 1, "the story")
            begun += 1 if known else 2  # the scene is put there, and then begins where the story does
            assert session.playback_request_key[1] == begun and session.scene == BAR
            assert session.pinned.scene == BESIDE
            wait_until(lambda there=known: visitor.gone or there, "widgets that are made anew")
            assert bool(visitor.gone) is not known


def test_icons_and_kinds_of_values_are_the_viewers():
    """Though neither is looked up anew for each widget."""
    icon = viser.Icon.SCHOOL
    with ZipFile(viser_patches._ICONS) as archive:
        drawing = archive.read(f"{icon}.svg").decode()
    assert viser_patches.icon_svg(icon) == drawing and drawing.startswith("<svg")
    handle = SimpleNamespace(_impl=SimpleNamespace(props=GuiSliderProps.__new__(GuiSliderProps)))
    found = viser_patches.widget_property_types(handle)
    assert found == get_type_hints(GuiSliderProps) and found is viser_patches.widget_property_types(handle)


def test_a_number_may_be_past_an_end_by_half_of_its_last_digit():
    """As a browser rounds what it shows, and no farther; whole numbers not at all."""
    for value, least, most, fits in ((0.0, 0.1, 0.159, (0.0995, 0.1595)), (1, 1, 9, (1, 9))):
        slider = SimpleNamespace(value=value, min=least, max=most, precision=3)
        assert all(widget_validation._is_in_range(slider, one) for one in fits)
        low, high = fits
        assert not any(widget_validation._is_in_range(slider, one) for one in (low - 1e-5, high + 1e-5, math.nan))
