"""Soundness of a run in progress: its samples are judged as they come, each once."""

import numpy as np

from solvers.scene.scene import Scene
from solvers.solver import samples
from solvers.solver.base import Solver
from solvers.solver.soundness import SoundnessFinding, earliest_finding, findings
from solvers.solver.verdict_basis import (
    LargeRelativeError,
    checks_by_quantity,
    is_balance_motion_known,
    large_errors,
    merge_large_errors,
    missing_checks_sentence,
)

MOST_WAITING = 20  # samples
DOUBT_PERIODS = 0.5  # periods


class SoundnessMonitor:
    """Watch over one run of a scene: the contradictions found so far in its samples (``solvers.solver.soundness``)."""

    def __init__(self, scene: Scene):
        self._scene = scene
        self._waiting: list[np.ndarray] = []  # samples to be judged with those that come next
        self._findings: dict[str, SoundnessFinding] = {}
        self._large: dict[str, LargeRelativeError] = {}
        self._followed = True
        self._looked: np.ndarray | None = None  # the last sample (1, C) with a check for contradictions
        self._doubts: dict[str, tuple[float, str]] = {}  # the time in s at which an estimator last failed, and why

    def check_samples(self, rows: np.ndarray, particles: int, goes_on: bool = False) -> None:
        """Checks new ``rows`` (n, C) of samples of a run with so many particles, and stores the findings; ignores rows
        once a finding is final, because no earlier one can follow.

        Checking a few rows costs as much as many: in a run that ``goes_on``, rows wait until one of them has a check
        for contradictions, or until they are many."""
        scene = self._scene
        if len(rows):
            self._waiting.append(rows)
        if not self._waiting or any(name not in scene.active_estimators for name in self._findings):
            return
        looked = np.flatnonzero(np.isfinite(rows[:, samples.column_index("place")]))
        if goes_on and not len(looked) and sum(map(len, self._waiting)) < MOST_WAITING:
            return
        waiting = [*([] if self._looked is None else [self._looked]), *self._waiting]
        self._waiting = []
        self._looked = rows[looked[-1:]] if len(looked) else self._looked
        series = samples.read_rows(np.concatenate(waiting), scene, particles)
        self._findings = {**findings(scene, series), **self._findings}
        self._large = merge_large_errors(self._large, large_errors(scene, series))
        self._followed = is_balance_motion_known(scene, series)

    def doubted_estimators(self, time: float, not_valid: dict[str, str]) -> dict[str, str]:
        """Returns the names of the estimators that do not hold at a time in s, each with a sentence why: those that are
        ``not_valid`` now, and those that were in the half period before, because a failed estimator meets its bounds at
        times by chance, and would come and go with every frame."""
        self._doubts |= {name: (time, sentence) for name, sentence in not_valid.items()}
        return {name: sentence for name, (last, sentence) in self._doubts.items()
                if time - last < DOUBT_PERIODS * self._scene.period}

    def current_status(self, solver: Solver, not_valid: dict[str, str]) -> tuple[str, str | None, float | None]:
        """Returns the status of the run ("ok", "unstable" or "lost"), the sentence why or None, and the time in s since
        when or None. Findings of estimators that are ``not_valid`` (name: reason) by now do not count."""
        large = {quantity: one for quantity, one in self._large.items() if one.by not in not_valid}
        return solver.status(earliest_finding(self._findings, not_valid), large)

    def unchecked_note(self, not_valid: dict[str, str]) -> str | None:
        """Returns in a sentence what has not been checked in the run so far, or None; ``not_valid`` has a reason for
        each estimator that is not valid (:func:`~solvers.solver.verdict_basis.missing_checks_sentence`)."""
        return missing_checks_sentence(self._scene, checks_by_quantity(self._scene, not_valid, self._followed))
