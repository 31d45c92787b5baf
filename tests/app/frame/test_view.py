"""What the stage shows of a frame, in words and numbers: halves, silences, regions. No web server, no engine."""

from dataclasses import replace
from types import SimpleNamespace
from xml.etree import ElementTree

import numpy as np
import pytest

from app import names_and_units
from app.frame.colour_scale import DECADES, MOST_TICKS, ColourScale
from app.frame.error_view_captions import ESTIMATE_OFF, NONE_CHOSEN, OFF, TRUTH_OFF, UNKNOWN, frame_error_view
from app.frame.stage import Stage
from app.page.panels.readout_tables import _percent, live_readout
from app.page.stage.worst_region import SteadyMaximum, WorstRegions
from app.page.visit.first_scene import first_scene
from app.problems.bar.view import BAR as BAR_VIEW
from app.problems.bar.view import LENGTHS
from app.problems.views import VIEWS
from solvers.engine.engine_messages import FrameReport
from solvers.engine.shared_frames import FrameArrays, FrameOptions
from solvers.problems import PROBLEMS
from solvers.problems.bar.scene import BarScene
from solvers.problems.planar.particle_layout import particle_layout
from solvers.problems.ring import RingScene
from solvers.problems.vortex import VortexScene
from solvers.scene.estimator_registry import ESTIMATORS
from tests.support.unsolved_bar import unsolved

BAR = BarScene(cells=10, ppc=2, estimators=("transport",))
PLACES = (np.arange(20)[:, None] + 0.5) / 20


def report_of(scene, not_valid=None, differences=False):
    return FrameReport(1, 1, "", scene, True, True, 20, 0, 0.0, np.zeros((0, 1)), None, 0.0, None, "x64",
                       not_valid or {}, FrameOptions(differences))


def arrays_of(estimate, error, differences=True):
    """A frame with the errors of x given (20,) and nothing else."""
    def column(values):
        return np.stack([values, *[np.full(20, np.nan)] * 3], axis=1)

    return FrameArrays(PLACES, np.zeros_like(PLACES), np.ones((20, 1)), np.full(20, -1.0), column(error),
                       {"transport": column(estimate)},
                       {"transport": column(np.abs(estimate - error))} if differences else {}, np.zeros((20, 0)))


SIGNED, TRUE = np.linspace(-1, 1, 20), np.linspace(1, -1, 20)


def view_of(scene=BAR, estimator="transport", difference=False, quantity="x", not_valid=None):
    return frame_error_view(report_of(scene, not_valid), arrays_of(SIGNED, TRUE), quantity, estimator, difference)


@pytest.mark.parametrize(("difference", "title", "times"), [(False, "Estimate", 1), (True, "Estimate − truth", 2)])
def test_both_halves_show_sizes_and_the_difference_knows_signs(difference, title, times):
    """Estimate and truth of equal sizes and opposite signs look alike side by side, and apart in the difference."""
    view = view_of(difference=difference)
    np.testing.assert_allclose(view.left.sizes, times * np.abs(SIGNED))
    np.testing.assert_allclose(view.right.sizes, np.abs(TRUE))
    assert (view.left.title, view.left.by) == (title, "by transport")
    assert (view.right.title, view.right.by) == ("Truth", "exact solution")
    assert view.left.silence == view.right.silence == "" and ("estimate − truth" in view.measures) == difference
    np.testing.assert_allclose(view.estimated, np.abs(SIGNED))  # what is read off stays the estimate


@pytest.mark.parametrize(("scene", "left", "right"), [(unsolved(BAR), "", UNKNOWN),
                                                      (replace(BAR, effects=("estimate",)), "", TRUTH_OFF),
                                                      (replace(BAR, effects=("truth",)), ESTIMATE_OFF, "")])
def test_an_empty_half_says_why(scene, left, right):
    view = view_of(scene)
    assert (view.left.silence, view.right.silence) == (left, right)
    assert (view.left.sizes is None, view.right.sizes is None) == (bool(left), bool(right))


