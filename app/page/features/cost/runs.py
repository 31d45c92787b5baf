"""A visitor's runs: those seen on the stage and those of small sweeps, one row each, numbered."""

import functools
import math
import threading
from collections.abc import Sequence
from dataclasses import dataclass

from solvers.scene.scene import Scene
from solvers.solver.soundness import BROKEN, OK
from solvers.study import summary as table
from solvers.study.grid import Task
from solvers.study.row import FAILED

MOST_RUNS = 200  # then the oldest is forgotten
LIVE, SWEEP = "live", "sweep"


@dataclass(frozen=True)
class NumberedRun:
    """A row (``solvers.study.row``) with its number and where it comes from. What follows from the row is found once:
    all runs are drawn anew with every one that is added."""

    number: int
    source: str
    row: dict

    @functools.cached_property
    def scene(self) -> Scene:
        return Task(self.row["problem"], self.row["asked"]).scene()

    @functools.cached_property
    def error(self) -> float | None:
        """The largest RMS error of x over A, None if it is not known."""
        return self._relative(self.row.get("error") or {})

    @functools.cached_property
    def estimate(self) -> float | None:
        """The same by the first of the estimators that hold."""
        return next((self._relative(norms) for norms in (self.row.get("estimate") or {}).values()), None)

    @property
    def size(self) -> float:
        """Where its dot goes: the error, or the estimate where no error is known; NaN if neither is."""
        size = self.estimate if self.error is None else self.error
        return math.nan if size is None else size

    @property
    def seconds(self) -> float:
        """Of a sweep's row the bare run's, of a live one those of everything that was computed; NaN if not known."""
        seconds = self.row.get("seconds") or {}
        return seconds.get("min") or seconds.get("full") or math.nan

    @property
    def method(self) -> str:
        return self.row["scene"]["method"]

    @property
    def status(self) -> str:
        return self.row["status"]

    @property
    def broken(self) -> bool:
        """Whether it went unstable or was lost: its error says nothing."""
        return self.status in BROKEN

    @property
    def drawable(self) -> bool:
        """Whether it can be a dot: a broken run, whose error is out of bounds, goes to the edge."""
        return self.seconds > 0 and (self.broken or (self.status == OK and self.size > 0))

    def _relative(self, norms: dict) -> float | None:
        largest = (norms.get("x") or {}).get("max")
        return None if largest is None or not math.isfinite(largest) else largest / self.scene.size_of("x")


class Runs:
    """The rows of one visitor. Any thread may add and read; ``version`` grows with every change."""

    def __init__(self, most: int = MOST_RUNS):
        self._lock = threading.Lock()
        self._most = most
        self._runs: dict[str, NumberedRun] = {}
        self._numbers = 0
        self.version = 0

    def add(self, row: dict, source: str) -> None:
        """Take a row in. A scene that is there keeps its number, its sweep's row goes before a live one, and a row that
        was lost replaces none."""
        key = row["key"]
        with self._lock:
            before = self._runs.get(key)
            if before and ((before.source == SWEEP and source == LIVE) or row["status"] == FAILED):
                return
            if before is None:
                self._numbers += 1
                if len(self._runs) >= self._most:
                    del self._runs[next(iter(self._runs))]
            self._runs[key] = NumberedRun(before.number if before else self._numbers, source, row)
            self.version += 1

    def all(self) -> list[NumberedRun]:
        """Every run, by number."""
        with self._lock:
            return sorted(self._runs.values(), key=lambda run: run.number)

    def find(self, number: int) -> NumberedRun | None:
        return next((run for run in self.all() if run.number == number), None)


def csv_bytes(runs: Sequence[NumberedRun]) -> bytes:
    """The rows as ``mpm-lab sweep`` writes them, after the number and the source."""
    return table.csv_text({"run": run.number, "source": run.source, **run.row} for run in runs).encode()
