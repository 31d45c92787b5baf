"""The field plot: what a frame brings for it, and an axis that holds what is there. No web server, no engine."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from app.frame.colour_scale import ColourScale
from app.frame.error_plot import ErrorPlot, ErrorPlotBox
from app.frame.field_plot import ROOM, FieldPlot, ValueAxis, magnify_deviation
from app.frame.layout import ComparedRunSlot
from app.frame.primitives import StageMetrics
from app.problems.bar.stage import BarStage
from solvers.problems.bar.scene import BarScene
from solvers.running.run import build
from solvers.solver.samples import QUANTITIES

BAR_FIELD = BarStage.PLOT
BAR = BarScene(cells=10, ppc=2, periods=1)


@pytest.fixture(scope="module")
def solver():
    solver = build(BAR)
    solver.advance(40)
    return solver


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_values_less_deviations_are_the_exact_curve(solver, quantity):
    """To rounding of the values; each particle on the curve at its own coordinate at rest, and none all zero."""
    field, at = solver.snapshot(plotted=quantity).plotted, (np.arange(BAR.particles) + 0.5) / BAR.particles
    exact = BAR_FIELD.exact(BAR, quantity, at, solver.time)
    np.testing.assert_allclose(field[:, 0] - field[:, 1], exact, rtol=0, atol=1e-13 * np.abs(field).max())
    assert np.abs(field[:, 1]).max() > 0


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_deviations_are_the_true_errors(solver, quantity):
    """With their sign."""
    shot = solver.snapshot(plotted=quantity)
    error, deviation = shot.error[:, QUANTITIES.index(quantity)], shot.plotted[:, 1]
    np.testing.assert_allclose(deviation, error, rtol=0, atol=1e-13 * np.abs(shot.plotted).max())


def test_what_is_off_is_not_zero():
    """Accelerations are kept with their effect alone. Nothing is computed for a plot that nobody asked for."""
    solver = build(replace(BAR, effects=()))
    solver.advance(5)
    assert np.isnan(solver.snapshot(plotted="a").plotted).all()
    values, deviations = solver.snapshot(plotted="v").plotted.T
    assert np.isfinite(values).all() and np.isfinite(deviations).all()
    assert solver.snapshot().plotted is None


def test_magnified_is_exact_plus_so_many_deviations():
    """Of what does not swing, where all else is the same everywhere, deviations alone."""
    field, known = np.array([[5.0, 0.25], [2.0, -0.5]]), SimpleNamespace(swings=True)
    np.testing.assert_array_equal(magnify_deviation(known, field, 1), [5, 2])
    np.testing.assert_array_equal(magnify_deviation(known, field, 10), [4.75 + 2.5, 2.5 - 5])
    np.testing.assert_array_equal(magnify_deviation(SimpleNamespace(swings=False), field, 10), [2.5, -5])


def test_axis_ends_at_round_numbers_and_holds_everything():
    """For 1,000 random peaks one after the other, in either direction."""
    axis = ValueAxis()
    for peak in 10 ** np.random.default_rng(0).uniform(-12, 12, 1000):
        axis.update(peak, 0.0)
        assert peak <= ROOM * axis.top * (1 + 1e-12)
        assert float(f"{axis.top:.2g}") == pytest.approx(axis.top, rel=1e-12)


def test_axis_is_calm():
    """A vibration, and a peak that comes and goes by a hair around a round number, do not move it after the first."""
    axis, tops = ValueAxis(), []
    for frame in range(600):
        axis.update(abs(np.sin(0.05 * frame)) * (1 + 0.002 * np.sin(0.3 * frame)), 0.0)
        tops.append(axis.top)
    assert len(set(tops[60:])) == 1
    axis.reset()
    axis.update(1e-6, 2.0)
    assert axis.top == 2


def test_axis_comes_back_once_a_peak_is_gone():
    axis = ValueAxis()
    axis.update(1000.0, 1.0)
    for _ in range(600):
        axis.update(0.5, 1.0)
    assert 1 / ROOM <= axis.top < 3


def test_a_held_axis_only_grows():
    """Until 1.4 s after the last change, when the plot is drawn again and the axis fits what there is."""
    clock = SimpleNamespace(now=0.0)
    axis = ValueAxis(lambda: clock.now)
    axis.update(0.0, 85.0)
    assert axis.top == 100
    for clock.now, least, top in ((1.0, 98.0, 100), (2.0, 126.0, 150), (3.0, 10.0, 150)):
        axis.hold()
        axis.update(0.0, least)
        assert axis.top == top and not axis.is_outdated
    clock.now = 4.5
    assert axis.is_outdated
    axis.update(0.0, 10.0)
    assert axis.top == 10 and not axis.is_outdated


def test_the_curve_before_a_change_stays_for_a_moment():
    """That before the first of several changes, on the axis of now."""
    clock = SimpleNamespace(now=0.0)
    draw, made = plot()
    made["plot"].axis.clock = lambda: clock.now
    first, fields = np.linspace(0, 1, 20), [np.full((20, 2), value, np.float32) for value in (0.01, 0.02, 0.04)]
    scenes = [replace(BAR, amplitude=amplitude) for amplitude in (0.025, 0.026, 0.027)]
    for scene, field in zip(scenes, fields, strict=True):
        draw(scene, "x", 1, first, field, 0.1, UNCROSSED)
    ghost = made["before"].segments
    assert len(ghost) == 19 and made["plot"].shows_before
    np.testing.assert_allclose(ghost[:, 0, 1], BOX.middle + 0.01 * BOX.half / made["plot"].axis.top, rtol=1e-5)
    clock.now = 2.0
    assert made["plot"].is_outdated
    draw(scenes[-1], "x", 1, first, fields[-1], 0.1, UNCROSSED)
    assert not len(made["before"]) and not made["plot"].is_outdated


PLACES = BarStage.layout(StageMetrics(720.0, high=0.5, gutter=0.16), ComparedRunSlot.ALONE)
BOX = PLACES.field
AT, UNCROSSED = (np.arange(20) + 0.5) / 20, np.zeros(20, bool)


def plot(places=PLACES, beside=None):
    """A function that draws a plot's next frame, and what the plot shows by the last part of its name."""
    drawn, made = FieldPlot(BAR_FIELD, beside), {}

    def draw(*frame):
        made.update((mark.name.removeprefix("field/"), mark) for mark in drawn.draw(places, *frame))

    made["plot"] = drawn
    return draw, made