def test_no_difference_without_both():
    assert view_of(unsolved(BAR), difference=True).left.silence == UNKNOWN
    assert view_of(estimator=None, difference=True).left.silence == NONE_CHOSEN


def test_what_is_not_valid_is_said_and_not_drawn():
    view = view_of(not_valid={"transport": "not valid here: it rains"})
    assert view.left.silence == "transport: not valid here: it rains"
    assert view.left.sizes is None and view.estimated is None and view.right.sizes is not None


def test_what_is_not_estimated_is_said():
    view = view_of(quantity="sigma")
    assert view.left.sizes is None and view.left.silence == "transport does not estimate the stress σ"


def test_acceleration_is_unknown_without_its_effect():
    """Not zero: the truth's lane must not look like a perfect run."""
    view = view_of(replace(BAR, effects=("truth", "estimate")), quantity="a")
    assert view.left.silence == view.right.silence == OFF and view.right.sizes is None


def test_another_estimator_is_on_its_way():
    assert "being prepared" in view_of(estimator="companion").left.silence


class Clock:
    now = 0.0

    def __call__(self):
        return self.now


def test_scale_says_when_something_exceeds_it():
    clock = Clock()
    scale = ColourScale(clock)
    scale.update(np.full(3, 0.2), np.full(3, 0.01))
    clock.now = 2.0
    assert scale.top == 0.1 and scale.ticks("x")[-1][1] == "≥ 10 % of the largest displacement"
    scale.update(np.full(3, 0.09), np.full(3, 0.01))
    assert not scale.exceeded and scale.ticks("x")[-1][1] == "10 % of the largest displacement"
    scale.absolute, scale.whole = True, 2.0
    assert [text for _, text in scale.ticks("x")] == ["0, exact", "40 mm", "80 mm", "120 mm", "160 mm", "200 mm"]


def test_two_runs_share_one_scale():
    """Of estimate and truth, of the run on the stage and of one beside it, the largest that counts makes the top: a
    colour means the same everywhere. Without any truth the larger estimate counts."""
    small, large = np.full(3, 0.05), np.full(3, 0.25)
    for own, beside in (((small, large), (small, small)), ((small, small), (small, large)),
                        ((large, small), (small, small)), ((small, small), (large, small)),
                        ((None, small), (None, large)), ((small, None), (large, None)), ((large, None), (small, None))):
        scale = ColourScale()
        scale.update(*own, None, beside)
        assert scale.top == 0.3, (own, beside)
        assert not scale.exceeded


@pytest.mark.parametrize("logarithmic", [False, True])
def test_scale_is_used_and_its_numbers_are_round(logarithmic):
    """Whatever the largest error, it is from the middle of the scale to half beyond it, and ticks have a digit; a scale
    never reaches beyond the largest exact value."""
    for value in np.geomspace(1e-7, 1.5, 300):
        scale = ColourScale()
        scale.logarithmic = logarithmic
        scale.update(np.array([value]), None)
        assert 0.45 - 1e-12 <= value / scale.top <= 1.5 + 1e-12 and scale.top <= 1
        ticks = scale.ticks("x")
        assert len(ticks) <= MOST_TICKS and ticks[-1][0] == 1
        for at, text in ticks[not logarithmic:]:
            exact = scale.top * 10 ** (DECADES * (at - 1)) if logarithmic else scale.top * at
            number = text.removeprefix("≥ ").split(" %")[0]
            assert float(number) == pytest.approx(100 * exact, rel=1e-9)  # nothing was rounded away
        assert logarithmic or ticks[0] == (0.0, "0, exact")
    scale.update(np.array([40.0]), None, settled=True)
    assert scale.top == 1 and scale.exceeded


def test_a_scale_that_is_held_is_never_out_of_date():
    """Others are some time after another run has begun."""
    now = [0.0]
    scale = ColourScale(clock=lambda: now[0])
    scale.begin_run()
    for time, held, outdated in ((0.0, False, False), (60.0, False, True), (60.0, True, False)):
        now[0], scale.held = time, held
        assert scale.is_outdated == outdated


