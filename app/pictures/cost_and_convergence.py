"""Pictures of a study: cost of accuracy, convergence in h and dt, and reliability of estimates.

Each function takes rows (see ``solvers.study.row``) and returns a figure, with a note if there is nothing to show.
Methods have the colours and markers of ``app.colour_palette``; unstable runs are crosses, never left out."""

import statistics
from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from app.colour_palette import ESTIMATE_INK, INK, INK2, INK3, LINE2, METHOD_COLOURS, METHOD_MARKS, TRUTH, TRUTH_INK
from app.names_and_units import METHODS, QUANTITIES
from app.pictures import study_parts as parts
from app.pictures.run_errors import DRAWN
from app.renderers.picture_panel_style import Look, write_note
from app.renderers.picture_style import UnitPrefixTickFormatter, format_size_axis
from solvers.solver.soundness import BROKEN, OK
from solvers.study.convergence_analysis import (
    SingleInputSeries,
    completed_rows,
    corrected_rows,
    error_of,
    fit_space_time,
    pareto,
)

REST = "everything else\nthat was measured"
NO_TRUTH = "no row has a true error"
WIDTH = 13.5
MOST_NAMED = 8
MOST_ORDERS = 8
MOST_OFF = 100.0  # times the true errors: larger estimates do not extend the scale
FRONT: Look = {"color": LINE2, "linewidth": 6, "zorder": 1, "solid_capstyle": "round", "solid_joinstyle": "round"}
MOST_MISFIT = 0.15  # relative; beyond, the sum of two errors does not fit the points
SPACE = "space error rules: shorter steps gain little"
TIME = "time error rules: shorter steps pay"
NEITHER = "not a sum of space and time error"
HOLLOW: Look = {"markerfacecolor": "white", "zorder": 4}  # an error that tells nothing of the order
BALANCE_LOOK: Look = {"marker": "*", "markersize": 15, "markeredgecolor": INK, "linestyle": "none"}


def error_run_time_figure(rows: Sequence[dict]) -> Figure:
    """Returns each run's largest RMS error over its seconds, a panel per quantity, with the Pareto front; hollow, with
    the time of run and estimator, the error that is left when the estimate is subtracted."""
    rows = [*rows, *corrected_rows(rows)]
    title = "What accuracy costs: error against time"
    cells = sorted({row["scene"]["cells"] for row in completed_rows(rows)})
    shown = parts.known_quantities(rows, DRAWN)
    if not shown:
        return parts.empty_figure(title, NO_TRUTH)
    lines = parts.series_styles(rows)
    hollow = any(line.corrected_by for line, _ in lines)
    if 1 < len(cells) <= MOST_NAMED:
        title += f"; from left to right along a line: {', '.join(map(str, cells))} cells"
    figure, axes = parts.make_panel_grid(title, 1, len(shown), (WIDTH, 5.6))
    for panel, quantity in zip(axes[0], shown, strict=True):
        points = [(row["seconds"]["min"], error) for row in completed_rows(rows)
                  if row["status"] == OK and (error := error_of(row, quantity))]
        if points:
            best = [points[k] for k in pareto(*zip(*points, strict=True))]
            panel.plot(*zip(*best, strict=True), marker="o", markersize=6, **FRONT)
        parts.draw_errors(panel, lines, quantity, lambda row: row["seconds"]["min"])
        panel.set_xlabel("time of the run and, hollow, its estimator" if hollow else
                         "time of the bare run, shortest of the repeats")
        parts.set_log_axes(panel)
    front = Line2D([], [], **FRONT, label="Pareto front: no row has less error in less time")
    parts.add_legend_below(figure, lines, [front])
    return figure


def error_spacing_figure(rows: Sequence[dict]) -> Figure:
    """Returns each run's largest RMS error over h, a panel per quantity, with fitted orders and reference triangles."""
    title = "Convergence: error against cell size"
    shown = parts.known_quantities(rows, DRAWN)
    if not shown:
        return parts.empty_figure(title, NO_TRUTH)
    lines = parts.series_styles(rows)
    figure, axes = parts.make_panel_grid(title, 1, len(shown), (WIDTH, 6.2))
    for panel, quantity in zip(axes[0], shown, strict=True):
        parts.draw_errors(panel, lines, quantity, lambda row: row["h"], joined=False)
        spacings = sorted({row["h"] for row in completed_rows(rows)})
        _draw_fits(panel, lines, quantity)
        if len(spacings) > 1:
            _draw_triangles(panel, [(row["h"], error_of(row, quantity)) for row in completed_rows(rows)])
            panel.set_xlim(spacings[0] / 1.25, spacings[-1] * 1.25)
        else:
            panel.text(0.03, 0.03, "one h only: no order to fit", transform=panel.transAxes, color=INK3)
        panel.set_xlabel("cell size h")
        parts.set_log_axes(panel, "m")
        parts.set_ticks_at(panel, spacings, "m")
    parts.add_legend_below(figure, lines)
    return figure


