"""One picture of a run: how wrong it is, how wrong the estimate says it is, and whether the two agree.

Estimate and truth keep the two colours of ``app.colours`` and share every scale. Estimators are told apart by
line style. All drawing uses the object-oriented interface, so that threads and tests do not share state.
"""

from __future__ import annotations

import io
import textwrap

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from app.colours import COLOUR_MAP, ESTIMATE, TRUTH
from solvers.bar import exact
from solvers.result import Result

DOTS_PER_INCH = 110
METHODS = {"mpm": "MPM", "ugimp": "uGIMP", "cpgimp": "cpGIMP", "bspline": "B-spline MPM"}
#: The quantities drawn, as they are written, and their units.
DRAWN = {"x": ("position x", "m"), "v": ("velocity v", "m/s"), "sigma": ("stress σ", "Pa")}
ESTIMATOR_STYLES = ("-", "--", ":", "-.")
INDEX_STYLES = {"x": "-", "v": "--", "sigma": ":"}
INDEX_COLOUR = "#333333"
FEW_SAMPLES = 10  # fewer are marked one by one: a line through one point shows nothing
MOST_DOTS = 20_000  # more particles cannot be told apart in a picture
MOST_CELL_LINES = 400
HIGHEST_INDEX = 10.0  # a run that blows up must not squeeze the 1 out of sight
MOST_DECADES = 8  # nor its errors everything that came before