def test_scale_keeps_still_while_errors_come_and_go():
    """It holds the largest error so far, whatever comes."""
    clock, tops = Clock(), []
    scale = ColourScale(clock)
    for k in range(400):
        clock.now = k / 25
        scale.update(None, np.array([0.22 * abs(np.sin(2 * np.pi * k / 100)) + 0.01]))
        tops.append(scale.top)
    assert tops[-1] == 0.3 == max(tops) and tops == sorted(tops)
    scale.reset()
    scale.update(None, np.array([0.01]))
    assert scale.top == 0.01


def test_scale_keeps_its_top_from_run_to_run_and_is_then_fitted_to_the_last():
    """While a slider is moved colours mean the same; the stage is drawn again when it is time."""
    clock = Clock()
    scale = ColourScale(clock)
    scale.begin_run()
    scale.update(None, np.array([0.2]), settled=True)
    assert scale.top == 0.3
    for clock.now, error in ((10.0, 0.9), (11.0, 0.02)):
        scale.begin_run()
        scale.update(None, np.array([error]), settled=True)
        assert scale.top == 0.3 and not scale.is_outdated
    clock.now = 12.5
    assert scale.is_outdated
    scale.update(None, np.array([0.02]), settled=True)
    assert scale.top == 0.03 and not scale.is_outdated


def test_scale_grows_calmly():
    """But at once where all would look alike."""
    clock = Clock()
    scale = ColourScale(clock)
    scale.update(None, np.array([0.01]))
    for clock.now, error, top in ((0.1, 0.02, 0.01), (2.0, 0.02, 0.03), (2.1, 0.2, 0.3)):
        scale.update(None, np.array([error]))
        assert scale.top == top


def test_scale_is_settled_when_a_run_pauses():
    """Whenever frames came before: the paused picture has the same colours at each visit."""
    def top_after(*times):
        clock = Clock()
        scale = ColourScale(clock)
        for clock.now in times:
            scale.update(None, np.array([0.1 + 0.03 * clock.now]))
        scale.update(None, np.array([0.21]), settled=True)
        return scale.top

    assert top_after(0.0, 0.9, 1.0) == top_after(1.0, 1.1) == top_after(1.9) == 0.3


def test_a_run_that_is_shown_again_begins_with_what_it_has_come_to():
    scale = ColourScale()
    for size in (0.001, 0.73, 0.002):
        scale.update(None, np.array([size]), "this run")
    scale.reset()
    scale.update(None, np.array([0.001]), "another")
    assert scale.top == 0.001
    scale.reset()
    scale.update(None, np.array([0.001]), "this run")
    assert scale.top == 1
    scale.held = True
    scale.reset()
    scale.update(None, np.array([50.0]), "another")
    assert scale.top == 1 and scale.exceeded


@pytest.mark.parametrize(("margin", "shown"), [
    (0.456, "<td>0.46 of its bound</td>"), (1.3, "<span class='lab-over'>1.30 of its bound</span>"),
    (38255.0, "<span class='lab-over'>4 × 10⁴ of its bound</span>"), (np.nan, "<td>–</td>")])
def test_margin_of_the_step_is_read(margin, shown):
    assert f"<td>step</td>\n{shown}".replace("\n<span", "\n<td><span") in readout_of(BAR, margin)
    assert "<td>step</td>" not in readout_of(replace(BAR, effects=("truth",)), margin)


def readout_of(scene, margin):
    history = SimpleNamespace(series={}, step_to_bound_ratio=margin)
    session = SimpleNamespace(history=history, speed=1.0, pinned=None, is_over=False)
    return live_readout(session, session.history, report_of(scene), "x", "transport", None, WorstRegions()).html


