"""Answer of the Cost tab: which run is as accurate as the visitor's and cheaper, which as fast and more accurate; as a
headline above the chart, a box in the panel and the line of the tolerance."""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

from app.language.translation import lazy, tr, trn
from app.names_and_units import METHODS
from app.page.features.cost import cost_texts, visitor_run_list
from app.page.features.cost.cost_texts import format_percent, format_seconds, run_name
from app.page.features.cost.log_axes import Axes
from app.page.features.cost.visitor_run_list import NumberedRun, cheapest_run, measured_runs, sweep_curves
from solvers.scene.scene import Scene

FINAL = lazy("For an error of <b>{share}</b>, pay <strong>{seconds}</strong>: {run}.")
PROVISIONAL = lazy("Cheapest so far for <b>{share}</b>: <strong>{seconds}</strong>, {run}.")
WORSE = 1.1  # a finer grid with more than this times the coarsest one's error makes a method worse


@dataclass(frozen=True)
class CostAnswer:
    """The visitor's ``own`` run if it is known, the ``cheaper`` and the ``more_accurate`` one; the ``tolerance``
    (relative error, NaN for none), which may be the own run's error (``is_own``)."""

    own: NumberedRun | None
    cheaper: NumberedRun | None
    more_accurate: NumberedRun | None
    tolerance: float
    is_own: bool


def find_answer(comparable: Sequence[NumberedRun], scene: Scene, tolerance: float, follows: bool) -> CostAnswer:
    """Returns the answer for a scene among ``comparable`` runs; its own error, if known, takes the tolerance's place if
    that ``follows`` it."""
    own = own_run(comparable, scene)
    if own is None or not follows:
        return CostAnswer(own, cheapest_run(comparable, tolerance), None, tolerance, False)
    return CostAnswer(own, visitor_run_list.cheaper_run(comparable, own),
                      visitor_run_list.more_accurate_run(comparable, own), own.error_or_estimate, True)


def own_run(comparable: Sequence[NumberedRun], scene: Scene) -> NumberedRun | None:
    """Returns the run of exactly this scene if its error is known; None if it is not."""
    own = visitor_run_list.run_of_scene(comparable, scene)
    return None if own is None or own.broken else own


def answer_headline(answer: CostAnswer, runs: Sequence[NumberedRun], comparable: Sequence[NumberedRun], scene: Scene,
                    trouble: str, provisional: bool = False) -> tuple[str, str]:
    """Returns the answer and a second line as html; ``runs`` are all of the problem, ``trouble``: why no tolerance."""
    known, own = measured_runs(comparable), answer.own
    measure = f"<button data-press='{escape(tr('Measure here'), quote=True)}'>{tr('Measure here')}</button>"
    error = "" if own is None else tr("Your run is <b>{share} wrong</b>.", share=format_percent(own.error_or_estimate))
    if not known:
        others = [run for run in runs if run.timed_alone and run.drawable and run not in comparable]
        other = tr("The faint runs are of another motion: {other}. Yours: {own}.",
                   other=escape(cost_texts.motion_until_end(others[0].scene)),
                   own=escape(cost_texts.motion_until_end(scene))) if others else \
            tr("No run of this motion has been timed yet.")
        return error or tr("Nothing measured for your run yet."), f"{other}<br>{measure}"
    if trouble:
        return tr("How accurate must it be?"), escape(trouble)
    if answer.is_own and own is not None:
        timed = own in known
        if timed:
            error = tr("Your run, <strong>{seconds}</strong>, is <b>{share} wrong</b>.",
                       seconds=format_seconds(own.seconds), share=format_percent(own.error_or_estimate))
        found = tr("No run in the chart is as accurate in less time.") if answer.cheaper is None else \
            tr("As accurate in <strong>{seconds}</strong>: <b>{run}</b>.", run=escape(run_name(answer.cheaper)),
               seconds=format_seconds(answer.cheaper.seconds))
        more = tr("Lower is more accurate, left is faster. Every mark is a run; click to load it.") if timed else \
            f"{tr('The time of your run has not been measured alone with these.')} {measure}"
        return f"{error} {found}", more
    best = answer.cheaper
    if best is None:
        near = min(known, key=lambda run: run.error_or_estimate)
        return (tr("No run so far comes below <b>{share}</b>.", share=format_percent(answer.tolerance)),
                tr("The closest has an error of {error}: {run}, {seconds}. <b>Find the cheapest run</b> looks for a "
                   "better one.", error=_error_text(near), run=escape(run_name(near)),
                   seconds=format_seconds(near.seconds)))
    worse = dict.fromkeys(str(METHODS.get(curve[0].method, curve[0].method)) for curve in sweep_curves(comparable)
                          if len(curve) > 1 and curve[-1].error_or_estimate > WORSE * curve[0].error_or_estimate)
    says = [trn("{methods} gets worse, however much you pay.", "{methods} get worse, however much you pay.", len(worse),
                methods=escape(cost_texts.join_names(worse)))] if worse else []
    return (tr(PROVISIONAL if provisional else FINAL, share=format_percent(answer.tolerance),
               seconds=format_seconds(best.seconds), run=escape(run_name(best))),
            " ".join([tr("Its error is {error}; {run}.", error=_error_text(best),
                         run=escape(cost_texts.run_details(best))), *says]))


