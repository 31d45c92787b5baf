"""A result in a notebook: its table and its picture; the notebook's own plots keep their style."""

from collections.abc import Iterator
from html import escape
from typing import TYPE_CHECKING

from app.names_and_units import NOTHING, QUANTITIES, format_ratio, in_a_line, with_unit
from solvers.running.result import Result
from solvers.solver.soundness import OK

if TYPE_CHECKING:
    from matplotlib.figure import Figure

CELL = "padding: 2px 12px; text-align: {}; font-variant-numeric: tabular-nums"


def result_table(result: Result) -> str:
    """Returns an HTML table: each quantity's largest true RMS error, every estimate of it, its index and distance."""
    valid = [name for name in result.estimate.estimators if name not in result.not_valid]
    head = ["largest RMS error", "true", *(part for name in valid for part in (f"by {name}", "index", "distance"))]
    rows = [[str(quantity), _format_size(result.error[key]["max"], quantity.unit),
             *(text for name in valid for text in (_format_size(result.estimate[name][key]["max"], quantity.unit),
                                                   _format_ratio(result.index[name][key]),
                                                   _format_ratio(result.distance[name][key])))]
            for key, quantity in QUANTITIES.items()]
    ended = f"{result.status} after {result.steps:,} steps, at {with_unit(result.time, 's')}"
    lines = "".join(_table_row("td", row) for row in rows)
    return (f"<div><p>{escape(in_a_line(result.scene))}: <b>{escape(ended)}</b></p>"
            f"<table><thead>{_table_row('th', head)}</thead><tbody>{lines}</tbody></table>"
            + "".join(f"<p>{escape(line)}</p>" for line in _notes(result)) + "</div>")


def _notes(result: Result) -> Iterator[str]:
    """Yields sentences: why the run is not ok, what was not checked, why estimators or indices are not valid."""
    if result.reason:
        yield result.reason
    if result.status == OK and result.verdict["not_checked"]:
        yield result.verdict["not_checked"]
    for name, why in result.not_valid.items():
        yield f"{name}: {why}"
    for key, why in result.rounding.items():
        yield f"no index of {QUANTITIES[key]}: {why}"


def _format_size(value: float | None, unit: str) -> str:
    return NOTHING if value is None else with_unit(value, unit)


def _format_ratio(value: float | None) -> str:
    return NOTHING if value is None else format_ratio(value)


def _table_row(kind: str, cells: list[str]) -> str:
    places = ("left", *("right" for _ in cells[1:]))
    return "<tr>" + "".join(f"<{kind} style=\"{CELL.format(place)}\">{escape(cell)}</{kind}>"
                            for place, cell in zip(places, cells, strict=True)) + "</tr>"


def result_picture(result: Result) -> "Figure":
    """Returns the figure that ``mpm-lab run --plot`` writes: errors over time, and particles."""
    import matplotlib  # here: a table does not need it
    with matplotlib.rc_context():  # this import would set them for the user's whole process
        from app.pictures.run_errors import run_figure
        from app.renderers.picture_style import SETTINGS
        matplotlib.rcParams.update(SETTINGS)
        return run_figure(result)
