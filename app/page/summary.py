"""What is seen now, in one sentence made from the numbers: for the eye, and what a screen reader gets."""

import numpy as np

from app.page.stage.worst import WorstRegions
from app.page.visit.downsampled import until
from app.page.visit.history import CROSSING_WINDOW
from app.page.visit.view import View
from app.words import QUANTITIES, brief, number, ratio, with_unit
from solvers.engine.frames import FrameArrays
from solvers.engine.messages import FrameReport
from solvers.solver.soundness import LOST, UNSTABLE

WAITING = "Waiting for the first frame."
ROUND_OFF = 1e-9  # of a quantity's size, and far above what a patch test that is passed has
SAY_SECONDS = 2.0  # between two sentences: a screen reader reads each of them


class Pace:
    """Lets sentences through calmly: a new one only, and not soon after the last."""

    def __init__(self) -> None:
        self._last, self._next = "", 0.0

    def lets(self, sentence: str, now: float, at_once: bool = False) -> bool:
        """Whether to say the sentence at a time in seconds; ``at_once`` for the answer to a click."""
        if sentence == self._last or (now < self._next and not at_once):
            return False
        self._last, self._next = sentence, now + SAY_SECONDS
        return True


def summary(report: FrameReport | None, arrays: FrameArrays | None, view: View | None, worst: WorstRegions,
            series: dict[str, np.ndarray], quantity: str, drawn: str | None, ago: float = 0.0,
            beside: str = "") -> str:
    """The sentence for a frame, the ``view`` of it, its worst regions and the run's sampled ``series``.

    ``quantity`` is a key, ``drawn`` the estimator on the stage, ``ago`` how many periods before now the frame was,
    ``beside`` what is to be said of a pinned run (:func:`compared`).
    """
    if report is None or arrays is None or view is None:
        return WAITING
    series = until(series, report.time)
    if report.status == UNSTABLE:
        return f"The run went unstable and has stopped at t = {number(report.time)} s; this is its last picture."
    still = _still(report, series, quantity)
    errors = [still] if still else [_errors(view, series, quantity, drawn), *_where(worst)]
    parts = [*errors, *_crossings(report, arrays), *filter(None, [beside])]
    if report.status == LOST:
        parts.insert(0, f"the run is lost from t = {number(report.since or 0.0)} s on")
    when = f"{ago:.2f} periods back" if ago else f"paused at t = {number(report.time)} s"
    before = "" if report.playing else f"{when}: "
    sentence = before + "; ".join(parts) + "."
    return sentence[:1].upper() + sentence[1:]


def compared(live: dict[str, np.ndarray], pinned: dict[str, np.ndarray], quantity: str) -> str:
    """How large a pinned run's true error is beside the live run's, both averaged over their last periods; nothing
    where either is not known."""
    sizes = [series.get(f"error_{quantity}", np.zeros(0)) for series in (live, pinned)]
    if not all(map(len, sizes)):
        return ""
    with np.errstate(all="ignore"):
        times = float(np.mean(sizes[1]) / np.mean(sizes[0]))
    if not np.isfinite(times) or times <= 0:
        return ""
    return f"the pinned run's error is {ratio(times)} {'times' if times >= 1 else 'of'} this one's"


def _errors(view: View, series: dict[str, np.ndarray], quantity: str, drawn: str | None) -> str:
    """How large the estimate is beside the truth, or either alone and why the other is missing."""
    of = f"error of {QUANTITIES[quantity]}"
    if view.true is None and view.estimated is None:
        return f"nothing is known of the {of}: {view.right.silence}; {view.left.silence}"
    if view.true is None:
        return f"{drawn} estimates the {of} at {_size(series, f'{drawn}/estimate_{quantity}', quantity)}; " \
               f"{view.right.silence}"
    if view.estimated is None:
        return f"the true {of} is {_size(series, f'error_{quantity}', quantity)}; {brief(view.left.silence)}"
    index = series.get(f"{drawn}/index_{quantity}", np.zeros(0))
    if not len(index) or not np.isfinite(index[-1]):
        return f"no {of} has been measured yet"
    times = "times" if index[-1] >= 1 else "of"
    return f"the estimate by {drawn} is {ratio(float(index[-1]))} {times} the true {of}"


def _still(report: FrameReport, series: dict[str, np.ndarray], quantity: str) -> str:
    """That a motion without swings is what it should be, but for round-off; "" where it is not, or nothing is known."""
    scene, values = report.scene, series.get(f"error_{quantity}", np.zeros(0))
    if scene.swings or not len(values) or not values[-1] <= ROUND_OFF * scene.size_of(quantity):
        return ""
    return f"exactly nothing happens, as it should: the true error of {QUANTITIES[quantity]} is " \
           f"{_size(series, f'error_{quantity}', quantity) if values[-1] else 'zero'}, round-off"


def _size(series: dict[str, np.ndarray], name: str, quantity: str) -> str:
    values = series.get(name, np.zeros(0))
    known = len(values) and np.isfinite(values[-1])
    return with_unit(float(values[-1]), QUANTITIES[quantity].unit, 2) if known else "nothing yet"


def _where(worst: WorstRegions) -> list[str]:
    """Where the error is worst: in truth where that is known."""
    region = worst.by_truth or worst.by_estimate
    return [f"worst at {region.name}"] if region else []


def _crossings(report: FrameReport, arrays: FrameArrays) -> list[str]:
    """How many particles have crossed a cell boundary within the time over which the plot counts them."""
    if not report.scene.has("crossings"):
        return []
    steps, window = arrays.steps_since_crossing, CROSSING_WINDOW * report.scene.period
    count = int(np.count_nonzero((steps >= 0) & (steps * report.scene.time_step <= window)))
    who = f"{count:,} particles" if count > 1 else "1 particle" if count else "no particle"
    return [f"{who} crossed a cell boundary in the last {number(window)} s"]
