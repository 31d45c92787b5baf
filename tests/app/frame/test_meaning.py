"""What a picture means: which half and which lane show which error, and that a colour at a tick is that of its number.
No web server, no engine."""

from __future__ import annotations

import numpy as np
import pytest

from app.frame.colour_scale import ZERO, ColourScale
from app.frame.error_view_captions import NONE_CHOSEN, StageHalfErrors
from app.frame.layout import HALVES
from app.frame.primitives import Dots, StageMetrics
from app.frame.stage import StageLabels, WorstRegionAnnotations, WorstRegionMark
from app.problems.views import VIEWS
from solvers.problems import PROBLEMS
from solvers.running.run import build
from tests.app.page.test_frame_buffer import engine_frame
from tests.support.recording_scene import RecordingSurface

TRUE, ESTIMATED = (255, 0, 0), (0, 0, 255)


class TwoColours(ColourScale):
    """A scale that tells one size from another."""

    def colours(self, sizes: np.ndarray) -> np.ndarray:
        return np.where(sizes[:, None] > 0.5, TRUE, ESTIMATED).astype(np.uint8)


def drawn(problem: str, quantity_known: tuple[bool, bool] = (True, True)):
    """The dots of a problem's body where every estimate is 0 and every true error 1, and the stage."""
    scene = PROBLEMS[problem].scene(cells=12, periods=1)
    arrays, stage = engine_frame(build(scene)), VIEWS[problem].stage(RecordingSurface(), TwoColours())
    sizes = [np.full(len(arrays.position), value) if known else None
             for value, known in zip((0.0, 1.0), quantity_known, strict=True)]
    stage.draw(scene, arrays, *sizes, 0.0)
    bodies = [mark for mark in stage.sheet.marks.values() if isinstance(mark, Dots)
              and mark.name in ("lanes", "particles", "estimate", "truth")]
    points = np.concatenate([mark.points[:, :2] + mark.origin for mark in bodies])
    return stage, points, np.concatenate([mark.colours for mark in bodies])


@pytest.mark.parametrize("problem", PROBLEMS)
def test_each_error_is_shown_where_its_name_stands(problem):
    """The estimate is above the truth along the bar and left of it in the plane, and its title is at its own lane or on
    its own side; every dot has the colour of its half."""
    stage, points, colours = drawn(problem)
    places = stage._layout
    named = {label.name: label for label in stage.labels(StageLabels(("Estimate", "Truth")), places)}
    estimate, truth = (named[f"{name}-title"] for name in ("estimate", "truth"))
    if hasattr(places, "lane"):
        at, middle, titles = points[:, 1], 0.5 * (places.estimate + places.truth), (estimate.y, truth.y)
        left = at > middle
        assert titles[0] > middle > titles[1]
    else:
        at, middle = points[:, 0], places.middle[0]
        left = at < middle
        assert estimate.x < middle < truth.x
    assert left.any() and (~left).any()
    assert (colours[left] == ESTIMATED).all() and (colours[~left] == TRUE).all()


def test_a_run_that_nobody_judges_has_the_lane_of_the_truth_alone():
    scene = PROBLEMS["bar"].scene(cells=12, periods=1)
    arrays, stage = engine_frame(build(scene)), VIEWS["bar"].stage(RecordingSurface(), TwoColours())
    ones, plot = np.ones(len(arrays.position)), stage._layout.field.half
    for nobody in (NONE_CHOSEN, ""):
        stage.show_captions(StageHalfErrors("Estimate", "", None, nobody), StageHalfErrors("Truth", "", ones))
        stage.draw(scene, arrays, 0 * ones, ones, 0.0)
        lanes, titles = stage.sheet.marks["lanes"], [stage.sheet.marks[f"{name}-title"].text for name in HALVES]
        assert (lanes.colours == TRUE).all() == bool(nobody) and titles == ["" if nobody else "estimate", "truth"]
        assert (stage._layout.field.half > plot) == bool(nobody)


