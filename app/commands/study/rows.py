"""What commands that run many scenes share: where rows run, how they are kept and told, and what is written of them."""

import contextlib
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from app.commands.flags import BadInput, NumberFlag, PathFlag, Switch, TextFlag, default_hint
from app.commands.output import Target, draw, say, telling
from solvers.outside.quoting import quoted
from solvers.scene.rules import require_whole
from solvers.solver.soundness import LOST, OK, UNSTABLE
from solvers.study.grid import MOST_ROWS, Task
from solvers.study.row import FAILED, REFUSED, fault, refused
from solvers.study.store import Store, StoreError
from solvers.workers.processors import usual_processes

if TYPE_CHECKING:
    from solvers.study.places import Place

INCOMPLETE = 1  # exit status
ADDRESS = re.compile(r"(tcp|tls|ucx|ws|wss)://\S+:\d+/?")


@dataclass(frozen=True, kw_only=True)
class Study:
    """The flags that say where rows run and are kept."""

    TIMED: ClassVar[bool] = True  # whether rows have times, for the sake of which one runs after the other

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

    def _workers(self) -> int:
        """Processes that run rows here, unless one says how many."""
        return self.workers or (1 if self.TIMED else usual_processes())

    def check_place(self, count: int) -> None:
        """Refuse what no study can be run with; ``count`` is the number of combinations asked for."""
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

    def rows(self, problem: str, tasks: Sequence[Task]) -> list[dict] | None:
        """The rows of the tasks in their order, then those of an earlier study in the directory; what is not there
        yet is run. None if the place where rows run was lost on the way."""
        refusals = {task.key: error for task in tasks if (error := task.refusal())}
        if len(refusals) == len(tasks):
            raise next(iter(refusals.values()))
        with contextlib.ExitStack() as stack:
            place = stack.enter_context(contextlib.closing(self._place()))
            store = stack.enter_context(contextlib.closing(self._store(problem)))
            self._announce(tasks, refusals, store)
            if not self._measure(tasks, refusals, place, store):
                return None
        order = {task.key: k for k, task in enumerate(tasks)}
        return sorted(store.rows.values(), key=lambda row: order.get(row["key"], len(order)))

    def draw(self, figures: Mapping[str, Callable], rows: Sequence[dict]) -> tuple[list[str], int]:
        return draw(figures, rows, self.put, self.out, "the rows are fine")

    def put(self, name: str, content: bytes) -> None:
        Target("out", f"{self.out.rstrip('/')}/{name}").write(content)

    def _place(self, work: str = "solvers.study.places:measure_row") -> "Place":
        """Where this ``work`` is done (``solvers.workers``)."""
        from solvers.study.places import Cluster, Here, NoCluster
        try:
            return Here(self._workers(), work) if self.scheduler is None else Cluster(self.scheduler, work)
        except NoCluster as error:
            raise BadInput("scheduler", self.scheduler, str(error)) from None

    def _store(self, problem: str, fault: Callable[[Any], str | None] = fault) -> Store:
        """The rows of the directory."""
        try:
            return Store(self.out, problem, self.resume, fault)
        except StoreError as error:
            raise BadInput("out", self.out, str(error)) from None

    def _announce(self, tasks: Sequence[Task], refusals: dict, store: Store) -> None:
        if self.quiet:
            return
        there = sum(store.finished(task.key) for task in tasks)
        say(f"{len(tasks)} rows" + (f", {there} of them there already" if there else ""))
        if old := sum(store.outdated(task.key) for task in tasks):
            say(f"{old} row{'s were' if old > 1 else ' was'} measured by another version of the solvers and "
                f"{'are' if old > 1 else 'is'} measured again")
        warnings = [f"warning: {w}" for t in tasks if t.key not in refusals for w in t.scene().warnings()]
        for sentence in dict.fromkeys([*(f"refused: {error}" for error in refusals.values()), *warnings]):
            say(sentence)

    def _measure(self, tasks: Sequence[Task], refusals: dict, place: "Place", store: Store) -> bool:
        """Fill the store; False if the place where rows run was lost on the way."""
        from solvers.study.places import PlaceLost, execute
        todo = [task for task in tasks if not store.finished(task.key)]
        done = len(tasks) - len(todo)
        beside = None if self.scheduler else self._workers()  # times are to be read with it

        def keep(row: dict) -> None:
            nonlocal done
            done += 1
            with telling(f"--out {quoted(self.out)}"):
                store.append({**row, "side_by_side": beside})
            if not self.quiet and row["status"] != REFUSED:  # that was said before
                say(f"{done}/{len(tasks)} {_told(row, tasks)}")

        for task in todo:
            if task.key in refusals:
                keep(refused(task, refusals[task.key]))
        try:
            execute([task for task in todo if task.key not in refusals], place, keep)
        except PlaceLost as error:
            say(f"{error}; {done} of {len(tasks)} rows are kept: give --resume to run the others")
            return False
        return True


def _told(row: dict, tasks: Sequence[Task]) -> str:
    inputs = ", ".join(f"{name.replace('_', '-')} {_words(value)}" for name, value in row["asked"].items()
                       if len({str(task.inputs.get(name)) for task in tasks}) > 1)
    if row["status"] in (OK, UNSTABLE, LOST):
        error = row["error"]["x"]["max"]
        outcome = f"error of x {error:.2e} m, " if error is not None else ""
        return f"{inputs}: {row['status']}, {outcome}{row['seconds']['min']:.3g} s"
    return f"{inputs}: {row['status']}" + (f": {row['reason']}" if row["status"] == FAILED else "")


def _words(value: Any) -> str:
    return (" ".join(map(str, value)) or "none") if isinstance(value, list) else str(value)
