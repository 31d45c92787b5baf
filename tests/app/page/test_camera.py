"""The camera shows its rectangle and nothing else: the canvas has the rectangle's shape."""

import math
from contextlib import nullcontext
from types import SimpleNamespace

import numpy as np
import pytest

from app.page.stage.pointer_and_camera import FixedRectangleCamera

RECTANGLE = (-0.015, 1.015, 0.0, 0.46)
HAIR = 1e-4  # by which fits differ, for the viewer to take each


@pytest.mark.parametrize("width", [773, 390, 1244])
def test_all_of_the_rectangle_is_seen_and_who_moves_the_view_is_taken_back(width):
    """And nothing else is seen. What is written over the picture would stay behind."""
    told = []
    camera = SimpleNamespace(image_width=width, image_height=width * 0.46 / 1.03, wxyz=np.array((0.0, 1.0, 0.0, 0.0)),
                             on_update=told.append, position=(0.0, 0.0, 1.0))
    FixedRectangleCamera(SimpleNamespace(camera=camera, atomic=nullcontext), RECTANGLE)
    x, y, distance = camera.position
    tall = 2 * distance * math.tan(camera.fov / 2)
    wide = tall * camera.image_width / camera.image_height
    seen = x - wide / 2, x + wide / 2, y - tall / 2, y + tall / 2
    assert np.allclose(seen, RECTANGLE, atol=HAIR)
    camera.position = (x + 0.2, y, distance)
    told[0](None)
    assert np.allclose(camera.position, (x, y, distance), rtol=HAIR)
