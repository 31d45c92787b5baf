"""Where the things of a plane problem stand, in rooms of every kind."""

from __future__ import annotations

import pytest

from app.frame.layout import Seat
from app.frame.marks import Room
from app.frame.planar_places import AROUND, planar_labels, planar_places
from app.frame.stage import Words


@pytest.mark.parametrize("letters", (1.0, 1.7, 2.5))
def test_a_body_keeps_its_room_beside_letters_of_any_size(letters):
    """On a projector they are large: names stand above the body then, and none gets a line of no length."""
    places = planar_places(Room(593.0, letters, 0.72, 0.26).settled(), Seat.ALONE)
    assert 2 * AROUND * places.radius >= 0.29
    assert all(label.width >= 0 for label in planar_labels(Words(crossings="crosses an edge"), places))
