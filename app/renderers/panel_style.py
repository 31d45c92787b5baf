"""What the panels of a picture share: line styles, the common colour scale, robust sizes, words in place of data."""

from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from app.colours import INK3
from app.frame.colour_scale import largest_finite
from app.frame.layout import RunSlot
from app.frame.primitives import Bounds, Label
from app.frame.stage import Stage, StageLabels
from app.renderers.picture_style import in_sizes
from solvers.running.result import Result
from solvers.scene.estimator_registry import ESTIMATORS

Look = dict[str, Any]  # how something is drawn: arguments of matplotlib's ``plot``
DASH_SCALE = 0.4  # dashes are counted in pixels on the page, in widths of the line in a picture
PAPER = Bounds(800.0, high=0.5)  # in which places of the body are said
MOST_DOTS = 20_000  # more particles cannot be told apart in a picture
MOST_CELL_LINES = 400
GROUND = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 2}  # of words on what is drawn
LEAST, MOST = 1e-100, 1e100  # of what axes are asked to show: they take powers and products of it
NO_ERROR = 1.0  # end of the scale where every error is zero
SCALE_OVER_TRUTH = 10  # an estimate that has lost its way must not blank the truth


def line_style(estimator: str) -> Any:
    dashes = ESTIMATORS[estimator].dashes
    return (0, tuple(DASH_SCALE * length for length in dashes)) if dashes else "-"


def estimator_styles(result: Result) -> list[tuple[str, str, Any]]:
    """Each active estimator with its colour and line style."""
    return [(name, ESTIMATORS[name].colour, line_style(name)) for name in result.scene.active_estimators]


def when_text(result: Result) -> str:
    """In words, when the particles are shown."""
    why = "" if result.mid_run is None else " (last peak of the motion)"
    return f"at t = {result.shown.time:.4g} s{why}"


def subsample_indices(count: int) -> np.ndarray:
    """Indices of the particles to draw: all, or some by chance, for every k-th may all lie at one place of a cell."""
    if count <= MOST_DOTS:
        return np.arange(count)
    return np.sort(np.random.default_rng(0).choice(count, MOST_DOTS, replace=False))


def shared_scale(truth: np.ndarray | None, estimates: list[np.ndarray]) -> Normalize:
    """One colour scale, from 0, for the sizes of the truth and of every estimate of it."""
    top = max((largest_finite(sizes) for sizes in estimates), default=0.0)
    if truth is not None and largest_finite(truth) > 0:
        top = min(max(top, largest_finite(truth)), SCALE_OVER_TRUTH * largest_finite(truth))
    return Normalize(0.0, min(top, MOST) or NO_ERROR)


def colour_bar(figure: Figure, drawn: ScalarMappable, axes: Axes | list[Axes], label: str, unit: str, aspect: float,
               shrink: float = 1.0) -> None:
    bar = figure.colorbar(drawn, ax=axes, location="bottom", aspect=aspect, shrink=shrink, pad=0.02, label=label)
    bar.outline.set_visible(False)
    if drawn.norm.vmax == NO_ERROR:
        bar.set_ticks([0.0])
    else:
        in_sizes(bar.ax.xaxis, unit, few=False)


def positive_or_gap(values: np.ndarray) -> np.ndarray:
    """What a logarithmic axis can show; the rest leaves a gap."""
    return np.where((values > LEAST) & (values < MOST), values, np.nan)


def robust_size(values: np.ndarray) -> float:
    """Size that all but a few runaway particles keep to."""
    shown = np.abs(values[np.abs(values) < MOST])  # not what is not a number either
    return float(np.percentile(shown, 98)) if len(shown) else 0.0


def drawable_or_gap(values: np.ndarray) -> np.ndarray:
    """What a linear axis can be asked to draw, on it or beside it; the rest leaves a gap."""
    return np.where(np.abs(values) < MOST, values, np.nan)


def write_note(axes: Axes, sentence: str) -> None:
    axes.text(0.5, 0.5, sentence, transform=axes.transAxes, ha="center", va="center", color=INK3, wrap=True)


def write_places(axes: Axes, stage: type[Stage], in_axes: Callable[[Label], tuple[float, float]]) -> None:
    """What a stage writes at places of the body; ``in_axes`` says where in the axes those are."""
    for label in stage.labels(StageLabels(), stage.places(PAPER, RunSlot.ALONE)):
        if label.role == "place":
            up, across = label.anchor.split("-")
            axes.text(*in_axes(label), label.text, va=up, ha=across, fontsize=9 * label.size, clip_on=True, bbox=GROUND,
                      zorder=5)
