"""The headline: the present state in one sentence and a few facts from the numbers, also for screen readers."""

import json
import math
from collections.abc import Callable
from html import escape
from time import monotonic

import numpy as np
import viser

from app.frame import headline
from app.frame.budget_chart_data import largest_cause_fact
from app.frame.error_view_captions import FrameErrorView
from app.frame.headline import BACK, LAST, LOST, PAUSED, SO_FAR, UNSTABLE, HeadlineWithFacts, fill_template
from app.frame.recent_crossings import crossing_window, is_recent_crossing
from app.language.translation import lazy, tr, trn
from app.names_and_units import QUANTITIES, difference_text, format_factor, format_number, reword_for_page
from app.page.stage.worst_region import WorstRegions
from app.page.visit.history import last_value, series_until
from solvers.engine.engine_messages import FrameReport
from solvers.engine.shared_frames import FrameArrays
from solvers.scene.scene import Scene
from solvers.solver import soundness

WAITING = lazy("Waiting for the first frame")
SAY_SECONDS = 2.0  # least time between two sentences, so that they can be read
MOST_DIFFERING = 40  # most characters of the difference to a pinned run


class HeadlinePanel:
    """The headline above the stage: shows only new ones, at least 2 s apart; ``verdict.js`` reads them aloud."""

    def __init__(self, gui: viser.GuiApi, clock: Callable[[], float] = monotonic):
        self._html, self._clock = gui.add_html(""), clock
        self._last, self._next, self._aloud = HeadlineWithFacts(), 0.0, 0

    def show(self, headline: HeadlineWithFacts, is_immediate: bool = False) -> None:
        """Shows a headline if it is new, 2 s after the last or at once; ``is_immediate``: it answers a click."""
        now, other = self._clock(), headline.moment != self._last.moment
        if not headline or str(headline) == str(self._last) or (now < self._next and not is_immediate and not other):
            return
        self._next, self._aloud = now + SAY_SECONDS, self._aloud + (is_immediate or other)
        self._last = headline
        spans = escape(json.dumps([headline.spans, headline.fact_sentences], ensure_ascii=False))
        self._html.content = f"<i class='lab-says' data-sentence=\"{escape(str(headline))}\" data-spans=\"{spans}\" " \
                             f"data-aloud='{self._aloud}'></i>"


def frame_headline(report: FrameReport | None, arrays: FrameArrays | None, view: FrameErrorView | None,
                   worst: WorstRegions, series: dict[str, np.ndarray], quantity: str, estimator: str | None,
                   periods_back: float = 0.0, comparison: str = "", speed: float = 0.0) -> HeadlineWithFacts:
    """Returns the headline of a frame from the ``view`` of its errors, its worst regions and the run's sampled
    ``series``.

    Errors and estimates are means so far for a playing run, present values for one that is paused or lost. ``quantity``
    is a key (x, v, sigma, a), ``estimator`` the one on the stage, ``periods_back`` the periods from the frame to the
    newest, ``comparison`` the text of :func:`compare_with_pinned`, ``speed`` in simulated seconds per second."""
    if report is None or arrays is None or view is None:
        return HeadlineWithFacts.from_template(tr(WAITING))
    series, when = series_until(series, report.time), format_number(report.time)
    moment = report.scene, report.playing, report.status, periods_back
    if report.status == soundness.UNSTABLE:
        return HeadlineWithFacts((("bad", fill_template(tr(UNSTABLE), time=when)),),
                                 (*_lost_run_reason(report), tr(LAST)), moment)
    lost = report.status == soundness.LOST
    of_now = not report.playing or lost
    true, estimate = map(_rms, (view.true, view.estimated)) if of_now else (
        _mean(series, name) for name in (f"error_{quantity}", f"{estimator}/estimate_{quantity}"))
    words = headline.error_headline_templates(report.scene, quantity, estimator,
                                              view.left.silence if view.estimated is None else "",
                                              view.right.silence if view.true is None else "")
    before = "" if lost else tr(SO_FAR)
    if not report.playing:
        before = fill_template(tr(BACK), ago=f"{periods_back:.2f}") if periods_back else \
            fill_template(tr(PAUSED), time=when)
    present_index = estimate / true if true else math.nan
    index = present_index if of_now else last_value(series, f"{estimator}/index_{quantity}")
    said = headline.format_error_headline(words, QUANTITIES[quantity].unit, true, estimate, index, before)
    region = None if true <= words.least else worst.by_truth or worst.by_estimate
    who = largest_cause_fact(report.scene, series, quantity)
    facts = [*said.facts[:1], who, *said.facts[1:],
             tr("worst at {region}", region=region.name) if region else "", *_crossings_text(report, arrays, speed)]
    if comparison:  # replaces the reference value
        facts[:1] = [*said.facts[1:], comparison]
    parts = said.headline
    if lost:
        facts = _lost_run_reason(report) or facts
        parts = ("bad", fill_template(tr(LOST), since=f"{report.since or 0.0:.4g}")), ("", ": "), *parts
    return HeadlineWithFacts(parts, tuple(filter(None, facts)), moment)


