"""Looking back: the last frames, how many there are, and the numbers that go with an earlier one. No web server."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from app.frame.error_view_captions import NOT_COMPARED, frame_error_view
from app.page.features.upload.uploaded_run import UploadedRun
from app.page.headline_panel import frame_headline
from app.page.panels.readout_tables import live_readout
from app.page.stage.worst_region import WorstRegions
from app.page.visit.history import LAST_PERIODS, MOST_ROWS, WINDOW, DownsampledSeries, NormHistory, series_until
from app.page.visit.recent_frames import MOST_BYTES, MOST_FRAMES, RecentFrames, frame_bytes
from solvers.engine.shared_frames import FrameOptions, block_bytes, read_frame, write_frame
from solvers.problems.bar.scene import BarScene
from solvers.running.run import build
from solvers.solver.samples import column_names as columns_of
from tests.app.frame.test_view import BAR, SIGNED, TRUE, arrays_of, report_of


def frame(step, playing=True, fresh=False, particles=20, scene=BAR):
    """A frame after so many steps; its first particle stands at the step's number."""
    arrays = arrays_of(np.zeros(20), np.zeros(20))
    arrays = replace(arrays, **{name: np.resize(getattr(arrays, name), (particles, *getattr(arrays, name).shape[1:]))
                                for name in ("position", "displacement", "deformation_gradient", "error")})
    arrays.position[0] = step
    return replace(report_of(scene), step=step, time=step * scene.time_step, fresh=fresh, playing=playing,
                   rows=np.ones((3, 30))), arrays


def recent_of(steps, **last):
    """Frames of so many steps, the last of which stands still."""
    recent = RecentFrames()
    for step in range(steps):
        recent.add(*frame(step, fresh=step == 0))
    recent.add(*frame(steps, playing=False, **last))
    return recent


def shown(recent):
    report, arrays = recent.shown_frame
    assert arrays.position[0, 0] == report.step
    return report.step


def test_the_last_frames_are_kept():
    recent = recent_of(MOST_FRAMES + 50)
    assert len(recent.frames) == MOST_FRAMES
    most, periods = recent.stored_frames_and_periods
    assert most == MOST_FRAMES - 1 and periods == pytest.approx(most * BAR.time_step / BAR.period)
    recent.go_back(10**6)
    assert shown(recent) == 51


def test_memory_is_bounded_and_large_frames_are_fewer():
    """And what is counted is all that a frame of the engine brings."""
    recent, particles = RecentFrames(), 200_000
    held = frame_bytes(frame(0, particles=particles)[1])
    for step in range(20):
        recent.add(*frame(step, particles=particles, fresh=step == 0))
    assert len(recent.frames) == MOST_BYTES // held < 20
    scene = BarScene(cells=8, ppc=2, estimators=("transport",))
    assert frame_bytes(engine_frame(build(scene))) == 4 * scene.particles * (1 + 1 + 1 + 1 + 4 + 4 + 2)


def engine_frame(solver):
    """A frame's arrays as an engine hands them over."""
    block = SimpleNamespace(buf=bytearray(block_bytes(solver.scene)))
    write_frame(block, solver.scene, solver.snapshot(plotted="x"))
    return read_frame(block, solver.scene, len(solver.snapshot().position), FrameOptions(plotted="x"))


def test_looking_back_needs_a_pause_and_ends_when_the_run_moves_or_begins_anew():
    """A frame that only holds something else, of the same step, changes nothing but itself."""
    recent = RecentFrames()
    assert recent.shown_frame is None and recent.stored_frames_and_periods == (0, 0.0)
    for step in range(10):
        recent.add(*frame(step, fresh=step == 0))
    recent.go_back(3)
    assert shown(recent) == 9 and recent.periods_back == 0
    recent.add(*frame(9, playing=False))
    recent.go_back(3)
    assert shown(recent) == 6 and not recent.shown_frame[0].playing
    assert recent.periods_back == pytest.approx(3 * BAR.time_step / BAR.period)
    recent.add(*frame(9, playing=False))
    assert shown(recent) == 6 and len(recent.frames) == 10
    recent.add(*frame(10, playing=False))  # a single step
    assert shown(recent) == 10
    recent.go_back(5)
    recent.add(*frame(10))  # on it goes
    assert shown(recent) == 10 and recent.back == 0
    recent.add(*frame(11, playing=False))
    recent.go_back(5)
    recent.add(*frame(0, fresh=True, playing=False))
    assert len(recent.frames) == 1 and recent.back == 0 and shown(recent) == 0


