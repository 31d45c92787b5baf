"""The base of every study: a plan of rows, run side by side and kept as they finish, and what is written of them."""

import contextlib
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from app.commands.flags import BadInput, NumberFlag, PathFlag, Switch, TextFlag, default_hint
from app.commands.output import Target, draw_pictures, print_message, put_text, report_write_errors
from solvers.scene.scene import Scene
from solvers.scene.validation import require_whole
from solvers.solver.soundness import LOST, OK, UNSTABLE
from solvers.study.parameter_grid import MOST_ROWS
from solvers.study.row import FAILED, IDENTITY, MEASURED, REFUSED, failed, fault
from solvers.study.row_store import Store, StoreError
from solvers.untrusted.quoting import quoted
from solvers.workers.cpu_count import usual_processes

if TYPE_CHECKING:
    from solvers.study.executors import Cluster, LocalExecutor, Question

INCOMPLETE = 1  # exit status
ADDRESS = re.compile(r"(tcp|tls|ucx|ws|wss)://\S+:\d+/?")


class Study:
    """A study as a command: ``questions`` are its rows to measure, ``document`` writes what was measured."""

    SCENE: ClassVar[type[Scene]]
    TIMED: ClassVar[bool] = True  # whether rows have times, for the sake of which one runs after the other
    WORK: ClassVar[str] = "solvers.study.executors:measure_row"  # that measures a row (``solvers.workers``)
    IDENTITY: ClassVar[dict] = IDENTITY  # the form of what says which row it is,
    MEASURED: ClassVar[dict] = MEASURED  # and of what was measured (``solvers.study.json_schema``)
    workers: Any = None
    scheduler: Any = None
    resume: bool | None = None
    out: Any
    quiet: bool

    def questions(self) -> Sequence["Question"]:
        """Every row that is wanted, in order; refuses bad input."""
        raise NotImplementedError

    def document(self, rows: list[dict]) -> int:
        """Writes tables of the rows, those of the plan first; returns the exit status."""
        raise NotImplementedError

    def execute(self) -> int:
        rows = self._rows(self.questions())
        return INCOMPLETE if rows is None else self.document(rows)

    @property
    def only_problem(self) -> str | None:
        """Of all rows, if they have one."""
        return self.SCENE.problem

    def given_up(self, task: Any, reason: str) -> dict:
        """The row of a question that was lost."""
        return failed(task, reason)

    def told(self, row: dict, tasks: Sequence[Any]) -> str:
        """A row in short, for whoever watches."""
        inputs = ", ".join(f"{name.replace('_', '-')} {_words(value)}" for name, value in row["asked"].items()
                           if len({str(task.inputs.get(name)) for task in tasks}) > 1)
        if row["status"] in (OK, UNSTABLE, LOST):
            error = row["error"]["x"]["max"]
            outcome = f"error of x {error:.2e} m, " if error is not None else ""
            return f"{inputs}: {row['status']}, {outcome}{row['seconds']['min']:.3g} s"
        return f"{inputs}: {row['status']}" + (f": {row['reason']}" if row["status"] == FAILED else "")

    def stages(self, tasks: Sequence[Any]) -> Iterable[Sequence[Any]]:
        """The rows that are to be measured, one group after the other, each side by side."""
        return [tasks]

    def beside(self, row: dict) -> dict:
        """A row with what its times are to be read with."""
        return {**row, "side_by_side": None if self.scheduler else self._workers()}

    def check_place(self, count: int) -> None:
        """Refuse what no study can be run with; ``count`` is the number of rows asked for."""
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
        """Draws ``values``, writes the ``files``, of which one may be ``printed``, and returns the exit status."""
        drawn, status = draw_pictures(figures, values, self._put, self.out, "the rows are fine")
        for name, text in (texts := files(drawn)).items():
            self._put(name, text.encode())
        if printed:
            put_text(texts[printed].partition("\n\n![")[0] + "\n")
        return status

    def _put(self, name: str, content: bytes) -> None:
        Target("out", f"{self.out.rstrip('/')}/{name}").write(content)

    def _workers(self) -> int:
        """Processes that run rows here, unless one says how many."""
        return self.workers or (1 if self.TIMED else usual_processes())

    def _rows(self, tasks: Sequence["Question"]) -> list[dict] | None:
        """Runs the rows that are missing; returns all rows, the tasks' first, or None if the executor was lost."""
        with contextlib.ExitStack() as stack:
            place = stack.enter_context(contextlib.closing(self._place()))
            try:
                store = stack.enter_context(contextlib.closing(Store(
                    self.out, self.only_problem, self.resume, lambda row: fault(row, self.MEASURED, self.IDENTITY))))
            except StoreError as error:
                raise BadInput("out", self.out, str(error)) from None
            self._announce(tasks, store)
            if not self._measure(tasks, place, store):
                return None
        order = {task.key: k for k, task in enumerate(tasks)}
        return sorted(store.rows.values(), key=lambda row: order.get(row["key"], len(order)))

    def _place(self) -> "LocalExecutor | Cluster":
        """Where rows run."""
        from solvers.study.executors import Cluster, LocalExecutor, NoCluster
        try:
            return LocalExecutor(self._workers(), self.WORK) if self.scheduler is None else \
                Cluster(self.scheduler, self.WORK)
        except NoCluster as error:
            raise BadInput("scheduler", self.scheduler, str(error)) from None

    def _announce(self, tasks: Sequence["Question"], store: Store) -> None:
        if self.quiet:
            return
        there = sum(store.finished(task.key) for task in tasks)
        print_message(f"{len(tasks)} rows" + (f", {there} of them there already" if there else ""))
        if old := sum(store.outdated(task.key) for task in tasks):
            print_message(f"{old} row{'s were' if old > 1 else ' was'} measured by another version of the solvers and "
                f"{'are' if old > 1 else 'is'} measured again")
        for sentence in dict.fromkeys(sentence for task in tasks for sentence in task.remarks()):
            print_message(sentence)

    def _measure(self, tasks: Sequence["Question"], place: "LocalExecutor | Cluster", store: Store) -> bool:
        """Fill the store; False if the place where rows run was lost on the way."""
        from solvers.study.executors import ExecutorLost, execute
        todo = [task for task in tasks if not store.finished(task.key)]
        done = len(tasks) - len(todo)

        def keep(row: dict) -> None:
            nonlocal done
            done += 1
            with report_write_errors(f"--out {quoted(self.out)}"):
                store.append(self.beside(row))
            if not self.quiet and row["status"] != REFUSED:  # that was said before
                print_message(f"{done}/{len(tasks)} {self.told(row, tasks)}")

        try:
            for group in self.stages(todo):
                execute(group, place, keep, self.given_up)
        except ExecutorLost as error:
            print_message(f"{error}; {done} of {len(tasks)} rows are kept: give --resume to run the others")
            return False
        return True


@dataclass(frozen=True, kw_only=True)
class StudyFlags(Study):
    """The flags that say where rows run and are kept."""

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


def _words(value: Any) -> str:
    return (" ".join(map(str, value)) or "none") if isinstance(value, list) else str(value)
