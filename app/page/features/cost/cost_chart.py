"""Chart of error against time, one dot per run, in place of the stage while the Cost tab is open; and the answer above
it.

Positions are percentages of the chart's box, so that the browser fits it to any window without scaling text: lines are
SVG, dots are buttons and labels are text (``css/60-cost.css``). ``data-run`` identifies what is clicked; a script
(``js/cost.js``) keeps labels apart and places the line of the tolerance."""

import functools
import json
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from html import escape
from itertools import chain, pairwise

from app.colour_palette import METHOD_MARKS
from app.language.translation import lazy, tr, trn
from app.names_and_units import METHODS, method_name
from app.page.features.cost import cost_texts, visitor_run_list
from app.page.features.cost.cost_texts import format_percent, format_seconds, reference_length_name, run_name
from app.page.features.cost.visitor_run_list import SWEEP, NumberedRun, cheapest_run, measured_runs, run_of_scene
from solvers.problems import PROBLEMS
from solvers.scene.scene import Scene

#: Markers of radius about 5 around (0, 0), all as paths.
SHAPES = {"o": "M-5 0a5 5 0 1 0 10 0a5 5 0 1 0 -10 0z", "s": "M-4.5 -4.5h9v9h-9z", "^": "M0 -5.8L5.4 4.2H-5.4z",
          "D": "M0 -6L5.8 0L0 6L-5.8 0z", "v": "M0 5.8L5.4 -4.2H-5.4z"}
CROSS = "M-4.5 -4.5L4.5 4.5M4.5 -4.5L-4.5 4.5"
ROOM = 0.12  # margin around the values in decades
LEAST = 1.0  # decades that an axis has at least
MINOR = (2, 5)  # times a power of ten: minor ticks, hidden in a narrow chart
MOST_BELOW = 2  # decades below all errors to which a tolerance may extend the axis
ORDER = 2  # order of the methods in the cell size


@dataclass(frozen=True)
class Tick:
    """Tick at ``position`` of an axis, from 0 (low end) to 1; ``minor`` if its value is no power of ten."""

    position: float
    label: str
    minor: bool


@dataclass(frozen=True)
class LogAxis:
    """Logarithmic axis from ``low`` to ``high``, which are decimal logarithms of its values."""

    low: float
    high: float

    def position(self, value: float) -> float:
        """Returns the position of a value above 0: 0 at the low end, 1 at the high one."""
        return (math.log10(value) - self.low) / (self.high - self.low)

    def extend_to(self, values: Iterable[float]) -> "LogAxis":
        """Returns this axis, extended to contain the values, all above 0, with a margin."""
        other = axis_around(values)
        return self if other is None else LogAxis(min(self.low, other.low), max(self.high, other.high))

    def ticks(self, label: Callable[[float], str]) -> list[Tick]:
        """Returns ticks at powers of ten, and at 2 and 5 times those; ``label`` formats a value."""
        found = []
        for power in range(math.floor(self.low), math.ceil(self.high) + 1):
            for factor in (1, *MINOR):
                value = float(f"{factor}e{power}")
                if 0 <= self.position(value) <= 1:
                    found.append(Tick(self.position(value), label(value), factor in MINOR))
        return found


def axis_around(values: Iterable[float]) -> LogAxis | None:
    """Returns an axis that contains these values, all above 0, with a margin; None if there are none."""
    logs = [math.log10(value) for value in values]
    if not logs:
        return None
    middle, half = 0.5 * (min(logs) + max(logs)), max(0.5 * (max(logs) - min(logs)) + ROOM, 0.5 * LEAST)
    return LogAxis(middle - half, middle + half)


UNTIMED, UNMEASURED = LogAxis(-4.3, -0.7), LogAxis(-3.3, -0.7)  # axes before anything is known


@dataclass(frozen=True)
class Axes:
    """Axes of times in s, if any is known, and of relative errors; they only grow, so that dots stay in place."""

    times: LogAxis | None
    error_axis: LogAxis

    @property
    def time_axis(self) -> LogAxis:
        return self.times or UNTIMED

    def run_position(self, run: NumberedRun) -> tuple[float, float]:
        """Returns a run's position from left and top in %; a broken run is at the top, an untimed one at the left."""
        return (_percent(self.time_axis.position(run.seconds)) if run.timed_alone else 0.0,
                0.0 if run.broken else _percent(1 - self.error_axis.position(run.error_or_estimate)))