def test_a_rectangle_on_any_quarter_of_the_ring_holds_the_particles_that_are_drawn_there():
    """A particle has four images: a small rectangle about any of them holds it, and so does the quarter's."""
    scene = PROBLEMS["ring"].scene(cells=12, periods=1)
    arrays, stage = engine_frame(build(scene)), VIEWS["ring"].stage(RecordingSurface(), TwoColours())
    sizes = np.zeros(len(arrays.position))
    stage.draw(scene, arrays, sizes, sizes, 0.0)
    middle, far = np.array(stage._layout.middle), np.array([10.0, 10.0])
    for image, side in zip(stage.drawn_particle_points(arrays, slice(5, 6))[:4, 0, :2], stage.MIRRORS, strict=True):
        assert (np.sign(image - middle) == side).all()
        assert np.flatnonzero(stage.particles_in(tuple(image - 1e-4), tuple(image + 1e-4), arrays)).tolist() == [5]
        ends = np.sort([middle, middle + side * far], axis=0)
        assert stage.particles_in(tuple(ends[0]), tuple(ends[1]), arrays).all()


@pytest.mark.parametrize("problem", PROBLEMS)
@pytest.mark.parametrize("known", [(True, False), (False, True)], ids=["no truth", "no estimate"])
def test_a_half_of_which_nothing_is_known_has_no_colour_of_the_other(problem, known):
    """The other one has its own."""
    _, _, colours = drawn(problem, known)
    shown, hidden = (ESTIMATED, TRUE) if known[0] else (TRUE, ESTIMATED)
    assert (colours == shown).all(axis=1).mean() == pytest.approx(0.5, abs=0.02)
    assert not (colours == hidden).all(axis=1).any()


def assert_shades(ticks, logarithmic, row_of):
    """The row of the shade of every tick's number is where the tick is."""
    assert len(ticks) > 3 and ticks[0][0] == 0 and ticks[-1][0] == 1
    for at, text in ticks:
        value = 0.0 if text == ZERO else float(text.removesuffix(" %")) / 100
        assert abs(row_of(value) - 255 * at) <= 1 + logarithmic


@pytest.mark.parametrize("logarithmic", [False, True], ids=["linear", "logarithmic"])
@pytest.mark.parametrize("size", [3.1e-4, 0.077, 0.77])
def test_the_colour_at_a_tick_is_that_of_its_number(size, logarithmic):
    """To one of 256 shades, or two on a logarithmic scale, where numbers of three digits are so far apart."""
    scale = ColourScale()
    scale.logarithmic = logarithmic
    scale.update(None, np.array([size]))
    scale.exceeded = False
    table = [tuple(shade) for shade in scale.gradient(256)]
    assert_shades(scale.ticks("x", says_of_what=False), logarithmic,
                  lambda value: table.index(tuple(scale.colours(np.array([value]))[0])))


def test_lines_of_a_ring_are_no_longer_than_its_wall_and_its_errors_stand_on_the_colours_scale():
    """The line between the halves leaves the hole free, arcs mark worst regions from outside, and points of the plot
    are as high as their colour is on the bar."""
    scene, surface, scale = PROBLEMS["ring"].scene(cells=12, periods=1), RecordingSurface(), ColourScale()
    surface.stage_metrics = StageMetrics(736.0, high=0.45, gutter=0.16)
    arrays, stage = engine_frame(build(scene)), VIEWS["ring"].stage(surface, scale)
    stage.plotted, scale.top = "x", 0.5
    true = np.linspace(0.0, 0.4, len(arrays.position))
    stage.draw(scene, arrays, 2 * true, true, 0.0)
    worst = WorstRegionMark(true > 0.39, "1 mm")
    stage.annotate(WorstRegionAnnotations((worst, worst)), arrays)
    places, marks = stage._layout, surface.marks
    metre = places.radius / stage.max_radius(scene)
    dot = 0.03  # m: half of a drawn particle, and some more
    for name, low, high in (("planes", scene.INNER - dot, scene.OUTER + dot),
                            ("worst", scene.OUTER, 1.1 * scene.OUTER)):
        away = np.linalg.norm(marks[name].segments[:, :, :2] - places.middle, axis=2) / metre
        assert len(away) and low <= away.min() and away.max() <= high, name
    assert marks["worst-size"].text == "1 mm"  # once for both
    box = places.plot
    for name, sizes in (("true", true), ("rings", 2 * true)):
        drawn_at = (marks[f"plot/{name}"].points[:, 1] - box.low) / (box.high - box.low)
        np.testing.assert_allclose(drawn_at, np.minimum(sizes / scale.top, 1), atol=1e-5)
