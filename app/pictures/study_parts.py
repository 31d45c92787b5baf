"""What the pictures of a study share: frames, how a series looks, unstable points, legends, words."""

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogFormatterSciNotation, LogLocator, NullFormatter

from app.colours import INK3, LINE, METHOD_COLOURS, METHOD_MARKS
from app.renderers.look import Sizes, sheet
from app.renderers.picture import Look, say
from app.words import METHODS, QUANTITIES, with_unit
from solvers.solver.soundness import BROKEN
from solvers.study.fit import Series, error_of, measured, series

LINE_STYLES = ("-", "--", ":", "-.")
MOST_LEGEND_ENTRIES = 12
LEGEND_WIDTH = 190  # letters
MOST_TICKS = 8
UNSTABLE_ROOM = 30.0  # times the largest error of a stable run: up to there an unstable one is drawn where it is
TOP = 0.97  # of the axes: where an unstable run goes whose error is beyond that, or not a number
UNSTABLE_LOOK: Look = {"marker": "x", "linestyle": "none", "markersize": 9, "markeredgewidth": 2.2}


def frame(title: str, rows: int, columns: int, size: tuple[float, float]) -> tuple[Figure, np.ndarray]:
    figure = sheet(*size, title)
    return figure, figure.subplots(rows, columns, squeeze=False)


def nothing(title: str, sentence: str) -> Figure:
    figure, axes = frame(title, 1, 1, (8.0, 2.5))
    axes[0, 0].set_axis_off()
    say(axes[0, 0], f"nothing to show: {sentence}")
    return figure


def known(rows: Sequence[dict], among: Iterable[str] = QUANTITIES) -> list[str]:
    """The quantities of which some row knows an error."""
    return [q for q in among if any(error_of(row, q) for row in measured(rows))]


def lined(rows: Sequence[dict], along: str = "cells") -> list[tuple[Series, Look]]:
    """Each series and how it is drawn: colour and mark say the method, line style and filling what else differs."""
    lines = series(rows, along)
    numbers = {variant: k for k, variant in enumerate(dict.fromkeys(line.variant for line in lines))}
    return [(line, {"color": METHOD_COLOURS[line.method], "marker": METHOD_MARKS[line.method], "markersize": 6,
                    "linewidth": 1.3, "linestyle": LINE_STYLES[(k := numbers[line.variant]) % len(LINE_STYLES)],
                    "fillstyle": ("full", "none")[k // len(LINE_STYLES) % 2]}) for line in lines]


def draw_errors(axes: Axes, lines: Sequence[tuple[Series, Look]], quantity: str, abscissa: Callable[[dict], float],
                joined: bool = True) -> None:
    """The errors of each series; crosses for runs that went unstable, at the top edge where the error is far out."""
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
    axes.yaxis.set_major_formatter(Sizes(QUANTITIES[quantity].unit))


def method_handles(rows: Iterable[dict]) -> list[Line2D]:
    """The methods of the rows, as they stand in a legend."""
    there = {row["scene"]["method"] for row in rows}
    return [Line2D([], [], color=METHOD_COLOURS[m], marker=METHOD_MARKS[m], linestyle="none", label=METHODS[m].name)
            for m in METHODS if m in there]


def legend_below(figure: Figure, entries: Sequence[tuple[Series, Look]], extra: Sequence[Line2D] = ()) -> None:
    """One legend for all panels, below them, where it hides nothing."""
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


def logarithmic(axes: Axes, unit: str = "s") -> None:
    """Both axes logarithmic, with lines at the powers of ten, and at 2 and 5 times those where an axis has one at
    most; sizes along the horizontal one are in ``unit``."""
    across = axes.yaxis.get_major_formatter()
    axes.set(xscale="log", yscale="log")
    axes.grid(axis="both", color=LINE)
    for axis, sizes in ((axes.xaxis, Sizes(unit)), (axes.yaxis, across)):
        low, high = axis.get_view_interval()
        few = low > 0 and np.floor(np.log10(high)) - np.ceil(np.log10(low)) < 1
        axis.set_major_locator(LogLocator(subs=(1, 2, 5) if few else (1,)))
        axis.set_major_formatter(sizes if isinstance(sizes, Sizes) else LogFormatterSciNotation())
        axis.set_minor_formatter(NullFormatter())


def ticks_at(axes: Axes, values: Sequence[float], unit: str = "") -> None:
    """The abscissae that there are as the only ticks, if they are few."""
    if len(values) <= MOST_TICKS:
        axes.set_xticks(values, [with_unit(value, unit) if unit else f"{value:,.6g}" for value in values])
        axes.xaxis.set_minor_formatter(NullFormatter())