def axes_for(runs: Sequence[NumberedRun], tolerance: float, before: Axes | None = None) -> Axes:
    """Returns axes that contain the runs, the relative tolerance (NaN for none) and the axes ``before``."""
    times = [run.seconds for run in runs if run.drawable and run.timed_alone]
    errors = [run.error_or_estimate for run in runs if run.drawable and not run.broken]
    least = min(errors, default=1e-2) / 10**MOST_BELOW
    wanted = [max(tolerance, least)] if math.isfinite(tolerance) else []
    if before is None:
        up = axis_around([*errors, *wanted]) if errors else None
        return Axes(axis_around(times), up or UNMEASURED.extend_to(wanted))
    return Axes(before.times.extend_to(times) if before.times else axis_around(times),
                before.error_axis.extend_to([*errors, *wanted]))


def draw_runs(runs: Sequence[NumberedRun], comparable: Sequence[NumberedRun], scene: Scene, axes: Axes) -> str:
    """Returns the runs of a problem as html: faint if not ``comparable`` with the scene, the scene's own marked."""
    numbers = {run.number for run in comparable}
    dots = [run for run in runs if run.drawable]
    best = visitor_run_list.pareto_front(comparable)
    band = f"<div class='lab-band'><span>{tr('not timed alone')}</span></div>" \
        * any(not run.timed_alone for run in dots)
    curves = sweep_curves(comparable)
    lines = "".join([_grid(axes), _guides(axes, scene.DIMENSIONS) if axes.times else "",
                     _path(best, axes, "class='lab-front'"),
                     *(_path(curve, axes, f"class='lab-curve' style='{_colour(curve[0])}'") for curve in curves)])
    texts = [_label(run, axes, "lab-name", words, _colour(run)) for run, words in curve_names(comparable)]
    texts += [  # names of methods without curves: at the right, at the height of the most accurate run
        f"<span class='lab-name lab-at-edge' style='left:100%;top:{axes.run_position(run)[1]}%;{_colour(run)}' "
        f"aria-hidden='true'><svg viewBox='-8 -8 16 16'><path d='{SHAPES[METHOD_MARKS[run.method]]}'/></svg>"
        f"{escape(method_name(run.method))}</span>" for run in best_without_curve(comparable)]
    texts += [_label(run, axes, "lab-cells", str(run.scene.cells)) for run in [*chain(*curves), *best]]
    if own := run_of_scene(comparable, scene):
        texts.append(_label(own, axes, f"lab-on-stage{' lab-untimed' * (not own.timed_alone)}", tr("on the stage")))
    # The comparable runs are drawn last, on top.
    last = sorted(dots, key=lambda run: (run.number in numbers, run in best))
    words = _axis_titles_svg(scene) + (_legend_svg(dots, best, scene.DIMENSIONS) if axes.times else "")
    return (f"{band}<svg class='lab-ruled' aria-hidden='true'>{lines}{words}</svg>{''.join(texts)}"
            f"{''.join(_dot(run, axes, run.number not in numbers) for run in last)}")


def sweep_curves(runs: Sequence[NumberedRun]) -> list[list[NumberedRun]]:
    """Groups runs of sweeps that differ only in their number of cells; returns each group sorted by cells."""
    groups: dict[str, list[NumberedRun]] = {}
    for run in measured_runs(runs):
        if run.source == SWEEP:
            groups.setdefault(json.dumps({**run.row["asked"], "cells": 0}, sort_keys=True), []).append(run)
    return [sorted(group, key=lambda run: run.scene.cells) for group in groups.values()]


def curve_names(runs: Sequence[NumberedRun]) -> list[tuple[NumberedRun, str]]:
    """Returns each curve's finest run and label: its method, and if curves share a method what distinguishes them."""
    ends = [curve[-1] for curve in sweep_curves(runs)]
    found = []
    for end in ends:
        others = [other for other in ends if other is not end and other.method == end.method]
        filled = tr("{particles} per cell", particles=end.scene.ppc)
        told = [words for words, of in ((filled, lambda run: run.scene.ppc),
                                        (f"CFL {end.scene.courant_number:.3g}", lambda run: run.scene.courant_number))
                if any(of(other) != of(end) for other in others)]
        preserving = [tr("linearity-preserving")] * end.scene.linearity_preserving
        found.append((end, ", ".join([method_name(end.method), *preserving, *told])))
    return found


def best_without_curve(runs: Sequence[NumberedRun]) -> list[NumberedRun]:
    """Returns the most accurate run of each method that has no curve."""
    named = {curve[0].method for curve in sweep_curves(runs)}
    best: dict[str, NumberedRun] = {}
    for run in sorted(measured_runs(runs), key=lambda run: run.error_or_estimate):
        if run.method not in named:
            best.setdefault(run.method, run)
    return list(best.values())


def _colour(run: NumberedRun) -> str:
    """Returns a CSS variable ``--m`` for the colour of a run's method; grey if the style sheet does not know it."""
    return f"--m:var(--m-{escape(run.method, quote=True)},var(--ink3))"


