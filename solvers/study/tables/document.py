"""A finished table as one JSON object: for each row what went in, the paper's numbers, ours, and the estimators'.

Everything that is printed or drawn of a table is made from this object and nothing else.
"""

from collections.abc import Mapping

from solvers.solver.norms import finite
from solvers.solver.samples import QUANTITIES
from solvers.study.tables.plan import Row, Table

SCHEMA = "mpm-lab/tables/1"
PAPERS_ESTIMATOR = "transport"
TIMED = ("cost",)  # runs of which times are shown: they are made alone

Results = Mapping[str, dict]  # the object of ``mpm-lab run --json`` for each run of a row


def document(table: Table, results: Mapping[str, Results]) -> dict:
    """The object of a table; ``results`` holds each row's under its name."""
    names = dict.fromkeys(name for row in table.rows for name in row.scenes["errors"].estimators)
    seconds = [result["seconds"] for row in table.rows for result in results[row.name].values()]
    return {"schema": SCHEMA, "table": table.number, "title": table.title, "caption": table.caption,
            "setup": list(table.setup), "estimators": list(names),
            "rows": [_row(table.number, row, results[row.name]) for row in table.rows],
            "seconds": {part: sum(each[part] for each in seconds) for part in ("setup", "compile", "run")}}


def parts(table: dict) -> dict[str, list[dict]]:
    """The rows of a table's object under each heading, in order."""
    found: dict[str, list[dict]] = {}
    for row in table["rows"]:
        found.setdefault(row["part"], []).append(row)
    return found


def _row(number: str, row: Row, results: Results) -> dict:
    run = results["errors"]
    ours = _ours(number, results)
    paper = {key: row.paper.get(key) for key in ours}
    inputs = run["scene"] | ({"t_end_crossings": results["crossings"]["t"]} if "crossings" in results else {})
    gone_bad = next((result["reason"] for result in results.values() if result["status"] != "ok"), None)
    return {"name": row.name, "part": row.part, "inputs": inputs, "particles": run["particles"],
            "h": row.scenes["errors"].spacing, "unstable": gone_bad, "paper": paper, "ours": ours,
            "ratio": {key: _ratio(ours[key], paper[key]) for key in ours},
            "estimators": {name: _estimator(name, results) for name in run["scene"]["estimator"]}}


def _ours(number: str, results: Results) -> dict:
    """Of a row of Table 1 the largest errors, crossings to the end of the long run and of the short one, and indices of
    the paper's estimator; of Table 2 the errors at the end; of Table 3 that index of x."""
    run = results["errors"]
    if number == "2":
        return {q: run["error"][q]["final"] for q in ("x", "v", "a_nodes")}
    indices = {f"index_{q}": _of(run, "index", PAPERS_ESTIMATOR, q) for q in ("x", "v", "sigma")}
    if number == "3":
        return {"index_x": indices["index_x"]}
    return {**{q: run["error"][q]["max"] for q in ("x", "v", "sigma_log")},
            "grid_crossings": results["crossings"]["grid_crossings"], "grid_crossings_short": run["grid_crossings"],
            **indices}


def _estimator(name: str, results: Results) -> dict:
    run, cost = results["errors"], results["cost"]
    seconds = cost["seconds"]["estimators"].get(name)
    reason = run["not_valid"].get(name) or cost["not_valid"].get(name)
    return {"index": {q: _of(run, "index", name, q) for q in QUANTITIES},
            "distance": {q: _of(run, "distance", name, q) for q in QUANTITIES},
            "cost": None if seconds is None or reason else _ratio(seconds, cost["seconds"]["run"]),
            "not_valid": reason}


def _of(run: dict, kind: str, name: str, quantity: str) -> float | None:
    """One estimator's index or distance; a run with a single estimator does not key them by its name."""
    names = run["scene"]["estimator"]
    if name not in names or name in run["not_valid"]:
        return None
    return (run[kind][name] if len(names) > 1 else run[kind])[quantity]


def _ratio(above: float | None, below: float | None) -> float | None:
    return finite(above / below) if above is not None and below else None
