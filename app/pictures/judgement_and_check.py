"""Pictures of a judgement: norms over time, the error in space, and largest errors over the cell size; and of ``mpm-lab
check``: the particles, their distances from their neighbours, and those with contradictions."""

from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from app.colour_palette import COLOUR_MAP, ESTIMATE, INK, METHOD_COLOURS, METHOD_MARKS, TRUTH
from app.names_and_units import QUANTITIES, method_name
from app.renderers import picture_panel_style
from app.renderers.picture_panel_style import positive_or_gap, random_subsample_indices, write_note
from app.renderers.picture_style import format_size_axis
from solvers.judging.check import MotionCheckResult
from solvers.judging.error_norms import QUANTITIES as JUDGED
from solvers.judging.error_norms import error_magnitudes, norm_series
from solvers.judging.findings.neighbour_comparison import departures
from solvers.judging.judgement import Judgement, SingleGridJudgement
from solvers.solver.error_series import largest_finite_or_none

THEIRS = INK
MARKS = "os^Dv"


def norms_figure(judged: Judgement) -> Figure:
    """Returns each quantity's RMS error over time on logarithmic axes, a line per grid; the companion's is dashed."""
    figure = Figure(figsize=(10, 7.5), layout="constrained")
    for axes, q in zip(figure.subplots(len(JUDGED), 1, sharex=True), JUDGED, strict=True):
        for k, g in enumerate(judged.grids):
            _draw_norms(axes, g, q, k, len(judged.grids))
        axes.set_title(f"Error of {QUANTITIES[q]}" + ", RMS over particles" * (q == JUDGED[0]))
        if _note_if_nothing_to_show(axes):
            continue
        axes.set_yscale("log")
        format_size_axis(axes.yaxis, QUANTITIES[q].unit)
    first = figure.axes[0]
    if first.get_legend_handles_labels()[0]:
        figure.legend(*first.get_legend_handles_labels(), loc="outside lower center", ncols=4)
    figure.axes[-1].set_xlabel("time t")
    format_size_axis(figure.axes[-1].xaxis, "s", few=False)
    return figure


def _note_if_nothing_to_show(axes: Axes) -> bool:
    """Returns whether no line on the axes has a finite value; then writes a note there."""
    if any(np.isfinite(line.get_ydata()).any() for line in axes.lines):
        return False
    axes.set_yticks([])
    write_note(axes, "not in the files, or zero")
    return True


def _draw_norms(axes: Axes, g: SingleGridJudgement, q: str, k: int, count: int) -> None:
    """Draws the true norm of a quantity's error and the companion's over time, of the grid k of ``count``."""
    shade = 1.0 if count == 1 else 0.35 + 0.65 * (k + 1) / count
    mark = MARKS[k % len(MARKS)] if len(g.grid.times) <= 12 else None
    lines = [("truth", norm_series(g.true_errors)[q], TRUTH, "-")] if g.true_errors else []
    lines.append(("companion", norm_series(g.companion_errors)[q], ESTIMATE, "--"))
    for label, values, colour, style in lines:
        moved = g.grid.times > 0  # the initial error is round-off, far below all others
        values, times = positive_or_gap(values[moved]), g.grid.times[moved]
        if np.isfinite(values).any():
            axes.plot(times, values, color=colour, linestyle=style, marker=mark, markersize=5, alpha=shade,
                      linewidth=1.4, label=f"{label}, {g.grid.cells} cells")


def spatial_error_figure(judged: Judgement) -> Figure | None:
    """Returns the last grid's errors of x when they are largest: over X on the bar, coloured in the plane; or None."""
    g = judged.grids[-1]
    worst = g.worst("x")
    if worst is None:
        return None
    frame, errors = next((f, e) for f, e in zip(g.grid.frames, g.best_known_errors, strict=True)
                         if f.time == worst.time)
    size = error_magnitudes(errors["x"])
    few = np.union1d(random_subsample_indices(len(size)), [int(np.argmax(size))])
    X, x, shown = frame.material_position[few], frame.position[few], size[few]
    outliers = g.position_outliers
    alone = np.isin(few, outliers.which if outliers and outliers.frame.time == frame.time else [])
    figure = Figure(figsize=(10, 4) if X.shape[1] == 1 else (10, 8.5), layout="constrained")
    axes = figure.subplots()
    axes.set_title(f"Error of x at t = {frame.time:.4g} s, {g.grid.cells} cells")
    if X.shape[1] == 1:
        axes.scatter(X[:, 0], shown, s=10, color=THEIRS, linewidths=0)
        axes.set(xlabel="material position X", ylim=(0, 1.1 * float(shown.max()) or 1))
        format_size_axis(axes.yaxis, "m")
        ring = axes.scatter(X[alone, 0], shown[alone], s=60, facecolors="none", edgecolors=ESTIMATE)
    else:
        top = Normalize(0.0, float(shown.max()) or 1.0)
        points = axes.scatter(x[:, 0], x[:, 1], c=shown, cmap=COLOUR_MAP, norm=top, linewidths=0,
                              s=float(np.clip(40_000 / len(few), 2, 40)))
        axes.set(xlabel="x", ylabel="y", aspect="equal")
        axes.grid(axis="both")
        format_size_axis(axes.yaxis, "m", few=False)
        picture_panel_style.add_colour_bar(figure, points, axes, "error of x", "m", aspect=60)
        ring = axes.scatter(x[alone, 0], x[alone, 1], s=60, facecolors="none", edgecolors=ESTIMATE)
    format_size_axis(axes.xaxis, "m", few=False)
    if alone.any():
        ring.set_label("not where the neighbours are")
        axes.legend(loc="upper right")
    return figure


