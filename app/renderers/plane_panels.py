"""A plane problem's panels in a run's picture: particles with estimated and true errors, and the error profile."""

from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec

from app.colour_palette import COLOUR_MAP, ESTIMATE_INK, INK, INK3, LINE, TRUTH, TRUTH_INK
from app.frame.error_view_captions import EMPTY_HALVES, NOTHING_TO_SHOW
from app.frame.layout import ComparedRunSlot
from app.frame.planar_stage import PlanarStage
from app.renderers import picture_panel_style
from app.renderers.picture_style import ESTIMATE_WIDTH, TRUTH_WIDTH, format_size_axis, label_curve_ends
from solvers.running.result import Result
from solvers.scene.scene import Scene

UNKNOWN_COLOUR = "0.7"  # of particles without a computed error
MOST_BINS = 60  # of the profile over R; finer ones hold too few particles to average


class ProfileCoordinate(NamedTuple):
    """Abscissa of an error profile: ``coordinate`` computes it (P,) in m from material positions (P, 2) in m; the rest
    are words for its title, symbol and axis label."""

    coordinate: Callable[[np.ndarray], np.ndarray]
    across: str
    symbol: str
    label: str


OVER_RADIUS = ProfileCoordinate(lambda X: np.linalg.norm(X, axis=1), "the thickness", "R",
                                "material radius R, from the inner surface to the outer")
OVER_WIDTH = ProfileCoordinate(lambda X: X[:, 0], "the width", "X",
                               "material coordinate X, from the left side to the right")


def draw_profile(axes: Axes, result: Result, stage: type[PlanarStage], over: ProfileCoordinate = OVER_RADIUS) -> None:
    """Draws the sizes of position errors in m over a coordinate of the body: each particle, and the RMS in shells."""
    at, inner, outer = result.picture_snapshot, stage.PLOT.start, stage.PLOT.end
    radius = over.coordinate(at.material_position)
    lines = [] if at.error is None else [("true", at.error[:, 0], TRUTH, "-")]
    lines += [(name, at.estimate[name][:, 0], *look) for name, *look in picture_panel_style.estimator_styles(result)]
    few, drawn, ends = picture_panel_style.random_subsample_indices(len(radius)), [], []
    for name, sizes, colour, style in lines:
        shown = picture_panel_style.positive_or_gap(sizes)
        if not np.isfinite(shown).any():
            continue
        size = float(np.clip(2000 / len(few), 1.0, 8.0))
        axes.scatter(radius[few], shown[few], s=size, color=colour, alpha=0.25, linewidths=0)
        at_radius, in_shell = _shell_means(result, radius, shown, inner, outer)
        axes.plot(at_radius, in_shell, color=colour, linestyle=style, zorder=3,
                  linewidth=TRUTH_WIDTH if name == "true" else ESTIMATE_WIDTH)
        drawn.append(shown)
        ends.append((name, in_shell, colour))
    axes.set_title(f"Error of x over {over.across} {picture_panel_style.when_text(result)}: particles, and RMS at "
                   f"{over.symbol}")
    axes.set(xlabel=over.label, xlim=(inner, outer))
    format_size_axis(axes.xaxis, "m", few=False)
    if not drawn:
        axes.set_yticks([])
        picture_panel_style.write_note(axes, NOTHING_TO_SHOW)
        return
    low, high = np.nanpercentile(drawn, 1) / 2, 2 * np.nanmax(drawn)
    axes.set(yscale="log", ylim=(low, high))
    format_size_axis(axes.yaxis, "m")
    label_curve_ends(axes, ends, apart=0.1)


def _shell_means(result: Result, radius: np.ndarray, sizes: np.ndarray, inner: float,
                 outer: float) -> tuple[np.ndarray, np.ndarray]:
    """Returns the means of ``radius`` (P,) and the RMS of ``sizes`` (P,) in thin shells from ``inner`` to ``outer``,
    all in m; shells are about a particle thick, and empty ones are left out."""
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


