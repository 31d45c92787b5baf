"""The picture of a run: true error, estimated error, and their ratio.

Estimate and truth keep the two colours of ``app.colour_palette`` and share every scale. Estimators differ in line
style. All drawing uses the object-oriented interface, so that threads and tests do not share state."""

import io
import textwrap
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from app.colour_palette import ESTIMATE_INK, INK3, TRUTH
from app.frame.error_view_captions import NOTHING_TO_SHOW
from app.names_and_units import QUANTITIES, method_name, motion_text, particles_per_cell, unit_of
from app.pictures.budget import add_cause_legend, draw_budget
from app.problems.views import VIEWS
from app.renderers.picture_panel_style import estimator_styles, positive_or_gap, write_note
from app.renderers.picture_style import ESTIMATE_WIDTH, TRUTH_WIDTH, format_size_axis, label_curve_ends, make_figure
from solvers.running.result import Result
from solvers.scene.error_causes import FIELDS
from solvers.solver import budget_shares
from solvers.solver.error_series import RunningEffectivityIndex
from solvers.solver.rounding import largest_rounding_error

DOTS_PER_INCH = 110
WIDTH, MIN_SHARE = 12.5, 0.3  # inches; least height of bodies side by side over that of one
MADE = 3.2  # inches, height of the error budget
DRAWN = ("x", "v", "sigma")
INDEX_STYLES = {"x": "-", "v": "--", "sigma": ":"}
INDEX_COLOUR = "#333333"  # of a single estimator; several have their colours, as line styles denote quantities
FEW_SAMPLES = 10  # fewer have markers: a line through one point is invisible
HIGHEST_INDEX = 10.0  # keeps the 1 visible when a run blows up
MOST_DECADES = 8  # keeps earlier errors visible then


def run_figure(result: Result, corrected: str = "") -> Figure:
    """Returns the picture of a run: norms and indices over time, errors on the body and, if known, the error budget;
    with the norms of the result minus its estimate by the estimator ``corrected``, "" for none."""
    view = VIEWS[result.scene.problem]
    height, lower = view.picture
    if result.scene.DIMENSIONS > 1:  # one picture of the body per estimator, side by side
        several = max(1, len(result.scene.active_estimators))
        upper, lower = height / (1 + lower), lower * (MIN_SHARE + (1 - MIN_SHARE) / several)
        height = upper * (1 + lower)
    divided = result.scene.has("budget") and budget_shares.why_not_valid(result.series) is None
    figure = make_figure(WIDTH, height + MADE * divided, _figure_title(result))
    places = figure.add_gridspec(2 + divided, 2, height_ratios=(1, lower, MADE * (1 + lower) / height)[:2 + divided])
    norms = places[0, 0].subgridspec(len(DRAWN), 1).subplots(squeeze=False)[:, 0]
    index, space = places[0, 1].subgridspec(2, 1).subplots(squeeze=False)[:, 0]
    for axes, quantity in zip(norms, DRAWN, strict=True):
        _draw_norm(axes, result, quantity, corrected if corrected not in result.not_valid else "")
        axes.tick_params(labelbottom=axes is norms[-1])
    norms[-1].set_xlabel("time t")
    _draw_index(index, result)
    view.draw_picture(figure, space, places[1, :], result)
    if divided:
        draw_budget(places[2, :].subgridspec(1, len(FIELDS)).subplots(squeeze=False)[0], result.series)
        add_cause_legend(figure, result.series, "lower")
    return figure


def png_bytes(figure: Figure) -> bytes:
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=DOTS_PER_INCH)
    return buffer.getvalue()


def save_png(result: Result, path: str) -> None:
    Path(path).write_bytes(png_bytes(run_figure(result)))


def _figure_title(result: Result) -> str:
    scene = result.scene
    lp = ", linearity preserving" if scene.linearity_preserving else ""
    layout = scene.to_dict().get("layout")
    swing = f"A = {scene.amplitude:g} {unit_of(type(scene), 'amplitude')}" if "amplitude" in scene.motion_fields \
        else motion_text(scene)
    first = (f"{scene.problem.capitalize()}, {method_name(scene.method)}{lp} · {scene.cells} cells "
             f"(h = {scene.spacing:.3g} m) · {particles_per_cell(scene.problem, scene.ppc)}"
             f"{f' ({layout} layout)' if layout else ''} · {swing}")
    second = (f"E = {scene.modulus:g} Pa · density {scene.density:g} kg/m³ · cfl {scene.courant_number:.3g} · body "
              f"force {scene.body_force} · {result.steps:,} step{'s' * (result.steps != 1)} to t = {result.time:.4g} s")
    return "\n".join([first, second, *textwrap.wrap(result.reason or "", 130)])


