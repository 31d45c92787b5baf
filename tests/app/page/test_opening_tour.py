"""The opening: its words are true of its runs, in their own numbers; its steps come in time; it ends as it should."""

import math
from contextlib import nullcontext
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from app.frame.primitives import StageMetrics
from app.names_and_units import per_cent
from app.page.features.opening_tour import BAR, BEFORE_CROSSING, BESIDE, OPENING, QUARTER, SECONDS, OpeningTour
from app.page.playback_controls import SLOW
from app.problems.bar.stretching_bar import MAGNIFIED, PIECES, StretchingBar
from solvers.running.run import build
from tests.app.frame.test_view import report_of
from tests.app.page.panel import page_view
from tests.app.page.test_frame_buffer import engine_frame
from tests.support.recording_scene import RecordingSurface


def frame(scene, periods):
    """A run after so many periods."""
    solver = build(scene)
    rows = solver.advance(round(periods * scene.period / scene.time_step))
    return replace(report_of(scene), step=solver.step, time=solver.time, rows=rows), engine_frame(solver)


class Session:
    """A session that does at once what it is asked to, without a run."""

    def __init__(self):
        self.scene, self.refused, self.playing, self.restarts, self.at = BAR, None, True, 0, QUARTER
        self.pinned, self.watched = SimpleNamespace(scene=BESIDE, last=None), True
        self.report = None

    @property
    def playback_request_key(self):
        return self.scene, self.restarts

    def reset(self, begin_at, playing):
        self.at, self.playing, self.restarts = begin_at, playing, self.restarts + 1

    def play(self, playing):
        self.playing = playing


class Visit:
    """A page without a browser, and the tour there."""

    def __init__(self):
        self.now, self.session, self.html, self.drawn = 0.0, Session(), SimpleNamespace(content=""), 0
        self.surfaces = []
        shown = SimpleNamespace(state=replace(OPENING, compared=None),
                                show=lambda state: setattr(self.session, "scene", state.scene))
        page = SimpleNamespace(
            gui=SimpleNamespace(add_html=lambda _: self.html), session=self.session, controls=shown,
            run=SimpleNamespace(numbers=None, sentence=None, seek=None, stage_content=lambda _: None),
            recent=SimpleNamespace(shown_frame=None), client=SimpleNamespace(atomic=nullcontext, flush=lambda: None),
            stage=SimpleNamespace(draw=self._draw),
            canvas=SimpleNamespace(add_surface=self._surface, cover=lambda _: None))
        self.tour = OpeningTour(page, lambda: self.now)

    def _draw(self):
        self.drawn += 1

    def _surface(self, _):
        self.surfaces.append(SimpleNamespace(visible=True, stage_metrics=StageMetrics(736), show_marks=lambda *_: None))
        return self.surfaces[-1]

    def after(self, seconds, periods=QUARTER):
        """The step so many seconds later, with frames of both runs after so many periods."""
        self.now += seconds
        self.session.report = SimpleNamespace(scene=BAR, time=periods * BAR.period)
        self.session.pinned.last = self.session.pinned.last or (None, None)
        self.tour.refresh(page_view())
        return self.tour.beat


@pytest.fixture
def visit():
    visit = Visit()
    yield visit
    visit.tour.close()


def test_four_steps_in_the_runs_own_numbers(visit):
    """The stress is several per cent wrong after a quarter, and recovered finds most of that; B-splines, whose
    particles cross as well, are better by a factor of ten. Nobody has crossed where slow motion begins."""
    before, run, beside = frame(BAR, BEFORE_CROSSING), frame(BAR, QUARTER), frame(BESIDE, QUARTER)
    rms = [math.sqrt(np.mean(errors[:, 2].astype(float) ** 2)) for errors in
           (run[1].error, run[1].estimate["recovered"], beside[1].error)]
    wrong, splines = rms[0] / BAR.size_of("sigma"), rms[2] / BAR.size_of("sigma")
    assert wrong > 0.05 and 0.85 < rms[1] / rms[0] < 1 and splines < 0.1 * wrong
    assert [(arrays.steps_since_crossing >= 0).sum() for _, arrays in (before, run, beside)] == [0, 10, 10]

    visit.session.pinned.last = beside
    said = []
    for visit.tour.beat in SECONDS:
        said.append(str(visit.tour.headline(run)))
    assert "Material Point Method" in said[0] and "The stress jumps off the line" in said[1]
    assert said[2].startswith(f"{per_cent(wrong)} wrong,")
    assert f"finds {per_cent(rms[1] / rms[0])} of the error" in said[2]
    assert f"without a jump: {per_cent(splines)} wrong" in said[3]
    visit.tour.beat = 0
    assert not visit.tour.headline(run)