def draw_estimate_and_truth_halves(figure: Figure, place: SubplotSpec, result: Result, stage: type[PlanarStage],
                                   half_width: float, lines: Iterable[np.ndarray], line_names: str,
                                   points_per_metre: float) -> None:
    """Draws the particles, coloured by position error, in a panel for each estimator, all on one scale.

    For a body mirrored at x = 0 the estimate is the left image and the truth the right one; else each half has its own
    particles. Axes go out to ``half_width`` m. ``lines``, each (n, 2) in m, are exact and named ``line_names``."""
    shown, mirrored = result.picture_snapshot, (-1, 1) in stage.MIRRORS
    few = picture_panel_style.random_subsample_indices(len(shown.position))
    few = few[np.isfinite(shown.position[few]).all(axis=1)]  # an unstable run leaves NaN
    x, y = picture_panel_style.drawable_or_gap(shown.position[few]).T
    truth = None if shown.error is None else shown.error[few, 0]
    estimates = {name: shown.estimate[name][few, 0] for name in result.scene.active_estimators}
    scale = picture_panel_style.shared_colour_scale(truth, list(estimates.values()))
    names = list(estimates) or [""]
    panels = place.subgridspec(1, len(names)).subplots(squeeze=False)[0]
    # A dot is about as wide as the particles are apart, in points of the picture, not so wide that they merge.
    apart = result.scene.spacing / result.scene.ppc * np.sqrt(result.particles / max(1, len(few)))
    area = float(np.clip((0.8 * apart * (points_per_metre / len(names) ** 0.5)) ** 2, 0.5, 64.0))
    for axes, name in zip(panels, names, strict=True):
        _draw_grid_and_exact_lines(axes, result.scene, stage, half_width, lines, line_names)
        for side, sizes, title, colour, silence in (
                (-1, estimates.get(name), f"estimate ({name})", ESTIMATE_INK, EMPTY_HALVES[0]),
                (1, truth, "truth", TRUTH_INK, EMPTY_HALVES[1])):
            own = slice(None) if mirrored else (x < 0) == (side < 0)
            look = {"color": UNKNOWN_COLOUR} if sizes is None else {"c": sizes[own], "cmap": COLOUR_MAP, "norm": scale}
            axes.scatter(side * x[own] if mirrored else x[own], y[own], linewidths=0, zorder=2, s=area, **look)
            axes.text(0.5 + 0.485 * side, 0.95 if mirrored else 0.985, silence if sizes is None else title,
                      transform=axes.transAxes, color=INK3 if sizes is None else colour, fontsize=11,
                      fontweight="bold", va="top", ha="right" if side > 0 else "left", bbox=picture_panel_style.GROUND)
        if not len(few):
            picture_panel_style.write_note(axes, "no particle is left")
        coloured = ", coloured by the size of the position's error" if estimates or truth is not None else ""
        axes.set_title(f"Particles {picture_panel_style.when_text(result)}{coloured}" if axes is panels[0] else "")
    if len(few) and (estimates or truth is not None):
        picture_panel_style.add_colour_bar(figure, ScalarMappable(scale, COLOUR_MAP), list(panels),
                                   "error of x, one scale for both halves", "m", aspect=60, shrink=0.75)


def _draw_grid_and_exact_lines(axes: Axes, scene: Scene, stage: type[PlanarStage], half_width: float,
                               lines: Iterable[np.ndarray], line_names: str) -> None:
    """Draws cell lines, exact lines and the line between the halves, with equal scales on both axes."""
    least, mirrored = (0.0, ", the estimate mirrored") if (-1, 1) in stage.MIRRORS else (-half_width, "")
    cells = _draw_cell_lines(axes, scene, half_width, least, stage.cell_edge_position(scene))
    for line in lines:
        axes.plot(*line.T, color=INK, linewidth=0.9, zorder=3)
    axes.axvline(0, color=INK, linewidth=0.9, linestyle=(0, (6, 3)), zorder=3)
    axes.set(xlim=(-half_width, half_width), ylim=(least, half_width), aspect="equal",
             xlabel=f"x{mirrored}{cells}; dark lines: {line_names}")
    axes.grid(visible=False)
    format_size_axis(axes.xaxis, "m", few=False)
    format_size_axis(axes.yaxis, "m")
    places = stage.layout(picture_panel_style.PAPER, ComparedRunSlot.ALONE)
    (x, y), metres = places.middle, stage.max_radius(scene) / places.radius
    picture_panel_style.write_places(axes, stage, lambda label: (metres * (label.x - x), metres * (label.y - y)))


def _draw_cell_lines(axes: Axes, scene: Scene, half_width: float, least: float, start: float) -> str:
    """Draws cell lines, one at x = ``start``, above y = ``least``, out to ``half_width`` m; returns a caption."""
    if scene.cells > picture_panel_style.MOST_CELL_LINES:
        return ""
    lines = np.arange(-scene.cells, scene.cells + 1) * scene.spacing + start
    lines = lines[np.abs(lines) <= half_width]
    width = min(0.7, 20 / scene.cells)
    axes.vlines(lines, least, half_width, color=LINE, linewidth=width, zorder=0)
    axes.hlines(lines[lines >= least], -half_width, half_width, color=LINE, linewidth=width, zorder=0)
    return "; grey lines: cells"
