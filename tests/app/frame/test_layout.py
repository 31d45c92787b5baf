"""Where things stand on the stages, in windows of all shapes."""

from itertools import product

import pytest

from app.frame.field_plot import ROOM
from app.frame.headline import InstantErrors, lane_facts
from app.frame.layout import ComparedRunSlot, FieldPlotLayout, colour_bar_box
from app.frame.planar_layout import AROUND, make_planar_layout, planar_labels
from app.frame.primitives import StageMetrics
from app.frame.stage import StageLabels, title_labels
from app.problems.views import VIEWS

#: 1280 × 720, 1920 × 1080, 800 × 1100 and a phone.
ROOMS = (StageMetrics(736.0, high=0.45, gutter=0.16), StageMetrics(1248.0, 1.17, 0.53, 0.12),
         StageMetrics(632.0, high=0.5, gutter=0.15), StageMetrics(358.0, high=0.84))
SAID = StageLabels(("Estimate", "Truth"), ("by recovered", "exact solution"), ("", ""),
                   (("", "This run: hat functions"), ("settings", "80 cells")), (("figure", "5 %"), ("", "wrong")),
                   (("", "Compare with"),), "a note", "crosses an edge", "before", "Alike?")


@pytest.mark.parametrize(("problem", "seat", "room"), list(product(VIEWS, ComparedRunSlot, ROOMS)))
def test_everything_stands_in_the_rectangle_below_the_scale(problem, seat, room):
    """But for names in the gutter, which are as high as the rest."""
    stage = VIEWS[problem].stage
    places = stage.layout(room.rounded(), seat)
    x0, x1, y0, y1 = places.rectangle
    end = colour_bar_box(places.stage_metrics, room.high).end
    assert y0 == 0 and y1 == pytest.approx(room.high)
    for label in stage.labels(SAID, places):
        assert y0 - 1e-9 <= label.y <= end + 1e-9, label
        assert x0 <= label.x <= x1 or (room.gutter and -room.gutter - 0.01 <= label.x < 0), label
    if isinstance(places, FieldPlotLayout):
        box = places.field
        low, high = box.middle - ROOM * box.half, box.middle + ROOM * box.half
    else:
        (x, y), reach, box = places.middle, AROUND * places.radius, places.plot
        assert 0 <= x - reach < x + reach <= 1 and y0 < y - reach < y + reach < end and reach * room.pixels > 60
        assert (box is None) == (room.gutter == 0)
        if box is None:
            return
        assert seat == ComparedRunSlot.SECOND or x + reach < box.left
        low, high = box.low, box.high
    assert 0 <= box.left < box.right <= 1 and y0 < low < high < end and (high - low) * room.pixels > 30


def test_a_title_leaves_out_what_has_no_room():
    """Settings of the run first, then its time, at last whose numbers these are."""
    words = StageLabels(name=(("what", "This run: "), ("", "hat functions"), ("settings", "40 cells, 4 a cell")),
                        facts=lane_facts(InstantErrors(0.064, 0.058), 1.0, "recovered", False, 0.0015))
    said = {round(room.pixels): [label.text for label in title_labels(words, room, 0.1)] for room in ROOMS[::3]}
    assert said[736] == ["This run: hat functions40 cells, 4 a cell", "6.4 % wrong · recovered finds 91 % · 1.5 ms"]
    assert said[358] == ["hat functions", "6.4 % wrong · recovered finds 91 %"]
    shortest = [label.text for label in title_labels(words, StageMetrics(250.0), 0.1)]
    assert shortest == ["hat functions", "6.4 % wrong · finds 91 %"]


@pytest.mark.parametrize("letters", (1.0, 1.7, 2.5))
def test_a_body_keeps_its_room_beside_letters_of_any_size(letters):
    """On a projector they are large: names stand above the body then, and none gets a line of no length."""
    places = make_planar_layout(StageMetrics(593.0, letters, 0.72, 0.26).rounded(), ComparedRunSlot.ALONE)
    assert 2 * AROUND * places.radius >= 0.29
    assert all(label.width >= 0 for label in planar_labels(StageLabels(crossings="crosses an edge"), places))
