"""What stands above the chart: the answer in a sentence, what follows from it, and the line of the accuracy wanted."""

import math
from collections.abc import Sequence
from html import escape

from app.page.features.cost.front import cheapest, measured
from app.page.features.cost.picture import Axes, curves
from app.page.features.cost.runs import NumberedRun
from app.page.features.cost.words import called, details, percent, seconds, whole
from app.words import METHODS
from solvers.problems import PROBLEMS
from solvers.scene.scene import Scene

WORSE = 1.1  # times the error of the coarsest grid, from which on a method gets worse with finer ones


def headline(like: Sequence[NumberedRun], scene: Scene, tolerance: float, trouble: str, sweep: int) -> tuple[str, str]:
    """The answer and a second line, as html, out of the runs that can be compared with the scene. ``trouble`` is why
    there is no tolerance, ``sweep`` the number of runs that a small sweep makes."""
    known, of = measured(like), whole(scene)
    if not known:
        button = f"<button data-press='Small sweep'>Begin with a small sweep of {sweep} runs</button>"
        return _nothing(like, scene, button)
    if trouble:
        return "How accurate must it be?", escape(trouble)
    best = cheapest(like, tolerance)
    if best is None:
        near = min(known, key=lambda run: run.size)
        return (f"No run so far comes below <b>{percent(tolerance)} of {of}</b>.",
                f"The closest errs by {percent(near.size)}{_by(near)}: {escape(called(near))}, {seconds(near.seconds)}."
                " <b>Find the cheapest run</b> looks for a better one.")
    return (f"For <b>{percent(tolerance)} of {of}</b>, pay <strong>{seconds(best.seconds)}</strong>: "
            f"{escape(called(best))}.",
            " ".join([f"Its error is {percent(best.size)}{_by(best)}; {escape(details(best))}.", *_worse(like)]))


def _nothing(like: Sequence[NumberedRun], scene: Scene, begin: str) -> tuple[str, str]:
    """What is said before anything has been timed, and how to ``begin``."""
    live = next((run for run in reversed(like) if run.drawable and not run.broken), None)
    if live is None:
        title = PROBLEMS[scene.problem].scene.TITLE
        return "Nothing measured yet.", f"What does accuracy cost on the {title}?<br>{begin}"
    return "Nothing timed yet.", (f"The run on the stage errs by {percent(live.size)} of {whole(scene)}, but its time "
                                  f"was taken beside pictures and estimates.<br>{begin}")


def line(like: Sequence[NumberedRun], scene: Scene, tolerance: float, inside: Axes | None) -> str:
    """The line of the accuracy wanted, as a mark that the script reads: the axis, as powers of ten, the value, its
    words, and the run that it lights up with its price."""
    if inside is None or not math.isfinite(tolerance):
        return "<i class='lab-cost-line'></i>"
    best, text = cheapest(like, tolerance), percent(tolerance)
    price = f" data-best='{best.number}' data-price='{seconds(best.seconds)}'" if best else ""
    found = f"{seconds(best.seconds)}, {called(best)}" if best else "no run so far"
    return (f"<i class='lab-cost-line' data-low='{inside.up.low:.6g}' data-high='{inside.up.high:.6g}' "
            f"data-value='{math.log10(tolerance):.6g}' data-text='{text}' "
            f"data-spoken='{escape(f'{text} of {whole(scene)}: {found}', quote=True)}'{price}></i>")


def _by(run: NumberedRun) -> str:
    """Whose word an error is, where it is not the true one."""
    return "" if run.error is not None else f", as {escape(run.estimator)} estimates"


def _worse(runs: Sequence[NumberedRun]) -> list[str]:
    """Methods that more cells make worse, if any."""
    found = dict.fromkeys(str(METHODS.get(curve[0].method, curve[0].method)) for curve in curves(runs)
                          if len(curve) > 1 and curve[-1].size > WORSE * curve[0].size)
    return [f"{escape(' and '.join(found))} {'get' if len(found) > 1 else 'gets'} worse, however much you pay."] * bool(
        found)