def _percent(part: float) -> float:
    return round(100 * part, 2)


def _grid(axes: Axes) -> str:
    parts = []
    for tick in axes.time_axis.ticks(format_seconds):
        x, kind = _percent(tick.position), " lab-minor" * tick.minor
        parts.append(f"<line x1='{x}%' x2='{x}%' y1='0' y2='100%' class='lab-grid{kind}'/><text x='{x}%' y='100%' "
                     f"dy='1.6em' text-anchor='middle' class='lab-across{kind}'>{tick.label}</text>")
    for tick in axes.error_axis.ticks(format_percent):
        y, kind = _percent(1 - tick.position), " lab-minor" * tick.minor
        parts.append(f"<line x1='0' x2='100%' y1='{y}%' y2='{y}%' class='lab-grid{kind}'/><text x='0' y='{y}%' "
                     f"dy='0.35em' text-anchor='end' class='lab-up{kind}'>{tick.label}</text>")
    return "".join([*parts, "<line x1='0' x2='0' y1='0' y2='100%' class='lab-edge'/>"
                    "<line x1='0' x2='100%' y1='100%' y2='100%' class='lab-edge'/>"])


def _guides(axes: Axes, dimensions: int) -> str:
    """Returns faint lines as svg, with the slope of a second-order method in so many dimensions."""
    slope = ORDER / (dimensions + 1)  # cells in each direction, and steps
    across, up = axes.time_axis, axes.error_axis
    lines = []
    for power in range(math.floor(up.low + slope * across.low), math.ceil(up.high + slope * across.high) + 1):
        ends = [_percent(1 - (power - slope * x - up.low) / (up.high - up.low)) for x in (across.low, across.high)]
        lines.append(f"<line x1='0' x2='100%' y1='{ends[0]}%' y2='{ends[1]}%' class='lab-guide'/>")
    return f"<svg>{''.join(lines)}</svg>"


def _legend_svg(dots: Sequence[NumberedRun], best: Sequence[NumberedRun], dimensions: int) -> str:
    """Returns the legend, in the corner where no run can be, fast and exact; ``best`` are the runs on the front."""
    judges = list(dict.fromkeys(run.estimator for run in dots if run.error is None and not run.broken))
    keys = [tr("hollow: estimated by {judges}", judges=functools.reduce(
        lambda before, last: tr("{before} or {last}", before=before, last=last), judges))] if judges else []
    keys += [tr("grey: no run is better for less")] * (len(best) > 1)
    keys.append(tr("dashed: a quarter of the error for {times} times the time", times=2 ** (dimensions + 1)))
    lines = "".join(f"<text x='12' y='100%' dy='{-12 - 17 * k}' class='lab-key-line'>{escape(words)}</text>"
                    for k, words in enumerate(reversed(keys)))
    return f"<g class='lab-keys'>{lines}</g>"


def _axis_titles_svg(scene: Scene) -> str:
    length = tr("the RMS, largest in the run") if not scene.periods else tr("the RMS, largest in one period") \
        if scene.periods == 1 else tr("the RMS, largest in {n:g} periods", n=scene.periods)
    return f"<text x='0' y='0' class='lab-title lab-above'>" \
        f"{tr('error of x, in % of {whole}', whole=reference_length_name(scene))} <tspan>{length}</tspan></text>" \
        f"<text x='100%' y='100%' dy='3.2em' text-anchor='end' class='lab-title'>{tr('time of one run')} " \
        f"<tspan>{tr('alone on this machine')}</tspan></text>"


def _path(runs: Sequence[NumberedRun], axes: Axes, attributes: str) -> str:
    """Returns svg lines from run to run with these ``attributes``."""
    places = [axes.run_position(run) for run in runs]
    return "".join(f"<line x1='{x}%' y1='{y}%' x2='{right}%' y2='{below}%' {attributes}/>"
                   for (x, y), (right, below) in pairwise(places))


def _dot(run: NumberedRun, axes: Axes, aside: bool) -> str:
    """Returns a run's dot as an html button; faint if it is ``aside``, of another scene than the one on the stage."""
    x, y = axes.run_position(run)
    shape = CROSS if run.broken else SHAPES[METHOD_MARKS[run.method]]
    kinds = [kind for kind, holds in (("lab-broken", run.broken), ("lab-judged", run.error is None),
                                      ("lab-untimed", not run.timed_alone), ("lab-aside", aside)) if holds]
    said = cost_texts.run_sentence(run)
    words = escape(tr("{run}; of another scene than the one on the stage", run=said) if aside else said, quote=True)
    return (f"<button class='{' '.join(['lab-dot', *kinds])}' data-run='{run.number}' tabindex='-1' "
            f"style='left:{x}%;top:{y}%;{_colour(run)}' aria-label='{words}'>"
            f"<svg viewBox='-8 -8 16 16'><path d='{shape}'/></svg></button>")