def order_figure(judged: Judgement) -> Figure | None:
    """Returns the largest errors of the particles and of our methods over h, by quantity; None with one grid alone."""
    ours = any(g.ours for g in judged.grids)
    if len(judged.grids) < 2 and not ours:
        return None
    figure = Figure(figsize=(11, 4.2), layout="constrained")
    for axes, q in zip(figure.subplots(1, len(JUDGED)), JUDGED, strict=True):
        h = [g.scene.spacing for g in judged.grids]
        here = np.array([largest_finite_or_none(g.norms[q]) for g in judged.grids], dtype=float)  # None becomes NaN
        axes.plot(h, positive_or_gap(here), "o-", color=THEIRS, linewidth=2, markersize=7, label="these particles")
        if fit := judged.orders[q]:
            axes.plot(h, np.where(np.isin(h, fit.left_out), positive_or_gap(here), np.nan), "o", color=THEIRS,
                      markersize=7, markerfacecolor="white",
                      label="tells nothing of the order" if fit.left_out else None)
        lines: dict[tuple[str, bool], list[tuple[float, float]]] = {}
        for g in judged.grids:
            for run in g.ours:
                if run.status == "ok" and (value := largest_finite_or_none(run.norms[q])):
                    name = run.scene.method, run.scene.linearity_preserving
                    lines.setdefault(name, []).append((g.scene.spacing, value))
        for (method, lp), at in lines.items():
            axes.plot(*zip(*at, strict=True), marker=METHOD_MARKS[method], color=METHOD_COLOURS[method], linewidth=1,
                      markersize=5, linestyle="--" if lp else "-", alpha=0.8,
                      label=f"our {method_name(method)}{', linearity preserving' * lp}")
        axes.set(xlabel="cell size h", title=f"Largest error of {QUANTITIES[q].symbol}")
        if _note_if_nothing_to_show(axes):
            axes.set_xticks([])
            continue
        axes.set(xscale="log", yscale="log")
        axes.grid(axis="both")
        if len(set(h)) == 1:
            axes.set_xlim(h[0] / 1.5, h[0] * 1.5)
        format_size_axis(axes.xaxis, "m")
        format_size_axis(axes.yaxis, QUANTITIES[q].unit)
    entries = {label: line for axes in figure.axes
               for line, label in zip(*axes.get_legend_handles_labels(), strict=True)}
    figure.legend(entries.values(), entries, loc="outside lower center", ncols=4)
    return figure


FIGURES: dict[str, Callable[[Judgement], Figure | None]] = {
    "norms": norms_figure, "space": spatial_error_figure, "order": order_figure}


def motion_check_figure(checked: MotionCheckResult) -> Figure | None:
    """Returns displacements over X (1D) or positions at the first contradiction, else at the end, coloured by distance
    from the neighbours' plane; None where particles have no known neighbours."""
    motion = checked.motion.representative_part
    if motion.neighbourhood is None:
        return None
    named = [one for one in checked.contradictions if one.time is not None and one.particle is not None]
    moment = int(np.argmin(np.abs(motion.times - named[0].time))) if named else len(motion.times) - 1
    with np.errstate(all="ignore"):
        far = np.nan_to_num(departures(motion.neighbourhood, motion.x[moment] - motion.reference), posinf=0.0)
    few = random_subsample_indices(len(far))
    figure = Figure(figsize=(10, 4.5) if motion.dimensions == 1 else (10, 8), layout="constrained")
    axes = figure.subplots()
    axes.set_title(f"Particles at t = {motion.times[moment]:.4g} s, verdict: {checked.verdict}")
    x = motion.x[moment]
    along, across = (motion.reference[:, 0], x[:, 0] - motion.reference[:, 0]) if motion.dimensions == 1 else (
        x[:, 0], x[:, 1])
    points = axes.scatter(along[few], across[few], c=far[few], cmap=COLOUR_MAP, linewidths=0,
                          norm=Normalize(0.0, float(far.max()) or 1.0), s=float(np.clip(40_000 / len(few), 2, 40)))
    axes.set(xlabel="X" if motion.dimensions == 1 else "x", ylabel="x - X" if motion.dimensions == 1 else "y")
    if motion.dimensions > 1:
        axes.set_aspect("equal")
    who = np.flatnonzero(np.isin(motion.number, np.array([one.particle for one in named], dtype=float)))
    if len(who):
        axes.scatter(along[who], across[who], s=80, facecolors="none", edgecolors=ESTIMATE, label="named in the report")
        axes.legend(loc="upper right")
    axes.grid(axis="both")
    format_size_axis(axes.xaxis, "m", few=False)
    format_size_axis(axes.yaxis, "m", few=False)
    picture_panel_style.add_colour_bar(figure, points, axes, "from a plane through the neighbours", "m", aspect=60)
    return figure


CHECKED: dict[str, Callable[[MotionCheckResult], Figure | None]] = {"places": motion_check_figure}
