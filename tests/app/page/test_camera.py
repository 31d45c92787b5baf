"""The camera looks at its rectangle, above what a notice covers."""

from __future__ import annotations

import math
from contextlib import nullcontext
from types import SimpleNamespace

import numpy as np
import pytest

from app.page.stage.camera import MARGIN, FlatCamera
from app.page.visit.notice import Notice

RECTANGLE = (0.0, 1.0, -0.2, 1.0)


def seen(width, height, left):
    """x0, x1, y0, y1 of what a canvas of this size shows, above the ``left`` pixels at its bottom."""
    camera = SimpleNamespace(image_width=width, image_height=height, wxyz=np.array((0.0, 1.0, 0.0, 0.0)),
                             on_update=lambda act: None, position=(0.0, 0.0, 1.0))
    flat = FlatCamera(SimpleNamespace(camera=camera, atomic=nullcontext), RECTANGLE)
    flat.leave(left)
    x, y, distance = camera.position
    tall = 2 * distance * math.tan(camera.fov / 2)
    wide = tall * width / height
    return x - wide / 2, x + wide / 2, y - tall / 2 + tall * min(left, height / 3) / height, y + tall / 2


@pytest.mark.parametrize(("width", "height"), [(773, 720), (390, 438), (1244, 1080)])
@pytest.mark.parametrize("left", [0.0, 60.0, 130.0, 400.0])
def test_all_of_the_rectangle_is_seen(width, height, left):
    """Whole, and no smaller than need be: it fills what is free of the canvas in one direction, but for the margin."""
    x0, x1, y0, y1 = seen(width, height, left)
    assert x0 <= 0 and x1 >= 1 and y0 <= -0.2 + 1e-9 and y1 >= 1 - 1e-9
    assert min(x1 - x0, (y1 - y0) / 1.2) < MARGIN + 0.002  # the hair by which fits differ, and more


def test_a_longer_notice_needs_more_room():
    """More lines, and more of them on a narrow stage: about as the browser breaks them (measured in one)."""
    sentence = "The run went unstable at t = 0.0782 s: particle 208 (X = 0.1100, 0.3976) turned inside out (its " \
               "deformation gradient fell to zero or is not a number); take shorter steps (the box \"Auto step\" " \
               "takes 2.43e-05 s, this run took 2.5e-05 s)."
    assert 74 <= Notice("unstable", sentence).height(773) <= 84
    assert Notice("unstable", sentence).height(390) > 2 * Notice("unstable", sentence[:100]).height(773)
