"""What is written on the viewer's stage: labels that the page gets as data, in parts of the stage's box."""

import gc
import json
import re
import weakref
from dataclasses import replace
from html import unescape
from types import SimpleNamespace

from app.frame.primitives import Label
from app.renderers.viewer_renderer import LabelLayer, ViewerSurface

NOTE = Label("note", "a", 0.0, 0.5, "center-center", "note")


class Gui:
    """Of the viewer's only what labels need."""

    def __init__(self):
        self.sent = []

    def add_html(self, content):
        gui = self

        class Html:
            def __setattr__(self, name, value):
                gui.sent.append(value)

        return Html()

    @property
    def labels(self):
        said = json.loads(unescape(re.search("data-said='(.*)'", self.sent[-1])[1]))
        return {label["name"]: label for label in said["labels"]}


def sheet_of(gui, at="/stage"):
    scene = SimpleNamespace(add_frame=lambda name, **options: SimpleNamespace(visible=True))
    lettering = LabelLayer(gui)
    lettering.set_visible_rectangle((-0.015, 1.015, 0.0, 0.5))
    return ViewerSurface(SimpleNamespace(scene=scene), lettering, at), lettering


def test_a_label_is_placed_in_parts_of_the_box():
    """x = 0 is a little right of the box's left edge, the top of the stage is its upper edge."""
    gui = Gui()
    sheet, lettering = sheet_of(gui)
    sheet.show_marks(NOTE, replace(NOTE, name="end", x=1.0, y=0.0, tone="truth", bold=True))
    lettering.send()
    assert gui.labels["/stage/note"] == {"name": "/stage/note", "text": "a", "role": "note", "x": 0.0146, "y": 0.0,
                                         "anchor": "center-center"}
    end = gui.labels["/stage/end"]
    assert (end["x"], end["y"], end["tone"], end["bold"]) == (0.9854, 1.0, "truth", True)


def test_only_changes_are_sent_and_a_label_without_text_is_none():
    gui = Gui()
    sheet, lettering = sheet_of(gui)
    sheet.show_marks(replace(NOTE, text=""))
    lettering.send()
    before = len(gui.sent)
    lettering.send()
    assert len(gui.sent) == before and not gui.labels
    sheet.show_marks(NOTE)
    lettering.send()
    sheet.show_marks(NOTE)
    lettering.send()
    assert len(gui.sent) == before + 1 and gui.labels["/stage/note"]["text"] == "a"
    sheet.show_marks(replace(NOTE, text=""))
    lettering.send()
    assert not gui.labels


def test_labels_are_seen_with_their_sheet_and_those_it_belongs_to():
    gui = Gui()
    sheet, lettering = sheet_of(gui)
    sheet.add_child("pinned").show_marks(NOTE)
    sheet.visible = False
    lettering.send()
    assert not gui.labels
    sheet.visible = True
    lettering.send()
    assert "/stage/pinned/note" in gui.labels


def test_the_room_is_what_the_browser_has_free():
    _, lettering = sheet_of(Gui())
    assert lettering.set_pixel_layout(600.0, 300.0, 120.0) and not lettering.set_pixel_layout(600.0, 300.0, 120.0)
    room = lettering.stage_metrics
    assert (room.pixels, room.high, room.gutter) == (600.0, 0.5, 0.2)


def test_a_stage_that_nobody_needs_is_forgotten():
    """With all that belongs to its visitor: a page, its session, its history."""
    sheet, lettering = sheet_of(Gui())
    sheet.show_marks(NOTE)
    known = weakref.ref(lettering)
    del sheet, lettering
    gc.collect()
    assert known() is None
