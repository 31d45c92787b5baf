"""Style of all pictures: the page's font, few lines, sizes with units. Importing it changes matplotlib's settings."""

import io
from collections.abc import Sequence
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.font_manager import FontEntry, fontManager
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.ticker import Formatter, LogLocator, MaxNLocator, NullFormatter

from app.colour_palette import INK, INK2, LINE, LINE2
from app.logo_and_font import FONTS
from app.names_and_units import with_unit

FAMILY = "Lab Inter"
TRUTH_WIDTH, ESTIMATE_WIDTH = 2.6, 1.3  # points: the truth is wide, estimates are drawn on top
FEW = 3  # approximate number of grid lines

for _name, _weight in (("Inter-Regular.otf", 400), ("Inter-SemiBold.otf", 700)):  # the bold weight
    fontManager.ttflist.append(FontEntry(fname=str(FONTS / _name), name=FAMILY, weight=_weight))
SETTINGS: Any = {
    "font.family": [FAMILY, "DejaVu Sans"], "font.size": 11, "text.hinting": "none",
    "mathtext.fontset": "custom", "mathtext.rm": FAMILY, "mathtext.it": FAMILY, "mathtext.bf": f"{FAMILY}:bold",
    "mathtext.cal": FAMILY, "text.color": INK, "axes.labelcolor": INK2, "axes.labelsize": 10.5,
    "axes.titlecolor": INK, "axes.titlesize": 11, "axes.titleweight": "bold", "axes.titlelocation": "left",
    "axes.titlepad": 8, "figure.titleweight": "bold", "axes.spines.top": False, "axes.spines.right": False,
    "axes.spines.left": False, "axes.edgecolor": LINE2, "axes.grid": True, "axes.grid.axis": "y",
    "axes.axisbelow": True, "grid.color": LINE, "grid.linewidth": 0.9, "xtick.color": LINE2, "ytick.color": LINE2,
    "xtick.labelcolor": INK2, "ytick.labelcolor": INK2, "xtick.labelsize": 10, "ytick.labelsize": 10,
    "xtick.major.size": 4, "ytick.major.size": 0, "xtick.minor.size": 0, "ytick.minor.size": 0,
    "legend.frameon": False, "legend.labelcolor": INK2, "legend.fontsize": 10, "lines.solid_capstyle": "round"}
matplotlib.rcParams.update(SETTINGS)


class UnitPrefixTickFormatter(Formatter):
    """Formats ticks with one prefix, and the unit at the last (0, 100, 200 µm) or, on a logarithmic axis, at each."""

    def __init__(self, unit: str):
        self.unit = unit

    def format_ticks(self, values: Sequence[float]) -> list[str]:
        assert isinstance(self.axis, Axis)
        low, high = sorted(self.axis.get_view_interval())
        slack = 1e-9 * (high - low)
        there = [value for value in values if low - slack <= value <= high + slack]
        if self.axis.get_scale() == "log":
            return [with_unit(value, self.unit).strip() if value > 0 else "" for value in values]
        largest = max(map(abs, there), default=0.0)
        number, _, unit = with_unit(largest, self.unit).partition(" ")
        times = float(number) / largest if largest else 1.0
        last = max(there, default=None)
        return [f"{times * value:.4g} {unit}".strip().replace("-", "−") if value == last
                else f"{times * value:.4g}".replace("-", "−") for value in values]

    def __call__(self, value: float, position: int | None = None) -> str:
        return with_unit(value, self.unit).strip()


def format_size_axis(axis: Axis, unit: str, few: bool = True) -> None:
    """Formats the sizes on an axis with set scale and limits, with about three grid lines, or more unless ``few``."""
    axis.set_major_formatter(UnitPrefixTickFormatter(unit))
    axis.set_minor_formatter(NullFormatter())
    if axis.get_scale() == "log":
        low, high = axis.get_view_interval()
        powers = np.floor(np.log10(high)) - np.ceil(np.log10(low)) + 1 if low > 0 else FEW
        axis.set_major_locator(LogLocator(subs=(1, 2, 5) if powers < 2 else (1,), numticks=FEW + 2))
    elif few:
        axis.set_major_locator(MaxNLocator(FEW, steps=[1, 2, 2.5, 5, 10]))


def label_curve_ends(axes: Axes, named: Sequence[tuple[str, np.ndarray, str]], apart: float = 0.14) -> None:
    """Writes curves' names at their right ends, in place of a legend. ``axes`` has scales and limits; ``named`` has
    each curve's name, ordinates and text colour; names are ``apart`` or more, as a fraction of the axes' height."""
    to_share = axes.transScale + axes.transLimits
    ends: list[tuple[float, str, str]] = []
    for name, values, colour in named:
        known = values[np.isfinite(values)]
        if len(known):
            share = float(to_share.transform((axes.get_xlim()[1], known[-1]))[1])
            ends.append((float(np.clip(share, 0.0, 1.0)), name, colour))
    ends.sort()
    heights = np.array([share for share, _, _ in ends])
    for _ in range(50):  # neighbours that are too close move by half each
        near = apart - np.diff(heights)
        push = np.where(near > 0, near / 2, 0.0)
        heights[1:] += push
        heights[:-1] -= push
        heights = np.clip(heights, 0.0, 1.0)
    for height, (_, name, colour) in zip(heights, ends, strict=True):
        axes.text(1.012, height, name, transform=axes.transAxes, color=colour, va="center", fontsize=10,
                  fontweight="bold")


class NotebookFigure(Figure):
    """Figure with the pictures' style, whatever matplotlib's settings are when a notebook shows it."""

    def savefig(self, *arguments: Any, **options: Any) -> None:
        with matplotlib.rc_context(SETTINGS):
            super().savefig(*arguments, **options)

    def _repr_png_(self) -> bytes:
        picture = io.BytesIO()
        self.savefig(picture, format="png")
        return picture.getvalue()


def make_figure(width: float, height: float, title: str) -> NotebookFigure:
    """Returns an empty figure of a width and height in inches, with a title at its upper left."""
    figure = NotebookFigure(figsize=(width, height), layout=ConstrainedLayoutEngine(w_pad=0.1, h_pad=0.08))
    figure.suptitle(title, x=0.012, ha="left", fontsize=13, linespacing=1.4)
    return figure
