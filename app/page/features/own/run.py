"""A visitor's file as a run: its frames, as the stage draws them, and its norms over time, as the plots do."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from app.frame.captions import UNKNOWN
from app.frame.view import View, view
from app.language.spoken import later, tr
from app.page.visit.history import RunSeries
from app.words import QUANTITIES
from solvers.engine.frames import FrameArrays, FrameOptions
from solvers.engine.messages import FrameReport
from solvers.judging.show import Shown, columns, open_table
from solvers.solver.norms import RunningIndex
from solvers.solver.rounding import rounding
from solvers.solver.samples import QUANTITIES as KEYS
from solvers.study.grid import Task

JUDGE = "companion"  # which estimates the errors of a file
COMING = later("the companion is being solved")
NO_ACCELERATION = later("a file is not judged by its acceleration")


class OwnRun(RunSeries):
    """T frames of a file called ``name``. What the companion and the judge say comes later: ``estimate`` has norms over
    the times by quantity, ``verdict`` the judge's report on the grid."""

    def __init__(self, name: str, shown: Shown, table: Path):
        self.scene = Task(**shown.task).scene()
        super().__init__(self.scene.period)
        self.table = table
        self.name, self.times, self.missing = name, np.array(shown.times), shown.missing
        self._crossed = np.array(shown.crossed)
        self._starts = np.cumsum([0, *shown.counts])
        self._columns = columns(self.scene.DIMENSIONS)
        self._rows = open_table(table, shown.counts, self.scene.DIMENSIONS)
        self.true = None if shown.norms is None else _arrays(shown.norms)
        self.estimate: dict[str, np.ndarray] | None = None
        self._tops: dict[tuple[str, bool], tuple[np.ndarray, np.ndarray]] = {}
        self.verdict: dict | None = None
        self.trouble = ""  # why there will be no verdict

    def __len__(self) -> int:
        return len(self.times)

    def estimated(self, norms: Mapping[str, Sequence[float | None]]) -> None:
        """The companion's estimate is in the table."""
        estimate, none = _arrays(norms), np.full(len(self), np.nan)
        new = {"time": self.times}
        for q in KEYS:
            new[f"error_{q}"] = none if self.true is None else self.true.get(q, none)
            new[f"{JUDGE}/estimate_{q}"] = estimate.get(q, none)
            new[f"{JUDGE}/index_{q}"] = RunningIndex().extend(new[f"{JUDGE}/estimate_{q}"], new[f"error_{q}"], rounding(
                self.scene, q, self.scene.steps))
        self.append(new)
        self.estimate = estimate

    def particles(self, k: int) -> int:
        return int(self._starts[k + 1] - self._starts[k])

    def frame(self, k: int, quantity: str, playing: bool) -> tuple[FrameReport, FrameArrays]:
        """The frame k, with the field of a quantity."""
        rows = np.array(self._rows[self._starts[k]:self._starts[k + 1]])
        part = {name: rows[:, which] for name, which in self._columns.items()}
        P, q = len(rows), KEYS.index(quantity)
        arrays = FrameArrays(part["position"], part["displacement"], np.zeros((P, 0), np.float32),
                             part["crossed"][:, 0] - 1, part["error"], {JUDGE: part["estimate"]},
                             {JUDGE: part["difference"]}, part["field"][:, 2 * q:2 * q + 2])
        report = FrameReport(0, 0, "", self.scene, False, playing, P, k, float(self.times[k]), np.empty((0, 0)), None,
                             0.0, None, "", holds=FrameOptions(plotted=quantity))
        return report, arrays

    def view(self, arrays: FrameArrays, quantity: str, difference: bool) -> View:
        """What the two halves show."""
        column = KEYS.index(quantity)
        lacks = tr(NO_ACCELERATION) if quantity == "a" else \
            tr("the file has no {quantity}", quantity=QUANTITIES[quantity].noun) if quantity in self.missing else ""
        no_truth = lacks or (tr(UNKNOWN) if self.true is None else "")
        no_estimate = lacks or (tr(COMING) if self.estimate is None else "")
        true = None if no_truth else arrays.error[:, column]
        estimated = None if no_estimate else arrays.estimate[JUDGE][:, column]
        return view(quantity, JUDGE, estimated, true, no_estimate, no_truth, difference,
                    arrays.difference[JUDGE][:, column])

    def largest(self, quantity: str) -> tuple[np.ndarray, np.ndarray]:
        """The largest estimated and true sizes of all times, (1,) each: the colours of a file stay as they are."""
        known = quantity, self.estimate is not None
        if known not in self._tops:
            columns = (self._columns[name].start + KEYS.index(quantity) for name in ("estimate", "error"))
            estimated, true = (np.fmax.reduce(self._rows[:, column], initial=0.0) for column in columns)
            self._tops[known] = np.array([estimated]), np.array([true])
        return self._tops[known]

    def crossings_per_second(self, series: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Those that are known of: between two times of a file a particle may cross and come back."""
        return self.times[1:], self._crossed[1:] / np.diff(self.times)


def _arrays(norms: Mapping[str, Sequence[float | None]]) -> dict[str, np.ndarray]:
    return {q: np.array([np.nan if value is None else value for value in values]) for q, values in norms.items()}
