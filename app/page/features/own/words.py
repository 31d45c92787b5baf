"""What the page says of a visitor's own file: the sentence above the stage, and the numbers beside it."""

from contextlib import suppress
from dataclasses import fields, replace
from html import escape

import numpy as np

from app.frame.captions import TRUE
from app.frame.sentence import Said, error_words, errors
from app.frame.view import View
from app.language.heard import heard
from app.language.spoken import later, tr
from app.page.features.own.run import JUDGE, OwnRun
from app.page.panels.readout import DRAG, Readout, named, row, table
from app.page.stage.worst import WorstRegions
from app.words import NOTHING, QUANTITIES, differing, number, ratio, with_unit
from solvers.judging.said import NOT_OF_THE_PROBLEM
from solvers.scene.rules import SceneError
from solvers.scene.scene import Scene

HINTS = {later("now"): later("root of the mean square over the particles, at the time that is shown"),
         later("largest"): later("of all times in the file after the start"),
         later("index"): later("estimated over true error, summed over the times; 1 is perfect")}


def sentence(run: OwnRun, k: int, view: View, worst: WorstRegions, quantity: str) -> Said:
    true, estimated = (_now(norms, k, quantity) for norms in (run.true, run.estimate))
    words = error_words(run.scene, quantity, JUDGE, view.left.silence if estimated is None else "",
                        view.right.silence if true is None else "")
    wrong, says = (np.nan if norm is None else norm for norm in (true, estimated))
    said = errors(words, QUANTITIES[quantity].unit, wrong, says, says / wrong if wrong else np.nan,
                  tr("at t = {time} s in {file} ", time=number(run.times[k]), file=run.name))
    region = worst.by_truth or worst.by_estimate
    return replace(said, facts=(*said.facts, tr("worst at {region}", region=region.name)) if region else said.facts)


def scene_of(own: Scene, page: Scene) -> Scene:
    """The page's scene of a file's problem, with all that matters to a judge as in the file's own."""
    with suppress(SceneError):  # a method may not bear it
        return replace(page, **{f.name: getattr(own, f.name) for f in fields(page) if f.name not in NOT_OF_THE_PROBLEM})
    return page


def taken(run: OwnRun, page: Scene) -> str:
    """That a file is on the stage, and with what it is judged where that is not what the page shows."""
    said = differing(scene_of(run.scene, page), page) if run.scene.problem == page.problem else ""
    return tr("The file {file} is on the stage, judged with {settings}.", file=run.name, settings=said) if said else \
        tr("The file {file} is on the stage.", file=run.name)


def readout(run: OwnRun, k: int, quantity: str, probed: str | None) -> Readout:
    verdict = run.verdict or {}
    rows = [(tr("file"), f"<b>{escape(run.name)}</b>"),
            (tr("frame"), tr("{n} of {all}", n=k + 1, all=len(run))),
            (tr("time"), tr("{time:.4g} s = {periods:.2f} periods", time=run.times[k],
                            periods=run.times[k] / run.scene.period)),
            (tr("grid"), tr("{cells} cells, h = {spacing}", cells=run.scene.cells,
                            spacing=with_unit(run.scene.spacing, "m"))),
            (tr("particles"), f"{run.particles(k):,}"),
            *([(tr("crossings"), tr("{n:,} at least", n=verdict["crossings_at_least"]))] if verdict else []),
            (tr("region"), escape(probed or tr(DRAG)))]
    run_of = table("".join(f"<tr><td>{name}</td>\n<td>{text}</td></tr>\n" for name, text in rows))
    found = "".join(f"<p>{escape(text)}</p>" for text in _found(run, quantity))
    return Readout(f"{_errors(run, k, quantity)}<div class='lab-own'>{found}</div>", run_of)


def _errors(run: OwnRun, k: int, quantity: str) -> str:
    """A line for the truth and one for the companion."""
    words = QUANTITIES[quantity]
    heads = (f"<span title=\"{escape(tr(hint))}\">{tr(head)}</span>" for head, hint in HINTS.items())
    rows = [row("head", tr("error of {symbol}", symbol=words.symbol), *heads)]
    if quantity in run.missing or quantity == "a":
        return table("".join([*rows, row("", named(TRUE), tr("not in the file"))]), "lab-numbers lab-estimates")
    for name, norms in ((TRUE, run.true), (JUDGE, run.estimate)):
        last = run.series.get(f"{JUDGE}/index_{quantity}", np.zeros(0))[-1:]
        index = "" if name != JUDGE else ratio(float(last[0])) if np.isfinite(last).any() else NOTHING
        values = np.zeros(0) if norms is None or quantity not in norms else \
            norms[quantity][run.times > 0 if (run.times > 0).any() else ...]
        largest = float(values.max()) if len(values) and np.isfinite(values).all() else None
        rows.append(row("", named(name), *(NOTHING if value is None else with_unit(value, words.unit, 2) for value in (
            _now(norms, k, quantity), largest)), index))
    return table("".join(rows), "lab-numbers lab-estimates")


def _found(run: OwnRun, quantity: str) -> list[str]:
    """What the judge says, sentence by sentence."""
    if run.verdict is None:
        return [tr("There is no verdict: {reason}", reason=run.trouble) if run.trouble else
                tr("The judge is still at work.")]
    found, worst = [], run.verdict["worst"].get(quantity)
    if worst:
        size = with_unit(worst["size"], QUANTITIES[quantity].unit)
        found.append(tr("Worst of all: {size}, particle {particle} at {place}, t = {time} s.", size=size,
                        particle=worst["particle"], place=_place(worst["X"]), time=number(worst["t"])))
    if gap := run.verdict["neighbour_gap"]:
        found.append(tr("{count:,} particles ({share:.2g} %) are not where their neighbours are, by up to {apart:.2g} "
                        "h, at t = {time} s: the farthest is particle {particle} at {place}.", count=gap["count"],
                        share=100 * gap["share"], apart=gap["farthest_over_h"], time=number(gap["t"]),
                        particle=gap["particle"], place=_place(gap["X"])))
    notes = map(heard, run.verdict["notes"])
    return [*found, *(f"{note[:1].upper()}{note[1:]}." for note in notes)]


def _place(X: list[float]) -> str:
    place = ", ".join(f"{c:.3g}" for c in X)
    return f"X = ({place}) m" if len(X) > 1 else f"X = {place} m"


def _now(norms: dict[str, np.ndarray] | None, k: int, quantity: str) -> float | None:
    value = np.nan if norms is None or quantity not in norms else norms[quantity][k]
    return float(value) if np.isfinite(value) else None
