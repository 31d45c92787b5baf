"""Parts of studies' pictures; and coverage, the shares of runs with accurate estimates, by how far particles move; and
the stability map, lifetime over amplitude and time step, by method and treatment."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogFormatterSciNotation, LogLocator, NullFormatter

from app.colour_palette import INK, INK3, LINE, LINE2, METHOD_COLOURS, METHOD_MARKS
from app.names_and_units import METHODS, QUANTITIES, method_name, unit_of, with_unit
from app.renderers.picture_panel_style import Look, write_note
from app.renderers.picture_style import UnitPrefixTickFormatter, make_figure
from solvers.problems import PROBLEMS
from solvers.running.quantities_of_interest import SAFETY
from solvers.scene.estimator_registry import ESTIMATORS
from solvers.solver.soundness import BROKEN
from solvers.study.convergence_analysis import SingleInputSeries, completed_rows, error_of, group_series
from solvers.study.coverage.estimate_coverage_counts import FACTORS, INTERVALS, REGIMES, wilson_interval
from solvers.study.stability_map import TREATMENTS, stayed_accurate, survived_periods, treatment_of

LINE_STYLES = ("-", "--", ":", "-.")
MOST_LEGEND_ENTRIES = 12
LEGEND_WIDTH = 190  # letters
MOST_TICKS = 8
UNSTABLE_ROOM = 30.0  # times the largest error of a stable run: larger errors of unstable runs are clipped
TOP = 0.97  # position on the axes of unstable runs with a larger error or NaN
UNSTABLE_LOOK: Look = {"marker": "x", "linestyle": "none", "markersize": 9, "markeredgewidth": 2.2}


def make_panel_grid(title: str, rows: int, columns: int, size: tuple[float, float]) -> tuple[Figure, np.ndarray]:
    figure = make_figure(*size, title)
    return figure, figure.subplots(rows, columns, squeeze=False)


def empty_figure(title: str, sentence: str) -> Figure:
    figure, axes = make_panel_grid(title, 1, 1, (8.0, 2.5))
    axes[0, 0].set_axis_off()
    write_note(axes[0, 0], f"nothing to show: {sentence}")
    return figure


def known_quantities(rows: Sequence[dict], among: Iterable[str] = QUANTITIES) -> list[str]:
    """Returns the keys, ``among`` some, of the quantities with a true error in any row of a completed run."""
    return [q for q in among if any(error_of(row, q) for row in completed_rows(rows))]


def series_styles(rows: Sequence[dict], along: str = "cells") -> list[tuple[SingleInputSeries, Look]]:
    """Returns the series of rows along one input, each with its style: colour and marker by method, line style and
    filling by other inputs, hollow for corrected results."""
    lines = group_series(rows, along)
    kinds = [(line.variant, line.corrected_by) for line in lines]
    numbers = {kind: k for k, kind in enumerate(dict.fromkeys(kinds))}
    return [(line, {"color": METHOD_COLOURS[line.method], "marker": METHOD_MARKS[line.method], "markersize": 6,
                    "linewidth": 1.3, "linestyle": LINE_STYLES[(k := numbers[kind]) % len(LINE_STYLES)],
                    "fillstyle": "none" if line.corrected_by else ("full", "left")[k // len(LINE_STYLES) % 2]})
            for line, kind in zip(lines, kinds, strict=True)]


def draw_errors(axes: Axes, lines: Sequence[tuple[SingleInputSeries, Look]], quantity: str,
                abscissa: Callable[[dict], float], joined: bool = True) -> None:
    """Draws the errors of a quantity of each series over the ``abscissa`` of a row, ``joined`` by lines; unstable runs
    are crosses, at the top edge if their error is too large. Sets the vertical axis."""
    stood: list[float] = []
    crosses = []
    for line, look in lines:
        points = [(abscissa(row), error) for row in line.rows
                  if row["status"] not in BROKEN and (error := error_of(row, quantity))]
        if points:
            axes.plot(*zip(*points, strict=True), **(look if joined else {**look, "linestyle": "none"}), zorder=3)
        stood += [error for _, error in points]
        crosses += [(abscissa(row), error_of(row, quantity), look["color"]) for row in line.rows
                    if row["status"] in BROKEN]
    limit = UNSTABLE_ROOM * max(stood, default=np.inf)
    shown = stood + [error for _, error, _ in crosses if error is not None and 0 < error <= limit]
    if shown:
        axes.set_ylim(min(shown) / 1.6, max(shown) * (4.0 if crosses else 1.6))
    for x, error, colour in crosses:
        height, place = TOP, dict[str, Any](transform=axes.get_xaxis_transform(), clip_on=False)
        if error is not None and np.isfinite(error) and 0 < error <= limit:
            height, place = error, {}
        axes.plot([x], [height], color=colour, zorder=5, **UNSTABLE_LOOK, **place)
    axes.set_title(f"Error of {QUANTITIES[quantity]}, largest RMS")
    axes.yaxis.set_major_formatter(UnitPrefixTickFormatter(QUANTITIES[quantity].unit))


def method_handles(rows: Iterable[dict]) -> list[Line2D]:
    """Returns an entry of a legend, with colour and marker, for each method in the rows."""
    there = {row["scene"]["method"] for row in rows}
    return [Line2D([], [], color=METHOD_COLOURS[m], marker=METHOD_MARKS[m], linestyle="none", label=METHODS[m].name)
            for m in METHODS if m in there]


def add_legend_below(figure: Figure, entries: Sequence[tuple[SingleInputSeries, Look]],
                     extra: Sequence[Line2D] = ()) -> None:
    """Adds one legend below all panels: the first series with their styles, ``extra`` entries and that of crosses."""
    shown, names = entries[:MOST_LEGEND_ENTRIES], {code: method.name for code, method in METHODS.items()}
    handles = [Line2D([], [], label=line.label(names), **look) for line, look in shown] + list(extra)
    if len(entries) > len(shown):
        handles.append(Line2D([], [], linestyle="none", label=f"and {len(entries) - len(shown)} more"))
    if any(row["status"] in BROKEN for line, _ in entries for row in line.rows):
        handles.append(Line2D([], [], color=INK3, label="unstable or lost (at the top edge: error beyond the scale)",
                              **UNSTABLE_LOOK))
    lengths = [len(str(handle.get_label())) + 7 for handle in handles]
    columns = len(handles) if sum(lengths) < LEGEND_WIDTH else max(1, LEGEND_WIDTH // max(lengths))
    figure.legend(handles=handles, loc="outside lower center", ncols=columns)


def set_log_axes(axes: Axes, unit: str = "s") -> None:
    """Makes both axes logarithmic, with ticks at 1, 2 and 5 where an axis is short; the horizontal one in ``unit``."""
    across = axes.yaxis.get_major_formatter()
    axes.set(xscale="log", yscale="log")
    axes.grid(axis="both", color=LINE)
    for axis, sizes in ((axes.xaxis, UnitPrefixTickFormatter(unit)), (axes.yaxis, across)):
        low, high = axis.get_view_interval()
        few = low > 0 and np.floor(np.log10(high)) - np.ceil(np.log10(low)) < 1
        axis.set_major_locator(LogLocator(subs=(1, 2, 5) if few else (1,)))
        axis.set_major_formatter(sizes if isinstance(sizes, UnitPrefixTickFormatter) else LogFormatterSciNotation())
        axis.set_minor_formatter(NullFormatter())


def set_ticks_at(axes: Axes, values: Sequence[float], unit: str = "") -> None:
    """Makes ``values`` the only ticks of the horizontal axis, if they are few; labels have the unit."""
    if len(values) <= MOST_TICKS:
        axes.set_xticks(values, [with_unit(value, unit) if unit else f"{value:,.6g}" for value in values])
        axes.xaxis.set_minor_formatter(NullFormatter())


PROMISED = 95.0  # per cent, nominal for the grid convergence index
SYMBOLS = ("o", "s", "^")  # one for each regime
SPREAD = 0.22  # distance of markers in one row


def coverage_figure(counted: Sequence[Mapping]) -> Figure:
    """Returns, left, the shares of runs whose estimate of x is within the smallest factor of the truth; right, those of
    error bars that contain it. ``counted`` has one object of counts, from ``coverage_counts.tally``."""
    [one] = counted
    title = f"How often is it right? {one['runs']:,} runs of the {one['problem']}, drawn at random"
    figure, axes = make_panel_grid(title, 1, 2, (13.5, 5.2))
    names = list(one["estimators"])
    left, right = axes[0]

    def right_of(name: str, regime: str) -> tuple[int, int]:
        found = one["estimators"][name]["regime"][regime]["x"]
        return found["within"][f"{FACTORS[0]:g}"], found["runs"]

    def held_of(name: str, regime: str) -> tuple[int, int]:  # of all goals together
        found = [split["regime"][regime][bars[name]] for split in one["goals"].values()]
        return sum(goal["held"] for goal in found), sum(goal["runs"] for goal in found)

    _draw_coverage_rows(left, names, right_of)
    left.set_xlabel(f"runs with the estimate of x within a factor of {FACTORS[0]:g} of the truth, %")
    bars = {f"{SAFETY:g} × {name}": f"{SAFETY:g} x {name}" for name in names} | {name: name for name in INTERVALS}
    _draw_coverage_rows(right, list(bars), held_of)
    right.axvline(PROMISED, color=INK, linewidth=1, linestyle=(0, (4, 3)))
    right.set_xlabel("bars around a number that hold the truth, %; dashed: the GCI's promise")
    handles = [left.plot([], [], symbol, color=INK3, label=f"particles move {regime}")[0]
               for symbol, regime in zip(SYMBOLS, REGIMES, strict=True)]
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles), frameon=False)
    return figure


def _draw_coverage_rows(axes: Axes, names: Sequence[str], counts: Callable[[str, str], tuple[int, int]]) -> None:
    """Draws a row per name: for each regime, how far particles move, a share in per cent with its 95 % interval.
    ``counts`` returns the hits and runs of a name and a regime."""
    for row, name in enumerate(names):
        known = [key for key in ESTIMATORS if name.endswith(key)]
        colour = ESTIMATORS[known[0]].colour if known else INK3
        for k, (symbol, regime) in enumerate(zip(SYMBOLS, REGIMES, strict=True)):
            held, of = counts(name, regime)
            if of:
                low, high = wilson_interval(held, of)
                y = row + (k - 1) * SPREAD
                axes.plot([100 * low, 100 * high], [y, y], color=colour, linewidth=1.5)
                axes.plot([100 * held / of], [y], symbol, color=colour, markersize=6)
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.5, -0.5)
    axes.set_xlim(-2, 102)
    axes.grid(axis="x", color=LINE2)


PANEL = (2.5, 1.7)  # inches
SPELT_OUT = {"lp": "linearity\npreserving", "lp+zero-drift": "linearity\npreserving,\nzero drift",
             "all-three": "linearity\npreserving,\nfilter+coupled"}  # treatments, where the short name says too little
SHORTEST = 0.1  # periods, at the dark end of the scale


def stability_map_figure(rows: Sequence[dict]) -> Figure:
    """Returns the stability map: survived periods, bright for many, over amplitude and Courant number, a column per
    method and a row per treatment; "✓" marks runs that stayed accurate to the end."""
    shown = completed_rows(rows)
    if not shown:
        return empty_figure("Stability", "no run was possible")
    kind = PROBLEMS[shown[0]["problem"]].scene
    methods = [name for name in kind.choices("method") if any(row["scene"]["method"] == name for row in shown)]
    treatments = [name for name in TREATMENTS if any(treatment_of(row) == name for row in shown)]
    amplitudes, steps = (sorted({row["scene"][name] for row in shown}) for name in ("amplitude", "cfl"))
    longest = max(row["scene"]["periods"] for row in shown)
    unit = unit_of(kind, "amplitude")
    size = (1.6 + PANEL[0] * len(methods), 1.8 + PANEL[1] * len(treatments))
    figure = make_figure(*size, f"{kind.TITLE.capitalize()}: periods until x is off by A/10 or\nthe run breaks, of "
                          f"{longest:g} (✓: held to the end)")
    axes = figure.subplots(len(treatments), len(methods), squeeze=False, sharex=True, sharey=True)
    for line, treatment in zip(axes, treatments, strict=True):
        for panel, method in zip(line, methods, strict=True):
            own = [row for row in shown if row["scene"]["method"] == method and treatment_of(row) == treatment]
            lives = np.full((len(steps), len(amplitudes)), np.nan)
            for row in own:
                at = steps.index(row["scene"]["cfl"]), amplitudes.index(row["scene"]["amplitude"])
                lives[at] = max(survived_periods(row), SHORTEST)
                text = "✓" if stayed_accurate(row) else f"{survived_periods(row):.2g}"
                dark = lives[at] < np.sqrt(SHORTEST * longest)
                panel.text(at[1], at[0], text, ha="center", va="center", fontsize=10, color="w" if dark else INK)
            panel.imshow(lives, origin="lower", aspect="auto", norm=LogNorm(SHORTEST, longest), cmap="cividis")
            panel.grid(visible=False)
            panel.spines["bottom"].set_visible(False)
            panel.set(xticks=range(len(amplitudes)), xticklabels=[with_unit(A, unit) for A in amplitudes],
                      yticks=range(len(steps)), yticklabels=[f"{cfl:g}" for cfl in steps])
            if not own:
                panel.text(0.5, 0.5, "not offered", transform=panel.transAxes, ha="center", va="center", color=INK3)
    for panel, method in zip(axes[0], methods, strict=True):
        panel.set_title(method_name(method))
    for panel, treatment in zip(axes[:, 0], treatments, strict=True):
        panel.set_ylabel(f"{SPELT_OUT.get(treatment, treatment)}\ncfl")
    for panel in axes[-1]:
        panel.set_xlabel("amplitude A")
    bar = figure.colorbar(axes[0, 0].images[0], ax=list(axes.ravel()), location="bottom", aspect=50, pad=0.02,
                          label="periods")
    bar.outline.set_visible(False)
    bar.ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))  # 0.1 periods, not 100 m
    return figure
