"""What stands above the chart: the answer in a sentence, what follows from it, and the line of the accuracy wanted."""

import math
from collections.abc import Sequence
from html import escape

from app.language.spoken import later, tr, trn
from app.page.features.cost.picture import Axes, curves
from app.page.features.cost.runs import NumberedRun, cheapest, measured
from app.page.features.cost.words import called, details, percent, seconds, together, whole
from app.words import METHODS
from solvers.problems import PROBLEMS
from solvers.scene.scene import Scene

FINAL = later("For <b>{share} of {whole}</b>, pay <strong>{seconds}</strong>: {run}.")
PROVISIONAL = later("Cheapest so far for <b>{share} of {whole}</b>: <strong>{seconds}</strong>, {run}.")
WORSE = 1.1  # times the error of the coarsest grid, from which on a method gets worse with finer ones


def headline(like: Sequence[NumberedRun], scene: Scene, tolerance: float, trouble: str, sweep: int,
             provisional: bool = False) -> tuple[str, str]:
    """The answer and a second line, as html, out of the runs that can be compared with the scene. ``trouble`` is why
    there is no tolerance, ``sweep`` the number of runs that a small sweep makes; ``provisional`` while more come."""
    known, of = measured(like), whole(scene)
    if not known:
        begin = tr("Begin with a small sweep of {n} runs", n=sweep)
        button = f"<button data-press='{escape(tr('Small sweep'))}'>{begin}</button>"
        live = next((run for run in reversed(like) if run.drawable and not run.broken), None)
        if live is None:
            asked = tr("What does accuracy cost on the {problem}?", problem=tr(PROBLEMS[scene.problem].scene.TITLE))
            return tr("Nothing measured yet."), f"{asked}<br>{button}"
        untimed = tr("The run on the stage errs by {share} of {whole}, but its time was taken beside pictures and "
                     "estimates.", share=percent(live.size), whole=of)
        return tr("Nothing timed yet."), f"{untimed}<br>{button}"
    if trouble:
        return tr("How accurate must it be?"), escape(trouble)
    best = cheapest(like, tolerance)
    if best is None:
        near = min(known, key=lambda run: run.size)
        return (tr("No run so far comes below <b>{share} of {whole}</b>.", share=percent(tolerance), whole=of),
                tr("The closest errs by {error}: {run}, {seconds}. <b>Find the cheapest run</b> looks for a better "
                   "one.", error=_error(near), run=escape(called(near)), seconds=seconds(near.seconds)))
    answer = PROVISIONAL if provisional else FINAL
    worse = dict.fromkeys(str(METHODS.get(curve[0].method, curve[0].method)) for curve in curves(like)
                          if len(curve) > 1 and curve[-1].size > WORSE * curve[0].size)
    says = [trn("{methods} gets worse, however much you pay.", "{methods} get worse, however much you pay.", len(worse),
                methods=escape(together(worse)))] if worse else []
    return (tr(answer, share=percent(tolerance), whole=of, seconds=seconds(best.seconds), run=escape(called(best))),
            " ".join([tr("Its error is {error}; {run}.", error=_error(best), run=escape(details(best))), *says]))


def line(like: Sequence[NumberedRun], scene: Scene, tolerance: float, inside: Axes | None) -> str:
    """The line of the accuracy wanted, as a mark that the script reads: the axis, as powers of ten, the value, its
    words, and the run that it lights up with its price."""
    if inside is None or not math.isfinite(tolerance):
        return "<i class='lab-cost-line'></i>"
    best, text = cheapest(like, tolerance), percent(tolerance)
    price = f" data-best='{best.number}' data-price='{seconds(best.seconds)}'" if best else ""
    found = f"{seconds(best.seconds)}, {called(best)}" if best else tr("no run so far")
    spoken = tr("{share} of {whole}: {found}", share=text, whole=whole(scene), found=found)
    return (f"<i class='lab-cost-line' data-low='{inside.up.low:.6g}' data-high='{inside.up.high:.6g}' "
            f"data-value='{math.log10(tolerance):.6g}' data-text='{text}' "
            f"data-spoken='{escape(spoken, quote=True)}'{price}></i>")


def _error(run: NumberedRun) -> str:
    """How wrong a run is, and whose word that is, where it is not the true error."""
    share = percent(run.size)
    return share if run.error is not None else tr("{share}, as {estimator} estimates", share=share,
                                                  estimator=escape(run.estimator))
