"""A class at work, in short: visitors without a browser on a real server, and what the bench says of them."""

import json

import pytest

from app.commands.bench.class_load import (
    BROKEN,
    SCHEMA,
    ClassLoadSettings,
    Control,
    Visitor,
    class_load_table,
    run_class_load,
)
from solvers.workers.worker_process import LINUX

VISITORS, SECONDS = 3, 4.0


@pytest.fixture(scope="module")
def found():
    """What a small class got within a few seconds."""
    parts = []
    yield run_class_load(ClassLoadSettings(VISITORS, SECONDS), parts.append)
    assert parts == sorted(parts) and parts[-1] == 1.0


@pytest.mark.slow
def test_all_see_a_moving_picture(found):
    assert found["schema"] == SCHEMA and found["visitors"] == found["moving"] == VISITORS and found["lost"] == []
    assert 0 < found["joined_median"] <= found["joined_95"]
    # At 30 frames a second each on a machine at rest; what others leave of a busy one is shared fairly.
    assert 1 < found["frames_slowest"] <= found["frames_median"] < 35
    assert found["slowest_of_median"] == found["frames_slowest"] / found["frames_median"] > 0.5
    assert found["standstill_longest"] < found["seconds"] and found["standstill_own_longest"] < found["seconds"]
    assert len(found["memory"]) == 3 and all(min(moment["server"], moment["engines"]) > 2e7  # as numpy alone takes
                                             for moment in found["memory"]) if LINUX else found["memory"] is None
    assert json.loads(json.dumps(found, allow_nan=False)) == found


@pytest.mark.slow
def test_a_table_for_a_person(found):
    table = class_load_table(found)
    for words in (f"{VISITORS} visitors for {SECONDS:g} s", f"{VISITORS} of {VISITORS}", "frames a second each",
                  "(slowest)", "longest standstill", "connections lost       0",
                  "after a visitor's own choice", *["megabytes held", "(at first, half way, at last)"] * LINUX):
        assert words in table
    assert max(map(len, table.splitlines())) <= 120
    nobody = {**found, "moving": 0, "joined_median": None, "joined_95": None, "lost": ["refused"], "memory": None}
    assert "after none" in class_load_table(nobody) and "lost       1; refused" in class_load_table(nobody)
    assert "megabytes" not in class_load_table(nobody)


def test_frames_are_counted_between_two_times():
    visitor = Visitor("nowhere", frames=[0.0, 1.0, 1.5, 2.0, 4.0])
    assert (
        visitor.frame_rate(1.0, 3.0) == 1.5
        and visitor.max_freeze(1.0, 3.0) == 1.0
        and visitor.max_freeze(0.0, 8.0) == 4.0
    )
    visitor.broken.add(2)  # after 1.0 and until 1.5 there was nothing to see
    assert visitor.frame_rate(1.0, 3.0) == 2 / 1.5 and visitor.max_freeze(1.0, 2.0) == 0.5
    visitor.notice = "9"  # and not after the last one
    assert visitor.max_freeze(0.0, 8.0) == 2.0
    visitor._handle_text_update("9", "")  # said before the first frame of the run that was asked for came
    visitor.frames.append(7.0)
    assert visitor.max_freeze(0.0, 8.0) == 2.0
    visitor.controls["7"] = Control("GuiSliderMessage", {"label": "Cells"})
    visitor.controls["8"] = Control("GuiTextMessage", {"label": "Cells, typed"})
    assert (visitor.find_control("Cells", "Slider"), visitor.find_control("Cells", "Text"),
            visitor.find_control("Cells", "Button")) == \
        ("7", "8", None)


def test_a_notice_between_two_frames_tells_why_they_are_apart():
    """Whether the last frame comes before the page says that the run has broken down, or after."""
    visitor = Visitor("nowhere", frames=[0.0])
    visitor._handle_text_update("9", f"<div {BROKEN}>")
    visitor.frames.append(4.0)
    visitor._handle_text_update("9", "")
    visitor.frames += [5.0, 9.0]
    assert visitor.max_freeze(0.0, 9.0) == 4.0 and visitor.broken == {1, 2}


def test_whose_choice_it_was_that_a_stage_stood_still_for():
    """Its visitor's own, if the standstill contains that or begins with a frame that was on its way meanwhile."""
    visitor = Visitor("nowhere", frames=[0.0, 0.5, 1.0, 3.0, 3.5, 5.0, 6.1], choices=[0.9])
    assert visitor.max_freeze(0.0, 6.1, own=True) == 2.0 and visitor.max_freeze(0.0, 6.1) == 1.5
    visitor.choices.append(4.0)
    assert visitor.max_freeze(0.0, 6.1) == pytest.approx(1.1) and visitor.max_freeze(0.0, 3.0) == 0.5