def estimate_truth_figure(rows: Sequence[dict]) -> Figure:
    """Returns estimated against true errors, with the diagonal: panels by estimator (rows) and quantity (columns)."""
    title = "Can the estimate be believed? Estimated against true error (largest RMS of each run)"
    rows = completed_rows(rows)
    shown = parts.known_quantities(rows)
    names = list(dict.fromkeys(name for row in rows for name, norms in row["estimate"].items()
                               if any(norms.get(quantity, {}).get("max") for quantity in shown)))
    if not names or not shown:
        return parts.empty_figure(title, NO_TRUTH if names else "no row has an estimate")
    figure, axes = parts.make_panel_grid(title, len(names), len(shown), (WIDTH, 1.3 + 3.1 * len(names)))
    for line, name in zip(axes, names, strict=True):
        for panel, quantity in zip(line, shown, strict=True):
            _draw_agreement(panel, rows, name, quantity)
    handles = [*parts.method_handles(rows), Line2D([], [], color=TRUTH, label="perfect"),
               Line2D([], [], color=TRUTH, linestyle=":", label="off by a factor of 2")]
    if any(row["status"] in BROKEN for row in rows):
        handles.append(Line2D([], [], color=INK3, label="unstable or lost", **parts.UNSTABLE_LOOK))
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
    return figure


def step_cost_figure(rows: Sequence[dict]) -> Figure:
    """Returns the time per particle-step of each method, and the added time of estimators and diagnostics."""
    title = "What a run costs"
    rows = [row for row in completed_rows(rows) if row["status"] == OK and row["rate"]]
    if not rows:
        return parts.empty_figure(title, "no run stood to its end")
    prices = _extra_costs(rows)
    figure, axes = parts.make_panel_grid(title, 1, 2, (WIDTH, max(4.6, 1.8 + 0.55 * len(prices))))
    _draw_step_costs(axes[0, 0], rows)
    _draw_extra_costs(axes[0, 1], prices)
    handles = [*parts.method_handles(rows), Line2D([], [], color=INK3, marker="|", markersize=16, markeredgewidth=2.5,
                                                   linestyle="none", label="median")]
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
    return figure


def error_time_step_figure(rows: Sequence[dict]) -> Figure:
    """Returns errors over dt, a line per method and h, with the dt at which time and space error are equal."""
    title = "Time step: where the error of time and the error of space balance"
    lines = [entry for entry in parts.series_styles(rows,
                                                    "dt") if len({row["scene"]["dt"] for row in entry[0].rows}) > 1]
    if not lines:
        return parts.empty_figure(title, "no grid was run with several time steps; give --dt or --cfl several values")
    shown = parts.known_quantities(rows, DRAWN)
    if not shown:
        return parts.empty_figure(title, NO_TRUTH)
    figure, axes = parts.make_panel_grid(title, 1, len(shown), (WIDTH, 6.0))
    for panel, quantity in zip(axes[0], shown, strict=True):
        _draw_balances(panel, lines, quantity)
    balanced = "time error = space error: shorter steps gain at most half"
    star = Line2D([], [], color=LINE2, label=balanced, **BALANCE_LOOK)
    fit = Line2D([], [], color=INK3, linewidth=1, linestyle="-", label="fit: space + c dt^p")
    parts.add_legend_below(figure, lines, [fit, star])
    return figure


def _draw_fits(axes: Axes, lines: Sequence[tuple[SingleInputSeries, dict]], quantity: str) -> None:
    """Draws the fitted power of h of each series' errors of a quantity, with the orders as legend if they are few.
    Errors that are not fitted are hollow."""
    handles = []
    for line, look in lines:
        fit = line.fit(quantity)
        if fit is not None:
            ends = np.array([line.rows[0]["h"], line.rows[-1]["h"]])
            axes.plot(ends, fit.at(ends), color=look["color"], linestyle=look["linestyle"], linewidth=1.0, zorder=2)
            unfitted = [(row["h"], error) for row in line.rows
                        if row["h"] in fit.left_out and row["status"] == OK and (error := error_of(row, quantity))]
            if unfitted:
                axes.plot(*zip(*unfitted, strict=True), **{**look, "linestyle": "none"}, **HOLLOW)
            label = f"no order: {fit.reason.partition(':')[0]}" if fit.reason else f"order {fit.order:.2f}"
            handles.append(Line2D([], [], **look, **(HOLLOW if fit.reason else {}), label=label))
    if handles and len(handles) <= MOST_ORDERS:
        bottom, top = axes.get_ylim()
        axes.set_ylim(bottom / (top / bottom) ** (0.055 * len(handles)), top)
        axes.legend(handles=handles, loc="lower right", fontsize=9)


