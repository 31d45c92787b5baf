"""Chart of error against time, one dot per run, in place of the stage while the Cost tab is open.

Positions are percentages of the chart's box, so that the browser fits it to any window without scaling text: lines are
SVG, dots are buttons and labels are text (``css/60-cost.css``). ``data-run`` identifies what is clicked; a script
(``js/cost.js``) keeps labels apart and places the line of the tolerance."""

from collections.abc import Sequence
from html import escape
from itertools import pairwise

from app.colour_palette import METHOD_MARKS
from app.language.translation import tr
from app.names_and_units import QUANTITIES, format_number, functions_name
from app.page.features.cost import cost_texts
from app.page.features.cost.cost_texts import format_percent, format_seconds, reference_size_name
from app.page.features.cost.log_axes import Axes, percent
from app.page.features.cost.visitor_run_list import (
    HERE,
    SHIPPED,
    NumberedRun,
    measured_runs,
    run_of_scene,
    sweep_curves,
)
from solvers.scene.scene import Scene

#: Markers of radius about 5 around (0, 0), all as paths.
SHAPES = {"o": "M-5 0a5 5 0 1 0 10 0a5 5 0 1 0 -10 0z", "s": "M-4.5 -4.5h9v9h-9z", "^": "M0 -5.8L5.4 4.2H-5.4z",
          "D": "M0 -6L5.8 0L0 6L-5.8 0z", "v": "M0 5.8L5.4 -4.2H-5.4z"}
CROSS = "M-4.5 -4.5L4.5 4.5M4.5 -4.5L-4.5 4.5"


def draw_runs(runs: Sequence[NumberedRun], comparable: Sequence[NumberedRun], scene: Scene, quantity: str,
              axes: Axes) -> str:
    """Returns the runs of a problem by their errors of a quantity as html: faint if not ``comparable`` with the scene,
    hollow if timed elsewhere than the others, the scene's own ringed. Of runs that were not timed alone only the own
    one is there, in a band."""
    numbers, own = {run.number for run in comparable}, run_of_scene(comparable, scene)
    dots = [run for run in runs if run.drawable and (run.timed_alone or run is own)]
    replaced = any(run.source in HERE for run in comparable)
    band = f"<div class='lab-band'><span>{tr('not timed alone')}</span></div>" if own and not own.timed_alone else ""
    curves = sweep_curves(comparable)
    lines = _grid(axes) + "".join(
        _path(curve, axes, f"class='lab-curve{' lab-corrected' * bool(curve[0].corrected_by)}' "
                           f"style='{_colour(curve[0])}'") for curve in curves)
    texts = [_label(run, axes, "lab-name", words, _colour(run)) for run, words in curve_names(comparable)]
    texts += [  # names of methods without curves: at the right, at the height of the most accurate run
        f"<span class='lab-name lab-at-edge' style='left:100%;top:{axes.run_position(run)[1]}%;{_colour(run)}' "
        f"aria-hidden='true'><svg viewBox='-8 -8 16 16'><path d='{SHAPES[METHOD_MARKS[run.method]]}'/></svg>"
        f"{escape(functions_name(run.method))}</span>" for run in best_without_curve(comparable)]
    most_accurate = min(curves, key=lambda curve: curve[-1].error_or_estimate, default=[])
    texts += [_label(run, axes, "lab-cells", tr("{cells} cells", cells=run.scene.cells))
              for run in most_accurate if not _is_small(run)]
    if own:
        texts.append(_label(own, axes, "lab-on-stage lab-own", tr(
            "your run: {method}, {cells} cells", method=functions_name(own.method), cells=own.scene.cells))
            if own.timed_alone else _label(own, axes, "lab-on-stage lab-own lab-untimed", tr("your run")))
    # The comparable runs are drawn last, on top.
    last = sorted(dots, key=lambda run: (run is own, run.number in numbers))
    marks = "".join(_dot(run, axes, [kind for kind, holds in (
        ("lab-broken", run.broken), ("lab-judged", run.error is None and not run.broken), ("lab-own", run is own),
        ("lab-untimed", not run.timed_alone), ("lab-aside", run.number not in numbers), ("lab-small", _is_small(run)),
        ("lab-corrected", run.corrected_by), ("lab-elsewhere", replaced and run.source == SHIPPED)) if holds])
                    for run in last)
    return f"{band}<svg class='lab-ruled' aria-hidden='true'>{lines}{_axis_titles_svg(scene, quantity)}</svg>" \
        f"{''.join(texts)}{marks}"


