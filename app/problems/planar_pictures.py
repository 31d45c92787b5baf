"""What the pictures of plane problems share: cells, dots, and the profile of the error over R."""

import numpy as np
from matplotlib.axes import Axes

from app.colours import TRUTH
from app.figures import MOST_CELL_LINES, positive, say, styled, thinned, when_text
from app.frame.silences import NOTHING_TO_SHOW
from solvers.scene.scene import Scene
from solvers.solver.result import Result

UNKNOWN_COLOUR = "0.7"  # of particles whose error nobody has computed
LEGEND_ROOM = 0.3  # above the data, as a part of their decades
MOST_BINS = 60  # of the profile over R; finer ones hold too few particles to average


def draw_profile(axes: Axes, result: Result, inner: float, outer: float) -> None:
    """Where between the inner and the outer radius the error is: each particle, and the RMS over a thin shell."""
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
        axes.plot(*_shells(result, radius, shown, inner, outer), color=colour, linestyle=style, linewidth=1.6,
                  label=label, zorder=3)
        drawn.append(shown)
    axes.set_title(f"error of x {when_text(result)}, over the thickness", fontsize=10)
    axes.set(xlabel=f"material radius R (m), from the inner surface {inner} to the outer {outer}",
             ylabel="|error of x| (m)", xlim=(inner, outer))
    if not drawn:
        axes.set_yticks([])
        say(axes, NOTHING_TO_SHOW)
        return
    low, high = np.nanpercentile(drawn, 1) / 2, 2 * np.nanmax(drawn)
    axes.set(yscale="log", ylim=(low, high * (high / low) ** LEGEND_ROOM))
    axes.grid(alpha=0.3)
    axes.legend(loc="upper right", fontsize=8, ncols=2, framealpha=0.9, title="dots: particles, lines: RMS at R",
                title_fontsize=8)


def _shells(result: Result, radius: np.ndarray, sizes: np.ndarray, inner: float,
            outer: float) -> tuple[np.ndarray, np.ndarray]:
    """Mean radius and RMS of the sizes in thin shells, about a particle thick; empty shells are left out."""
    scene = result.scene
    thickness = outer - inner
    count = int(np.clip(round(thickness * scene.ppc / scene.spacing), 2, MOST_BINS))
    shell = np.clip(((radius - inner) / thickness * count).astype(int), 0, count - 1)
    known = np.isfinite(sizes)
    shell, radius, sizes = shell[known], radius[known], sizes[known]
    held = np.bincount(shell, minlength=count)
    there = held > 0
    with np.errstate(over="ignore"):  # a run gone bad
        squares = np.bincount(shell, weights=sizes**2, minlength=count)
    return (np.bincount(shell, weights=radius, minlength=count)[there] / held[there],
            np.sqrt(squares[there] / held[there]))


def draw_cells(axes: Axes, scene: Scene, reach: float, least: float, start: float = 0.0) -> str:
    """Lines between cells out to ``reach`` metres from the middle, above y = ``least``; a line is at ``start``. Returns
    what the label of an axis says of them."""
    if scene.cells > MOST_CELL_LINES:
        return ""
    lines = np.arange(-scene.cells, scene.cells + 1) * scene.spacing + start
    lines = lines[np.abs(lines) <= reach]
    width = min(0.7, 20 / scene.cells)
    axes.vlines(lines, least, reach, color="0.8", linewidth=width, zorder=0)
    axes.hlines(lines[lines >= least], -reach, reach, color="0.8", linewidth=width, zorder=0)
    return "; grey lines: cells"


def dot_area(result: Result, shown: int, per_metre: float) -> float:
    """Area of a dot in points squared: about as wide as the particles are apart, not so wide that they merge.

    A metre is ``per_metre`` points of the picture, roughly."""
    apart = result.scene.spacing / result.scene.ppc * np.sqrt(result.particles / max(1, shown))
    return float(np.clip((0.8 * apart * per_metre) ** 2, 0.5, 64.0))
