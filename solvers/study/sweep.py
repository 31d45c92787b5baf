"""A sweep as a function: every combination of lists of values, one row each, and columns of these rows by name."""

import contextlib
import math
import numbers
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import fields
from typing import Any, SupportsIndex, overload

import numpy as np

from solvers.bodies.body import Body
from solvers.problems import PROBLEMS
from solvers.running.run import as_scene
from solvers.scene.scene import LISTS, Scene
from solvers.scene.validation import SceneError, field_key, key_field, require_choice, require_whole
from solvers.study.body_sweep import MEASURE_BODY, BodyTask, plan_body_tasks
from solvers.study.csv_and_markdown_summary import uniform_rows
from solvers.study.executors import MEASURE_ROW, LocalExecutor, execute
from solvers.study.parameter_grid import MOST_ROWS, plan_tasks
from solvers.study.row import failed_row
from solvers.untrusted import quoting

#: Alternative inputs, of which only one may be given.
ALTERNATIVES = {"dt": "cfl", "cfl": "dt", "t_end": "periods", "periods": "t_end"}


class Rows(list[dict]):
    """Rows with the same keys. A name selects a column: ``rows["error.x.max"]``, as an array over the rows."""

    def __init__(self, rows: Iterable[Mapping] = ()):
        super().__init__(map(dict, rows))

    @overload
    def __getitem__(self, which: SupportsIndex) -> dict: ...
    @overload
    def __getitem__(self, which: slice) -> "Rows": ...
    @overload
    def __getitem__(self, which: str) -> np.ndarray: ...

    def __getitem__(self, which):
        """Returns a row by its number, rows by a slice, a column by its name: numbers with NaN where a row has none, or
        anything else as objects, so that ``rows["scene.method"] == "mpm"`` is a mask of rows.

        Raises
        ------
        SceneError
            For a column that does not exist, with those that do.
        """
        if isinstance(which, str):
            return self._column(which)
        found = super().__getitem__(which)
        return Rows(found) if isinstance(which, slice) else found

    @property
    def columns(self) -> list[str]:
        """Names of all columns."""
        return list(self[0]) if self else []

    def _column(self, name: str) -> np.ndarray:
        if name not in self.columns:
            raise SceneError("column", name, f"is none of these rows{quoting.suggest_word(name, self.columns)}; they "
                             f"have {', '.join(self.columns) or 'none'}")
        values = [row[name] for row in self]
        known = [value for value in values if value is not None]
        if not known or not all(isinstance(value, numbers.Real) and not isinstance(value, bool) for value in known):
            return np.array([*values, None], dtype=object)[:-1]
        if len(known) == len(values) and all(isinstance(value, numbers.Integral) for value in values):
            return np.array(values)
        return np.array([np.nan if value is None else value for value in values], float)


def sweep(problem: str | Scene | type[Scene] | Body, *, repeats: int = 3, workers: int = 1,
          on_progress: Callable[[float, dict], None] = lambda part, row: None, **inputs: Any) -> Rows:
    """Measures a problem for every combination of values: ``sweep("bar", cells=[20, 40], method=["mpm", "bspline"])``.

    Parameters
    ----------
    problem
        "bar", "ring", "vortex" or "square"; or a scene, which gives the values that ``inputs`` do not. A body does
        too; its rows have the columns ``estimate.x.max``, ``estimate.x.delta``, ``goals.NAME.value``, ``.bar``, ...
    repeats
        Timed runs of each row, of which the shortest counts; 0 times only the run that gives the errors, as always for
        bodies.
    workers
        Processes that measure side by side, which disturbs the timings. An estimator that is registered in the caller's
        process alone is not known there; name its module in the environment variable ``MPM_LAB_EXTENSIONS``.
    on_progress
        Called after each row, as they come, with the part done (0 to 1) and the row.
    inputs
        Fields of the problem's scene. A list, range or array has the values to go through, anything else is one value,
        as is a list of names for ``estimators``, ``effects`` or ``remedies``; what is left out is the scene's default.

    Returns
    -------
    Rows
        A list with a row for each combination, the last input varying fastest; each is a dict with the columns of
        ``mpm-lab sweep``'s table.csv in SI units: ``scene.cells``, ``h``, ``error.x.max`` (the largest RMS error over
        the run), ``index.NAME.x``, ``seconds.min``, ``status`` ("ok", "unstable", "lost", "refused", "failed"),
        ``reason``, ... ``rows["error.x.max"]`` is a column as an array, ``rows.columns`` names them all. Whatever goes
        wrong in a run is a row; None, and NaN in a column of numbers, stands where a row has no such number.

    Raises
    ------
    SceneError
        For a problem, an input or a number of workers that there is not, and where no combination makes a scene.
    """
    if isinstance(problem, Body):
        lists = {name: _value_list(name, given) for name, given in inputs.items()}
        return _measure(plan_body_tasks(problem, lists), workers, on_progress, MEASURE_BODY, BodyTask.failed_row)
    if not isinstance(problem, str):
        scene = as_scene(problem)
        inputs = {key_field(name): value for name, value in inputs.items()}
        said = {same for name in inputs for same in (name, ALTERNATIVES.get(name))}
        given = {f.name: value for f in fields(scene) if (value := getattr(scene, f.name)) != f.default}
        inputs = {name: value for name, value in given.items() if name not in said} | inputs
        problem = scene.problem
    require_choice("problem", problem, tuple(PROBLEMS))
    require_whole("repeats", repeats, 0, 1000)
    axes = {field_key(name): _input_values(problem, name, given) for name, given in inputs.items()}
    if (count := math.prod(map(len, axes.values()))) > MOST_ROWS:
        raise SceneError("combinations", f"{count:,}", f"are too many for one sweep; give at most {MOST_ROWS:,}")
    return _measure(plan_tasks(problem, axes, repeats=repeats), workers, on_progress)


def _measure(tasks: Sequence[Any], workers: int, on_progress: Callable[[float, dict], None], work: str = MEASURE_ROW,
             give_up: Callable[[Any, str], dict] = failed_row) -> Rows:
    """Returns the rows of tasks, in their order; arguments as of ``sweep`` and ``execute``."""
    require_whole("workers", workers, 1, 1024)
    measured: dict[str, dict] = {}

    def keep(row: dict) -> None:
        measured[row["key"]] = row
        on_progress(len(measured) / len(tasks), *uniform_rows([row]))

    with contextlib.closing(LocalExecutor(workers, work)) as place:
        execute(tasks, place, keep, give_up)
    return Rows(uniform_rows([measured[task.key] for task in tasks]))


def _input_values(problem: str, name: str, given: Any) -> list:
    """Returns the list of values of an input."""
    names = [field for field in PROBLEMS[problem].scene.__dataclass_fields__ if field != "problem"]
    if key_field(name) not in names:
        raise SceneError(name, given, f"is no input of the {problem}; give some of {', '.join(names)}")
    return _value_list(name, given, key_field(name) in LISTS)


def _value_list(name: str, given: Any, takes_names: bool = False) -> list:
    """Returns the values of an input that is one value, or a list, range or array of several; of one that
    ``takes_names``, a list of them is one value."""
    given = given.tolist() if hasattr(given, "tolist") else list(given) if isinstance(given, range) else given
    one = not isinstance(given, list) or (takes_names and all(isinstance(v, str) for v in given))
    if given == [] and not one:
        raise SceneError(name, given, "holds no value; give one at least")
    return [given] if one else given
