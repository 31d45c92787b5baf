"""Runs of tables, measured and stored like rows of any study, and a finished table as one JSON object: for each row its
inputs, the paper's numbers, ours, and the estimators'. All that is printed or drawn of a table comes from this."""

from collections.abc import Callable, Iterable, Mapping

from solvers.scene.scene import Scene
from solvers.solver.error_series import finite_or_none
from solvers.solver.samples import QUANTITIES
from solvers.study.json_schema import NUMBER, MapOf
from solvers.study.parameter_grid import Task, task_of
from solvers.study.row import NORMS, identity_columns, measure
from solvers.study.tables.paper_table_definitions import PaperTableDefinition, TableRowDefinition

SCHEMA, RUN_SCHEMA = "mpm-lab/tables/1", "mpm-lab/tables-run/1"
PAPERS_ESTIMATOR = "transport"
TIMED = ("cost",)  # runs of which times are shown: they are made alone
#: What is read of a run.
MEASURED = {"result": {"scene": dict, "t": NUMBER, "particles": int, "error": NORMS, "index": dict, "distance": dict,
                       "grid_crossings": (int, type(None)), "not_valid": MapOf(str), "refused": dict,
                       "seconds": {"setup": NUMBER, "compile": NUMBER, "run": NUMBER, "estimators": MapOf(NUMBER)}}}

Results = Mapping[str, dict]  # the object of ``mpm-lab run --json`` for each run of a row


def all_runs(tables: Iterable[PaperTableDefinition]) -> list[Task]:
    """Returns the distinct runs of tables: first those without timing, the longest first, so that no CPU is idle at the
    end; then the timed ones, whose ``repeats`` is 1."""
    scenes = [(name in TIMED, scene) for table in tables for row in table.rows for name, scene in row.scenes.items()]
    wanted = sorted(scenes, key=lambda one: (one[0], 0 if one[0] else -one[1].particles * one[1].steps))
    found = {task.key: task for task in (task_of(scene, repeats=int(timed)) for timed, scene in wanted)}
    return list(found.values())


def measure_in_worker(task: dict, answer: Callable[[dict], None]) -> None:
    """Measures the run of a task (fields of Task) in a worker process, with prices if it is timed; sends its row."""
    from solvers.running.run import reuse_solvers  # here: Taichi is for workers

    reuse_solvers()
    answer(measure(Task(**task), _run_to_row))


def _run_to_row(task: Task, scene: Scene) -> dict:
    """Runs a scene; returns the row to store, with the object of ``mpm-lab run --json`` under ``result``."""
    from solvers.running.run import run  # here: a row can be read, kept and drawn without Taichi

    result = run(scene, prices=task.repeats > 0, mid_run=False).to_dict()
    return {**identity_columns(task), "schema": RUN_SCHEMA, "status": result["status"], "reason": result["reason"],
            "result": result}


def results_by_row(table: PaperTableDefinition, rows: Iterable[dict]) -> dict[str, Results]:
    """Returns the results of a table's runs by name of the row and run, from the stored ``rows`` of all runs."""
    found = {row["key"]: row["result"] for row in rows if "result" in row}
    return {row.name: {name: found[task_of(scene).key] for name, scene in row.scenes.items()} for row in table.rows}


def table_to_dict(table: PaperTableDefinition, results: Mapping[str, Results]) -> dict:
    """Returns the JSON object of a table; ``results`` are from :func:`results_by_row`."""
    names = dict.fromkeys(name for row in table.rows for name in row.scenes["errors"].estimators)
    seconds = [result["seconds"] for row in table.rows for result in results[row.name].values()]
    return {"schema": SCHEMA, "table": table.number, "title": table.title, "caption": table.caption,
            "setup": list(table.setup), "estimators": list(names),
            "rows": [_row_to_dict(table.number, row, results[row.name]) for row in table.rows],
            "seconds": {part: sum(each[part] for each in seconds) for part in ("setup", "compile", "run")}}


def rows_by_part(table: dict) -> dict[str, list[dict]]:
    """Returns the rows of a table's JSON object by their heading, in order."""
    found: dict[str, list[dict]] = {}
    for row in table["rows"]:
        found.setdefault(row["part"], []).append(row)
    return found


def _row_to_dict(number: str, row: TableRowDefinition, results: Results) -> dict:
    """Returns the JSON object of a row of Table ``number``: inputs, the paper's values, ours, their ratios."""
    run = results["errors"]
    ours = _computed_values(number, results)
    paper = {key: row.paper.get(key) for key in ours}
    inputs = run["scene"] | ({"t_end_crossings": results["crossings"]["t"]} if "crossings" in results else {})
    gone_bad = next((result["reason"] for result in results.values() if result["status"] != "ok"), None)
    return {"name": row.name, "part": row.part, "inputs": inputs, "particles": run["particles"],
            "h": row.scenes["errors"].spacing, "unstable": gone_bad, "paper": paper, "ours": ours,
            "ratio": {key: _ratio(ours[key], paper[key]) for key in ours},
            "estimators": {name: _estimator_to_dict(name, results) for name in run["scene"]["estimator"]}}


def _computed_values(number: str, results: Results) -> dict:
    """Returns our values in a row, by name. Table 1: largest RMS errors in SI units, crossings in the long and the
    short run, indices of the paper's estimator; Table 2: errors at the end; Table 3: the index of x."""
    run = results["errors"]
    if number == "2":
        return {q: run["error"][q]["final"] for q in ("x", "v", "a_nodes")}
    indices = {f"index_{q}": _estimator_value(run, "index", PAPERS_ESTIMATOR, q) for q in ("x", "v", "sigma")}
    if number == "3":
        return {"index_x": indices["index_x"]}
    return {**{q: run["error"][q]["max"] for q in ("x", "v", "sigma_log")},
            "grid_crossings": results["crossings"]["grid_crossings"], "grid_crossings_short": run["grid_crossings"],
            **indices}


def _estimator_to_dict(name: str, results: Results) -> dict:
    """Returns an estimator's index and distance by quantity, its share of the run time, and why it is not valid."""
    run, cost = results["errors"], results["cost"]
    seconds = cost["seconds"]["estimators"].get(name)
    reason = run["not_valid"].get(name) or cost["not_valid"].get(name)
    return {"index": {q: _estimator_value(run, "index", name, q) for q in QUANTITIES},
            "distance": {q: _estimator_value(run, "distance", name, q) for q in QUANTITIES},
            "cost": None if seconds is None else _ratio(seconds, cost["seconds"]["run"]), "not_valid": reason}


def _estimator_value(run: dict, kind: str, name: str, quantity: str) -> float | None:
    """Returns an estimator's index or distance (``kind``) of a quantity from a result's object; None if unknown. The
    paper's estimator has them where it is not valid too, as in the paper."""
    names = run["scene"]["estimator"]
    if name == PAPERS_ESTIMATOR and name in run["refused"]:
        return run["refused"][name][kind][quantity]
    if name not in names or name in run["not_valid"]:
        return None
    return (run[kind][name] if len(names) > 1 else run[kind])[quantity]  # a single estimator has no level of names


def _ratio(above: float | None, below: float | None) -> float | None:
    return finite_or_none(above / below) if above is not None and below else None
