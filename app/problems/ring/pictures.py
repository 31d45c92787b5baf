"""The ring's own panels: its particles, estimate on the left half and truth on the right, and a profile over R."""

from typing import cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec

from app.colours import COLOUR_MAP, ESTIMATE, TRUTH
from app.figures import (
    MOST_CELL_LINES,
    colour_bar,
    drawable,
    moment,
    positive,
    robust_size,
    say,
    shared_scale,
    styled,
    thinned,
)
from solvers.result import Result
from solvers.ring import exact
from solvers.ring.scene import RingScene

UNKNOWN_COLOUR = "0.7"  # of particles whose error nobody has computed
LEFT, RIGHT = -1, 1  # the sign of x
LEGEND_ROOM = 0.3  # above the data, as a part of their decades
MOST_BINS = 60  # of the profile over R; finer ones hold too few particles to average
POINTS_PER_METRE = 400  # of the picture of the ring, roughly
RIM_ANGLES = np.linspace(0, 0.5 * np.pi, 181)


def draw(figure: Figure, space: Axes, particles: SubplotSpec, result: Result) -> None:
    """The ring's part of a run's picture."""
    _draw_profile(space, result)
    _draw_halves(figure, particles, result)


def _draw_halves(figure: Figure, place: SubplotSpec, result: Result) -> None:
    """The ring, once an estimator: the estimate mirrored about x = 0, the truth beside it, one scale."""
    shown = result.shown
    few = thinned(len(shown.position))
    few = few[np.isfinite(shown.position[few]).all(axis=1)]  # an unstable run leaves NaN
    x, y = drawable(shown.position[few]).T
    truth = None if shown.error is None else shown.error[few, 0]
    estimates = {name: shown.estimate[name][few, 0] for name in result.scene.active_estimators}
    scale = shared_scale(truth, list(estimates.values()))
    names = list(estimates) or [""]
    panels = place.subgridspec(1, len(names)).subplots(squeeze=False)[0]
    for axes, name in zip(panels, names, strict=True):
        _frame(axes, result)
        halves = [(LEFT, estimates.get(name), f"estimate ({name})", ESTIMATE, "not estimated"),
                  (RIGHT, truth, "truth", TRUTH, "truth not computed")]
        for side, sizes, title, colour, silence in halves:
            look = {"color": UNKNOWN_COLOUR} if sizes is None else {"c": sizes, "cmap": COLOUR_MAP, "norm": scale}
            axes.scatter(side * x, y, s=_dot_area(result, len(few)), linewidths=0, zorder=2, **look)
            axes.text(0.5 + 0.485 * side, 0.95, silence if sizes is None else title, transform=axes.transAxes,
                      color="0.3" if sizes is None else colour, fontsize=11, fontweight="bold", va="top",
                      ha="right" if side == RIGHT else "left",
                      bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 2})
        if not len(few):
            say(axes, "no particle is left")
        coloured = ", coloured by the size of the position's error" if estimates or truth is not None else ""
        axes.set_title(f"particles {moment(result)}{coloured}", fontsize=10)
    panels[0].set_ylabel("y (m)")
    if len(few) and (estimates or truth is not None):
        colour_bar(figure, ScalarMappable(scale, COLOUR_MAP), list(panels),
                   "|error of x| (m), one scale for both halves", aspect=60, shrink=0.75)


