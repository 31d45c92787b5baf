"""The error budget over time: each cause's contribution, stacked, and the error as a line."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, MaxNLocator

from app.colour_palette import CAUSES as COLOURS
from app.colour_palette import INK, INK2, INK3, PINNED
from app.frame.budget_chart_data import CAPTION, UNITS, error_rms, format_percent, largest_share, stack_layers
from app.names_and_units import method_name, motion_text
from app.renderers.picture_style import FEW, format_size_axis, make_figure
from solvers.running.result import Result
from solvers.scene.error_causes import FIELDS, cause_labels
from solvers.solver.budget_shares import has_crossed

if TYPE_CHECKING:
    from solvers.running.budget_cause_removal import CauseRemovalResult  # needs Taichi, which a picture need not import

WIDTH, HEIGHT, MORE = 12.5, 4.4, 2.6  # inches; the last for the bars of a removed cause
BARS = {"before": "as it was", "predicted": "predicted by the budget", "again": "run again without it"}


def budget_figure(found: CauseRemovalResult) -> Figure:
    """Returns the budget of x, v and F over time; below, for a removed cause, errors before, predicted and after."""
    taken, labels = found.take_away(), cause_labels(has_crossed(found.result.series))
    figure = make_figure(WIDTH, HEIGHT + (MORE if taken else 0), _figure_title(found.result))
    places = figure.add_gridspec(2 if taken else 1, 3, height_ratios=(HEIGHT, MORE) if taken else (1,))
    draw_budget([figure.add_subplot(places[0, k]) for k in range(len(FIELDS))], found.result.series)
    if taken:
        for k, field in enumerate(FIELDS):
            _draw_removal_bars(figure.add_subplot(places[1, k]), taken, field, labels[taken["class"]], named=k == 0)
    add_cause_legend(figure, found.result.series)
    return figure


def draw_budget(panels: Sequence[Axes], series: Mapping[str, np.ndarray]) -> None:
    """Draws the errors of x, v and F over time as stacked parts by cause, on one of three ``panels`` each; ``series``
    are the samples by name of a run with the diagnostic budget."""
    for axes, field in zip(panels, FIELDS, strict=True):
        for layer in stack_layers(series, field):
            for edges in (layer.above, layer.below):
                axes.fill_between(series["time"], *edges, color=COLOURS[layer.cause].light, linewidth=0)
        axes.plot(series["time"], error_rms(series, field), color=INK, linewidth=1.4)
        axes.axhline(0, color=INK, linewidth=0.6)
        most = largest_share(series, field)
        made = f": {cause_labels(has_crossed(series))[most[0]]} made {format_percent(most[1])}" if most else ""
        axes.set_title(f"Error of {field}, RMS{made}")
        axes.margins(x=0)
        if UNITS[field]:
            format_size_axis(axes.yaxis, UNITS[field])
        else:
            axes.yaxis.set_major_locator(MaxNLocator(FEW, steps=[1, 2, 2.5, 5, 10]))
            axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.3g}".replace("-", "\u2212")))
        format_size_axis(axes.xaxis, "s", few=False)


def add_cause_legend(figure: Figure, series: Mapping[str, np.ndarray],
                     where: Literal["upper", "lower"] = "upper") -> None:
    """Adds a legend of the causes' colours at the upper or lower edge of a figure of a run with these samples, and a
    caption at the bottom."""
    labels = cause_labels(has_crossed(series))
    handles = [Patch(color=COLOURS[cause].light, label=name) for cause, name in labels.items()]
    figure.legend(handles=handles, loc="outside upper right" if where == "upper" else "outside lower right",
                  ncols=len(handles))
    words = textwrap.wrap(CAPTION, 150 if where == "upper" else 85)  # characters: the legend is beside them
    figure.supxlabel("\n".join(words), x=0.012, ha="left", fontsize=10, color=INK2)


def _draw_removal_bars(axes: Axes, taken: dict, field: str, cause: str, named: bool) -> None:
    """Draws bars of a field's error before, predicted and after the ``cause`` was removed, in per cent of that before.
    ``taken`` is from ``BudgetResult.take_away``; the bars have names if ``named``."""
    before = taken["before"][field] or 1.0
    shares = [100 * (taken[key][field] or 0.0) / before for key in BARS]
    axes.barh(list(BARS.values())[::-1], shares[::-1], color=[INK, PINNED, INK3], height=0.6)
    for k, share in enumerate(shares[::-1]):
        axes.text(share, k, f" {share:.3g} %", va="center", color=INK2, fontsize=10)
    axes.set_xlim(0, 1.25 * max(shares))
    axes.set_title(f"{field} without {cause}")
    axes.set_xticks([])
    axes.tick_params(labelleft=named)
    axes.grid(False)


def _figure_title(result: Result) -> str:
    scene = result.scene
    lp = ", linearity preserving" if scene.linearity_preserving else ""
    swing = f"A = {scene.amplitude:g} m" if "amplitude" in scene.motion_fields else motion_text(scene)
    said = [f"Who made this error? {scene.problem.capitalize()}, {method_name(scene.method)}{lp} · {scene.cells} cells "
            f"· {swing} · body force {scene.body_force}"]
    values = result.budget
    assert values is not None
    if values["reference"] == "companion":
        said.append("Against the companion: the exact solution was not looked at")
    return "\n".join([*said, *textwrap.wrap(values["not_valid"] or "", 130)])