def test_what_is_positive_is_above_the_axis():
    """Dots, and the exact curve beside them, at their values over the axis's end, upwards."""
    solver = build(BAR)
    solver.advance(40)
    draw, made = plot()
    field, X = solver.snapshot(plotted="v").plotted, (np.arange(BAR.particles) + 0.5) / BAR.particles
    draw(BAR, "v", 1, X, field, solver.time, np.zeros(BAR.particles, bool))
    unit = BOX.half / made["plot"].axis.top
    np.testing.assert_allclose(made["particles"].points[:, 1] - BOX.middle, unit * field[:, 0], rtol=0, atol=1e-6)
    line = np.linspace(0, 1, len(made["exact"]) + 1)
    exact = BAR_FIELD.exact(BAR, "v", line, solver.time)
    np.testing.assert_allclose(made["exact"].segments[:, 0, 1] - BOX.middle, unit * exact[:-1], rtol=0, atol=1e-6)
    assert unit * np.ptp(exact) > BOX.half


def test_a_run_gone_bad_breaks_nothing_and_is_said():
    """What is beyond every number is away and counted, what is large is on the axis, the curve is still there."""
    draw, made = plot()
    field = np.zeros((20, 2), np.float32)
    field[:, 1] = field[:, 0] = [*np.linspace(0, 1e9, 17), np.nan, np.inf, 1e38]
    at, crossed = (np.arange(20) + 0.5) / 20, np.arange(20) == 3
    draw(BAR, "v", 1000, at, field, 0.1, crossed)
    heights = made["particles"].points[:, 1]
    assert (heights[17:] < -1).all() and "3 without a number" in made["remark"].text
    assert np.abs(heights[:17] - BOX.middle).max() <= 1.001 * ROOM * BOX.half  # single precision
    assert made["magnified"].text == "error × 1000" and made["high"].text == "+1.00e+12 m/s"
    assert np.isfinite(made["exact"].segments).all()
    np.testing.assert_allclose(made["crossed"].segments.mean(axis=(0, 1))[:2],
                               made["particles"].points[crossed][0, :2], rtol=1e-5)  # a ring around it


def test_the_axis_begins_anew_with_the_run():
    """A restart after a bad end does not wait for its axis to fade."""
    draw, made = plot()
    field = np.full((20, 2), 1e6, np.float32)
    draw(BAR, "x", 1, AT, field, 0.5, UNCROSSED)
    assert made["high"].text == "+1 Mm"
    draw(BAR, "x", 1, AT, 0 * field, 0.0, UNCROSSED)
    assert made["high"].text == "+30 mm" and made["low"].text == "−30 mm"