def _draw_norm(axes: Axes, result: Result, quantity: str, corrected: str) -> None:
    """Draws the true and each estimated RMS error of a quantity over time, with a logarithmic vertical axis, and the
    true one of the result minus its estimate by ``corrected``."""
    lines = [("true", "truth", f"error_{quantity}", TRUTH, "-")]
    lines += [(name, f"estimate ({name})", f"{name}/estimate_{quantity}", colour, style)
              for name, colour, style in estimator_styles(result)]
    if corrected:
        words = f"corrected by {corrected}"
        lines.append((words, words, f"{corrected}/difference_{quantity}", TRUTH, ":"))
    drawn: list[tuple[str, np.ndarray, str]] = []
    for name, label, key, colour, style in lines:
        values = positive_or_gap(result.series[key])
        if np.isfinite(values).any():
            width = ESTIMATE_WIDTH if drawn or name != "true" else TRUTH_WIDTH
            axes.plot(result.series["time"], values, color=colour, linestyle=style, linewidth=width, label=label,
                      marker=_marker_if_few_samples(values), markersize=4)
            drawn.append((name, values, colour))
    _set_time_axis(axes, result)
    axes.set_title(f"Error of {QUANTITIES[quantity]}" + ", RMS over particles, logarithmic" * (quantity == "x"))
    silent = _estimators_without_quantity(result, quantity)
    if not drawn:
        axes.set_yticks([])
        write_note(axes,
                   f"nothing to show: not estimated by {', '.join(silent)}, and no true error was computed" if silent
                   else NOTHING_TO_SHOW)
        return
    if silent:
        axes.text(0.99, 0.04, f"not estimated by {', '.join(silent)}", transform=axes.transAxes, fontsize=9.5,
                  color=ESTIMATE_INK, ha="right")
    values = np.concatenate([values for _, values, _ in drawn])
    low = float(np.nanpercentile(values, 2)) / 2  # the first errors, which start at zero, may be below
    axes.set(yscale="log", ylim=(low, min(2 * float(np.nanmax(values)), low * 10.0**MOST_DECADES)))
    format_size_axis(axes.yaxis, QUANTITIES[quantity].unit)
    label_curve_ends(axes, drawn, apart=0.17)


def _draw_index(axes: Axes, result: Result) -> None:
    """Draws the error indices of the run so far over time (eq 35: summed estimates over summed true errors)."""
    axes.set_title("Error index so far: sum of estimates / sum of true errors; 1 is perfect")
    axes.set_xlabel("time t")
    axes.axhline(1.0, color=TRUTH, linewidth=1.2)
    highest = 1.0
    silent: list[str] = []
    drawn: list[tuple[str, np.ndarray, str]] = []
    several = len(result.scene.active_estimators) > 1
    for name, colour, _ in estimator_styles(result):
        for quantity, style in INDEX_STYLES.items():
            symbol = QUANTITIES[quantity].symbol
            estimated, true = result.series[f"{name}/estimate_{quantity}"], result.series[f"error_{quantity}"]
            ratio = RunningEffectivityIndex().extend(estimated, true,
                                                     largest_rounding_error(result.scene, quantity, result.steps))
            ratio = np.where(np.isfinite(ratio), ratio, np.nan)
            if not np.isfinite(ratio).any():
                silent += [f"{symbol} by {name}"] * (name in _estimators_without_quantity(result, quantity))
                continue
            highest = max(highest, float(np.nanpercentile(ratio, 90)))
            axes.plot(result.series["time"], ratio, color=colour if several else INDEX_COLOUR,
                      linestyle=style, linewidth=1.4, label=f"{symbol} ({name})" if several else symbol,
                      marker=_marker_if_few_samples(ratio), markersize=4)
            drawn.append((f"{symbol} {name}" if several else symbol, ratio, colour if several else INK3))
    _set_time_axis(axes, result)
    if not axes.get_legend_handles_labels()[0]:
        axes.set_yticks([])
        rounded = set(result.rounding) >= set(INDEX_STYLES) and bool(result.scene.active_estimators)
        write_note(axes, "no index: the true errors are nothing but rounding" if rounded else
                   "nothing to show: the index needs an estimate and a true error")
        return
    axes.set_ylim(0, 1.35 * min(highest, HIGHEST_INDEX))
    format_size_axis(axes.yaxis, "")
    if silent:
        axes.text(0.99, 0.97, f"not estimated: {', '.join(silent)}", transform=axes.transAxes, fontsize=9.5,
                  color=ESTIMATE_INK, va="top", ha="right")
    label_curve_ends(axes, drawn, apart=0.11)


def _estimators_without_quantity(result: Result, quantity: str) -> list[str]:
    """Returns the names of the active estimators that did not estimate a quantity in this run."""
    return [name for name in result.scene.active_estimators
            if np.isnan(result.series[f"{name}/estimate_{quantity}"]).all()]


def _marker_if_few_samples(values: np.ndarray) -> str | None:
    return "o" if np.isfinite(values).sum() <= FEW_SAMPLES else None


def _set_time_axis(axes: Axes, result: Result) -> None:
    """Sets the horizontal axis to the times of the whole run in s, with a margin for markers at its ends."""
    end = float(result.series["time"][-1]) or result.scene.time_step
    axes.set_xlim(-0.02 * end, 1.02 * end)
    format_size_axis(axes.xaxis, "s", few=False)
