"""Labels of a stage: written larger and smaller together, and gone with it."""

from __future__ import annotations

import gc
import weakref
from types import SimpleNamespace

from app.renderers.viewer import Sheet, enlarge, label


class Scene:
    """Of the viewer's only what labels need: it knows them, and they know it."""

    def __init__(self):
        self.labels = {}

    def add_frame(self, name, **options):
        return Handle(name=name)

    def add_label(self, name, text, position, anchor, font_screen_scale):
        self.labels[name] = handle = Handle(name=name, scene=self, font_screen_scale=font_screen_scale)
        return handle


class Handle(SimpleNamespace):
    pass


def test_labels_are_enlarged_together_and_each_from_its_own_size():
    scene = Scene()
    small, usual = label(scene, "/small", "a", 0, 0, "center", 0.5), label(scene, "/usual", "b", 0, 0, "center")
    sheet = Sheet(SimpleNamespace(scene=scene, camera=SimpleNamespace(image_width=600, image_height=800)), "/stage")
    room = sheet.room.letters(0.6)
    enlarge(scene, 2.0)
    assert (small.font_screen_scale, usual.font_screen_scale) == (1.0, 2.0) and sheet.room.letters(0.6) == room // 2
    assert label(scene, "/later", "c", 0, 0, "center").font_screen_scale == 2.0


def test_a_stage_that_nobody_needs_is_forgotten():
    """With all that belongs to its visitor: a page, its session, its history."""
    scene = Scene()
    label(scene, "/usual", "b", 0, 0, "center")
    enlarge(scene, 2.0)
    known = weakref.ref(scene)
    del scene
    gc.collect()
    assert known() is None
