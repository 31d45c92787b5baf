"""Rows as a table: CSV with a column for every number, and a summary in Markdown."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from solvers.scene.error_causes import CAUSES
from solvers.scene.estimator_registry import COMPANION
from solvers.solver.soundness import BROKEN, OK
from solvers.study import convergence_analysis
from solvers.study.convergence_analysis import (
    completed_rows,
    corrected_rows,
    error_of,
    group_series,
    pareto,
    varying_inputs,
)
from solvers.study.markdown_tables import markdown_table
from solvers.study.row import FAILED, REFUSED
from solvers.untrusted import quoting

SHOWN = ("x", "v", "sigma")
BUDGETED = ("x", "v")  # of which the shares of each cause are shown
NOTHING = "–"


def flatten_row(row: Mapping, before: str = "") -> dict:
    """Returns a row without levels: ``error.x.max`` for ``row["error"]["x"]["max"]``; lists become texts."""
    values: dict[str, Any] = {}
    for name, value in row.items():
        if isinstance(value, Mapping):
            values |= flatten_row(value, f"{before}{name}.")
        else:
            values[before + name] = " ".join(map(str, value)) if isinstance(value, (list, tuple)) else value
    return values


def uniform_rows(rows: Iterable[Mapping]) -> list[dict]:
    """Returns rows without levels, all with the union of their keys, and None where a row has no value."""
    lines = [flatten_row({**row, "scene": row["scene"] or row["asked"], "asked": {}}) for row in rows]
    names = list(dict.fromkeys(name for line in sorted(lines, key=len, reverse=True) for name in line))
    return [{name: line.get(name) for name in names} for line in lines]


def csv_text(rows: Iterable[Mapping]) -> str:
    """Returns a CSV with one line per row, a column for each key of any row; missing values are empty."""
    lines = uniform_rows(rows)
    return quoting.csv_text([lines[0] if lines else (), *(line.values() for line in lines)])


def study_to_dict(problem: str, rows: Sequence[dict]) -> dict:
    """Returns the whole study as one object for JSON: its rows, and the fitted orders of convergence."""
    return {"schema": "mpm-lab/sweep/1", "problem": problem, "rows": list(rows),
            "fits": convergence_analysis.fit_orders(rows)}


def summarise_study(problem: str, rows: Sequence[dict], pictures: Sequence[str] = ()) -> str:
    """Returns the study in Markdown: every row in short, orders of convergence, the rows that are best for their time,
    failures, and links to ``pictures`` (file names)."""
    counts = {status: sum(row["status"] == status for row in rows) for status in (OK, *BROKEN, FAILED, REFUSED)}
    parts = [f"# Sweep of the {problem}",
             f"{len(rows)} rows: " + ", ".join(f"{count} {status}" for status, count in counts.items() if count) + "."]
    names = list(dict.fromkeys(["method", "cells", *varying_inputs(rows)]))
    ways = [*rows, *corrected_rows(rows)]
    parts += [_rows_table(ways, names), _orders_table(rows), _pareto_table(ways, names), _reasons_list(rows, names)]
    parts += [f"![{name}]({name})" for name in pictures]
    return "\n\n".join(part for part in parts if part) + "\n"


def _rows_table(rows: Sequence[dict], names: Sequence[str]) -> str:
    estimators = list(dict.fromkeys(name for row in completed_rows(rows) for name in row["index"]))
    divided = any(row.get("budget") for row in rows)
    shares = [(field, cause) for field in BUDGETED for cause in CAUSES] if divided else []
    heads = [*names, "status", *(f"error {q}" for q in SHOWN), *(f"{e}: index {q}" for e in estimators for q in SHOWN),
             *(f"{CAUSES[cause]}: share of {field}" for field, cause in shares), "seconds", "10⁶ particle-steps/s"]
    lines = []
    for row in rows:
        values = row["scene"] or row["asked"]
        index, budget = row.get("index") or {}, row.get("budget") or {}
        if budget.get("not_valid"):
            budget = {}  # shares are meaningless there
        large = row["status"] == OK and row.get("as_large_as_itself")  # for these the status does not hold
        status = row["status"] + (f" for x, not for {', '.join(large)}" if large else "")
        lines.append([*(_way_cell(row, values, name) for name in names), status,
                      *(_number(error_of(row, q), ".3e") for q in SHOWN),
                      *(_number((index.get(e) or {}).get(q), ".3f") for e in estimators for q in SHOWN),
                      *(_number((budget.get(field) or {}).get(cause), ".3f") for field, cause in shares),
                      _number((row.get("seconds") or {}).get("min"), ".4g"), _number(row.get("rate"), ".3g")])
    most = max((row.get("side_by_side") or 1 for row in rows), default=1)
    beside = f", taken while up to {most} rows ran side by side" * (most > 1)
    corrected = ", with the estimator's where the result is corrected by subtracting its estimate" \
        * any("corrected_by" in row for row in rows)
    if any(COMPANION in (row.get("corrected") or {}) for row in rows):
        beside += ". Corrected by companion no MPM is left in a result, so that is in table.csv alone"
    return f"Errors are the largest RMS over particles; seconds the shortest of the bare runs{corrected}{beside}.\n\n" \
        + markdown_table(heads, lines)


def _orders_table(rows: Sequence[dict]) -> str:
    title = "## Order of convergence: error ~ h^p\n\n"
    lines, said = [], dict[str, list[str]]()
    for line in group_series(rows):
        found = {q: fit for q in SHOWN if (fit := line.fit(q))}
        if found:
            lines.append([line.label(), *(_number(found[q].order, ".2f") if q in found else NOTHING for q in SHOWN),
                          *(", ".join(f"{p:.2f}" for p in reversed(found[q].pairwise)) if q in found else NOTHING
                            for q in SHOWN)])
        for q, fit in found.items():
            if words := (f"no order, {fit.reason}" if fit.reason else fit.remark):
                said.setdefault(words, []).append(f"{line.label()}, {q}")
    if not lines:
        return title + "Nothing to fit: it takes two grids at least, and true errors."
    remarks = [f"* {who[0]}{f' and {len(who) - 1} more' * (len(who) > 1)}: {words}" for words, who in said.items()]
    table = markdown_table(["", *SHOWN, *(f"{q}, grid to grid" for q in SHOWN)], lines)
    return title + "\n\n".join(["Fitted over all stable grids, and from each grid to the next finer one.", table,
                                "\n".join(remarks)]).rstrip()


def _pareto_table(rows: Sequence[dict], names: Sequence[str]) -> str:
    usable = [row for row in completed_rows(rows) if row["status"] == OK and error_of(row, "x")]
    if not usable:
        return ""
    front = pareto([row["seconds"]["min"] for row in usable], [error_of(row, "x") or 0 for row in usable])
    lines = [[*(_way_cell(row, row["scene"], name) for name in names), _number(error_of(row, "x"), ".3e"),
              _number(row["seconds"]["min"], ".4g")] for row in (usable[k] for k in front)]
    return "## Best for its time\n\nNo other row has a smaller error of x in less time.\n\n" \
        + markdown_table([*names, "error x", "seconds"], lines)


def _reasons_list(rows: Sequence[dict], names: Sequence[str]) -> str:
    """Returns a list in Markdown of runs that are not ok, or only for positions, once for each reason."""
    reasons: dict[tuple[str, str], list[dict]] = {}
    for row in rows:
        if row["reason"]:
            reasons.setdefault((row["status"], row["reason"]), []).append(row)
    lines = []
    for (status, reason), alike in reasons.items():
        first = ", ".join(f"{name} {_cell((alike[0]['scene'] or alike[0]['asked']).get(name))}" for name in names)
        more = f" and {len(alike) - 1} more" if len(alike) > 1 else ""
        lines.append(f"* {first}{more}: {status}: {quoting.escape_markdown(reason)}")
    return "## Not ok, or not for all\n\n" + "\n".join(lines) if lines else ""


def _way_cell(row: Mapping, inputs: Mapping, name: str) -> str:
    """Returns the cell of an input; that of the method names the estimator that corrects the result too."""
    corrected = f", corrected by {row['corrected_by']}" if name == "method" and "corrected_by" in row else ""
    return _cell(inputs.get(name)) + corrected


def _cell(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    text = " ".join(map(str, value)) if isinstance(value, (list, tuple)) else NOTHING if value is None else str(value)
    return quoting.escape_markdown(text, quoting.QUOTE)


def _number(value: float | None, form: str) -> str:
    return NOTHING if value is None else format(value, form)
