"""One picture of a run: how wrong it is, how wrong the estimate says it is, and whether the two agree.

Estimate and truth keep the two colours of ``app.colours`` and share every scale. Estimators are told apart by
line style. All drawing uses the object-oriented interface, so that threads and tests do not share state.
"""

import io
import textwrap
from pathlib import Path

from matplotlib.figure import Figure

from app.pictures.series import DRAWN, draw_index, draw_norm
from app.problems.views import VIEWS
from app.words import method_name, moving, per_cell, unit_of
from solvers.scene.scene import Scene
from solvers.solver.result import Result

DOTS_PER_INCH = 110


def run_figure(result: Result) -> Figure:
    view = VIEWS[result.scene.problem]
    height, lower = view.picture
    figure = Figure(figsize=(12.5, height), layout="constrained")
    figure.suptitle(_title(result), fontsize=12)
    places = figure.add_gridspec(2, 2, height_ratios=(1, lower))
    norms = places[0, 0].subgridspec(len(DRAWN), 1).subplots(squeeze=False)[:, 0]
    index, space = places[0, 1].subgridspec(2, 1).subplots(squeeze=False)[:, 0]
    for axes, quantity in zip(norms, DRAWN, strict=True):
        draw_norm(axes, result, quantity)
        axes.tick_params(labelbottom=axes is norms[-1])
    norms[0].set_title("error norms (RMS over particles)", fontsize=10)
    norms[-1].set_xlabel("time t (s)")
    draw_index(index, result)
    view.draw(figure, space, places[1, :], result)
    return figure


def png_bytes(figure: Figure) -> bytes:
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=DOTS_PER_INCH)
    return buffer.getvalue()


def save_png(result: Result, path: str) -> None:
    Path(path).write_bytes(png_bytes(run_figure(result)))


def _moving(scene: Scene) -> str:
    return f"A = {scene.amplitude:g} {unit_of(type(scene), 'amplitude')}" if scene.swings else moving(scene)


def _title(result: Result) -> str:
    scene = result.scene
    lp = ", linearity preserving" if scene.linearity_preserving else ""
    layout = f" ({scene.layout} layout)" if hasattr(scene, "layout") else ""
    first = (f"{scene.problem.capitalize()}, {method_name(scene.method)}{lp} · {scene.cells} cells "
             f"(h = {scene.spacing:.3g} m) · {per_cell(scene.problem, scene.ppc)} particles per cell{layout}"
             f" · {_moving(scene)}")
    second = (f"E = {scene.modulus:g} Pa · density {scene.density:g} kg/m³ · cfl {scene.courant_number:.3g} · body "
              f"force {scene.body_force} · {result.steps:,} step{'s' * (result.steps != 1)} to t = {result.time:.4g} s")
    return "\n".join([first, second, *textwrap.wrap(result.reason or "", 130)])