@pytest.mark.parametrize("problem", PROBLEMS)
def test_every_problem_is_shown(problem):
    """Its sliders reach its first scene, of which there is an estimate that holds; its details are fields with choices
    or switches, its folder has the rest."""
    view, scene, first = VIEWS[problem], PROBLEMS[problem].scene(periods=1), first_scene(problem)
    assert not first.warnings() and not first.not_valid and ESTIMATORS[first.estimators[0]].judges
    for field in ("cells", "ppc", "amplitude", "modulus"):
        low, high, *_ = getattr(view.slider_ranges, field)
        assert low <= getattr(scene, field) <= high
    for field in view.details:
        value, names = getattr(scene, field), names_and_units.choice_labels(type(scene), field)
        assert value in names if scene.choices(field) else isinstance(value, bool)
    assert issubclass(view.stage, Stage) and callable(view.draw_picture)


def test_regions_of_the_bar():
    regions = BAR_VIEW.regions(PLACES)
    assert len(regions.names) == LENGTHS and regions.names[4] == "X = 0.20–0.25 m"
    np.testing.assert_array_equal(regions.number, np.arange(20))
    np.testing.assert_allclose(regions.rms_errors(SIGNED), np.abs(SIGNED))


@pytest.mark.parametrize("scene, count, least", [(RingScene(cells=36), 18, 0.8), (VortexScene(cells=24), 40, 0.6)],
                         ids=["ring", "vortex"])
def test_regions_of_a_ring(scene, count, least):
    """Every particle has one, and each holds its share."""
    position = particle_layout(scene).position
    regions = VIEWS[scene.problem].regions(position)
    counts = np.bincount(regions.number, minlength=len(regions.names))
    assert len(counts) == count and counts.min() > least * counts.max() and counts.sum() == len(position)


def test_a_body_that_is_whole_has_no_mirror_images():
    assert [len(VIEWS[name].stage.MIRRORS) for name in ("ring", "vortex")] == [4, 1]


def test_a_known_place_of_the_ring_has_the_name_it_should():
    place = VIEWS["ring"].regions(np.array([[0.42 * np.cos(0.6), 0.42 * np.sin(0.6)], [0.0, 0.6]]))
    assert [place.names[k] for k in place.number] == ["inner third, 30–45°", "outer third, 75–90°"]


def test_worst_region_does_not_flicker():
    worst = SteadyMaximum()
    assert worst.find(np.array([np.nan, 0.0])) is None
    assert worst.find(np.array([1.0, 0.9])) == 0
    assert worst.find(np.array([1.0, 1.04])) == 0
    assert worst.find(np.array([1.0, 1.1])) == 1


def test_worst_places_by_estimate_and_by_truth():
    places, estimate, error = WorstRegions(), np.full(20, 0.1), np.full(20, 0.2)
    estimate[3], error[7] = 1.0, -2.0
    arrays, report = arrays_of(estimate, error), report_of(BAR)
    places.find(report, arrays, frame_error_view(report, arrays, "x", "transport", False), "x")
    assert (places.by_estimate.name, places.by_truth.name) == ("X = 0.15–0.20 m", "X = 0.35–0.40 m")
    assert (places.by_estimate.estimated, places.by_estimate.true) == (1.0, 0.2)
    assert (places.by_truth.estimated, places.by_truth.true) == (0.1, 2.0)
    report = report_of(unsolved(BAR))
    places.find(report, arrays, frame_error_view(report, arrays, "x", "transport", False), "x")
    assert places.by_truth is None and places.by_estimate.true is None


def test_every_estimator_is_explained():
    """Well formed, with an equation, and with what it assumes, sees and misses."""
    texts = {name: estimator.explanation for name, estimator in ESTIMATORS.items()}
    for text in texts.values():
        tree = ElementTree.fromstring(f"<div>{text}</div>")
        assert tree.find(".//math[@display='block']") is not None
        bold = [element.text for element in tree.iter("b")]
        assert {"Assumes", "Sees", "Misses"} <= set(bold)


@pytest.mark.parametrize(("share", "shown"), [(-0.0274, "−2.74%"), (0.0007, "+0.07%"), (-1e-6, "0.00%"), (0.0, "0.00%"),
                                              (-1.42784, "−142.78%"), (530.0, "+5 × 10⁴%"), (None, "–")])
def test_shares_are_read(share, shown):
    """With a minus as everywhere else on the page, none before nothing, and no digits that nobody reads."""
    assert _percent(share) == shown