def test_the_first_particle_crosses_soon_after_slow_motion_begins():
    """Within 7.5 s of the start."""
    solver = build(BAR)
    solver.advance(round(BEFORE_CROSSING * BAR.period / BAR.time_step))
    while not (engine_frame(solver).steps_since_crossing >= 0).any():
        solver.advance(1)
    assert 1.0 < (solver.time / BAR.period - BEFORE_CROSSING) / SLOW < 7.5 - SECONDS[1]


def test_its_steps_come_in_time_and_it_ends_playing(visit):
    """22 s in all; a step waits for the frames that it shows."""
    tour, session = visit.tour, visit.session
    tour.on_message("play")
    assert (tour.beat, session.at, session.playing) == (1, BEFORE_CROSSING, False)
    visit.now += 2 * SECONDS[1]
    tour.refresh(page_view())
    assert tour.beat == 1  # no frame yet
    assert visit.after(0, BEFORE_CROSSING) == 2 and session.playing and tour.source.is_on
    assert visit.after(6.0) == 2 and not session.playing and session.at == QUARTER
    assert visit.after(SECONDS[2] - 5.9) == 3 and tour.source.is_on
    assert visit.after(SECONDS[3] + 0.1) == 4 and not tour.source.is_on and visit.drawn
    assert "data-beat='4'" in visit.html.content and not any(surface.visible for surface in visit.surfaces)
    assert visit.after(SECONDS[4] + 0.1) == 0 and sum(SECONDS.values()) == 22
    assert (session.at, session.playing) == (QUARTER, True)


def test_the_bar_moves_on_when_it_is_asked_for_again(visit, monkeypatch):
    """As a browser does once it shows the page; the first step then takes all its time."""
    drawn = []
    visit.tour.close()  # its own thread would draw as well
    monkeypatch.setattr(visit.tour._bar, "draw", drawn.append)
    for _ in range(2):
        visit.tour.on_message("play")
        visit.now += 1.5
        visit.tour._draw_cover()
    assert drawn == [1.5, 3.0] and visit.after(SECONDS[1] - 1.6) == 1 and visit.after(0.2) == 2


@pytest.mark.parametrize("beat", SECONDS)
def test_skip_lands_at_its_end_from_every_step(visit, beat):
    visit.tour.on_message("play")
    while visit.tour.beat < beat:
        visit.after(7.0)
    visit.tour.on_message("skip")
    assert visit.tour.beat == 0 and "data-beat='0'" in visit.html.content
    assert (visit.session.at, visit.session.playing) == (QUARTER, True)


def test_who_wants_no_motion_goes_on_by_a_button(visit):
    """And nothing plays, not even at the end."""
    visit.tour.on_message("stills")
    assert visit.after(60.0) == 1 and visit.session.at == QUARTER
    for beat in (2, 3, 4, 0):
        assert not visit.session.playing
        visit.tour.on_message("next")
        assert visit.tour.beat == beat
    assert not visit.session.playing
    visit.tour.on_message({"no": "word"})
    visit.tour.on_message("next")
    assert visit.tour.beat == 0


def test_anything_else_ends_it(visit):
    """A moved slider goes on from where it is; a lesson or another scene is left alone."""
    tour, session = visit.tour, visit.session
    tour.on_message("play")
    session.scene = replace(BAR, amplitude=0.005)
    assert visit.after(0.1) == 0 and session.playing and session.restarts == 1
    tour.on_message("play")
    assert session.scene == BAR
    tour.refresh(page_view(alone=False))
    assert tour.beat == 0 and not session.playing
    tour.on_message("play")
    session.scene, session.restarts = replace(BAR, cells=20), session.restarts + 1
    assert visit.after(0.1) == 0 and not session.playing


def test_pieces_tile_the_bar_and_cover_each_other_in_order():
    """Each is drawn over what is too long of that before it, and so are the gaps; ends stand still, the middle of each
    half moves 20 times as far as the bar's."""
    surface = RecordingSurface()
    bar = StretchingBar(surface, BAR)
    for seconds, moved in ((0.0, 0.0), (0.5, MAGNIFIED * BAR.amplitude), (1.5, -MAGNIFIED * BAR.amplitude)):
        bar.draw(seconds)
        marks = surface.marks
        left = marks["pieces"].points[:, 0] - 0.5 * marks["pieces"].size / 1.02
        edges = left[:2 * PIECES:2]
        assert (np.diff(edges) > 0).all() and edges[0] == pytest.approx(0, abs=2e-3)
        assert edges[PIECES // 4] - 0.25 == pytest.approx(moved, abs=2e-3)
        assert (np.diff(edges) < marks["pieces"].size).all()  # wide enough for the longest
        assert len(marks["spots"].points) == PIECES // 2