def _draw_profile(axes: Axes, result: Result) -> None:
    """Where between the inner and the outer surface the error is: each particle, and the RMS over a thin shell."""
    at = result.shown
    radius = np.linalg.norm(at.material_position, axis=1)
    lines = [] if at.error is None else [("truth", at.error[:, 0], TRUTH, "-")]
    lines += [(f"estimate ({name})", at.estimate[name][:, 0], colour, style) for name, colour, style in styled(result)]
    few, drawn = thinned(len(radius)), []
    for label, sizes, colour, style in lines:
        shown = positive(sizes)
        if not np.isfinite(shown).any():
            continue
        size = float(np.clip(2000 / len(few), 1.0, 8.0))
        axes.scatter(radius[few], shown[few], s=size, color=colour, alpha=0.25, linewidths=0)
        axes.plot(*_shells(result, radius, shown), color=colour, linestyle=style, linewidth=1.6, label=label, zorder=3)
        drawn.append(shown)
    axes.set_title(f"error of x {moment(result)}, over the thickness", fontsize=10)
    axes.set(xlabel=f"material radius R (m), from the inner surface {exact.INNER} to the outer {exact.OUTER}",
             ylabel="|error of x| (m)", xlim=(exact.INNER, exact.OUTER))
    if not drawn:
        axes.set_yticks([])
        say(axes, "nothing to show: every error is zero, or was not computed")
        return
    low, high = np.nanpercentile(drawn, 1) / 2, 2 * np.nanmax(drawn)
    axes.set(yscale="log", ylim=(low, high * (high / low) ** LEGEND_ROOM))
    axes.grid(alpha=0.3)
    axes.legend(loc="upper right", fontsize=8, ncols=2, framealpha=0.9, title="dots: particles, lines: RMS at R",
                title_fontsize=8)


def _shells(result: Result, radius: np.ndarray, sizes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean radius and RMS of the sizes in thin shells, about a particle thick; empty shells are left out."""
    scene = result.scene
    thickness = exact.OUTER - exact.INNER
    count = int(np.clip(round(thickness * scene.ppc / scene.spacing), 2, MOST_BINS))
    shell = np.clip(((radius - exact.INNER) / thickness * count).astype(int), 0, count - 1)
    known = np.isfinite(sizes)
    shell, radius, sizes = shell[known], radius[known], sizes[known]
    held = np.bincount(shell, minlength=count)
    there = held > 0
    with np.errstate(over="ignore"):  # a run gone bad
        squares = np.bincount(shell, weights=sizes**2, minlength=count)
    return (np.bincount(shell, weights=radius, minlength=count)[there] / held[there],
            np.sqrt(squares[there] / held[there]))


def _frame(axes: Axes, result: Result) -> None:
    """Cell lines, the exact surfaces and the plane of mirroring; equal scales, so that a circle is one."""
    scene, shown = cast(RingScene, result.scene), result.shown
    outer = exact.OUTER + abs(float(exact.displacement(scene, np.array([[exact.OUTER, 0.0]]), shown.time)[0, 0]))
    reach = float(np.clip(robust_size(np.hypot(*drawable(shown.position).T)), outer, 2 * outer)) * 1.06
    if scene.cells <= MOST_CELL_LINES:
        lines = np.arange(-scene.cells, scene.cells + 1) * scene.spacing
        lines = lines[np.abs(lines) <= reach]
        width = min(0.7, 20 / scene.cells)
        axes.vlines(lines, 0, reach, color="0.8", linewidth=width, zorder=0)
        axes.hlines(lines[lines >= 0], -reach, reach, color="0.8", linewidth=width, zorder=0)
    for R in (exact.INNER, exact.OUTER):
        rim = R * np.stack([np.cos(RIM_ANGLES), np.sin(RIM_ANGLES)], axis=1)
        x, y = (rim + exact.displacement(scene, rim, shown.time)).T
        for side in (LEFT, RIGHT):
            axes.plot(side * x, y, color="0.25", linewidth=0.9, zorder=3)
    axes.axvline(0, color="0.25", linewidth=0.9, linestyle=(0, (6, 3)), zorder=3)
    cells = "; grey lines: cells" * (scene.cells <= MOST_CELL_LINES)
    axes.set(xlim=(-reach, reach), ylim=(0, reach), aspect="equal",
             xlabel=f"x (m), the estimate mirrored{cells}; dark lines: exact surfaces")


def _dot_area(result: Result, shown: int) -> float:
    """Area of a dot in points squared: about as wide as the particles are apart, not so wide that they merge."""
    apart = result.scene.spacing / result.scene.ppc * np.sqrt(result.particles / max(1, shown))
    return float(np.clip((0.8 * apart * POINTS_PER_METRE) ** 2, 0.5, 64.0))
