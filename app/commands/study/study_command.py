"""Base class of studies: a plan of rows, run in parallel and stored as they finish, and their output."""

import contextlib
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from app.commands.lenient_flag_types import (
    BadInput,
    NumberFlag,
    PathFlag,
    ProcessesFlag,
    Switch,
    TextFlag,
    default_hint,
)
from app.commands.output import OutputTarget, draw_pictures, print_message, put_text, report_write_errors
from solvers.scene.scene import Scene
from solvers.scene.validation import require_whole
from solvers.solver.soundness import LOST, OK, UNSTABLE
from solvers.study.coverage import random_draw
from solvers.study.parameter_grid import MOST_ROWS
from solvers.study.row import FAILED, IDENTITY, MEASURED, REFUSED, failed_row, find_fault
from solvers.study.row_store import RowStore, StoreError
from solvers.untrusted.quoting import quote
from solvers.workers.cpu_count import default_processes

if TYPE_CHECKING:
    from solvers.study.executors import DaskExecutor, LocalExecutor, MeasurementTask

INCOMPLETE = 1  # exit status
MOST_SEED = 2**31 - 1
ADDRESS = re.compile(r"(tcp|tls|ucx|ws|wss)://\S+:\d+/?")


class Study:
    """Base of studies: :meth:`measurement_tasks` are the rows to measure, :meth:`write_tables` their output."""

    SCENE: ClassVar[type[Scene]]
    TIMED: ClassVar[bool] = True  # whether rows are timed, and so run one after the other
    WORK: ClassVar[str] = "solvers.study.executors:measure_in_worker"  # measures a row (``solvers.workers``)
    IDENTITY: ClassVar[dict] = IDENTITY  # schema of a row's identity,
    MEASURED: ClassVar[dict] = MEASURED  # and of its results (``solvers.study.json_schema``)
    workers: Any = None
    scheduler: Any = None
    resume: bool | None = None
    out: Any
    quiet: bool

    def measurement_tasks(self) -> Sequence["MeasurementTask"]:
        """Returns a task for each row to measure, in order; raises BadInput or SceneError."""
        raise NotImplementedError

    def write_tables(self, rows: list[dict]) -> int:
        """Writes tables and pictures of all rows, this command's first; returns the exit status."""
        raise NotImplementedError

    def execute(self) -> int:
        rows = self._run_missing(self.measurement_tasks())
        return INCOMPLETE if rows is None else self.write_tables(rows)

    @property
    def only_problem(self) -> str | None:
        """The problem of all rows, by name, or None if they have several."""
        return self.SCENE.problem

    def failed_task_row(self, task: Any, reason: str) -> dict:
        """Returns the row for a task that could not be measured, with a sentence why."""
        return failed_row(task, reason)

    def describe_row(self, row: dict, tasks: Sequence[Any]) -> str:
        """Returns a row's status as a line for the console, with the inputs that vary among the ``tasks``."""
        inputs = ", ".join(f"{name.replace('_', '-')} {_format_value(value)}" for name, value in row["asked"].items()
                           if len({str(task.inputs.get(name)) for task in tasks}) > 1)
        inputs += ": " * bool(inputs)
        if row["status"] in (OK, UNSTABLE, LOST):
            error = row["error"]["x"]["max"]
            outcome = f"error of x {error:.2e} m, " if error is not None else ""
            return f"{inputs}{row['status']}, {outcome}{row['seconds']['min']:.3g} s"
        return f"{inputs}{row['status']}" + (f": {row['reason']}" if row["status"] == FAILED else "")

    def parallel_groups(self, tasks: Sequence[Any]) -> Iterable[Sequence[Any]]:
        """Returns tasks in groups: those of a group are measured in parallel, the groups one after the other."""
        return [tasks]

    def with_timing_conditions(self, row: dict) -> dict:
        """Returns a row with "side_by_side", the number of rows measured at a time; None on a cluster."""
        return {**row, "side_by_side": None if self.scheduler else self._worker_count()}

    def check_study_flags(self, count: int) -> None:
        """Raises BadInput for flags that no study can run with; ``count`` is the number of its rows."""
        if not (self.out or "").strip():
            raise BadInput("out", "", "give a directory for the rows, tables and pictures")
        if self.workers is not None:
            require_whole("workers", self.workers, 1, 1024)
            if self.scheduler is not None:
                raise BadInput("workers", self.workers, "is for this machine; with --scheduler leave it out")
        if self.scheduler is not None and not ADDRESS.fullmatch(self.scheduler):
            raise BadInput("scheduler", self.scheduler, "give the address of a Dask scheduler, such as tcp://host:8786")
        if count > MOST_ROWS:
            raise BadInput("out", self.out, f"{count:,} combinations are too many for one study; give lists that make "
                           f"at most {MOST_ROWS:,}")

    def write(self, figures: Mapping[str, Callable], values: Any, files: Callable[[list[str]], Mapping[str, str]],
              printed: str = "") -> int:
        """Draws ``values`` by ``figures`` to NAME.png, writes the texts that ``files`` makes by name for these
        pictures' names, prints the one named ``printed``, and returns the exit status."""
        drawn, status = draw_pictures(figures, values, self._write_file, self.out, "the rows are fine")
        for name, text in (texts := files(drawn)).items():
            self._write_file(name, text.encode())
        if printed:
            put_text(texts[printed].partition("\n\n![")[0] + "\n")
        return status

    def _write_file(self, name: str, content: bytes) -> None:
        OutputTarget("out", f"{self.out.rstrip('/')}/{name}").write(content)

    def _worker_count(self) -> int:
        """Returns the number of local processes: the one given, or one if rows are timed, else one per processor."""
        return self.workers or (1 if self.TIMED else default_processes())

    def _run_missing(self, tasks: Sequence["MeasurementTask"]) -> list[dict] | None:
        """Measures tasks without a stored row; returns all rows, the tasks' first, None if the executor was lost."""
        with contextlib.ExitStack() as stack:
            executor = stack.enter_context(contextlib.closing(self._executor()))
            try:
                store = stack.enter_context(contextlib.closing(RowStore(
                    self.out, self.only_problem, self.resume,
                    lambda row: find_fault(row, self.MEASURED, self.IDENTITY))))
            except StoreError as error:
                raise BadInput("out", self.out, str(error)) from None
            self._announce(tasks, store)
            if not self._measure(tasks, executor, store):
                return None
        order = {task.key: k for k, task in enumerate(tasks)}
        return sorted(store.rows.values(), key=lambda row: order.get(row["key"], len(order)))

    def _executor(self) -> "LocalExecutor | DaskExecutor":
        """Returns the executor of tasks: local processes, or the scheduler's; raises BadInput without it."""
        from solvers.study.executors import ClusterUnavailable, DaskExecutor, LocalExecutor
        try:
            return LocalExecutor(self._worker_count(), self.WORK) if self.scheduler is None else \
                DaskExecutor(self.scheduler, self.WORK)
        except ClusterUnavailable as error:
            raise BadInput("scheduler", self.scheduler, str(error)) from None

    def _announce(self, tasks: Sequence["MeasurementTask"], store: RowStore) -> None:
        if self.quiet:
            return
        there = sum(store.is_finished(task.key) for task in tasks)
        print_message(f"{len(tasks)} row{'s' * (len(tasks) != 1)}"
                      + (f", {there} of them there already" if there else ""))
        if old := sum(store.is_outdated(task.key) for task in tasks):
            print_message(f"{old} row{'s were' if old > 1 else ' was'} measured by another version of the solvers and "
                          f"{'are' if old > 1 else 'is'} measured again")
        for sentence in dict.fromkeys(sentence for task in tasks for sentence in task.remarks()):
            print_message(sentence)

    def _measure(self, tasks: Sequence["MeasurementTask"], executor: "LocalExecutor | DaskExecutor",
                 store: RowStore) -> bool:
        """Measures the tasks whose rows the store lacks, and stores these; returns False if the executor was lost."""
        from solvers.study.executors import ExecutorLost, execute
        todo = [task for task in tasks if not store.is_finished(task.key)]
        done = len(tasks) - len(todo)

        def keep(row: dict) -> None:
            nonlocal done
            done += 1
            with report_write_errors(f"--out {quote(self.out)}"):
                store.append(self.with_timing_conditions(row))
            if not self.quiet and row["status"] != REFUSED:  # already reported
                print_message(f"{done}/{len(tasks)} {self.describe_row(row, tasks)}")

        try:
            for group in self.parallel_groups(todo):
                execute(group, executor, keep, self.failed_task_row)
        except ExecutorLost as error:
            print_message(f"{error}; {done} of {len(tasks)} rows are kept: give --resume to run the others")
            return False
        return True