def _label(run: NumberedRun, axes: Axes, kind: str, words: str, style: str = "") -> str:
    x, y = axes.run_position(run)
    return f"<span class='{kind}' style='left:{x}%;top:{y}%;{style}' aria-hidden='true'>{escape(words)}</span>"


FINAL = lazy("For <b>{share} of {whole}</b>, pay <strong>{seconds}</strong>: {run}.")
PROVISIONAL = lazy("Cheapest so far for <b>{share} of {whole}</b>: <strong>{seconds}</strong>, {run}.")
WORSE = 1.1  # a finer grid with more than this times the coarsest one's error makes a method worse


def answer_headline(comparable: Sequence[NumberedRun], scene: Scene, tolerance: float, trouble: str, sweep_size: int,
                    provisional: bool = False) -> tuple[str, str]:
    """Returns the answer and a second line as html; ``trouble``: why no tolerance; ``sweep_size``: runs in a sweep."""
    known, of = measured_runs(comparable), reference_length_name(scene)
    if not known:
        begin = tr("Begin with a small sweep of {n} runs", n=sweep_size)
        button = f"<button data-press='{escape(tr('Small sweep'))}'>{begin}</button>"
        live = next((run for run in reversed(comparable) if run.drawable and not run.broken), None)
        if live is None:
            asked = tr("What does accuracy cost on the {problem}?", problem=tr(PROBLEMS[scene.problem].scene.TITLE))
            return tr("Nothing measured yet."), f"{asked}<br>{button}"
        untimed = tr("The run on the stage has an error of {share} of {whole}, but its time includes pictures and "
                     "estimates.", share=format_percent(live.error_or_estimate), whole=of)
        return tr("Nothing timed yet."), f"{untimed}<br>{button}"
    if trouble:
        return tr("How accurate must it be?"), escape(trouble)
    best = cheapest_run(comparable, tolerance)
    if best is None:
        near = min(known, key=lambda run: run.error_or_estimate)
        return (tr("No run so far comes below <b>{share} of {whole}</b>.", share=format_percent(tolerance), whole=of),
                tr("The closest has an error of {error}: {run}, {seconds}. <b>Find the cheapest run</b> looks for a "
                   "better one.", error=_error_text(near), run=escape(run_name(near)),
                   seconds=format_seconds(near.seconds)))
    answer = PROVISIONAL if provisional else FINAL
    worse = dict.fromkeys(str(METHODS.get(curve[0].method, curve[0].method)) for curve in sweep_curves(comparable)
                          if len(curve) > 1 and curve[-1].error_or_estimate > WORSE * curve[0].error_or_estimate)
    says = [trn("{methods} gets worse, however much you pay.", "{methods} get worse, however much you pay.", len(worse),
                methods=escape(cost_texts.join_names(worse)))] if worse else []
    return (tr(answer, share=format_percent(tolerance), whole=of, seconds=format_seconds(best.seconds),
               run=escape(run_name(best))),
            " ".join([tr("Its error is {error}; {run}.", error=_error_text(best),
                         run=escape(cost_texts.run_details(best))), *says]))


def tolerance_line(comparable: Sequence[NumberedRun], scene: Scene, tolerance: float, axes: Axes | None) -> str:
    """Returns the line of the relative tolerance as html for the script, with the cheapest of ``comparable`` runs."""
    if axes is None or not math.isfinite(tolerance):
        return "<i class='lab-cost-line'></i>"
    best, text = cheapest_run(comparable, tolerance), format_percent(tolerance)
    price = f" data-best='{best.number}' data-price='{format_seconds(best.seconds)}'" if best else ""
    found = f"{format_seconds(best.seconds)}, {run_name(best)}" if best else tr("no run so far")
    spoken = tr("{share} of {whole}: {found}", share=text, whole=reference_length_name(scene), found=found)
    return (f"<i class='lab-cost-line' data-low='{axes.error_axis.low:.6g}' data-high='{axes.error_axis.high:.6g}' "
            f"data-value='{math.log10(tolerance):.6g}' data-text='{text}' "
            f"data-spoken='{escape(spoken, quote=True)}'{price}></i>")


def _error_text(run: NumberedRun) -> str:
    """Returns a run's error, in % of the scene's length; with the estimator's name if it is an estimate."""
    share = format_percent(run.error_or_estimate)
    return share if run.error is not None else tr("{share}, estimated by {estimator}", share=share,
                                                  estimator=escape(run.estimator))
