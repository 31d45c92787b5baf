"""The opening: what its story says is true of its scene, in numbers of the runs themselves; it ends as it should."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from app.names_and_units import per_cent
from app.page.features.opening_tour import BEAT, OPENING, OpeningTour
from solvers.running.run import build
from tests.app.frame.test_view import report_of
from tests.app.page.panel import page_view
from tests.app.page.test_frame_buffer import engine_frame


def frame(scene, periods):
    """A run after so many periods."""
    solver = build(scene)
    solver.advance(round(periods * scene.period / scene.time_step))
    return replace(report_of(scene), step=solver.step, time=solver.time), engine_frame(solver)


QUARTER = 0.25


class Visit:
    """A session that does what it is asked to, and the story told there."""

    pinned_scene = property(lambda self: self.pinned and self.pinned.scene)

    def __init__(self):
        self.now, self.asked, self.report, self.is_over = 0.0, [], None, False
        self.playback_request_key = None, 0
        self.compiled = True  # the pinned run
        self.scene = OPENING.scene
        self.pinned = SimpleNamespace(scene=OPENING.pinned, last=None, stop_reason=lambda: None)
        self.html = SimpleNamespace(content="")
        gui = SimpleNamespace(add_html=lambda _: self.html)
        self.story = OpeningTour(gui, self, lambda: self.asked.append("open"), lambda: self.asked.append("hurry"),
                           lambda: self.now)

    def continue_past_end(self):
        self.asked.append("no end")

    def at(self, periods):
        """The frame after so many periods."""
        shown = frame(self.scene, periods)
        self.report, self.is_over = shown[0], periods >= QUARTER
        if self.pinned and self.compiled:
            step, last = round(periods / QUARTER * OPENING.pinned.steps), self.pinned.last
            self.pinned.last = replace(shown[0], step=step), last and last[1]
        self.story.refresh(page_view())
        return str(self.story.headline(shown))


@pytest.fixture(scope="module")
def quarter():
    """Both runs after a quarter of a period: the share of the errors and their sizes, computed here anew."""
    shown, pinned = (frame(scene, QUARTER) for scene in (OPENING.scene, OPENING.pinned))
    return shown, pinned


def test_four_beats_in_the_runs_own_numbers(quarter):
    """The stress is several per cent wrong, most of it within a cell of the particles that have crossed; recovered
    finds most of that; B-splines, whose particles cross as well, are better by a factor of ten."""
    (_, arrays), (_, other) = quarter
    size, error, crossed = OPENING.scene.size_of("sigma"), arrays.error[:, 2], arrays.steps_since_crossing >= 0
    x, square = arrays.position[:, 0], error.astype(float) ** 2
    near = np.abs(x[:, None] - x[crossed]).min(axis=1) <= OPENING.scene.spacing * (1 + 1e-6)
    wrong, share = math.sqrt(square.mean()), square[near].sum() / square.sum()
    found = math.sqrt(np.mean(arrays.estimate["recovered"][:, 2].astype(float) ** 2)) / wrong
    splines = math.sqrt(np.mean(other.error[:, 2].astype(float) ** 2))
    assert wrong / size > 0.05 and share > 0.8 and near.mean() < 0.35 and 0.85 < found < 1
    assert splines < 0.1 * wrong and (other.steps_since_crossing >= 0).sum() == crossed.sum() == 10

    visit = Visit()
    visit.story.on_message("play")
    assert visit.asked == ["open"] and "exact stress" in visit.at(0.01) and "data-beat='1'" in visit.html.content
    assert "No particle has changed its cell yet" in visit.at(0.15) and "data-beat='2'" in visit.html.content
    visit.pinned.last = quarter[1]
    assert f"The stress is {per_cent(wrong / size)} wrong" in (said := visit.at(QUARTER)) or "An estimator" in said
    assert visit.asked[1:] == ["no end", "hurry"]
    visit.story.beat = 2
    said = str(visit.story.headline(quarter[0]))
    assert f"The stress is {per_cent(wrong / size)} wrong" in said
    assert f"10 particles have changed their cell: {per_cent(share)} of the squared error" in said
    assert f"finds {per_cent(found)} of that error" in visit.at(QUARTER)
    visit.now += BEAT + 1
    assert f"B-splines: {per_cent(splines / size)} wrong, though 10 particles" in visit.at(QUARTER)
    visit.now += BEAT + 1
    assert visit.at(QUARTER) == "" and "data-beat='0'" in visit.html.content


def test_it_can_be_left_and_anything_else_ends_it():
    """Left, it hurries to the quarter; with another scene it does nothing more. Over a lesson it is not told."""
    visit = Visit()
    visit.story.on_message("skip")
    assert visit.asked == []
    visit.story.on_message("play")
    visit.at(0.01)
    visit.story.on_message("skip")
    assert visit.story.beat == 0 and visit.asked == ["open", "hurry"]
    visit.at(QUARTER)
    assert visit.asked[2:] == ["no end", "hurry"]
    for change in (lambda v: setattr(v, "scene", replace(v.scene, cells=20)), lambda v: setattr(v, "pinned", None)):
        other = Visit()
        other.story.on_message("play")
        other.at(0.01)
        change(other)
        other.at(0.02)
        assert other.story.beat == 0 and other.asked == ["open", "no end"]  # a slider was moved, or the run unpinned
    chosen = Visit()
    chosen.at(0.01)
    chosen.scene, chosen.playback_request_key = replace(chosen.scene,
                                                        cells=20), (None, 1)  # whole, and with an end of its own
    chosen.at(0.02)
    assert chosen.asked == []
    lesson = Visit()
    lesson.story.on_message("play")
    lesson.story.refresh(page_view(alone=False))
    assert lesson.story.beat == 0
    lesson.story.on_message({"no": "word"})


def test_it_does_not_pause_before_the_pinned_run_is_there():
    """That begins both anew once it is compiled: paused before, they would stand at t = 0 for good."""
    visit = Visit()
    visit.compiled = False
    visit.story.on_message("play")
    visit.at(0.01)
    visit.story.on_message("skip")
    visit.at(QUARTER)
    assert visit.asked == ["open", "hurry"]
    visit.compiled = True
    visit.at(0.01)
    visit.is_over = True  # as the frame before said
    visit.story.refresh(page_view())
    assert visit.asked == ["open", "hurry"]
    visit.at(QUARTER)
    assert visit.asked[2:] == ["no end", "hurry"]
    failed = Visit()
    failed.compiled, failed.pinned.stop_reason = False, lambda: "it could not be compiled"
    failed.at(QUARTER)
    assert failed.asked == ["no end", "hurry"]