def _draw_triangles(axes: Axes, points: Sequence[tuple[float, float | None]]) -> None:
    """Draws slopes 1 and 2 at small h and large errors; extends the axis if ``points`` (h, error) are there."""
    spacings = [h for h, _ in points]
    left, ratio = min(spacings), (max(spacings) / min(spacings)) ** 0.3
    right = left * ratio
    bottom, top = axes.get_ylim()
    below = min(top, max((error for h, error in points if error and h < 1.3 * right), default=bottom))
    top = max(top, 1.6 * below * ratio**2)
    axes.set_ylim(bottom, top * (top / bottom) ** 0.06)
    start = top / ratio**2
    for power in (1, 2):
        axes.plot([left, right, right, left], [start, start * ratio**power, start, start], color=INK3, linewidth=0.9)
        axes.text(right * 1.04, start * ratio ** (power - 0.5), str(power), color=INK3, fontsize=9.5, va="center")


def _draw_balances(axes: Axes, lines: Sequence[tuple[SingleInputSeries, Look]], quantity: str) -> None:
    """Draws the errors of a quantity over dt, their fits, and the dt at which time and space error are equal."""
    parts.draw_errors(axes, lines, quantity, lambda row: row["scene"]["dt"], joined=False)
    notes = []
    for line, look in lines:
        points = [(row["scene"]["dt"], error) for row in line.rows
                  if row["status"] == OK and (error := error_of(row, quantity))]
        found = fit_space_time([dt for dt, _ in points], [error for _, error in points])
        if found is None or found.misfit > MOST_MISFIT:
            notes += [NEITHER] * (found is not None)
            if points:
                axes.plot(*zip(*points, strict=True), color=look["color"], linestyle=look["linestyle"], linewidth=1)
            continue
        fine = np.geomspace(found.least, found.most, 60)
        axes.plot(fine, found.at(fine), color=look["color"], linestyle=look["linestyle"], linewidth=1, zorder=2)
        if found.dt:
            axes.plot([found.dt], found.at(np.array([found.dt])), color=look["color"], zorder=4, **BALANCE_LOOK)
        else:
            notes.append(SPACE if found.space_dominates else TIME)
    said = "".join(f"\n{note}" + ("" if number == len(lines) else f" ({number} of {len(lines)} series)")
                   for note in (SPACE, TIME, NEITHER) if (number := notes.count(note)))
    axes.set_title(axes.get_title("left") + said)
    axes.set_xlabel("time step dt")
    parts.set_log_axes(axes)


def _draw_agreement(axes: Axes, rows: Sequence[dict], estimator: str, quantity: str) -> None:
    """Draws an estimator's against the true error of a quantity, largest RMS of each run; unstable runs as crosses."""
    name = QUANTITIES[quantity]
    axes.set_title(f"{str(name).capitalize()} by {estimator}")
    axes.set_xlabel("true error", color=TRUTH_INK)
    axes.set_ylabel("estimated error", color=ESTIMATE_INK)
    axes.yaxis.set_major_formatter(UnitPrefixTickFormatter(name.unit))
    axes.set_box_aspect(1)
    points = []
    for row in rows:
        true, estimated = error_of(row, quantity), row["estimate"].get(estimator, {}).get(quantity, {}).get("max")
        if true and estimated:
            points.append((true, estimated, row["scene"]["method"], row["status"] in BROKEN))
    if not points:
        axes.set_axis_off()
        write_note(axes, "not estimated" if any(row["estimate"].get(estimator) for row in rows) else "not valid here")
        return
    # One range for both axes: the true errors of stable runs, and estimates within ``MOST_OFF`` of them.
    stood = [point for point in points if not point[3]] or points
    sizes = [point[0] for point in stood]
    least, most = min(sizes) / MOST_OFF, max(sizes) * MOST_OFF
    sizes += [float(np.clip(point[1], least, most)) for point in stood]
    low, high = min(sizes) / 2, max(sizes) * 2
    edge, far = (high / low) ** 0.025, 0
    for true, estimated, method, unstable in points:
        look: Look = {"marker": METHOD_MARKS[method], "linestyle": "none", "markersize": 6}
        x, y = np.clip([true, estimated], edge * low, high / edge)
        far += (x, y) != (true, estimated)
        axes.plot([x], [y], color=METHOD_COLOURS[method], zorder=3, alpha=0.9,
                  **(parts.UNSTABLE_LOOK if unstable else look))
    if far:
        axes.set_title(f"{str(name).capitalize()} by {estimator}\n{far} beyond the scale, drawn at its edge")
    ends = np.array([low, high])
    axes.plot(ends, ends, color=TRUTH, linewidth=1.4, zorder=2)
    for factor in (0.5, 2):
        axes.plot(ends, factor * ends, color=TRUTH, linewidth=0.9, linestyle=":", zorder=2)
    axes.set(xlim=(low, high), ylim=(low, high))
    parts.set_log_axes(axes, name.unit)