@dataclass(frozen=True, kw_only=True)
class StudyFlags(Study):
    """Flags common to studies: where rows run and are stored."""

    out: Annotated[PathFlag, default_hint("none, it must be given")] = None
    """Directory for rows.jsonl, the tables and the pictures."""
    workers: Annotated[NumberFlag, default_hint("1, for the sake of the timings")] = None
    """Processes on this machine that run rows side by side."""
    scheduler: Annotated[TextFlag, default_hint("none: rows run on this machine")] = None
    """Address of a Dask scheduler whose workers run the rows, tcp://HOST:PORT; needs mpm-lab[cluster]."""
    resume: Annotated[Switch, default_hint("off")] = False
    """Go on with what is in --out: rows that are there are not run again, those that failed are."""
    quiet: Annotated[Switch, default_hint("off")] = False
    """Nothing on standard error but what goes wrong."""


@dataclass(frozen=True, kw_only=True)
class RandomDrawStudy(StudyFlags):
    """Study of so many ``runs`` of random draws of the class ``DRAW`` with a ``seed``."""

    DRAW: ClassVar[type[Any]]  # a RandomDraw
    TIMED = False
    IDENTITY = random_draw.IDENTITY

    runs: NumberFlag
    seed: NumberFlag
    workers: ProcessesFlag = None
    """Processes on this machine that run rows side by side; nothing is timed."""

    def measurement_tasks(self) -> Sequence["MeasurementTask"]:
        require_whole("runs", self.runs, 1, MOST_ROWS)
        require_whole("seed", self.seed, 0, MOST_SEED)
        self.check_study_flags(self.runs)
        return [self.DRAW(self.only_problem, self.seed, number) for number in range(self.runs)]

    def failed_task_row(self, task: random_draw.RandomDraw, reason: str) -> dict:
        return task.failed_row(reason)

    def with_timing_conditions(self, row: dict) -> dict:
        return row


def _format_value(value: Any) -> str:
    return (" ".join(map(str, value)) or "none") if isinstance(value, list) else str(value)
