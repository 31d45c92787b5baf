"""Where and when an error was made, as a picture: material to the right, time upwards, what was made until then and in
each cell beside it, and dots where particles cross."""

from __future__ import annotations

import textwrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from app.colours import CAUSES as COLOURS
from app.colours import INK, INK2
from app.renderers.look import in_sizes, sheet
from app.words import method_name, moving, with_unit
from solvers.scene.causes import CAUSES
from solvers.solver.error_map import ErrorMap

WIDTH, HEIGHT = 10.5, 8.0  # inches
ROWS = 100  # of the map, of as many steps each
BRIGHT = 99.5  # percentile of the map that has the full colour
SEEN = 2e-3  # of the error: a cause that never has made more is not drawn beside the map
UNITS = {"x": "m", "v": "m/s", "F": ""}


def budget_map_figure(found: ErrorMap) -> Figure:
    """The map of the cause that has made most; beside and below it those of all."""
    cause = found.main_cause
    figure = sheet(WIDTH, HEIGHT, _title(found))
    places = figure.add_gridspec(2, 2, width_ratios=(3, 1), height_ratios=(3, 1))
    at = figure.add_subplot(places[0, 0])
    _draw_map(figure, at, found, cause)
    _draw_time(figure.add_subplot(places[0, 1], sharey=at), found)
    _draw_cells(figure.add_subplot(places[1, 0], sharex=at), found)
    shown = figure.add_subplot(places[1, 1])
    shown.axis("off")
    for k, name in enumerate(CAUSES):
        shown.text(0.06, 0.8 - 0.22 * k, f"{CAUSES[name]} {_percent(100 * found.share(name))}", color=INK2)
        shown.plot(0.0, 0.83 - 0.22 * k, "s", color=COLOURS[name].light, clip_on=False, markersize=8)
    shown.set(xlim=(0, 1), ylim=(0, 1))
    caption = (f"Colour: what {CAUSES[cause]} added to the error of the end, here and then; dark: what was taken off "
               "it. Dots: a particle crosses into another cell.")
    figure.supxlabel("\n".join(textwrap.wrap(caption, 110)), x=0.012, ha="left", fontsize=10, color=INK2)
    return figure


def _draw_map(figure: Figure, axes: Axes, found: ErrorMap, cause: str) -> None:
    values = 100 * found.binned(cause, min(ROWS, len(found.times)))
    most = float(np.percentile(np.abs(values), BRIGHT)) or 1.0
    shades = LinearSegmentedColormap.from_list("made", [INK, "#ffffff", COLOURS[cause].light])
    image = axes.imshow(values, origin="lower", aspect="auto", extent=(0.0, 1.0, 0.0, float(found.times[-1])),
                        cmap=shades, vmin=-most, vmax=most, interpolation="nearest")
    axes.plot(found.crossings[:, 1], found.crossings[:, 0], ".", color=INK, markersize=1.6, alpha=0.6)
    bar = figure.colorbar(image, ax=axes, location="left", shrink=0.6, pad=0.03)
    bar.set_label("% of the error, a cell and a hundredth of the time")
    bar.ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.2g}".replace("-", "\u2212")))
    axes.set_title(f"{CAUSES[cause].capitalize()}: where and when")
    axes.grid(False)
    in_sizes(axes.yaxis, "s")
    axes.set_ylabel("t")
    axes.tick_params(labelbottom=False)


def _draw_time(axes: Axes, found: ErrorMap) -> None:
    """What of the error had been made until each time."""
    for cause in CAUSES:
        made = 100 * found.until(cause)
        if np.abs(made).max() > 100 * SEEN:
            axes.plot(made, found.times, color=COLOURS[cause].light, linewidth=1.8)
    axes.axvline(0, color=INK, linewidth=0.6)
    axes.set_title("Made until then, %")
    axes.tick_params(labelleft=False)


def _draw_cells(axes: Axes, found: ErrorMap) -> None:
    """What each cell of the material has made, cause upon cause, below zero what makes the error smaller."""
    h, above, below = found.scene.spacing, 0.0, 0.0
    for cause in CAUSES:
        made = 100 * found.binned(cause, 1)[0]
        if np.abs(made).max() <= 100 * SEEN / found.scene.cells:
            continue
        for base, part in ((above, np.maximum(made, 0)), (below, np.minimum(made, 0))):
            axes.bar((np.arange(len(made)) + 0.5) * h, part, 0.8 * h, base, color=COLOURS[cause].light)
        above, below = above + np.maximum(made, 0), below + np.minimum(made, 0)
    axes.axhline(0, color=INK, linewidth=0.6)
    axes.set(xlim=(0, 1))
    axes.set_title("Made in each cell, %")
    in_sizes(axes.xaxis, "m", few=False)
    axes.set_xlabel("X, where the material was at rest")


def _percent(value: float) -> str:
    return f"{value:.3g} %".replace("-", "\u2212") if abs(value) >= 0.05 else "0 %"


def _title(found: ErrorMap) -> str:
    scene = found.scene
    particle = found.particle
    whose = "RMS" if particle is None else f"particle {particle}, X = {with_unit(found.X[particle], 'm')}"
    swing = f"A = {scene.amplitude:g} m" if "amplitude" in scene.moved_by else moving(scene)
    size = with_unit(abs(found.size), UNITS[found.field]).strip() if UNITS[found.field] else f"{found.size:.3g}"
    return (f"Where and when was the error of {found.field} at t = {with_unit(found.times[-1], 's')} made? ({whose}: "
            f"{size})\n{scene.problem.capitalize()}, {method_name(scene.method)} · {scene.cells} cells · "
            f"{swing} · body force {scene.body_force}")