def _extra_costs(rows: Sequence[dict]) -> dict[str, list[tuple[str, float]]]:
    """Returns by estimator and diagnostic (method, added over bare run's time) per row; untimed ones are together."""
    prices: dict[str, list[tuple[str, float]]] = {}
    for row in rows:
        method, seconds = row["scene"]["method"], row["seconds"]
        single = {f"estimator {name}": value for name, value in seconds["estimators"].items()}
        single |= {f"effect {name}": value for name, value in seconds["effects"].items()}
        if not seconds["effects"]:
            single[REST] = seconds["full"] - seconds["min"] - sum(seconds["estimators"].values())
        for name, value in single.items():
            prices.setdefault(name, []).append((method, value / seconds["min"]))
    return prices


def _draw_step_costs(axes: Axes, rows: Sequence[dict]) -> None:
    for method in METHODS:
        points = [(row["particles"], 1e-6 / row["rate"]) for row in rows if row["scene"]["method"] == method]
        if points:
            axes.plot(*zip(*points, strict=True), color=METHOD_COLOURS[method], marker=METHOD_MARKS[method],
                      linestyle="none", markersize=6, alpha=0.9)
    axes.set_title("A step of the bare method, time for one particle")
    axes.set_xlabel("particles")
    parts.set_log_axes(axes, "")
    axes.set(yscale="linear", ylim=(0, 1.15 * max(1e-6 / row["rate"] for row in rows)))
    format_size_axis(axes.yaxis, "s")
    parts.set_ticks_at(axes, sorted({row["particles"] for row in rows}))


def _draw_extra_costs(axes: Axes, prices: dict[str, list[tuple[str, float]]]) -> None:
    axes.set_title("On top of it, as a part of the bare run's time")
    # The range of most prices, so that a disturbed run does not compress the others; outliers are at the edge.
    low, high = np.percentile([100 * part for points in prices.values() for _, part in points], (10, 90))
    high = max(1.6 * high, 10.0)
    low = min(1.6 * low, -0.08 * high)
    for height, points in enumerate(prices.values()):
        for method, part in points:
            place = height + 0.3 * ((list(METHODS).index(method) + 0.5) / len(METHODS) - 0.5) * 1.6
            outside = "<" if 100 * part < low else ">" if 100 * part > high else ""
            axes.plot([min(max(100 * part, low), high)], [place], color=METHOD_COLOURS[method], linestyle="none",
                      marker=outside or METHOD_MARKS[method], markersize=5, alpha=0.8, zorder=3, clip_on=False)
        middle = 100 * statistics.median(part for _, part in points)
        axes.plot([middle], [height], color=INK3, marker="|", markersize=30, markeredgewidth=2.5, zorder=2)
        axes.text(middle, height + 0.36, f"{middle:.0f} %", ha="center", va="bottom", color=INK)
    axes.axvline(0, color=LINE2, linewidth=1)
    axes.set_yticks(range(len(prices)), list(prices))
    for tick, name in zip(axes.get_yticklabels(), prices, strict=True):
        tick.set_color(ESTIMATE_INK if name.startswith("estimator") else INK2)
    axes.grid(visible=False, axis="y")
    axes.grid(axis="x")
    axes.set(xlabel="added time (% of the bare run)", xlim=(low, high), ylim=(-0.6, len(prices) - 0.4))


#: The pictures of a study by the names of their files.
FIGURES: dict[str, Callable[[Sequence[dict]], Figure]] = {
    "error-time": error_run_time_figure, "error-h": error_spacing_figure, "estimate-truth": estimate_truth_figure,
    "cost": step_cost_figure, "error-dt": error_time_step_figure}
