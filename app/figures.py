"""What the panels of a picture share: line styles, the common colour scale, robust sizes, words in place of data."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from solvers.result import Result

ESTIMATOR_STYLES = ("-", "--", ":", "-.")
MOST_DOTS = 20_000  # more particles cannot be told apart in a picture
MOST_CELL_LINES = 400
NO_ERROR = 1.0  # end of the scale where every error is zero
SCALE_OVER_TRUTH = 10  # an estimate that has lost its way must not blank the truth


def styled(result: Result) -> list[tuple[str, str]]:
    """Each active estimator with its line style."""
    names = result.scene.active_estimators
    return [(name, ESTIMATOR_STYLES[k % len(ESTIMATOR_STYLES)]) for k, name in enumerate(names)]


def shared_scale(truth: np.ndarray | None, estimates: list[np.ndarray]) -> Normalize:
    """One colour scale, from 0, for the sizes of the truth and of every estimate of it."""
    top = max((largest(sizes) for sizes in estimates), default=0.0)
    if truth is not None and largest(truth) > 0:
        top = min(max(top, largest(truth)), SCALE_OVER_TRUTH * largest(truth))
    return Normalize(0.0, top or NO_ERROR)


def colour_bar(figure: Figure, drawn: ScalarMappable, axes: Axes | list[Axes], label: str, aspect: float,
               shrink: float = 1.0) -> None:
    """The colour bar of a shared scale, below the axes."""
    bar = figure.colorbar(drawn, ax=axes, location="bottom", aspect=aspect, shrink=shrink, pad=0.02)
    bar.set_label(label)
    bar.formatter.set_powerlimits((-2, 3))
    if drawn.norm.vmax == NO_ERROR:
        bar.set_ticks([0.0])


def largest(values: np.ndarray) -> float:
    finite = values[np.isfinite(values)]
    return float(finite.max()) if len(finite) else 0.0


def robust_size(values: np.ndarray) -> float:
    """Size that all but a few runaway particles keep to."""
    finite = np.abs(values[np.isfinite(values)])
    return float(np.percentile(finite, 98)) if len(finite) else 0.0


def say(axes: Axes, sentence: str) -> None:
    axes.text(0.5, 0.5, sentence, transform=axes.transAxes, ha="center", va="center", fontsize=9, color="0.3",
              wrap=True)
