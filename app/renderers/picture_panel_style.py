"""Common to the panels of a picture: line styles, colour scale, robust sizes, notes in place of data."""

from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from app.colour_palette import INK3
from app.frame.colour_scale import largest_finite
from app.frame.layout import ComparedRunSlot
from app.frame.primitives import Label, StageMetrics
from app.frame.stage import Stage, StageLabels
from app.renderers.picture_style import format_size_axis
from solvers.running.result import Result
from solvers.scene.estimator_registry import ESTIMATORS

Look = dict[str, Any]  # arguments of matplotlib's ``plot``
DASH_SCALE = 0.4  # dashes are in pixels on the page, in line widths in a picture
PAPER = StageMetrics(800.0, high=0.5)  # bounds for labels at points of the body
MOST_DOTS = 20_000  # more particles are indistinguishable in a picture
MOST_CELL_LINES = 400
GROUND = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 2}  # behind text on a drawing
LEAST, MOST = 1e-100, 1e100  # range of plotted values: axes compute powers and products of them
NO_ERROR = 1.0  # end of the scale where every error is zero
SCALE_OVER_TRUTH = 10  # limits the scale, so that a diverged estimate does not hide the truth


def line_style(estimator: str) -> Any:
    """Returns the matplotlib line style of an estimator, by its name."""
    dashes = ESTIMATORS[estimator].dashes
    return (0, tuple(DASH_SCALE * length for length in dashes)) if dashes else "-"


def estimator_styles(result: Result) -> list[tuple[str, str, Any]]:
    """Returns name, colour and matplotlib line style of each estimator that ran."""
    return [(name, ESTIMATORS[name].colour, line_style(name)) for name in result.scene.active_estimators]


def when_text(result: Result) -> str:
    """Returns the time at which a picture shows the particles, as text ("at t = 0.25 s")."""
    why = "" if result.mid_run is None else " (last peak of the motion)"
    return f"at t = {result.picture_snapshot.time:.4g} s{why}"


def random_subsample_indices(count: int) -> np.ndarray:
    """Returns the indices of particles to draw, of ``count``: all, or 20,000 at random (regular ones form patterns)."""
    if count <= MOST_DOTS:
        return np.arange(count)
    return np.sort(np.random.default_rng(0).choice(count, MOST_DOTS, replace=False))


def shared_colour_scale(truth: np.ndarray | None, estimates: list[np.ndarray]) -> Normalize:
    """Returns one colour scale, from 0, for sizes (P,) of the true error (None if unknown) and of estimates of it."""
    top = max((largest_finite(sizes) for sizes in estimates), default=0.0)
    if truth is not None and largest_finite(truth) > 0:
        top = min(max(top, largest_finite(truth)), SCALE_OVER_TRUTH * largest_finite(truth))
    return Normalize(0.0, min(top, MOST) or NO_ERROR)


def add_colour_bar(figure: Figure, drawn: ScalarMappable, axes: Axes | list[Axes], label: str, unit: str, aspect: float,
                   shrink: float = 1.0) -> None:
    """Adds a colour bar of ``drawn`` below axes, with sizes in a unit, or 0 alone if all are zero."""
    bar = figure.colorbar(drawn, ax=axes, location="bottom", aspect=aspect, shrink=shrink, pad=0.02, label=label)
    bar.outline.set_visible(False)
    if drawn.norm.vmax == NO_ERROR:
        bar.set_ticks([0.0])
    else:
        format_size_axis(bar.ax.xaxis, unit, few=False)


def positive_or_gap(values: np.ndarray) -> np.ndarray:
    """Returns values with NaN, a gap in a curve, for those that a logarithmic axis cannot show."""
    return np.where((values > LEAST) & (values < MOST), values, np.nan)


def robust_size(values: np.ndarray) -> float:
    """Returns the 98th percentile of the absolute values, so that a few runaway particles do not matter; 0 for none."""
    shown = np.abs(values[np.abs(values) < MOST])  # NaN is dropped too
    return float(np.percentile(shown, 98)) if len(shown) else 0.0


def drawable_or_gap(values: np.ndarray) -> np.ndarray:
    """Returns values with NaN, a gap in a curve, for those too large for a linear axis."""
    return np.where(np.abs(values) < MOST, values, np.nan)


def write_note(axes: Axes, sentence: str) -> None:
    axes.text(0.5, 0.5, sentence, transform=axes.transAxes, ha="center", va="center", color=INK3, wrap=True)


def write_places(axes: Axes, stage: type[Stage], in_axes: Callable[[Label], tuple[float, float]]) -> None:
    """Writes the names of parts of the body that a stage shows; ``in_axes(label)`` returns the position in the axes."""
    for label in stage.labels(StageLabels(), stage.layout(PAPER, ComparedRunSlot.ALONE)):
        if label.role == "place":
            up, across = label.anchor.split("-")
            axes.text(*in_axes(label), label.text, va=up, ha=across, fontsize=9 * label.size, clip_on=True, bbox=GROUND,
                      zorder=5)
