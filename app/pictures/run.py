"""One picture of a run: how wrong it is, how wrong the estimate says it is, and whether the two agree.

Estimate and truth keep the two colours of ``app.colours`` and share every scale. Estimators are told apart by
line style. All drawing uses the object-oriented interface, so that threads and tests do not share state.
"""

import io
import textwrap

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from app.pictures.series import DRAWN, draw_index, draw_norm
from app.problems.views import VIEWS
from app.words import method_name, per_cell
from solvers.result import Result

DOTS_PER_INCH = 110


def run_figure(result: Result) -> Figure:
    """The picture of a run, ready to be saved."""
    view = VIEWS[result.scene.problem]
    height, lower = view.picture
    figure = Figure(figsize=(12.5, height), layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(_title(result), fontsize=12)
    places = figure.add_gridspec(2, 2, height_ratios=(1, lower))
    left, right = places[0, 0].subgridspec(len(DRAWN), 1), places[0, 1].subgridspec(2, 1)
    norms = [figure.add_subplot(left[k]) for k in range(len(DRAWN))]
    for axes, quantity in zip(norms, DRAWN, strict=True):
        draw_norm(axes, result, quantity)
        axes.tick_params(labelbottom=axes is norms[-1])
    norms[0].set_title("error norms (RMS over particles)", fontsize=10)
    norms[-1].set_xlabel("time t (s)")
    draw_index(figure.add_subplot(right[0]), result)
    view.draw(figure, figure.add_subplot(right[1]), places[1, :], result)
    return figure


def png_bytes(figure: Figure) -> bytes:
    """A figure as the content of a PNG file."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=DOTS_PER_INCH)
    return buffer.getvalue()


def save_png(result: Result, path: str) -> None:
    """Draw a run and write the picture to ``path``."""
    content = png_bytes(run_figure(result))
    with open(path, "wb") as file:
        file.write(content)


def _title(result: Result) -> str:
    scene = result.scene
    lp = ", linearity preserving" if scene.linearity_preserving else ""
    layout = f" ({scene.layout} layout)" if hasattr(scene, "layout") else ""
    first = (f"{scene.problem.capitalize()}, {method_name(scene.method)}{lp} · "
             f"{scene.cells} cells (h = {scene.spacing:.3g} m) · {per_cell(scene.problem, scene.ppc)} particles per "
             f"cell{layout} · A = {scene.amplitude:g} m")
    steps = f"{result.steps:,} step{'s' * (result.steps != 1)} to t = {result.time:.4g} s"
    second = (f"E = {scene.modulus:g} Pa · density {scene.density:g} kg/m³ · cfl {scene.courant_number:.3g}"
              f" · body force {scene.body_force} · {steps}")
    reason = "\n".join(textwrap.wrap(result.reason, 130)) if result.reason else ""
    return "\n".join(filter(None, [first, second, reason]))
