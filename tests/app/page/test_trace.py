"""The traced particle: its numbers are the frames', and a click finds it; and what the probe reads in a rectangle."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from app.frame.colour_scale import ColourScale
from app.frame.layout import ComparedRunSlot
from app.frame.primitives import AWAY
from app.page.stage.pointer_and_camera import RADIUS, RectangleErrorProbe, TracedParticleRing
from app.page.visit.history import LAST_PERIODS, MOST_ROWS
from app.page.visit.recent_frames import RecentFrames
from app.page.visit.traced_particle_series import ParticleTracer
from app.problems.bar.stage import BarStage
from app.problems.views import VIEWS
from app.renderers import viewer_renderer
from app.renderers.viewer_renderer import LabelLayer
from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.running.run import build
from solvers.solver.samples import QUANTITIES
from tests.app.frame.test_view import report_of
from tests.app.page.test_frame_buffer import engine_frame
from tests.support.recording_scene import RecordingScene, RecordingSurface

BAR = BarScene(cells=10, ppc=2, periods=1, amplitude=0.1, estimators=("transport",))
RING = RingScene(cells=12, periods=1, estimators=("transport",))
GUI = SimpleNamespace(add_html=lambda content: SimpleNamespace())
FRAMES, STEPS = 40, 10  # and between two frames


@pytest.fixture(scope="module", params=[BAR, RING], ids=["bar", "ring"])
def run(request):
    """Frames of a run as a page gets them."""
    solver, frames = build(request.param), []
    solver.measure()
    for k in range(FRAMES):
        report = replace(report_of(solver.scene), fresh=k == 0, step=solver.step, time=solver.time,
                         particles=len(solver.snapshot().position))
        frames.append((report, engine_frame(solver)))
        solver.advance(STEPS)
    return frames


def traced_after(frames, particle, chosen_after=FRAMES // 2):
    """What is traced when the particle is chosen in the middle of a run."""
    recent = RecentFrames()
    trace = ParticleTracer(recent)
    for k, frame in enumerate(frames):
        recent.add(*frame)
        trace.on_frame(*frame)
        if k == chosen_after:
            trace.choose(particle)
    return trace


def test_series_are_the_frames_numbers(run):
    """From the first frame that is remembered, past and future of the choice alike."""
    traced = traced_after(run, 7).traced
    series = traced.series
    np.testing.assert_array_equal(series["time"], [report.time for report, _ in run])
    for q, name in enumerate(QUANTITIES):
        np.testing.assert_array_equal(series[f"error_{name}"], [abs(arrays.error[7, q]) for _, arrays in run])
        np.testing.assert_array_equal(series[f"transport/estimate_{name}"],
                                      [abs(arrays.estimate["transport"][7, q]) for _, arrays in run])
    assert series["error_x"].max() > 0 and traced.latest_periods_series["time"][-1] == run[-1][0].time
    assert traced.title.startswith("particle 7, X = ")


def test_crossings_are_marked_where_they_are_first_seen(run):
    """On the first frame after the step of the crossing; of a particle that has not crossed there are none."""
    marked = 0
    for particle in range(0, run[0][0].particles, 3):
        traced = traced_after(run, particle).traced
        since = np.array([arrays.steps_since_crossing[particle] for _, arrays in run])
        fresh = (since >= 0) & (since < STEPS) & (np.arange(FRAMES) > 0)
        np.testing.assert_array_equal(traced.crossing_marks(traced.series["time"])[1:], fresh[1:])
        marked += fresh.sum()
    assert marked > 3


def test_a_long_trace_is_bounded():
    """And what shows the last periods ends there, whatever the whole has been thinned to."""
    report, arrays = replace(report_of(BAR), fresh=True), replace(
        engine_frame(build(BAR)), steps_since_crossing=np.zeros(20, np.float32))
    trace = traced_after([(report, arrays)], 3, chosen_after=0)
    steps = range(5, 4 * MOST_ROWS * 5, 5)
    for step in steps:
        trace.on_frame(replace(report, fresh=False, step=step, time=step * BAR.time_step), arrays)
    for series in (trace.traced.series, trace.traced.latest_periods_series):
        assert MOST_ROWS // 10 < len(series["time"]) <= MOST_ROWS
        assert series["time"][-1] == pytest.approx(steps[-1] * BAR.time_step, rel=1e-2)
    latest = trace.traced.latest_periods_series["time"]
    assert latest[-1] - latest[0] == pytest.approx(LAST_PERIODS * BAR.period, rel=0.05)
    assert trace.traced.series["time"][0] == 0 and len(trace.traced._crossings) == MOST_ROWS


def test_another_run_goes_on_with_the_same_place():
    """With finer particles the nearest one; another problem has no such place."""
    trace = traced_after([frame_of(BAR)], 7, chosen_after=0)
    finer = replace(BAR, ppc=6)
    trace.on_frame(*frame_of(finer))
    traced = trace.traced
    assert traced.scene == finer and traced.at_rest[0] == pytest.approx(7.5 / 20, abs=0.5 / 60 + 1e-6)
    assert traced.particle in (22, 23) and len(traced.series["time"]) == 1
    trace.on_frame(*frame_of(RING))
    assert trace.traced is None


def frame_of(scene):
    return replace(report_of(scene), fresh=True, particles=scene.particles), engine_frame(build(scene))


@pytest.fixture
def stage(run):
    report, arrays = run[-1]
    stage = VIEWS[report.scene.problem].stage(RecordingSurface(), ColourScale())
    stage.plotted = "x"
    stage.draw(report.scene, arrays, None, arrays.error[:, 0], report.time)
    return stage


def test_every_image_is_found_by_a_click(run, stage):
    """The bar's in both lanes, the ring's mirror images, and the dots of the bar's field plot; beside them nothing."""
    arrays = run[-1][1]
    images = stage.drawn_particle_points(arrays, slice(None))
    halves = 2 if isinstance(stage, BarStage) else len(stage.MIRRORS)
    assert images.shape == (halves + 1, len(arrays.position), 3)
    assert (np.ptp(images[:halves, :, :2], axis=0) > 0).any()
    for image in images[:halves + isinstance(stage, BarStage)]:
        for particle in range(0, len(arrays.position), 5):
            x, y, _ = image[particle]
            assert stage.nearest_particle((x, y), arrays) == particle
    places = stage.layout(stage.sheet.stage_metrics.rounded(), ComparedRunSlot.ALONE)
    beside = places.middle if halves > 2 else (0.5, 1.0)  # the ring's hole, above the bar
    assert stage.nearest_particle(beside, arrays) is None