def test_a_plot_says_what_is_drawn():
    draw, made = plot()

    def said(scene, quantity, magnified=1, value=0.0):
        draw(scene, quantity, magnified, AT, np.full((20, 2), value, np.float32), 0.1, UNCROSSED)
        return made["name"].text, made["remark"].text

    assert said(BAR, "x") == ("Displacement", "") and len(made["exact"])
    assert said(BAR, "sigma", 100) == ("Stress", "") and made["magnified"].text == "error × 100"
    off = replace(BAR, effects=("truth",))
    assert said(off, "a", value=np.nan)[1] == "not computed: the effect \"acceleration error\" is off"
    patch = replace(BAR, motion="patch", amplitude=BarScene().amplitude)
    assert said(patch, "sigma")[1] == "deviation from the exact one"
    assert not np.ptp(made["exact"].segments[:, :, 1])  # which is zero


def test_where_a_name_has_no_room_the_remark_says_it():
    places = BarStage.layout(StageMetrics(358.0, high=0.84), ComparedRunSlot.ALONE)
    draw, made = plot(places)
    draw(BAR, "x", 10, AT, np.zeros((20, 2), np.float32), 0.1, UNCROSSED)
    assert made["remark"].text == "Displacement" and not made["name"].text


def test_dots_and_curve_are_along_the_bar_where_the_material_is():
    """A particle without error lies on the curve, which is drawn against where material is now."""
    t, X = 0.25 * BAR.period, (np.arange(400) + 0.5) / 400
    draw, made = plot()
    u = BAR_FIELD.exact(BAR, "x", X, t)
    draw(BAR, "sigma", 1, X + u, np.stack([BAR_FIELD.exact(BAR, "sigma", X, t), 0 * X], 1), t, np.zeros(400, bool))
    curve = made["exact"].segments[:, 0]
    assert np.abs(np.interp(made["particles"].points[:, 0], curve[:, 0], curve[:, 1])
                  - made["particles"].points[:, 1])[8:-8].max() < 1e-3 * BOX.half
    assert np.abs(u).max() > 0.02 and not len(made["stems"])


def test_stems_are_as_long_as_the_errors():
    """From the exact value to the dot; none that the dot would hide."""
    draw, made = plot()
    error = np.zeros(20)
    error[[4, 11]] = 0.01, -0.02
    for magnified in (1, 10):
        draw(BAR, "x", magnified, AT, np.stack([error, error], axis=1), 0.0, UNCROSSED)
        stems, dots = made["stems"], made["particles"].points
        top = float(made["high"].text[1:].split()[0]) / 1000
        drawn = stems.segments[:, 1, 1] - stems.segments[:, 0, 1]
        np.testing.assert_allclose(drawn, magnified * error[[4, 11]] * BOX.half / top, rtol=1e-4)
        np.testing.assert_array_equal(stems.segments[:, 1, :2], dots[[4, 11], :2])


def test_two_plots_share_an_axis():
    draw, made = plot()
    beside, other = plot(beside=made["plot"])
    field = np.zeros((20, 2), np.float32)
    draw(BAR, "x", 1, AT, field, 0.1, UNCROSSED)
    beside(BAR, "x", 1, AT, field + 1, 0.1, UNCROSSED)
    assert made["plot"].shared_axis_changed and made["high"].text == "+30 mm"
    draw(BAR, "x", 1, AT, field, 0.1, UNCROSSED)
    assert not made["plot"].shared_axis_changed and made["high"].text == other["high"].text == "+1 m"


@pytest.mark.parametrize("known", [True, False])
def test_a_particle_is_pointed_at_where_its_true_error_is(known):
    """Or the estimated one where no other is known."""
    scale, at = ColourScale(), np.linspace(0, 1, 5)
    estimated, true = np.full(5, 0.5), np.full(5, 0.25)
    scale.update(estimated, true)
    plotted = SimpleNamespace(start=0.0, end=1.0, ends=("0", "1"))
    plot, box = ErrorPlot(plotted, scale), ErrorPlotBox(0.0, 1.0, 0.0, 1.0)
    plot._labelled = box, StageMetrics(900.0), "x", scale.appearance
    assert list(plot.draw(box, StageMetrics(900.0), "x", at, estimated, true if known else None))
    heights = plot.dot_positions(slice(1, 3), 2)[:, 1]
    assert heights == pytest.approx(scale.shares(true if known else estimated)[:2])
