"""The vortex's own panels: its particles, estimate on the left half and truth on the right, and a profile over R."""

from typing import cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec

from app.colours import COLOUR_MAP, ESTIMATE, TRUTH
from app.figures import colour_bar, drawable, say, shared_scale, thinned, when_text
from app.frame.silences import EMPTY_HALVES
from app.problems.planar_pictures import UNKNOWN_COLOUR, dot_area, draw_cells, draw_profile
from solvers.problems.vortex import exact
from solvers.problems.vortex.scene import VortexScene
from solvers.solver.result import Result

SPOKES = 12  # material lines that were straight along e_R, drawn where the exact solution has them
POINTS_PER_METRE = 160  # of the picture, roughly
REACH = 1.06 * exact.OUTER


def draw(figure: Figure, space: Axes, particles: SubplotSpec, result: Result) -> None:
    """The vortex's part of a run's picture."""
    draw_profile(space, result, exact.INNER, exact.OUTER)
    _draw_halves(figure, particles, result)


def _draw_halves(figure: Figure, place: SubplotSpec, result: Result) -> None:
    """The ring, once an estimator: particles on the left show the estimate, those on the right the truth."""
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
        for half, sizes, title, colour, silence, at in (
                (x < 0, estimates.get(name), f"estimate ({name})", ESTIMATE, EMPTY_HALVES[0], 0.015),
                (x >= 0, truth, "truth", TRUTH, EMPTY_HALVES[1], 0.985)):
            look = {"color": UNKNOWN_COLOUR} if sizes is None else {"c": sizes[half], "cmap": COLOUR_MAP, "norm": scale}
            axes.scatter(x[half], y[half], s=dot_area(result, len(few), POINTS_PER_METRE), linewidths=0, zorder=2,
                         **look)
            axes.text(at, 0.985, silence if sizes is None else title, transform=axes.transAxes, va="top",
                      color="0.3" if sizes is None else colour, fontsize=11, fontweight="bold",
                      ha="left" if at < 0.5 else "right",
                      bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 2})
        if not len(few):
            say(axes, "no particle is left")
        coloured = ", coloured by the size of the position's error" if estimates or truth is not None else ""
        axes.set_title(f"particles {when_text(result)}{coloured}", fontsize=10)
    panels[0].set_ylabel("y (m)")
    if len(few) and (estimates or truth is not None):
        colour_bar(figure, ScalarMappable(scale, COLOUR_MAP), list(panels),
                   "|error of x| (m), one scale for both halves", aspect=60, shrink=0.75)


def _frame(axes: Axes, result: Result) -> None:
    """Cell lines, the exact rims and spokes, and the line between the halves; equal scales."""
    scene, t = cast(VortexScene, result.scene), result.shown.time
    cells = draw_cells(axes, scene, REACH, -REACH, 0.5 * scene.spacing * (scene.cells % 2))
    R = np.linspace(exact.INNER, exact.OUTER, 61)
    angles = 2 * np.pi * np.arange(SPOKES) / SPOKES
    lines = [R[:, None] * np.array([np.cos(angle), np.sin(angle)]) for angle in angles] if scene.solution_known else []
    around = np.linspace(0, 2 * np.pi, 361)
    lines += [rim * np.stack([np.cos(around), np.sin(around)], axis=1) for rim in (exact.INNER, exact.OUTER)]
    for X in lines:
        axes.plot(*exact.position(scene, X, t).T, color="0.25", linewidth=0.9, zorder=3)
    axes.axvline(0, color="0.25", linewidth=0.9, linestyle=(0, (6, 3)), zorder=3)
    axes.set(xlim=(-REACH, REACH), ylim=(-REACH, REACH), aspect="equal",
             xlabel=f"x (m){cells}; dark lines: rims and material lines of the exact solution")