def test_height_in_the_lanes_does_not_count():
    """As wide as a particle is the column in which it is meant, between the lanes as well."""
    report, arrays = frame_of(BAR)
    stage = BarStage(RecordingSurface(), ColourScale())
    stage.draw(report.scene, arrays, None, arrays.error[:, 0], 0.0)
    places = stage.layout(stage.sheet.stage_metrics.rounded(), ComparedRunSlot.ALONE)
    for y in (places.estimate + 0.01, 0.5 * (places.estimate + places.truth), places.truth - 0.01):
        assert [stage.nearest_particle((x, y), arrays) for x in (0.001, 0.374, 0.424, 0.999)] == [0, 7, 8, 19]
    assert stage.nearest_particle((1.2, places.truth), arrays) is None


def test_a_click_marks_and_another_ends_it(run, stage):
    """Rings stand around every image of the particle; they go with a click into the empty place or on it again."""
    report, arrays = run[-1]
    recent = RecentFrames()
    recent.add(report, arrays)
    clicks, scene = [], RecordingScene()
    scene.on_click = lambda: clicks.append
    trace, client = ParticleTracer(recent), SimpleNamespace(scene=scene)
    mark = TracedParticleRing(client, viewer_renderer.ViewerSurface(client, LabelLayer(GUI), "/trace"), trace)
    mark.update(stage, arrays)
    assert not scene.made["trace"].visible
    images = stage.drawn_particle_points(arrays, slice(5, 6))[:, 0, :2]
    seen = images[:, 1] > AWAY  # the ring's plot has no room here

    def click(x, y):
        eye = np.array([0.4, 0.6, 20.0])
        clicks[0](SimpleNamespace(ray_origin=eye, ray_direction=(np.array([x, y, 0.0]) - eye) / 20))

    for place in (tuple(images[0]), (0.5, -5.0)):
        click(*images[0])
        assert trace.traced.particle == 5
        assert scene.made["trace"].visible
        for rings in (scene.made["ground"], scene.made["dot"]):
            points = rings.points.reshape(len(images), -1, 3)[seen, :, :2]
            apart = np.linalg.norm(points - images[seen, None], axis=2)
            np.testing.assert_allclose(apart, RADIUS, rtol=1e-4)  # single precision near 1
        click(*place)
        assert trace.traced is None and not scene.made["trace"].visible


def test_mean_and_worst_are_of_the_particles_in_the_rectangle_alone():
    """Drawn from its lower right to its upper left; one of three particles within has no estimate."""
    acts = []
    client = SimpleNamespace(scene=SimpleNamespace(on_rect_select=lambda: acts.append))
    camera = SimpleNamespace(stage_point=lambda place: place)
    x = np.array([0.1, 0.2, 0.3, 0.9])
    stage = SimpleNamespace(particles_in=lambda low, high, arrays: (x >= low[0]) & (x <= high[0]))
    probe = RectangleErrorProbe(client, RecordingSurface(), camera)
    estimated, true = np.array([1e-3, np.nan, 5e-3, 1.0]), np.array([2e-3, 3e-3, 10e-3, 1.0])
    probe.measure(stage, None, estimated, true, "m")
    assert probe.text is None
    acts[0](SimpleNamespace(screen_min=(0.5, -0.1), screen_max=(0.0, 0.2)))
    probe.measure(stage, None, estimated, true, "m")
    assert probe.text == "3 particles; estimated mean 3 mm, worst 5 mm; true mean 5 mm, worst 10 mm"
    probe.measure(stage, None, None, true, "m")
    assert probe.text == "3 particles; true mean 5 mm, worst 10 mm"
    acts[0](SimpleNamespace(screen_min=(0.4, 0.0), screen_max=(0.5, 1.0)))
    probe.measure(stage, None, estimated, true, "m")
    assert probe.text is None
    probe.hide()
    acts[0](SimpleNamespace(screen_min=(0.0, -0.1), screen_max=(0.5, 0.2)))
    probe.measure(stage, None, estimated, true, "m")
    assert probe.text is None  # it was dragged over something else
