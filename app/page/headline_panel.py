"""The headline: the present state in one sentence and a few facts from the numbers, also for screen readers."""

import json
import math
from collections.abc import Callable
from html import escape
from time import monotonic

import numpy as np
import viser

from app.frame import headline
from app.frame.error_view_captions import FrameErrorView
from app.frame.headline import BACK, LAST, LOST, PAUSED, UNSTABLE, HeadlineWithFacts, InstantErrors, fill_template
from app.language.translation import lazy, localise_number, tr, trn
from app.names_and_units import QUANTITIES, format_factor, format_number, per_cent, reword_for_page
from app.page.visit.history import series_until
from solvers.engine.engine_messages import FrameReport
from solvers.engine.shared_frames import FrameArrays
from solvers.scene.scene import Scene
from solvers.solver import soundness

WAITING = lazy("Waiting for the first frame")
COMPILED = lazy("a combination of method, estimators and effects is compiled the first time it is used")
SAY_SECONDS = 0.3  # least time between two sentences
SAME = 0.005  # distance of a ratio from 1
NEARLY_EVERY = 0.8  # of all particles


class HeadlinePanel:
    """The headline above the stage: shows only new ones, at least 0.3 s apart; ``verdict.js`` reads them aloud."""

    def __init__(self, gui: viser.GuiApi, clock: Callable[[], float] = monotonic):
        self._html, self._clock = gui.add_html(""), clock
        self._last, self._next, self._aloud = HeadlineWithFacts(), 0.0, 0

    def show(self, headline: HeadlineWithFacts, is_immediate: bool = False) -> None:
        """Shows a headline if it is new, 0.3 s after the last or at once; ``is_immediate``: it answers a click."""
        now, other = self._clock(), headline.moment != self._last.moment
        if not headline or str(headline) == str(self._last) or (now < self._next and not is_immediate and not other):
            return
        self._next, self._aloud = now + SAY_SECONDS, self._aloud + (is_immediate or other)
        self._last = headline
        spans = escape(json.dumps([headline.spans, headline.fact_sentences], ensure_ascii=False))
        self._html.content = f"<i class='lab-says' data-sentence=\"{escape(str(headline))}\" data-spans=\"{spans}\" " \
                             f"data-aloud='{self._aloud}'></i>"


def frame_headline(report: FrameReport | None, arrays: FrameArrays | None, view: FrameErrorView | None,
                   quantity: str, estimator: str | None, periods_back: float = 0.0,
                   comparison: str = "", left: float = math.nan) -> HeadlineWithFacts:
    """Returns the headline of a frame from the ``view`` of its errors.

    ``quantity`` is a key (x, v, sigma, a), ``estimator`` the one on the stage, ``periods_back`` the periods from the
    frame to the newest, ``comparison`` the text of :func:`compare_errors`, ``left`` the relative error that
    is left of the result when the estimate is subtracted, NaN if that is not offered."""
    if report is None or arrays is None or view is None:
        return HeadlineWithFacts.from_template(tr(WAITING))
    when = format_number(report.time)
    moment = report.scene, report.playing, report.status, periods_back
    if report.status == soundness.UNSTABLE:
        return HeadlineWithFacts((("bad", fill_template(tr(UNSTABLE), time=when)),),
                                 (*_lost_run_reason(report), tr(LAST)), moment)
    errors = InstantErrors.of_view(view)
    words = headline.error_headline_templates(report.scene, quantity, estimator,
                                              view.left.silence if view.estimated is None else "",
                                              view.right.silence if view.true is None else "")
    lost = report.status == soundness.LOST
    before = fill_template(tr(BACK), ago=localise_number(f"{periods_back:.2f}")) if periods_back else \
        "" if lost else fill_template(tr(PAUSED), time=when)
    said = headline.format_error_headline(words, QUANTITIES[quantity].unit, errors, before)
    facts = [*([*said.facts[1:], comparison] if comparison else said.facts), *_crossings_text(report.scene, arrays)]
    if math.isfinite(left) and not lost:
        facts.insert(0, tr("subtracting the estimate leaves {share}", share=per_cent(left)))
    parts = said.headline
    if lost:
        facts = _lost_run_reason(report) or facts
        since = localise_number(f"{report.since or 0.0:.4g}")
        parts = ("bad", fill_template(tr(LOST), since=since)), ("", ": "), *parts
    return HeadlineWithFacts(parts, tuple(filter(None, facts)), moment)


def awaited_headline(scene: Scene) -> HeadlineWithFacts:
    """Returns the headline until the first frame of a ``scene`` of another problem comes."""
    return HeadlineWithFacts((("awaited", tr("{problem}: being prepared …", problem=tr(scene.TITLE))),),
                             (tr(COMPILED),), scene)


def compare_errors(own: float, other: float, run: str) -> str:
    """Returns a text such as "21 times as wrong as B-spline at the same settings" from the relative true errors of the
    visitor's run and of another ``run``, described in words; "" if either is unknown or zero."""
    ratio = own / other if other > 0 else math.nan
    if not math.isfinite(ratio) or ratio <= 0:
        return ""
    if abs(ratio - 1) < SAME:
        return tr("as wrong as {run}", run=run)
    if ratio >= 1:
        return tr("{factor} times as wrong as {run}", factor=format_factor(float(f"{ratio:.2g}")), run=run)
    return tr("{run} is {factor} times as wrong", factor=format_factor(float(f"{1 / ratio:.2g}")), run=run)


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


def _mean(series: dict[str, np.ndarray], name: str) -> float:
    values = series.get(name, np.zeros(0))
    with np.errstate(all="ignore"):  # a run gone bad holds anything
        return float(np.mean(values)) if len(values) else math.nan


def _crossings_text(scene: Scene, arrays: FrameArrays) -> list[str]:
    """Returns how many particles have changed their cell since the start, as a list of one sentence; [] if not
    recorded."""
    if not scene.has("crossings"):
        return []
    count, particles = int(np.count_nonzero(arrays.steps_since_crossing >= 0)), len(arrays.steps_since_crossing)
    if not count:
        return [tr("no particle has changed its cell yet")]
    if count > NEARLY_EVERY * particles:
        return [tr("nearly every particle has changed its cell")]
    return [trn("{count:,} particle has changed its cell", "{count:,} particles have changed their cell", count)]
