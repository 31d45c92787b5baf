"""The picture of a table, from its JSON object: errors against h, and each estimator's index against the cells."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.ticker import FixedFormatter, FixedLocator, LogLocator, NullFormatter, NullLocator

from app.colour_palette import ESTIMATE_INK, INK, INK3, TRUTH
from app.names_and_units import EXTRA_NORMS, QUANTITIES, method_name, with_unit
from app.renderers.picture_panel_style import Look, line_style, write_note
from app.renderers.picture_style import format_size_axis, make_figure
from solvers.scene.estimator_registry import ESTIMATORS
from solvers.study.tables.paper_table_definitions import format_round_number
from solvers.study.tables.table_runs import rows_by_part

PAPER: Look = dict(color=INK, marker="x", markersize=7, markeredgewidth=1.6, linestyle="none",
                   label="the paper's, printed")
#: Styles of the first and second set-up.
OURS: tuple[Look, ...] = (dict(color=TRUTH, linestyle="-", marker="o", markersize=5),
                          dict(color=TRUTH, linestyle="--", marker="o", markersize=5, markerfacecolor="white"))
BAND = (0.8, 1.25)  # range of a reliable index
LEAST_SPAN, MOST_SPAN = (0.3, 3.0), (0.003, 2000.0)  # of the axis of an index


def table_figure(table: dict) -> Figure:
    """Returns the picture of a table of the paper, from its JSON object (``table_to_dict``)."""
    width, height = {"1": (15, 19), "2": (13, 12), "3": (20, 12.5)}[table["table"]]
    whole = make_figure(width, height, f"{table['title']}\n{table['caption']}")
    draw = {"1": (_draw_bar_errors, _draw_index_panels), "2": (_draw_ring_errors,),
            "3": (_draw_index_panels,)}[table["table"]]
    places = whole.add_gridspec(len(draw), 1, height_ratios=(1, 1.75)[:len(draw)], hspace=0.03)
    for k, part in enumerate(draw):
        part(whole.add_subfigure(places[k]), table)
    return whole


def _draw_bar_errors(figure: SubFigure, table: dict) -> None:
    """Draws the errors of Table 1 over h: a row of panels per modulus, with both variants of the body force in each."""
    cases = _group_rows("modulus", table["rows"])
    axes = figure.subplots(len(cases), 3, squeeze=False)
    for across, (modulus, rows) in zip(axes, cases.items(), strict=True):
        forces, amplitude = _group_rows("body_force", rows), rows[0]["inputs"]["amplitude"]
        series = {"ours, force at nodes": forces["node"], "ours, force at material points": forces["material"]}
        for panel, key in zip(across, ("x", "v", "sigma_log"), strict=True):
            _draw_errors(panel, series, key)
        across[1].set_title(f"E = {modulus:g} Pa, A = {format_round_number(amplitude)} m: largest RMS error over time",
                            loc="center")
    _add_legend(figure, axes[0, 0])


def _draw_ring_errors(figure: SubFigure, table: dict) -> None:
    """Draws the errors of Table 2 over h: a column of panels per method, with both set-ups in each panel."""
    methods = _group_rows("method", table["rows"])
    axes = figure.subplots(3, len(methods), squeeze=False, sharey="row")
    for panels, method in zip(axes.T, methods, strict=True):
        series = {part: _group_rows("method", rows)[method] for part, rows in rows_by_part(table).items()}
        for panel, key in zip(panels, ("x", "v", "a_nodes"), strict=True):
            _draw_errors(panel, series, key)
        panels[0].set_title(method_name(method))
    for panel in axes[:, 1:].flat:
        panel.set_ylabel("")
    _add_legend(figure, axes[0, 0], columns=1)


def _draw_index_panels(figure: SubFigure, table: dict) -> None:
    """Draws error indices over the cells: a row of panels per quantity, a column per heading (Table 3: and method)."""
    if table["table"] == "1":
        columns = {"\n".join(part.rsplit(", ", 1)): rows for part, rows in rows_by_part(table).items()}
    else:
        columns = {"\n".join([method_name(method), *part.partition(" (")[0].rsplit(", ", 1)]): rows
                   for part, found in rows_by_part(table).items() for method,
                   rows in _group_rows("method", found).items()}
    known = [quantity for quantity in QUANTITIES if any(_has_index(row, quantity) for row in table["rows"])]
    if not known:
        write_note(figure.subplots(), "no estimator gives an index here")
        return
    axes = figure.subplots(len(known), len(columns), squeeze=False, sharey="row")
    for panels, (title, rows) in zip(axes.T, columns.items(), strict=True):
        _draw_indices(panels, rows, known)
        panels[0].set_title(title)
    for across, name in zip(axes, (QUANTITIES[quantity] for quantity in known), strict=True):
        values = [value for panel in across for line in panel.get_lines() for value in line.get_ydata()]
        low = max(MOST_SPAN[0], min(LEAST_SPAN[0], min(values) / 1.4))
        high = min(MOST_SPAN[1], max(LEAST_SPAN[1], max(values) * 1.4))
        bottom = low * (low / high) ** 0.08  # space for text
        outer = next(panel for panel in across if panel.axison)
        outer.set(yscale="log", ylim=(bottom, high), ylabel=f"index of {name}")
        outer.tick_params(labelleft=True)
        _format_log_ticks(outer)
    for panels in axes.T:
        for panel in [panel for panel in panels if panel.axison][-1:]:
            panel.set_xlabel("cells")
    _add_legend(figure, next(panel for panel in axes.flat if panel.axison))


def _has_index(row: dict, quantity: str) -> bool:
    """Whether any estimator or the paper has an index of a quantity in a row of a table's JSON object."""
    ours = any(estimator["index"][quantity] for estimator in row["estimators"].values())
    return ours or bool(row["paper"].get(f"index_{quantity}"))