def test_numbers_are_those_of_the_frame():
    """The readout of an earlier frame is that of the live run when it was there, but for how the page goes."""
    scene = BarScene(cells=10, ppc=2, periods=1, estimators=("transport",))
    solver, history, seen = build(scene), NormHistory(scene, 20), []
    session = SimpleNamespace(pinned=None, history=history, speed=1.0, is_over=False)
    for step in range(12):
        history.add(solver.measure() if step == 0 else solver.advance(40))
        report = replace(report_of(scene), step=solver.step, time=solver.time, playing=False)
        seen.append((report, live_readout(session, session.history, report, "x", "transport", None,
                                          WorstRegions()).html))
    report, then = seen[5]
    now = live_readout(session, session.history, report, "x", "transport", None, WorstRegions(), ago=0.314).html
    assert "<td>shown</td>\n<td><b>0.31 periods back</b>, paused</td>" in now and "<td>speed</td>" not in now
    assert then != seen[-1][1]
    cut = then.index("<td>energy</td>")
    assert then[cut:] == now[now.index("<td>energy</td>"):]
    arrays = engine_frame(solver)
    view = frame_error_view(report, arrays, "x", "transport", False)
    said = [frame_headline(report, arrays, view, "x", "transport", ago) for ago in (0.0, 0.314)]
    now, then = (str(one).partition(" the displacement is ") for one in said)
    assert now[0] == f"At t = {report.time:.3g} s" and then[0] == "0.31 periods back" and now[2] == then[2] != ""


def test_a_frame_from_before_the_comparison_says_so():
    view = frame_error_view(report_of(BAR), arrays_of(SIGNED, TRUE, differences=False), "x", "transport", True)
    assert view.left.sizes is None and view.left.silence == NOT_COMPARED


def test_a_course_is_thinned_evenly_and_bounded():
    kept, count = DownsampledSeries(), 10 * MOST_ROWS + 7
    for k in range(0, count, 3):
        kept.add({"time": np.arange(k, k + 3.0), "double": 2 * np.arange(k, k + 3.0)})
    time = kept.series["time"]
    assert MOST_ROWS // 2 < len(time) <= MOST_ROWS and time[0] == 0 and len(set(np.diff(time))) == 1
    np.testing.assert_array_equal(kept.series["double"], 2 * time)


def test_the_latest_periods_stay_fine_however_long_the_run():
    """Each sample of two periods in a run whose whole course has become eight times as coarse."""
    scene, each = BAR, 100  # samples in a period
    history, columns = NormHistory(scene, 20), len(columns_of(scene.active_estimators, scene.active_effects))
    steps = np.arange(8 * MOST_ROWS) * scene.period / scene.time_step / each
    for few in np.split(steps, len(steps) // 8):
        history.add(np.pad(few[:, None], ((0, 0), (0, columns - 1))))
    assert np.diff(history.series["time"]).min() > 7.9 * scene.period / each
    time = history.latest_periods_series["time"]
    assert len(time) == pytest.approx(LAST_PERIODS * each, abs=1)
    assert time[-1] - time[0] <= LAST_PERIODS * scene.period * (1 + 1e-12)


def test_until_cuts_at_a_time():
    series = {"time": np.array([0.0, 1.0, 2.0]), "value": np.array([5.0, 6.0, 7.0])}
    assert series_until(series, 2.0) is series and series_until({}, 1.0) == {}
    np.testing.assert_array_equal(series_until(series, 1.0)["value"], [5, 6])
    np.testing.assert_array_equal(series_until(series, -1.0)["value"], [5])


@pytest.mark.parametrize("scene", [BarScene(modulus=64.0), BarScene(modulus=0.25)], ids=["quick", "slow"])
def test_a_rate_of_crossings_is_per_second(scene):
    """A history made up: 40 crossings a second, then none, then 120; looked at a hundred times a period, and seldom.
    The rate is there a window later, whatever the period is: a number by the period would be wrong by as much."""
    T = scene.period
    history = NormHistory(scene, scene.particles)
    for steps in (300, 15):
        time = np.linspace(0, 3 * T, steps + 1)
        count = np.interp(time, [0, T, 2 * T, 3 * T], np.cumsum([0, 40 * T, 0, 120 * T]))
        at, rate = history.crossings_per_second({"time": time, "crossings": count})
        late = max(WINDOW * T, time[1] * (1 + 1e-9))
        for start, expected in ((0, 40.0), (1, 0.0), (2, 120.0)):
            inside = (at >= start * T + late) & (at <= (start + 1) * T)
            assert inside.sum() >= 4
            np.testing.assert_allclose(rate[inside], expected, rtol=0, atol=1e-9 * 120)


def test_a_rate_of_crossings_in_a_file_is_per_second():
    """7, 3 and 10 particles are elsewhere after a half, a quarter and a second."""
    file = SimpleNamespace(times=np.array([0, 0.5, 0.75, 1.75]), _crossed=np.array([0, 7, 3, 10]))
    at, rate = UploadedRun.crossings_per_second(file, {})
    np.testing.assert_array_equal(at, [0.5, 0.75, 1.75])
    np.testing.assert_allclose(rate, [14, 12, 10])
