"""Titles, captions and reasons for missing numbers, for the page, exported files and pictures; views of frames."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np

from app.frame.colour_scale import any_finite
from app.language.translation import language_cache, lazy, tr, translate_message
from app.names_and_units import QUANTITIES
from solvers.engine.engine_messages import FrameReport
from solvers.engine.shared_frames import FrameArrays
from solvers.scene.scene import Scene
from solvers.solver import samples

SIDE_BY_SIDE, DIFFERENCE = lazy("estimate | truth"), lazy("estimate − truth | truth")
ESTIMATE, TRUTH = (lazy("Estimate"), lazy("Estimate − truth")), lazy("Truth")  # the halves' names
EXACT_SOLUTION = lazy("exact solution")
#: Hints about two equal halves: for a run, and for a lost one.
ALIKE = lazy("{} alike? Then the estimate is right.")
ALIKE_LOST = lazy("{} alike: the estimate is right, the run is not.")
#: Translated by ``tr`` where they are used.
UNKNOWN = lazy("true error unknown here: no exact solution is built in")
TRUTH_OFF = lazy("true error not computed: its effect is off")
ESTIMATE_OFF = lazy("not estimated: the effect \"estimate\" is off")
NONE_CHOSEN = lazy("no estimator is chosen")
OFF = lazy("not computed: the effect \"acceleration error\" is off")  # of accelerations
NOT_COUNTED = lazy("not counted: the effect \"grid crossings\" is off")
NOT_COMPARED = lazy("not compared when this frame was made")
NO_INDEX = lazy("empty: no exact solution is built in")
NOTHING_TO_SHOW = "nothing to show: every error is zero, or was not computed"
EMPTY_HALVES = ("not estimated", "truth not computed")  # short reasons, for the estimate's half and the truth's
TRUE, ESTIMATED = lazy("true"), lazy("estimated")  # rows beside those of estimators


@dataclass(frozen=True)
class StageHalfCaptions:
    """Captions of the estimate's and the truth's half, in this order: their ``titles``, the source ``by`` which each is
    known, why either is empty (``silences``; "" if it is not), and what the colours measure."""

    titles: tuple[str, str]
    by: tuple[str, str]
    silences: tuple[str, str]
    measures: str


@dataclass(frozen=True)
class FieldPlotCaption:
    """Name of a field plot, and a remark on what it shows or why it is empty; "" if none is needed."""

    name: str
    remark: str = ""

    def __str__(self) -> str:
        return f"{self.name}: {self.remark}" if self.remark else self.name


@language_cache(64)  # called with every frame
def make_captions(quantity: str, estimator: str | None, difference: bool, no_estimate: str,
                  no_truth: str) -> StageHalfCaptions:
    """Returns the captions of the errors of a quantity (key x, v, sigma or a) by an estimator's name, or None if none
    is chosen. With ``difference`` the left half is estimate minus truth; ``no_estimate`` and ``no_truth`` are the
    reasons if either is missing, else ""."""
    by = tr("by {estimator}", estimator=estimator) if estimator else "", tr(EXACT_SOLUTION)
    titles = tr(ESTIMATE[difference]), tr(TRUTH)
    if difference:
        return StageHalfCaptions(titles, by, (no_estimate or no_truth, no_truth),
                                 tr("size of the error, and of estimate − truth, of {quantity}",
                                    quantity=QUANTITIES[quantity]))
    return StageHalfCaptions(titles, by, (no_estimate, no_truth),
                             tr("size of the error of {quantity}", quantity=QUANTITIES[quantity]))


def field_plot_caption(scene: Scene, quantity: str) -> FieldPlotCaption:
    """Returns name and remark of the plot of the field of a quantity (key x, v, sigma or a)."""
    noun = QUANTITIES[quantity].noun
    name = noun[:1].upper() + noun[1:]
    if off := why_no_field(scene, quantity):
        return FieldPlotCaption(name, off)
    return FieldPlotCaption(name, "" if scene.swings else tr("deviation from the exact one"))


def add_unknown_count(remark: str, unknown: int | str) -> str:
    """Returns the ``remark`` on a plot with the number of particles whose value is ``unknown`` (or its placeholder)
    appended; unchanged if that is 0, or the remark says that no particle has a value."""
    if not unknown or remark == tr(OFF):
        return remark
    if not remark:
        return tr("{unknown} without a number", unknown=unknown)
    return tr("{remark}; {unknown} without a number", remark=remark, unknown=unknown)


def crossing_marks_legend(legend: str, stride: int) -> str:
    """Returns the ``legend``, translated, of marks at cell crossings; names the ``stride`` between them if above 1."""
    return tr("{marked} (1 in {every})", marked=tr(legend), every=stride) if stride > 1 else tr(legend)


def why_no_truth(scene: Scene, quantity: str) -> str:
    """Returns in a sentence why a scene has no true error of a quantity (key x, v, sigma or a); "" if it has one."""
    if not scene.solution_known:
        return tr(UNKNOWN)
    return why_no_field(scene, quantity) if scene.has("truth") else tr(TRUTH_OFF)


def why_no_estimate(scene: Scene, not_valid: Mapping[str, str], estimator: str | None, quantity: str) -> str:
    """Returns in a sentence why an estimator (its name; None if none is chosen) has no estimate of a quantity (key x,
    v, sigma or a); "" if it has. ``not_valid`` has a reason for each estimator that is not valid in the run."""
    if estimator is None:
        return tr(NONE_CHOSEN)
    if "estimate" not in scene.effects:
        return tr(ESTIMATE_OFF)
    if estimator in not_valid:
        return f"{estimator}: {translate_message(not_valid[estimator])}"
    if estimator not in scene.active_estimators:
        return tr("{estimator} is being prepared", estimator=estimator)  # the frame is still one of the scene before
    return why_no_field(scene, quantity)


def why_no_field(scene: Scene, quantity: str) -> str:
    """Returns why the particles' values of a quantity (key x, v, sigma or a) are not computed; "" if they are."""
    return tr(OFF) if quantity == "a" and not scene.has("acceleration") else ""


