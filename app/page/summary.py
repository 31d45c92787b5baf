"""What is seen now, in one sentence made from the numbers: for the eye, and what a screen reader gets."""

import math
from collections.abc import Callable
from html import escape
from time import monotonic

import numpy as np
import viser

from app.frame.sentence import LOST, PAUSED, UNSTABLE, error_words, errors, fill, joined
from app.frame.view import View
from app.page.stage.worst import WorstRegions
from app.page.visit.downsampled import until
from app.page.visit.history import CROSSING_WINDOW
from app.words import QUANTITIES, number, times
from solvers.engine.frames import FrameArrays
from solvers.engine.messages import FrameReport
from solvers.solver import soundness

WAITING = "Waiting for the first frame."
SAY_SECONDS = 2.0  # between two sentences: a screen reader reads each of them


class Speaker:
    """Says sentences calmly: a new one only, and not soon after the last. That there is one lifts the page's ground
    (``ground.html``)."""

    def __init__(self, gui: viser.GuiApi, clock: Callable[[], float] = monotonic):
        self._html, self._clock = gui.add_html(""), clock
        self._last, self._next = "", 0.0

    def say(self, sentence: str, at_once: bool = False) -> None:
        """Say a sentence, if there is one and it is time; ``at_once`` for the answer to a click."""
        now = self._clock()
        if sentence in ("", self._last) or (now < self._next and not at_once):
            return
        self._last, self._next = sentence, now + SAY_SECONDS
        said = escape(sentence).replace("–", "–&NoBreak;")  # no line ends between "0.25–" and "0.30"
        self._html.content = f"<i class='lab-says' data-sentence=\"{said}\"></i>"


def summary(report: FrameReport | None, arrays: FrameArrays | None, view: View | None, worst: WorstRegions,
            series: dict[str, np.ndarray], quantity: str, drawn: str | None, ago: float = 0.0,
            beside: str = "") -> str:
    """The sentence for a frame, the ``view`` of it, its worst regions and the run's sampled ``series``.

    ``quantity`` is a key, ``drawn`` the estimator on the stage, ``ago`` how many periods before now the frame was,
    ``beside`` what is to be said of a pinned run (:func:`compared`).
    """
    if report is None or arrays is None or view is None:
        return WAITING
    series, when = until(series, report.time), number(report.time)
    if report.status == soundness.UNSTABLE:
        return joined([fill(UNSTABLE, time=when)])
    true, estimate, index = (_last(series, name) for name in (
        f"error_{quantity}", f"{drawn}/estimate_{quantity}", f"{drawn}/index_{quantity}"))
    words = error_words(report.scene, quantity, drawn, view.left.silence if view.estimated is None else "",
                        view.right.silence if view.true is None else "")
    region = None if true <= words.least else worst.by_truth or worst.by_estimate
    parts = [errors(words, QUANTITIES[quantity].unit, true, estimate, index),
             *([f"worst at {region.name}"] if region else []), *_crossings(report, arrays), *filter(None, [beside])]
    if report.status == soundness.LOST:
        parts.insert(0, fill(LOST, since=number(report.since or 0.0)))
    before = f"{ago:.2f} periods back: " if ago else fill(PAUSED, time=when)
    return joined(parts, "" if report.playing else before)


def compared(live: dict[str, np.ndarray], pinned: dict[str, np.ndarray], quantity: str) -> str:
    """How large a pinned run's true error is beside the live run's, both averaged over their last periods; nothing
    where either is not known."""
    sizes = [series.get(f"error_{quantity}", np.zeros(0)) for series in (live, pinned)]
    if not all(map(len, sizes)):
        return ""
    with np.errstate(all="ignore"):
        larger = float(np.mean(sizes[1]) / np.mean(sizes[0]))
    if not np.isfinite(larger) or larger <= 0:
        return ""
    return f"the pinned run's error is {times(larger)} this one's"


def _last(series: dict[str, np.ndarray], name: str) -> float:
    values = series.get(name, np.zeros(0))
    return float(values[-1]) if len(values) else math.nan


def _crossings(report: FrameReport, arrays: FrameArrays) -> list[str]:
    """How many particles have crossed a cell boundary within the time over which the plot counts them."""
    if not report.scene.has("crossings"):
        return []
    steps, window = arrays.steps_since_crossing, CROSSING_WINDOW * report.scene.period
    count = int(np.count_nonzero((steps >= 0) & (steps * report.scene.time_step <= window)))
    who = f"{count:,} particles" if count > 1 else "1 particle" if count else "no particle"
    return [f"{who} crossed a cell boundary in the last {number(window)} s"]
