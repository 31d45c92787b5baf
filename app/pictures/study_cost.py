"""What things cost: a step of each method, and each estimator and effect on top of it."""

import statistics
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from app.colours import ESTIMATE, METHOD_COLOURS, METHOD_MARKS
from app.pictures.study_parts import frame, logarithmic, method_handles, nothing, ticks_at
from app.words import METHODS
from solvers.solver.soundness import OK
from solvers.study.series import measured

REST = "everything else\nthat was measured"


def cost_figure(rows: Sequence[dict]) -> Figure:
    """Nanoseconds of a particle-step of each method, and the price of whatever came on top of it."""
    title = "What a run costs"
    rows = [row for row in measured(rows) if row["status"] == OK and row["rate"]]
    if not rows:
        return nothing(title, "no run stood to its end")
    prices = extra_prices(rows)
    figure, axes = frame(title, 1, 2, (13.5, max(4.6, 1.8 + 0.55 * len(prices))))
    _steps(axes[0, 0], rows)
    _extras(axes[0, 1], prices)
    handles = [*method_handles(rows), Line2D([], [], color="0.3", marker="|", markersize=16, markeredgewidth=2.5,
                                             linestyle="none", label="median")]
    figure.legend(handles=handles, loc="outside lower center", fontsize=9, frameon=False, ncols=len(handles))
    return figure


def extra_prices(rows: Sequence[dict]) -> dict[str, list[tuple[str, float]]]:
    """For each estimator and effect: (method, seconds added over seconds of the bare run) of every row. Effects not
    timed alone are known together, as what is left of the whole run."""
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


def _steps(axes: Axes, rows: Sequence[dict]) -> None:
    for method in METHODS:
        points = [(row["particles"], 1e3 / row["rate"]) for row in rows if row["scene"]["method"] == method]
        if points:
            axes.plot(*zip(*points, strict=True), color=METHOD_COLOURS[method], marker=METHOD_MARKS[method],
                      linestyle="none", markersize=6, alpha=0.9)
    axes.set_title("a step of the bare method", fontsize=10)
    axes.set(xlabel="particles", ylabel="time of one step of one particle (ns)")
    logarithmic(axes)
    axes.set(yscale="linear", ylim=(0, 1.15 * max(1e3 / row["rate"] for row in rows)))
    ticks_at(axes, sorted({row["particles"] for row in rows}))


def _extras(axes: Axes, prices: dict[str, list[tuple[str, float]]]) -> None:
    axes.set_title("on top of it, as a part of the bare run's time", fontsize=10)
    low, high = _span([100 * part for points in prices.values() for _, part in points])
    for height, points in enumerate(prices.values()):
        for method, part in points:
            place = height + 0.3 * ((list(METHODS).index(method) + 0.5) / len(METHODS) - 0.5) * 1.6
            outside = "<" if 100 * part < low else ">" if 100 * part > high else ""
            axes.plot([min(max(100 * part, low), high)], [place], color=METHOD_COLOURS[method], linestyle="none",
                      marker=outside or METHOD_MARKS[method], markersize=5, alpha=0.8, zorder=3, clip_on=False)
        middle = 100 * statistics.median(part for _, part in points)
        axes.plot([middle], [height], color="0.3", marker="|", markersize=30, markeredgewidth=2.5, zorder=2)
        axes.text(middle, height + 0.36, f"{middle:.0f} %", ha="center", va="bottom", fontsize=9, color="0.2")
    axes.axvline(0, color="0.5", linewidth=1)
    axes.set_yticks(range(len(prices)), list(prices))
    for tick, name in zip(axes.get_yticklabels(), prices, strict=True):
        tick.set_color(ESTIMATE if name.startswith("estimator") else "0.2")
    axes.grid(alpha=0.3, axis="x")
    axes.set(xlabel="added time (% of the bare run)", xlim=(low, high), ylim=(-0.6, len(prices) - 0.4))


def _span(percents: Sequence[float]) -> tuple[float, float]:
    """Most of the prices; a run that was disturbed must not squeeze the others. What is outside is at the edge."""
    low, high = np.percentile(percents, (10, 90))
    high = max(1.6 * high, 10.0)
    return min(1.6 * low, -0.08 * high), high
