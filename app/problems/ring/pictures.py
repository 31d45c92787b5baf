"""The ring's own panels: its particles, estimate on the left half and truth on the right, and a profile over R."""

from typing import cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec

from app.colours import COLOUR_MAP, ESTIMATE, TRUTH
from app.figures import colour_bar, drawable, robust_size, say, shared_scale, thinned, when_text
from app.frame.silences import EMPTY_HALVES
from app.problems.planar_pictures import UNKNOWN_COLOUR, dot_area, draw_cells, draw_profile
from solvers.problems.ring import exact
from solvers.problems.ring.scene import RingScene
from solvers.solver.result import Result

LEFT, RIGHT = -1, 1  # the sign of x
POINTS_PER_METRE = 400  # of the picture of the ring, roughly
RIM_ANGLES = np.linspace(0, 0.5 * np.pi, 181)


def draw(figure: Figure, space: Axes, particles: SubplotSpec, result: Result) -> None:
    """The ring's part of a run's picture."""
    draw_profile(space, result, exact.INNER, exact.OUTER)
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
        halves = [(LEFT, estimates.get(name), f"estimate ({name})", ESTIMATE, EMPTY_HALVES[0]),
                  (RIGHT, truth, "truth", TRUTH, EMPTY_HALVES[1])]
        for side, sizes, title, colour, silence in halves:
            look = {"color": UNKNOWN_COLOUR} if sizes is None else {"c": sizes, "cmap": COLOUR_MAP, "norm": scale}
            axes.scatter(side * x, y, s=dot_area(result, len(few), POINTS_PER_METRE), linewidths=0, zorder=2, **look)
            axes.text(0.5 + 0.485 * side, 0.95, silence if sizes is None else title, transform=axes.transAxes,
                      color="0.3" if sizes is None else colour, fontsize=11, fontweight="bold", va="top",
                      ha="right" if side == RIGHT else "left",
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
    """Cell lines, the exact surfaces and the plane of mirroring; equal scales, so that a circle is one."""
    scene, shown = cast(RingScene, result.scene), result.shown
    outer = exact.OUTER + abs(float(exact.displacement(scene, np.array([[exact.OUTER, 0.0]]), shown.time)[0, 0]))
    reach = float(np.clip(robust_size(np.hypot(*drawable(shown.position).T)), outer, 2 * outer)) * 1.06
    cells = draw_cells(axes, scene, reach, 0.0)
    for R in (exact.INNER, exact.OUTER):
        rim = R * np.stack([np.cos(RIM_ANGLES), np.sin(RIM_ANGLES)], axis=1)
        x, y = (rim + exact.displacement(scene, rim, shown.time)).T
        for side in (LEFT, RIGHT):
            axes.plot(side * x, y, color="0.25", linewidth=0.9, zorder=3)
    axes.axvline(0, color="0.25", linewidth=0.9, linestyle=(0, (6, 3)), zorder=3)
    axes.set(xlim=(-reach, reach), ylim=(0, reach), aspect="equal",
             xlabel=f"x (m), the estimate mirrored{cells}; dark lines: exact surfaces")
