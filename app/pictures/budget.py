"""The error budget over time: what each cause has made of the error, stacked, with the error itself on top."""

import textwrap
from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, MaxNLocator

from app.colours import CAUSES as COLOURS
from app.colours import INK, INK2, INK3, PINNED
from app.renderers.look import FEW, in_sizes, sheet
from app.words import method_name, moving
from solvers.running.budget import BudgetResult
from solvers.scene.causes import CAUSES, FIELDS
from solvers.solver.result import Result

WIDTH, HEIGHT, MORE = 12.5, 4.4, 2.6  # inches; the last for the bars of what was taken away
CAPTION = ("The black line is the error; each colour is the part of it that one cause has made, below zero where it "
           "makes it smaller.")
UNITS = {"x": "m", "v": "m/s", "F": ""}
SEEN = 2e-3  # of the largest error: a cause that never makes more is not drawn
BARS = {"before": "as it was", "predicted": "predicted by the budget", "again": "run again without it"}


def budget_figure(found: BudgetResult) -> Figure:
    """x, v and F over time; below, of a cause that was taken away, the errors before, as predicted and as they came."""
    taken = found.take_away()
    figure = sheet(WIDTH, HEIGHT + (MORE if taken else 0), _title(found.result))
    places = figure.add_gridspec(2 if taken else 1, 3, height_ratios=(HEIGHT, MORE) if taken else (1,))
    draw_budget([figure.add_subplot(places[0, k]) for k in range(len(FIELDS))], found.result.series)
    if taken:
        for k, field in enumerate(FIELDS):
            _bars(figure.add_subplot(places[1, k]), taken, field, named=k == 0)
    handles = [Patch(color=COLOURS[cause].light, label=name) for cause, name in CAUSES.items()]
    figure.legend(handles=handles, loc="outside upper right", ncols=len(handles))
    figure.supxlabel("\n".join(textwrap.wrap(CAPTION, 130)), x=0.012, ha="left", fontsize=10, color=INK2)
    return figure


def draw_budget(panels: Sequence[Axes], series: Mapping[str, np.ndarray]) -> None:
    """The stacked parts of the error of each field, one to a panel; ``series`` of a run with the effect budget."""
    for axes, field in zip(panels, FIELDS, strict=True):
        time, error = series["time"], series[f"budget/error_{field}"]
        error = np.where(np.isfinite(error), error, np.nan)
        above, below = np.zeros_like(time), np.zeros_like(time)
        largest = float(np.nanmax(error, initial=0.0))
        for cause in CAUSES:
            part = np.nan_to_num(series[f"budget/part_{field}_{cause}"], posinf=0.0, neginf=0.0)
            if np.abs(part).max(initial=0.0) <= SEEN * largest:
                continue
            up, down = np.maximum(part, 0), np.minimum(part, 0)
            for base, piece in ((above, up), (below, down)):
                axes.fill_between(time, base, base + piece, color=COLOURS[cause].light, linewidth=0)
            above, below = above + up, below + down
        axes.plot(time, error, color=INK, linewidth=1.4)
        axes.axhline(0, color=INK, linewidth=0.6)
        axes.set_title(f"Error of {field}, RMS over particles")
        axes.margins(x=0)
        if UNITS[field]:
            in_sizes(axes.yaxis, UNITS[field])
        else:
            axes.yaxis.set_major_locator(MaxNLocator(FEW, steps=[1, 2, 2.5, 5, 10]))
            axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.3g}".replace("-", "\u2212")))
        in_sizes(axes.xaxis, "s", few=False)


def _bars(axes: Axes, taken: dict, field: str, named: bool) -> None:
    """The error before, as predicted without the cause, and as it came, in per cent of that before."""
    before = taken["before"][field] or 1.0
    shares = [100 * (taken[key][field] or 0.0) / before for key in BARS]
    axes.barh(list(BARS.values())[::-1], shares[::-1], color=[INK, PINNED, INK3], height=0.6)
    for k, share in enumerate(shares[::-1]):
        axes.text(share, k, f" {share:.3g} %", va="center", color=INK2, fontsize=10)
    axes.set_xlim(0, 1.25 * max(shares))
    axes.set_title(f"{field} without {CAUSES[taken['class']]}")
    axes.set_xticks([])
    axes.tick_params(labelleft=named)
    axes.grid(False)


def _title(result: Result) -> str:
    scene = result.scene
    lp = ", linearity preserving" if scene.linearity_preserving else ""
    swing = f"A = {scene.amplitude:g} m" if scene.swings else moving(scene)
    said = [f"Who made this error? {scene.problem.capitalize()}, {method_name(scene.method)}{lp} · {scene.cells} cells "
            f"· {swing} · body force {scene.body_force}"]
    values = result.budget()
    assert values is not None
    if values["reference"] == "companion":
        said.append("Against the companion: the exact solution was not looked at")
    return "\n".join([*said, *textwrap.wrap(values["not_valid"] or "", 130)])