def not_estimated_text(quantity: str) -> str:
    """Returns "does not estimate the ..." for a quantity (key x, v, sigma or a), to follow an estimator's name."""
    return tr("does not estimate the {quantity}", quantity=QUANTITIES[quantity])


def why_no_numbers(scene: Scene, not_valid: Mapping[str, str], quantity: str,
                   silent: Collection[str]) -> dict[str, str]:
    """Returns for "true" and each requested estimator's name why it has no error of a quantity (key x, v, sigma or a),
    "" if it has; "estimated" stands for the estimators if none is requested. ``not_valid`` has the reasons of invalid
    ones (``Result.not_valid``), ``silent`` the names of those without a finite value of the quantity so far."""
    found = {TRUE: why_no_truth(scene, quantity)}
    for name in scene.estimators:
        found[name] = translate_message(not_valid.get(name, "")) or why_no_estimate(scene, not_valid, name, quantity) \
            or not_estimated_text(quantity) * (name in silent)
    return found if scene.estimators else {**found, ESTIMATED: tr(NONE_CHOSEN)}


def why_no_index(scene: Scene, valid: Collection[str], quantity: str) -> str:
    """Returns why the plot of a quantity's error index (estimate over true error) is empty, "" if it is not; ``valid``
    are the names of the estimators that are valid in the run."""
    if not scene.solution_known:
        return tr(NO_INDEX)
    if why_no_truth(scene, quantity):
        return tr("empty: the true error is not computed")
    return "" if valid else tr("empty: no valid estimate") if scene.estimators else tr("empty: no estimate")


@dataclass(frozen=True)
class StageHalfErrors:
    """Lane of the bar or half of a plane body: its title, the source ``by`` which the errors are known, their ``sizes``
    (P,) in the quantity's unit, or None and the reason in ``silence``."""

    title: str
    by: str
    sizes: np.ndarray | None
    silence: str = ""


@dataclass(frozen=True)
class FrameErrorView:
    """View of a frame's errors: its left half (the estimate, or estimate minus truth) and right half (the truth), what
    the colour scale measures, and the sizes (P,) of the estimated and the true errors, None if unknown."""

    left: StageHalfErrors
    right: StageHalfErrors
    measures: str
    estimated: np.ndarray | None
    true: np.ndarray | None


def frame_error_view(report: FrameReport, arrays: FrameArrays, quantity: str, estimator: str | None,
                     difference: bool) -> FrameErrorView:
    """Returns the view of the errors of a quantity (key x, v, sigma or a) in a frame, given by ``report`` and
    ``arrays``, by an estimator's name or None; with ``difference``, of estimate minus truth in the left half."""
    scene, column = report.scene, samples.QUANTITIES.index(quantity)
    no_truth = why_no_truth(scene, quantity)
    no_estimate = why_no_estimate(scene, report.not_valid, estimator, quantity)
    true, estimated = None if no_truth else np.abs(arrays.error[:, column]), None
    if estimator is not None and not no_estimate:
        estimated = np.abs(arrays.estimate[estimator][:, column])
        if not any_finite(estimated):
            estimated, no_estimate = None, f"{estimator} {not_estimated_text(quantity)}"
    apart = arrays.difference[estimator][:, column] if estimator in arrays.difference else None
    return error_view_of_sizes(quantity, estimator, estimated, true, no_estimate, no_truth, difference, apart)


def error_view_of_sizes(quantity: str, estimator: str | None, estimated: np.ndarray | None, true: np.ndarray | None,
                        no_estimate: str, no_truth: str, difference: bool, apart: np.ndarray | None) -> FrameErrorView:
    """Returns the view of given errors: ``estimated``, ``true`` and ``apart`` are the sizes (P,), in the quantity's
    unit, of both errors and of estimate minus truth, None if unknown; other arguments as in :func:`make_captions`."""
    captions = make_captions(quantity, estimator, difference, no_estimate, no_truth)
    silence = captions.silences[0] or (tr(NOT_COMPARED) if difference and apart is None else "")
    shown = None if silence else apart if difference else estimated
    return FrameErrorView(StageHalfErrors(captions.titles[0], captions.by[0], shown, silence),
                          StageHalfErrors(captions.titles[1], captions.by[1], true, no_truth), captions.measures,
                          estimated, true)
