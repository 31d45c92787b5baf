"""The bar's panels in a run's picture: its particles' displacement, and lanes of true and estimated errors."""

from typing import cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec

from app.colour_palette import COLOUR_MAP, ESTIMATE_INK, INK, LINE2, TRUTH, TRUTH_INK
from app.frame.layout import ComparedRunSlot
from app.problems.bar.stage import BarStage
from app.renderers import picture_panel_style
from app.renderers.picture_style import format_size_axis
from solvers.problems.bar import exact_solution
from solvers.problems.bar.scene import BarScene
from solvers.running.result import Result

THIN = 1.4  # points: the width of a line over the dots, which stay in sight on both sides
WIDEST = 1.5  # mean distances: the part of the lane that stands for a particle; more is a gap


def draw_picture(figure: Figure, space: Axes, particles: SubplotSpec, result: Result) -> None:
    """Draws a bar's displacement into the axes ``space``, and lanes of errors into the subplot ``particles``."""
    _draw_displacement(space, result)
    _draw_error_lanes(figure, figure.add_subplot(particles), result)


def _draw_displacement(axes: Axes, result: Result) -> None:
    """Draws the particles' displacements in m, at the moment of a result's picture, and the exact curve."""
    shown, scene = result.picture_snapshot, cast(BarScene, result.scene)
    fine = np.linspace(0, 1, 801)
    even = scene.initial_velocity * shown.time if scene.is_patch else 0.0  # which would hide the rest
    curve = exact_solution.displacement(scene, fine, shown.time) - even
    axes.plot(fine, curve, color=TRUTH, linewidth=THIN, label="exact", zorder=4)  # many dots would bury it
    few = picture_panel_style.random_subsample_indices(len(shown.position))
    moved = picture_panel_style.drawable_or_gap((shown.position - shown.material_position - even)[few])
    size = float(np.clip(1500 / len(few), 2.0, 12.0))
    axes.scatter(shown.material_position[few], moved, s=size, color=INK, linewidths=0, label="particles", zorder=3)
    name = "Displacement u − vt" if scene.is_patch else "Displacement u"
    axes.set_title(f"{name} {picture_panel_style.when_text(result)}")
    limit = 1.4 * max(abs(curve).max(), picture_panel_style.robust_size(moved)) or scene.motion_amplitude
    axes.set(xlabel="material coordinate X; line: exact, dots: computed", xlim=(0, 1), ylim=(-limit, limit))
    format_size_axis(axes.xaxis, "m", few=False)
    format_size_axis(axes.yaxis, "m")


def _draw_error_lanes(figure: Figure, axes: Axes, result: Result) -> None:
    """Draws a lane of particles for the truth and one for each estimator, with errors of x on one colour scale."""
    shown, cells = result.picture_snapshot, result.scene.cells
    position = cast(BarScene, result.scene).wrap_into_period(shown.position)
    lanes = [("truth", None if shown.error is None else np.abs(shown.error[:, 0]), TRUTH_INK)]
    lanes += [(f"estimate\n({name})", np.abs(shown.estimate[name][:, 0]), ESTIMATE_INK)
              for name in result.scene.active_estimators]
    lanes = [lane for lane in lanes if lane[1] is not None] or [("particles", None, INK)]
    few = picture_panel_style.random_subsample_indices(len(shown.position))
    few = few[(position[few] >= 0) & (position[few] <= 1)]  # an unstable run leaves NaN and worse
    known = [sizes[few] for _, sizes, _ in lanes if sizes is not None]
    truth = known.pop(0) if shown.error is not None else None
    scale = picture_panel_style.shared_colour_scale(truth, known)
    left, right = _particle_intervals(position[few])
    for height, (_, sizes, _) in enumerate(lanes):
        look = {"color": "0.4"} if sizes is None else {"array": sizes[few], "cmap": COLOUR_MAP, "norm": scale}
        low, high = np.full_like(left, height - 0.32), np.full_like(left, height + 0.32)
        corners = np.stack([left, low, right, low, right, high, left, high], axis=1).reshape(-1, 4, 2)
        strokes = PolyCollection(list(corners), linewidths=0, antialiaseds=False, zorder=2, **look)
        axes.add_collection(strokes, autolim=False)
    if not len(few):
        picture_panel_style.write_note(axes, "no particle is left on the bar")
    lined = cells <= picture_panel_style.MOST_CELL_LINES
    if lined:
        axes.vlines(np.arange(cells + 1) / cells, -0.5, len(lanes) - 0.5, color=LINE2,
                    linewidth=min(0.8, 60 / cells), zorder=1)
    places = BarStage.layout(picture_panel_style.PAPER, ComparedRunSlot.ALONE)
    picture_panel_style.write_places(axes, BarStage,
                             lambda label: (label.x, (label.y - places.truth) / (places.estimate - places.truth)))
    axes.set_yticks(range(len(lanes)), [label for label, _, _ in lanes])
    for tick, (_, _, colour) in zip(axes.get_yticklabels(), lanes, strict=True):
        tick.set(color=colour, fontweight="bold")
    axes.set(xlabel=f"position x{'; grey lines: cell boundaries' if lined else ''}", xlim=(-0.01, 1.01),
             ylim=(-0.5, len(lanes) - 0.5))
    axes.grid(visible=False)
    format_size_axis(axes.xaxis, "m", few=False)
    axes.set_title(f"Particles {picture_panel_style.when_text(result)}, coloured by the size of the position's error")
    if len(few) and lanes[0][1] is not None:
        picture_panel_style.add_colour_bar(figure, strokes, axes, "error of x, one scale for all lanes", "m", aspect=80)


def _particle_intervals(position: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Returns the left and right ends (P,) of the intervals of a lane that stand for particles at ``position`` (P,) in
    m: half way to the neighbours, so that no gaps form a pattern, but 0.075 to 0.75 mean distances."""
    order = np.argsort(position)
    places, most = position[order], 0.5 * WIDEST / max(1, len(position))
    half = np.clip(0.5 * np.diff(places), 0.1 * most, most)
    left, right = np.empty_like(places), np.empty_like(places)
    left[order] = places - np.concatenate([[most] * bool(len(places)), half])
    right[order] = places + np.concatenate([half, [most] * bool(len(places))])
    return np.maximum(left, 0.0), np.minimum(right, 1.0)
