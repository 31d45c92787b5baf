"""Error budget of a run as html: stacked contributions over time, their shares, and the error without a cause."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np

from app.colour_palette import cause_css_variable
from app.frame.budget_chart_data import (
    CAPTION,
    MEANINGS,
    UNITS,
    below_zero_note,
    error_rms,
    estimated_error_note,
    format_percent,
    stack_layers,
)
from app.frame.colour_scale import round_up
from app.language.translation import lazy, tr, translate_message
from app.names_and_units import format_number, per_cent, with_unit
from app.page.visit.history import series_until
from solvers.scene.error_causes import CAUSES, NOTHING, cause_labels
from solvers.scene.scene import Scene
from solvers.solver import budget_shares

ENDS = (1, 1.5, 2, 3, 4, 5, 6, 8)  # times a power of ten: possible ends of an axis
TICKS = (1, 2, 5)
MOST = 160  # points of a curve: more are thinned out
WHOLE = 1e-9  # relative rounding of a run's end time
WIDTH, HEIGHT = 600, 200  # of a chart, in units of its own
PHRASES = {"before": lazy("before"), "predicted": lazy("predicted"), "again": lazy("run again")}


@dataclass(frozen=True)
class RunBudget:
    """A run with a budget: ``name`` beside another run, or ""; samples over time by key, all and those ``plotted``."""

    name: str
    scene: Scene
    series: dict[str, np.ndarray]
    plotted: dict[str, np.ndarray]

    @property
    def not_valid(self) -> str:
        """The reason why its shares are not valid, or ""."""
        return translate_message(budget_shares.why_not_valid(self.series) or "")


@dataclass(frozen=True)
class _SharedAxes:
    """Axes common to charts side by side: time from ``start`` to ``end`` in periods, error from ``low`` to ``top``."""

    start: float
    end: float
    low: float
    top: float

    def path_points(self, run: RunBudget, values: np.ndarray) -> list[str]:
        """Returns the points "x y" of ``values`` at the times plotted, in the chart's units, for an svg path."""
        time = run.plotted["time"] / run.scene.period
        kept = np.unique(np.r_[np.arange(0, len(time), -(-len(time) // MOST)), len(time) - 1])
        x = np.rint(WIDTH * (time[kept] - self.start) / (self.end - self.start)).astype(int)
        y = np.rint((self.top - values[kept]) / self.error_per_unit_height).astype(int)
        return [f"{at} {high}" for at, high in zip(x.tolist(), y.tolist(), strict=True)]

    @property
    def error_per_unit_height(self) -> float:
        """Error per unit of the chart's height."""
        return (self.top - self.low) / HEIGHT

    def css_top(self, value: float) -> str:
        """Returns the distance of an error ``value`` from the chart's top as a CSS percentage."""
        return f"{100 * (self.top - value) / (self.top - self.low):.1f}%"


def removed_cause(scene: Scene) -> str:
    """Returns the key of the error cause that a scene's run leaves out, or ``NOTHING``."""
    return getattr(scene, "take_away", NOTHING)  # problems without a budget have no such field


def budget_chart(runs: Sequence[RunBudget], field: str) -> str:
    """Returns html: stacked errors of ``field`` (x, v or F) of runs, with each cause's share, or why there are none."""
    drawn = [run for run in runs if not run.not_valid]
    axes = _axes(drawn, field) if drawn else None
    figures = "".join(
        _chart_figure_html(run, field, axes) if axes and not run.not_valid else
        _captioned_figure_html(run, f"<p class='lab-no-budget'>{escape(as_sentence(run.not_valid))}</p>")
        for run in runs)
    caption = f"<p class='lab-caption'>{tr(CAPTION)}</p>" if drawn else ""
    return f"<div class='lab-budget-chart'>{figures}{_legend_html(drawn, field) if drawn else ''}{caption}</div>"


def _axes(runs: Sequence[RunBudget], field: str) -> _SharedAxes:
    """Returns axes that contain the errors of ``field`` (x, v or F) in all runs."""
    highest, lowest, end, start = 0.0, 0.0, 0.0, math.inf
    for run in runs:
        layers, time = stack_layers(run.plotted, field), run.plotted["time"] / run.scene.period
        highest = max(highest, float(error_rms(run.plotted, field).max()), *(float(one.above.max()) for one in layers))
        lowest = min(lowest, *(float(one.below.min()) for one in layers), 0.0)
        end, start = max(end, float(time[-1])), min(start, float(time[0]))
    start = start if start > 1 else 0.0
    span = round_up((end - start) * (1 - WHOLE), ENDS)[0] if end > start else 1.0
    top = round_up(highest, ENDS)[0] if highest > 0 else 1.0
    return _SharedAxes(start, start + span, -round_up(-lowest, ENDS)[0] if lowest < -0.02 * top else min(lowest, 0.0),
                       top)


def _chart_figure_html(run: RunBudget, field: str, axes: _SharedAxes) -> str:
    """Returns one run's chart with its axes as html."""
    paths = []
    for layer in stack_layers(run.plotted, field):
        colour = f"style='fill:var(--{cause_css_variable(layer.cause)})'"
        for inner, outer in (layer.above, layer.below):
            if np.max(np.abs(outer - inner)) > 0.5 * axes.error_per_unit_height:
                around = [*axes.path_points(run, outer), *axes.path_points(run, inner)[::-1]]
                paths.append(f"<path {colour} d='M{'L'.join(around)}Z'/>")
    line, zero = axes.path_points(run, error_rms(run.plotted, field)), axes.css_top(0.0)
    tick = round_up(0.5 * axes.top, TICKS)[0]
    period, unit = run.scene.period, UNITS[field]
    size = with_unit(tick, unit) if unit else format_number(tick)
    begins = with_unit(axes.start * period, "s") if axes.start else "0"
    svg = f"<svg viewBox='0 0 {WIDTH} {HEIGHT}' preserveAspectRatio='none' role='img' " \
          f"aria-label='{_chart_text(run, field)}'>" \
          f"{''.join(paths)}<path class='lab-whole' d='M{'L'.join(line)}'/></svg>"
    return _captioned_figure_html(
        run,
        f"<div class='lab-made'>{svg}<i style='top:{axes.css_top(tick)}'></i><i style='top:{zero}'></i>"
        f"<span style='top:{axes.css_top(tick)}'>{size}</span><span style='top:{zero}'>0</span></div>"
        f"<div class='lab-made-times'><span>{begins}</span><span>t</span>"
        f"<span>{with_unit(axes.end * period, 's')}</span></div>")


def _captioned_figure_html(run: RunBudget, inside: str) -> str:
    title = f"<b>{escape(run.name)}</b>" if run.name else ""
    return f"<figure>{title}{inside}</figure>"


def _chart_text(run: RunBudget, field: str) -> str:
    """Returns a description of the chart for screen readers."""
    shares = budget_shares.shares(run.series, field)
    words = cause_labels(budget_shares.has_crossed(run.series))
    parts = ", ".join(f"{tr(words[cause])} {format_percent(share)}" for cause, share in shares.items())
    return escape(tr("error of {field} over time, made by {parts}", field=field, parts=parts), quote=True)


def _legend_html(runs: Sequence[RunBudget], field: str) -> str:
    """Returns the legend as html: each cause with its explanation and its share in each run."""
    shares = [budget_shares.shares(run.series, field) for run in runs]
    several = len(runs) > 1
    head = "".join(f"<th>{escape(run.name.partition(':')[0])}</th>" for run in runs) if several else "<td></td>"
    rows = "".join(
        f"<tr data-cause='{cause}'><td><i style='background:var(--{cause_css_variable(cause)})'></i><b>{tr(words)}</b> "
        f"<span>{tr(MEANINGS[cause])}</span></td>"
        f"{''.join(f'<td>{format_percent(one[cause])}</td>' for one in shares)}</tr>"
        for cause, words in cause_labels(any(budget_shares.has_crossed(run.series) for run in runs)).items())
    of = tr("share of the error of {field} over the run", field=field) + estimated_error_note(runs[-1].scene) \
        + below_zero_note(share for one in shares for share in one.values())
    return f"<table class='lab-causes{' lab-two' * several}'><tr><th>{of}</th>{head}</tr>{rows}</table>"


def removal_outcome(before: RunBudget, again: RunBudget, field: str, cause: str) -> str:
    """Returns RMS errors of ``field`` as html: in the run ``before``, predicted without a cause, and in that ``again``
    without it, over the time that both have."""
    end = min(run.series["time"][-1] for run in (before, again)) * (1 + WHOLE)
    first, second = series_until(before.series, end), series_until(again.series, end)
    sizes = {"before": budget_shares.rms_error_over_run(first, field),
             "predicted": budget_shares.rms_error_over_run(first, field, without=cause),
             "again": budget_shares.rms_error_over_run(second, field)}
    if not (whole := sizes["before"]):
        return ""
    rows = "".join(_size_bar_html(tr(PHRASES[key]), size, whole, UNITS[field], key) for key, size in sizes.items())
    of = tr("RMS of {field} over the run, without {cause}", field=field, cause=tr(CAUSES[cause]))
    return f"<div class='lab-outcome'><p>{of}</p>{rows}</div>"


def _size_bar_html(words: str, size: float | None, whole: float, unit: str, key: str) -> str:
    """Returns a size as a bar and a number, relative to the ``whole``, as html."""
    if size is None:
        return f"<p data-size='{key}'><span>{words}</span> <b>–</b></p>"
    said = with_unit(size, unit) if unit else format_number(size)
    share = "" if key == "before" else f" <small>{per_cent(size / whole)}</small>"
    return f"<p data-size='{key}'><span>{words}</span> <b>{said}</b>{share}" \
           f"<i style='width:{100 * min(1.0, size / whole):.1f}%'></i></p>"


def as_sentence(text: str) -> str:
    """Returns a reason as a sentence: with a capital letter and a full stop."""
    return f"{text[:1].upper()}{text[1:]}."