def compare_with_pinned(live: dict[str, np.ndarray], pinned: dict[str, np.ndarray], quantity: str,
                        scenes: tuple[Scene, Scene]) -> str:
    """Returns a text such as "3 times as wrong as the pinned run", by the mean true errors of a quantity ("x") over the
    periods that both runs have; "" if unknown. ``live`` and ``pinned`` are the runs' sampled series."""
    larger = live_to_pinned_ratio(live, pinned, f"error_{quantity}", scenes)
    if not math.isfinite(larger) or larger <= 0:
        return ""
    said = difference_text(scenes[1], scenes[0])
    if not 0 < len(said) <= MOST_DIFFERING:
        return tr("{factor} times as wrong as the pinned run", factor=format_factor(larger)) if larger >= 1 else \
            tr("the pinned run is {factor} times as wrong", factor=format_factor(1 / larger))
    return tr("{factor} times as wrong as the pinned run, {run}", factor=format_factor(larger),
              run=said) if larger >= 1 else \
        tr("the pinned run, {run}, is {factor} times as wrong", factor=format_factor(1 / larger), run=said)


def live_to_pinned_ratio(live: dict[str, np.ndarray], pinned: dict[str, np.ndarray], name: str,
                         scenes: tuple[Scene, Scene]) -> float:
    """Returns the mean of a live run's series over that of a pinned run's, both by ``name`` ("error_x") and over the
    periods that both have; NaN if unknown."""
    periods = min(elapsed_periods(series, scene) for series, scene in zip((live, pinned), scenes, strict=True))
    mine, other = (_mean(series_until(series, periods * scene.period * (1 + 1e-9)), name)
                   for series, scene in zip((live, pinned), scenes, strict=True))
    return mine / other if other else math.nan


def elapsed_periods(series: dict[str, np.ndarray], scene: Scene) -> float:
    """Returns the last time of a run's sampled series in periods of its scene; 0 before the first sample."""
    times = series.get("time", np.zeros(0))
    return float(times[-1]) / scene.period if len(times) else 0.0


def _lost_run_reason(report: FrameReport) -> list[str]:
    """Returns the reason why a run is lost, without the time, as a list of one text; [] if none is known."""
    reason = reword_for_page(report.reason or "")
    return [reason.partition(": ")[2] or reason] if reason else []


def _rms(sizes: np.ndarray | None) -> float:
    """Returns the root mean square of sizes (P,) of errors, in their unit; NaN for None."""
    with np.errstate(all="ignore"):  # a run gone bad holds anything
        return math.nan if sizes is None else float(np.sqrt(np.mean(sizes.astype(float) ** 2)))


def _mean(series: dict[str, np.ndarray], name: str) -> float:
    values = series.get(name, np.zeros(0))
    with np.errstate(all="ignore"):  # a run gone bad holds anything
        return float(np.mean(values)) if len(values) else math.nan


def _crossings_text(report: FrameReport, arrays: FrameArrays, speed: float) -> list[str]:
    """Returns how many particles crossed a cell boundary lately, as a list of one sentence; [] if not recorded."""
    if not report.scene.has("crossings"):
        return []
    count = int(np.count_nonzero(is_recent_crossing(arrays.steps_since_crossing, report.scene, speed)))
    seconds = format_number(crossing_window(report.scene, speed))
    if not count:
        return [tr("no particle crossed a cell boundary in the last {seconds} s", seconds=seconds)]
    return [trn("{count:,} particle crossed a cell boundary in the last {seconds} s",
                "{count:,} particles crossed a cell boundary in the last {seconds} s", count, seconds=seconds)]