def _group_rows(name: str, rows: list[dict]) -> dict[Any, list[dict]]:
    """Groups a table's rows by the value of the scene's input ``name``, in the order of appearance."""
    values = dict.fromkeys(row["inputs"][name] for row in rows)
    return {value: [row for row in rows if row["inputs"][name] == value] for value in values}


def _draw_errors(axes: Axes, series: dict[str, list[dict]], key: str) -> None:
    """Draws the error ``key`` over h: ours by series (rows by label), the paper's, slopes of first and second order."""
    axes.set(xscale="log", yscale="log")
    for style, (label, rows) in zip(OURS, series.items(), strict=False):
        axes.plot(*_known_points((row["h"], row["ours"][key]) for row in rows), label=label, **style)
    rows = next(iter(series.values()))
    axes.plot(*_known_points((row["h"], row["paper"][key]) for row in rows), **PAPER)
    spacings = sorted({row["h"] for row in rows})
    _set_ticks(axes, {h: with_unit(h, "m") for h in spacings})
    quantity = (QUANTITIES | EXTRA_NORMS)[key]
    axes.set(xlim=(spacings[0] / 1.25, spacings[-1] * 1.45), xlabel="cell size h", ylabel=f"error of {quantity.symbol}")
    _draw_slopes(axes, spacings[-1])
    format_size_axis(axes.yaxis, quantity.unit)


def _draw_slopes(axes: Axes, largest: float) -> None:
    """Draws triangles of first and second order under the right end, h = ``largest``, of the curves."""
    points = np.concatenate([np.asarray(line.get_xydata()) for line in axes.get_lines()])
    heights = points[points[:, 0] > 0.45 * largest, 1]
    if not len(heights):
        return
    left, low = largest / 2, float(heights.min()) / 8
    for order in (1, 2):
        high = low * 2**order
        axes.plot([left, largest, largest, left], [low, low, high, low], color=INK3, linewidth=0.9)
        axes.annotate(f" {order}", (largest, high), fontsize=9.5, color=INK3, va="center")


def _draw_indices(panels: list[Axes], rows: list[dict], quantities: list[str]) -> None:
    """Draws the error indices of some rows over the cells, a panel per quantity, with the band of reliable values."""
    cells = [row["inputs"]["cells"] for row in rows]
    for axes, quantity in zip(panels, quantities, strict=True):
        if not any(_has_index(row, quantity) for row in rows):
            axes.set_axis_off()
            write_note(axes, f"no index of {QUANTITIES[quantity].symbol} here")
            continue
        axes.set(xscale="log", xlim=(cells[0] / 1.25, cells[-1] * 1.25))
        axes.axhspan(*BAND, color=TRUTH, alpha=0.13, linewidth=0, label="0.8 to 1.25")
        axes.axhline(1.0, color=TRUTH, linewidth=1.2, label="1, perfect")
        silent = []
        for k, name in enumerate(rows[0]["estimators"]):
            points = _known_points((row["inputs"]["cells"], row["estimators"][name]["index"][quantity]) for row in rows)
            silent += [name] * (not points[1])
            look = ESTIMATORS[name]
            axes.plot(*points, color=look.colour, linestyle=line_style(name), marker=look.symbol, markersize=5.5,
                      markerfacecolor="white" if k % 2 else look.colour, linewidth=1.3, label=look.title)
        axes.plot(*_known_points((row["inputs"]["cells"], row["paper"].get(f"index_{quantity}")) for row in rows),
                  **PAPER)
        _set_ticks(axes, {n: str(n) for n in cells})
        if silent:
            axes.text(0.03, 0.04, f"no index: {', '.join(silent)}", transform=axes.transAxes, fontsize=9.5,
                      color=ESTIMATE_INK)


def _format_log_ticks(axes: Axes) -> None:
    """Sets ticks of a logarithmic vertical axis: 1, 2, 5 if it is short, else powers of ten."""
    low, high = axes.get_ylim()
    axes.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5) if high / low < 60 else (1,)))
    axes.yaxis.set_major_formatter(lambda value, _: format_round_number(value))
    axes.yaxis.set_minor_formatter(NullFormatter())


def _set_ticks(axes: Axes, labels: Mapping[float, str]) -> None:
    """Sets the only ticks of the horizontal axis, labels by value; ``set_xticks`` would change its limits."""
    axes.xaxis.set_major_locator(FixedLocator(list(labels)))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter(FixedFormatter(list(labels.values())))


def _add_legend(figure: SubFigure, axes: Axes, columns: int = 7) -> None:
    figure.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=columns)


def _known_points(points: Iterable[tuple[float, float | None]]) -> tuple[list[float], list[float]]:
    """Returns the x and the y of the points whose y is neither None nor 0."""
    known = [(x, y) for x, y in points if y]
    return [x for x, _ in known], [y for _, y in known]