def _is_small(run: NumberedRun) -> bool:
    """Whether a run is on a grid between two others, such as 28 cells between 20 and 40."""
    cells, own = run.scene.cells, type(run.scene)().cells
    return cells not in (own, 2 * own, 4 * own) and 2 * cells != own


def curve_names(runs: Sequence[NumberedRun]) -> list[tuple[NumberedRun, str]]:
    """Returns each curve's finest run and label: its method, and if curves share a method what distinguishes them."""
    ends = [curve[-1] for curve in sweep_curves(runs)]
    found = []
    for end in ends:
        others = [other for other in ends if other is not end and other.method == end.method]
        filled = tr("{particles} per cell", particles=end.scene.ppc)
        step = f"CFL {format_number(end.scene.courant_number)}"
        told = [words for words, of in ((filled, lambda run: run.scene.ppc),
                                        (step, lambda run: run.scene.courant_number))
                if any(of(other) != of(end) for other in others)]
        told += [tr("corrected by {estimator}", estimator=end.corrected_by)] * bool(end.corrected_by)
        preserving = [tr("linearity-preserving")] * end.scene.linearity_preserving
        found.append((end, ", ".join([functions_name(end.method), *preserving, *told])))
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


def _grid(axes: Axes) -> str:
    parts = []
    for tick in axes.time_axis.ticks(format_seconds):
        x, kind = percent(tick.position), " lab-minor" * tick.minor
        parts.append(f"<line x1='{x}%' x2='{x}%' y1='0' y2='100%' class='lab-grid{kind}'/><text x='{x}%' y='100%' "
                     f"dy='1.6em' text-anchor='middle' class='lab-across{kind}'>{tick.label}</text>")
    for tick in axes.error_axis.ticks(format_percent):
        y, kind = percent(1 - tick.position), " lab-minor" * tick.minor
        parts.append(f"<line x1='0' x2='100%' y1='{y}%' y2='{y}%' class='lab-grid{kind}'/><text x='0' y='{y}%' "
                     f"dy='0.35em' text-anchor='end' class='lab-up{kind}'>{tick.label}</text>")
    return "".join([*parts, "<line x1='0' x2='0' y1='0' y2='100%' class='lab-edge'/>"
                    "<line x1='0' x2='100%' y1='100%' y2='100%' class='lab-edge'/>"])


def _axis_titles_svg(scene: Scene, quantity: str) -> str:
    error = tr("Largest error of the {quantity} until {time}", quantity=QUANTITIES[quantity].noun,
               time=f"{format_number(scene.end_time)} s")
    return f"<text x='0' y='0' class='lab-title lab-above'>{escape(error)} " \
        f"<tspan>{tr('RMS, in % of {whole}', whole=reference_size_name(scene, quantity))}</tspan></text>" \
        f"<text x='100%' y='100%' dy='3.2em' text-anchor='end' class='lab-title'>{tr('Time of one run')} " \
        f"<tspan>{tr('without estimates')}</tspan></text>"


def _path(runs: Sequence[NumberedRun], axes: Axes, attributes: str) -> str:
    """Returns svg lines from run to run with these ``attributes``."""
    places = [axes.run_position(run) for run in runs]
    return "".join(f"<line x1='{x}%' y1='{y}%' x2='{right}%' y2='{below}%' {attributes}/>"
                   for (x, y), (right, below) in pairwise(places))


def _dot(run: NumberedRun, axes: Axes, kinds: Sequence[str]) -> str:
    """Returns a run's dot of these ``kinds`` (classes of the style sheet) as an html button."""
    x, y = axes.run_position(run)
    shape, said = CROSS if run.broken else SHAPES[METHOD_MARKS[run.method]], cost_texts.run_sentence(run)
    words = tr("{run}; of another scene than the one on the stage", run=said) if "lab-aside" in kinds else said
    return (f"<button class='{' '.join(['lab-dot', *kinds])}' data-run='{run.mark}' tabindex='-1' "
            f"style='left:{x}%;top:{y}%;{_colour(run)}' aria-label='{escape(words, quote=True)}'>"
            f"<svg viewBox='-8 -8 16 16'><path d='{shape}'/></svg></button>")


def _label(run: NumberedRun, axes: Axes, kind: str, words: str, style: str = "") -> str:
    x, y = axes.run_position(run)
    return f"<span class='{kind}' style='left:{x}%;top:{y}%;{style}' aria-hidden='true'>{escape(words)}</span>"
