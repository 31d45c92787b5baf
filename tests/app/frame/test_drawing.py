"""Labels of a stage: written larger and smaller together, and gone with it."""

from __future__ import annotations

import gc
import weakref
from dataclasses import replace
from types import SimpleNamespace

from app.frame.marks import Label
from app.renderers.viewer import Sheet, enlarge


class Scene:
    """Of the viewer's only what labels need: it knows them, and they know it."""

    def __init__(self):
        self.labels = {}

    def add_frame(self, name, **options):
        return Handle(name=name)

    def add_label(self, name, text, **properties):
        self.labels[name] = handle = Handle(name=name, scene=self, text=text, visible=True, **properties)
        return handle


class Handle(SimpleNamespace):
    pass


def label(sheet, name, size=1.0):
    sheet.show(Label(name, "a", 0.0, 0.0, "center-center", "note", size))


def sheet_of(scene):
    return Sheet(SimpleNamespace(scene=scene, camera=SimpleNamespace(image_width=600, image_height=800)), "/stage")


def test_labels_are_enlarged_together_and_each_from_its_own_size():
    scene = Scene()
    sheet, other = sheet_of(scene), sheet_of(scene)
    label(sheet, "small", 0.5)
    label(other, "usual")
    room = sheet.room.letters(0.6)
    enlarge(scene, 2.0)
    assert [handle.font_screen_scale for handle in scene.labels.values()] == [1.0, 2.0]
    assert sheet.room.letters(0.6) == room // 2
    label(sheet, "later")
    assert scene.labels["/stage/later"].font_screen_scale == 2.0


def test_what_was_not_seen_is_drawn_where_it_is_when_it_comes_back():
    """Also where it has moved meanwhile; what is as it was is not written again."""
    scene = Scene()
    sheet = sheet_of(scene)
    note = Label("note", "a", 0.0, 0.0, "center-center", "note")
    sheet.show(replace(note, text=""))
    assert not scene.labels
    sheet.show(note, replace(note, text="", x=0.5))
    handle = scene.labels["/stage/note"]
    assert not handle.visible and handle.text == "a"
    sheet.show(replace(note, x=0.5))
    assert handle.visible and handle.position == (0.5, 0.0, 0.0)


def test_a_stage_that_nobody_needs_is_forgotten():
    """With all that belongs to its visitor: a page, its session, its history."""
    scene = Scene()
    label(sheet_of(scene), "usual")
    enlarge(scene, 2.0)
    known = weakref.ref(scene)
    del scene
    gc.collect()
    assert known() is None
