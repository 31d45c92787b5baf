"""``mpm-lab sweep PROBLEM``: every combination of values, one row each."""

from __future__ import annotations

import contextlib
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, get_args, get_type_hints

from app import __version__
from app.commands.flags import BadInput, NumberFlag, PathFlag, Switch, TextFlag, default_hint
from app.commands.output import Target, json_text, say
from app.commands.scene_flags import SceneFlags
from solvers.rules import require_whole
from solvers.soundness import LOST, OK, UNSTABLE
from solvers.study import summary as table
from solvers.study.grid import MOST_ROWS, Task, plan
from solvers.study.row import FAILED, REFUSED, refused
from solvers.study.store import Store, StoreError

if TYPE_CHECKING:
    from solvers.study.places import Place

COMPLETE, INCOMPLETE = 0, 1
ADDRESS = re.compile(r"(tcp|tls|ucx|ws|wss)://\S+:\d+/?")


@dataclass(frozen=True, kw_only=True)
class Sweep(SceneFlags):
    """The flags of a sweep beside those of its scenes.

    Every flag of a scene may hold several values; those that are lists in one scene already (estimator, effects,
    remedies) are not swept over.
    """

    HELP: ClassVar[str] = """Run the {title} for every combination of the values given: what accuracy costs in time.

    Give any flag of a scene several values: --cells 20 40 80 --method {methods}. Each combination is a row with its
    errors, estimates, times and status; rows are kept as they finish. Tables and pictures follow at the end.
    Exit status: 0 every row is there, 1 could not run or write, 2 bad input, 130 stopped by Ctrl-C (rows are kept).
    """
    OUTPUT: ClassVar[frozenset[str]] = frozenset({"out", "workers", "scheduler", "resume", "repeats", "each_effect",
                                                  "quiet", "no_linearity_preserving"})
    LISTS: ClassVar[frozenset[str]] = frozenset({"estimator", "effects", "remedies"})

    no_linearity_preserving: Annotated[Switch, default_hint("on")] = False
    """Plain transfers; give both to compare."""
    out: Annotated[PathFlag, default_hint("none, it must be given")] = None
    """Directory for rows.jsonl, table.csv, table.json, summary.md and the pictures."""
    workers: Annotated[NumberFlag, default_hint("1, for the sake of the timings")] = None
    """Processes on this machine that run rows side by side."""
    scheduler: Annotated[TextFlag, default_hint("none: rows run on this machine")] = None
    """Address of a Dask scheduler whose workers run the rows, tcp://HOST:PORT; needs mpm-lab[cluster]."""
    resume: Annotated[Switch, default_hint("off")] = False
    """Go on with the sweep in --out: rows that are there are not run again, those that failed are."""
    repeats: NumberFlag = 3
    """Timed runs of each row; the shortest counts."""
    each_effect: Annotated[Switch, default_hint("off")] = False
    """Time each effect alone as well, which compiles and runs more."""
    quiet: Annotated[Switch, default_hint("off")] = False
    """Nothing on standard error but what goes wrong."""

    def execute(self) -> int:
        """Check everything, run what is not there yet, then write tables and pictures of all rows."""
        self._check()
        problem = self.SCENE.problem
        tasks = plan(problem, self.axes(), repeats=self.repeats, price_effects=self.each_effect, version=__version__)
        refusals = {task.key: error for task in tasks if (error := task.refusal())}
        if len(refusals) == len(tasks):
            raise next(iter(refusals.values()))
        with contextlib.ExitStack() as stack:
            place = stack.enter_context(contextlib.closing(self._place()))
            try:
                store = stack.enter_context(contextlib.closing(Store(self.out, problem, self.resume)))
            except StoreError as error:
                raise BadInput("out", self.out, str(error)) from None
            self._announce(tasks, refusals, store)
            if not self._measure(tasks, refusals, place, store):
                return INCOMPLETE
        order = {task.key: k for k, task in enumerate(tasks)}  # then the rows of an earlier sweep in this directory
        rows = sorted(store.rows.values(), key=lambda row: order.get(row["key"], len(order)))
        return self._write(problem, rows)

    def axes(self) -> dict[str, list]:
        """The values of each input of a scene, by the name of its flag."""
        hints = get_type_hints(type(self), include_extras=True)
        axes = {name: [value] if name in self.LISTS else _values(value, hints[name])
                for name, value in self.inputs().items()}
        on = axes["linearity_preserving"][0]
        return axes | {"linearity_preserving": [True] * on + [False] * (self.no_linearity_preserving or not on)}

    def _check(self) -> None:
        if not (self.out or "").strip():
            raise BadInput("out", "", "give a directory for the rows, tables and pictures")
        require_whole("repeats", self.repeats, 1, 1000)
        if self.workers is not None:
            require_whole("workers", self.workers, 1, 1024)
            if self.scheduler is not None:
                raise BadInput("workers", self.workers, "is for this machine; with --scheduler leave it out")
        if self.scheduler is not None and not ADDRESS.fullmatch(self.scheduler):
            raise BadInput("scheduler", self.scheduler, "give the address of a Dask scheduler, such as tcp://host:8786")
        count = math.prod(map(len, self.axes().values()))
        if count > MOST_ROWS:
            raise BadInput("out", self.out, f"{count:,} combinations are too many for one sweep; give lists that make "
                           f"at most {MOST_ROWS:,}")

    def _place(self) -> Place:
        from solvers.study.places import Cluster, Here, NoCluster
        try:
            return Here(self.workers or 1) if self.scheduler is None else Cluster(self.scheduler)
        except NoCluster as error:
            raise BadInput("scheduler", self.scheduler, str(error)) from None

    def _announce(self, tasks: Sequence[Task], refusals: dict, store: Store) -> None:
        if self.quiet:
            return
        there = sum(store.finished(task.key) for task in tasks)
        say(f"{len(tasks)} rows" + (f", {there} of them there already" if there else ""))
        warnings = [f"warning: {w}" for t in tasks if t.key not in refusals for w in t.scene().warnings()]
        for sentence in dict.fromkeys([*(f"refused: {error}" for error in refusals.values()), *warnings]):
            say(sentence)

    def _measure(self, tasks: Sequence[Task], refusals: dict, place: Place, store: Store) -> bool:
        """Fill the store; False if the place where rows run was lost on the way."""
        from solvers.study.places import PlaceLost, execute

        todo = [task for task in tasks if not store.finished(task.key)]
        done = len(tasks) - len(todo)

        def keep(row: dict) -> None:
            nonlocal done
            done += 1
            store.append(row)
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

    def _write(self, problem: str, rows: list[dict]) -> int:
        """Tables, pictures and summary; a picture that fails costs nothing else."""
        from app.pictures.run import png_bytes
        from app.pictures.study import FIGURES

        drawn, status = [], COMPLETE
        for name, figure in FIGURES.items():
            try:
                self._put(f"{name}.png", png_bytes(figure(rows)))
                drawn.append(f"{name}.png")
            except Exception as error:
                say(f"--out {self.out}: the picture {name} failed ({type(error).__name__}: {error}); the rows are fine")
                status = INCOMPLETE
        text = table.summary(problem, rows, drawn)
        self._put("table.csv", table.csv_text(rows).encode())
        self._put("table.json", json_text(table.table_dict(problem, rows), lines=True).encode())
        self._put("summary.md", text.encode())
        print(text.partition("\n\n![")[0], flush=True)
        return status

    def _put(self, name: str, content: bytes) -> None:
        Target("out", f"{self.out.rstrip('/')}/{name}").write(content)


def _values(value: Any, hint: Any) -> list:
    """The values in what was typed after one flag, which the flag left in one piece if it was several words."""
    if not isinstance(value, str):
        return [value]
    words = value.replace(",", " ").split()
    parse = next(part for part in get_args(hint) if hasattr(part, "instance_from_str")).instance_from_str
    return [parse([word]) for word in words] if len(words) > 1 else [value]


def _told(row: dict, tasks: Sequence[Task]) -> str:
    """A row in one line of progress."""
    inputs = ", ".join(f"{name.replace('_', '-')} {value}" for name, value in row["asked"].items()
                       if len({str(task.inputs.get(name)) for task in tasks}) > 1)
    if row["status"] in (OK, UNSTABLE, LOST):
        error = row["error"]["x"]["max"]
        outcome = f"error of x {error:.2e} m, " if error is not None else ""
        return f"{inputs}: {row['status']}, {outcome}{row['seconds']['min']:.3g} s"
    return f"{inputs}: {row['status']}" + (f": {row['reason']}" if row["status"] == FAILED else "")