def run_figure(result: Result) -> Figure:
    """The picture of a run, ready to be saved."""
    figure = Figure(figsize=(12.5, 10), layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(_title(result), fontsize=12)
    places = figure.add_gridspec(2, 2, height_ratios=(3, 1.25))
    left, right = places[0, 0].subgridspec(len(DRAWN), 1), places[0, 1].subgridspec(2, 1)
    norms = [figure.add_subplot(place) for place in left]
    for axes, quantity in zip(norms, DRAWN, strict=True):
        _draw_norm(axes, result, quantity)
        axes.tick_params(labelbottom=axes is norms[-1])
    norms[0].set_title("error norms (RMS over particles)", fontsize=10)
    norms[-1].set_xlabel("time t (s)")
    _draw_index(figure.add_subplot(right[0]), result)
    _draw_curve(figure.add_subplot(right[1]), result)
    _draw_lanes(figure, figure.add_subplot(places[1, :]), result)
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
    first = (f"Bar, {METHODS.get(scene.method, scene.method)}{lp} · "
             f"{scene.cells} cells (h = {scene.spacing:.3g} m) · {scene.particles_per_cell} particles per "
             f"cell · A = {scene.amplitude:g} m")
    steps = f"{result.steps:,} step{'s' * (result.steps != 1)} to t = {result.time:.4g} s"
    second = (f"E = {scene.modulus:g} Pa · density {scene.density:g} kg/m³ · cfl {scene.courant_number:.3g}"
              f" · body force {scene.body_force} · {steps}")
    reason = "\n".join(textwrap.wrap(result.reason, 130)) if result.reason else ""
    return "\n".join(filter(None, [first, second, reason]))


def _draw_norm(axes: Axes, result: Result, quantity: str) -> None:
    """The truth and each estimate of one quantity's error norm over time."""
    lines = [("truth", f"error_{quantity}", TRUTH, "-")]
    lines += [(f"estimate ({name})", f"{name}/estimate_{quantity}", ESTIMATE, style)
              for name, style in _styled(result)]
    drawn = []
    for label, key, colour, style in lines:
        values = _positive(result.series[key])
        if np.isfinite(values).any():
            axes.plot(result.series["time"], values, color=colour, linestyle=style, linewidth=1.3,
                      label=label, marker=_marker(values), markersize=4)
            drawn.append(values)
    _time_axis(axes, result)
    name, unit = DRAWN[quantity]
    axes.set_ylabel(f"{name} ({unit})")
    if not drawn:
        axes.set_yticks([])
        _say(axes, "nothing to show: every error is zero, or was not computed")
        return
    axes.set_yscale("log")
    axes.set_ylim(*_span(np.concatenate(drawn)))
    axes.grid(alpha=0.3)
    if quantity == "x":
        axes.legend(loc="lower right", fontsize=8, framealpha=0.9)


def _draw_index(axes: Axes, result: Result) -> None:
    """The error index of the run so far (eq 35): summed estimate over summed truth."""
    axes.set_title("error index so far: sum of estimates / sum of true errors", fontsize=10)
    axes.set_xlabel("time t (s)")
    axes.axhline(1.0, color=TRUTH, linewidth=1.2)
    highest = 1.0
    several = len(result.scene.active_estimators) > 1
    for name, _ in _styled(result):
        for quantity, style in INDEX_STYLES.items():
            ratio = _running_ratio(result, name, quantity)
            if not np.isfinite(ratio).any():
                continue
            highest = max(highest, float(np.nanpercentile(ratio, 90)))
            symbol = "σ" if quantity == "sigma" else quantity
            axes.plot(result.series["time"], ratio, color=_estimator_shade(result, name), linestyle=style,
                      linewidth=1.4, label=f"{symbol} ({name})" if several else symbol, marker=_marker(ratio),
                      markersize=4)
    _time_axis(axes, result)
    if not axes.get_legend_handles_labels()[0]:
        axes.set_yticks([])
        _say(axes, "nothing to show: the index needs an estimate and a true error")
        return
    axes.set_ylim(0, 1.35 * min(highest, HIGHEST_INDEX))
    axes.grid(alpha=0.3)
    axes.text(0.99, 1.0, "perfect ", transform=axes.get_yaxis_transform(), color=TRUTH, fontsize=8,
              ha="right", va="bottom")
    axes.legend(loc="upper right", fontsize=8, ncols=3, framealpha=0.9)


def _draw_curve(axes: Axes, result: Result) -> None:
    """Where the particles went, on the exact displacement."""
    final, scene = result.final, result.scene
    fine = np.linspace(0, 1, 801)
    curve = exact.displacement(scene, fine, final.time)
    axes.plot(fine, curve, color=TRUTH, linewidth=1.2, label="exact", zorder=4)
    few = _thinned(len(final.position))
    moved = (final.position - final.material_position)[few]
    size = float(np.clip(5000 / len(few), 3.0, 30.0))
    axes.scatter(final.material_position[few], moved, s=size, color="0.35", linewidths=0, label="particles",
                 zorder=3)
    axes.set_title(f"displacement at t = {final.time:.4g} s", fontsize=10)
    axes.set_xlabel("material coordinate X (m)")
    axes.set_ylabel("displacement u (m)")
    axes.set_xlim(0, 1)
    limit = 1.4 * max(abs(curve).max(), _robust_size(moved))
    axes.set_ylim(-(limit or scene.amplitude), limit or scene.amplitude)
    axes.yaxis.get_major_formatter().set_powerlimits((-2, 3))
    axes.grid(alpha=0.3)
    axes.legend(loc="upper right", fontsize=8, ncols=2, markerscale=np.sqrt(30 / size))


def _draw_lanes(figure: Figure, axes: Axes, result: Result) -> None:
    """The bar at the end: a lane for each estimate and one for the truth, on one colour scale."""
    final, cells = result.final, result.scene.cells
    lanes = [("truth", None if final.error is None else np.abs(final.error[:, 0]), TRUTH)]
    lanes += [(f"estimate\n({name})", np.abs(final.estimate[name][:, 0]), ESTIMATE)
              for name, _ in _styled(result)]
    lanes = [lane for lane in lanes if lane[1] is not None] or [("particles", None, "black")]
    few = _thinned(len(final.position))
    few = few[(final.position[few] >= 0) & (final.position[few] <= 1)]  # an unstable run leaves NaN and worse
    known = [_largest(sizes[few]) for _, sizes, _ in lanes if sizes is not None]
    largest = max(known, default=0.0)
    if final.error is not None and known[0] > 0:  # an estimate that has lost its way must not blank the truth
        largest = min(largest, 10 * known[0])
    scale = Normalize(0.0, largest or 1.0)
    width = float(np.clip(700 / max(1, len(few)), 0.7, 10.0))
    for height, (_, sizes, _) in enumerate(lanes):
        mapped = {} if sizes is None else {"array": sizes[few], "cmap": COLOUR_MAP, "norm": scale}
        strokes = axes.vlines(final.position[few], height - 0.32, height + 0.32, linewidth=width, zorder=2,
                              **(mapped or {"color": "0.4"}))
    if not len(few):
        _say(axes, "no particle is left on the bar")
    lined = cells <= MOST_CELL_LINES
    if lined:
        axes.vlines(np.arange(cells + 1) / cells, -0.5, len(lanes) - 0.5, color="0.6",
                    linewidth=min(0.8, 60 / cells), zorder=1)
    axes.set_yticks(range(len(lanes)), [label for label, _, _ in lanes])
    for tick, (_, _, colour) in zip(axes.get_yticklabels(), lanes, strict=True):
        tick.set_color(colour)
    axes.set_ylim(-0.5, len(lanes) - 0.5)
    axes.set_xlim(-0.01, 1.01)
    axes.set_xlabel(f"position x (m){'; grey lines: cell boundaries' if lined else ''}")
    axes.set_title(f"particles at t = {final.time:.4g} s, coloured by the size of the position's error",
                   fontsize=10)
    if len(few) and lanes[0][1] is not None:
        bar = figure.colorbar(strokes, ax=axes, location="bottom", aspect=80, pad=0.02)
        bar.set_label("|error of x| (m), one scale for all lanes")
        bar.formatter.set_powerlimits((-2, 3))
        if not largest:
            bar.set_ticks([0.0])


def _styled(result: Result) -> list[tuple[str, str]]:
    """Each active estimator with its line style."""
    names = result.scene.active_estimators
    return [(name, ESTIMATOR_STYLES[k % len(ESTIMATOR_STYLES)]) for k, name in enumerate(names)]


def _estimator_shade(result: Result, name: str) -> str:
    """Black for one estimator; greys for several, whose quantities share the line styles."""
    names = result.scene.active_estimators
    return INDEX_COLOUR if len(names) == 1 else str(0.65 * names.index(name) / (len(names) - 1))


def _running_ratio(result: Result, estimator: str, quantity: str) -> np.ndarray:
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        ratio = np.cumsum(result.series[f"{estimator}/estimate_{quantity}"]) \
            / np.cumsum(result.series[f"error_{quantity}"])
    return np.where(np.isfinite(ratio), ratio, np.nan)


def _positive(values: np.ndarray) -> np.ndarray:
    """What a logarithmic axis can show; the rest leaves a gap."""
    return np.where(np.isfinite(values) & (values > 0), values, np.nan)


def _span(values: np.ndarray) -> tuple[float, float]:
    """Limits of a logarithmic axis: the first steps, where errors begin at nothing, may leave it below."""
    low = float(np.nanpercentile(values, 2)) / 2
    return low, min(2 * float(np.nanmax(values)), low * 10.0**MOST_DECADES)


def _marker(values: np.ndarray) -> str | None:
    return "o" if np.isfinite(values).sum() <= FEW_SAMPLES else None


def _time_axis(axes: Axes, result: Result) -> None:
    """The run's whole time, with room for the marks of the first and the last sample."""
    end = float(result.series["time"][-1]) or result.scene.time_step
    axes.set_xlim(-0.02 * end, 1.02 * end)


def _thinned(count: int) -> np.ndarray:
    """Indices of the particles to draw: all, or every so many."""
    return np.arange(0, count, -(-count // MOST_DOTS) or 1)


def _largest(values: np.ndarray) -> float:
    finite = values[np.isfinite(values)]
    return float(finite.max()) if len(finite) else 0.0


def _robust_size(values: np.ndarray) -> float:
    """Size that all but a few runaway particles keep to."""
    finite = np.abs(values[np.isfinite(values)])
    return float(np.percentile(finite, 98)) if len(finite) else 0.0


def _say(axes: Axes, sentence: str) -> None:
    axes.text(0.5, 0.5, sentence, transform=axes.transAxes, ha="center", va="center", fontsize=9, color="0.3",
              wrap=True)