def answer_box(answer: CostAnswer) -> str:
    """Returns the runs of the answer as html for the panel, each with a button that loads it; "" where the tolerance is
    not the own run's error, as the headline says it then."""
    own, better, cheaper = answer.own, answer.more_accurate, answer.cheaper
    if own is None or not answer.is_own:
        return ""
    parts, buttons = [], []
    if cheaper is not None:
        now = tr("{run}: {seconds} instead of {before}, {share} wrong.", run=run_name(cheaper),
                 seconds=format_seconds(cheaper.seconds), before=format_seconds(own.seconds),
                 share=format_percent(cheaper.error_or_estimate)) if own.timed_alone else \
            tr("{run}: {share} wrong, {seconds}.", run=run_name(cheaper), seconds=format_seconds(cheaper.seconds),
               share=format_percent(cheaper.error_or_estimate))
        parts.append((tr("As accurate as your run, cheaper:"), now))
        buttons.append((cheaper, tr("Load the cheaper")))
    if better is not None:
        parts.append((tr("As fast as your run, more accurate:"),
                      tr("{run}: {share} wrong, {seconds}.", run=run_name(better),
                         share=format_percent(better.error_or_estimate), seconds=format_seconds(better.seconds))))
        buttons.append((better, tr("Load the better")))
    if not parts:
        return ""
    texts = "".join(f"<b>{escape(title)}</b><p>{escape(text)}</p>" for title, text in parts)
    pressed = "".join(f"<button data-run='{run.mark}'>{escape(label)}</button>" for run, label in buttons)
    return f"<div class='lab-cost-answer' role='status'>{texts}<div>{pressed}</div></div>"


def tolerance_line(answer: CostAnswer, axes: Axes | None) -> str:
    """Returns the line of the tolerance as html for the script, with the runs that it marks and their labels."""
    if axes is None or not math.isfinite(answer.tolerance):
        return "<i class='lab-cost-line'></i>"
    share, cheaper, better = format_percent(answer.tolerance), answer.cheaper, answer.more_accurate
    marks = [[cheaper.mark, format_seconds(cheaper.seconds)]] if cheaper else []
    if better:
        marks.append([better.mark, tr("same time: {share}", share=format_percent(better.error_or_estimate))])
    text = tr("as accurate as your run: drag the line") if answer.is_own else tr("{share} wanted", share=share)
    found = f"{format_seconds(cheaper.seconds)}, {run_name(cheaper)}" if cheaper else tr("no run so far")
    return (f"<i class='lab-cost-line' data-low='{axes.error_axis.low:.6g}' data-high='{axes.error_axis.high:.6g}' "
            f"data-value='{math.log10(answer.tolerance):.6g}' data-text='{escape(text, quote=True)}' "
            f"data-spoken='{escape(f'{share}: {found}', quote=True)}' "
            f"data-marks='{escape(json.dumps(marks), quote=True)}'></i>")


def _error_text(run: NumberedRun) -> str:
    """Returns a run's relative error in %; with the estimator's name if it is an estimate."""
    share = format_percent(run.error_or_estimate)
    return share if run.error is not None else tr("{share}, estimated by {estimator}", share=share,
                                                  estimator=escape(run.estimator))
