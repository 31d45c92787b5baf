"""Where and when the error at the end of a run was made, as numbers: what a problem's ``error_map`` returns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from solvers.scene.causes import CAUSES

#: The terms of a cause together, in sizes of the error, up to which a map of it shows anything: what is made in one
#: place and unmade in the next has no place. Hats, x: 1.9 after a quarter of a period; uGIMP, x after a whole one: 8.
MOST_CANCELLED = 5.0
ROUND_OFF = 1e-12  # in SI units: an error up to which it may be that of the last digits


@dataclass(frozen=True)
class ErrorMap:
    """Of a scene's end: the error of a ``field`` of one ``particle``, or of all (RMS) where that is None; ``size`` in
    its unit, m, m/s or none. ``made`` (n, 4, P) is what each cause has added to it in each step at each particle, which
    began at ``X`` (P,) in m; step k ends at ``times`` (n,) in s. ``crossings`` (k, 2) are the times and X of particles
    that change their cell."""

    scene: Any
    field: str
    particle: int | None
    size: float
    made: np.ndarray
    X: np.ndarray
    times: np.ndarray
    crossings: np.ndarray

    def share(self, cause: str) -> float:
        """What the cause has made of the error: the shares add up to 1."""
        return float(self._of(cause).sum() / self.size) if self.size else 0.0

    @property
    def main_cause(self) -> str:
        """The one that has made most."""
        return max(CAUSES, key=lambda cause: abs(self.share(cause)))

    def cancelled(self, cause: str) -> float:
        """The cause's terms without their signs, over the error."""
        return float(np.abs(self._of(cause)).sum() / abs(self.size)) if self.size else 0.0

    def not_valid(self) -> str | None:
        """Why a map of the main cause shows nothing, as a sentence; None where it does."""
        cause = self.main_cause
        if abs(self.size) <= ROUND_OFF:
            return "there is no map of this error: it is no more than round-off, and nobody's"
        if (times := self.cancelled(cause)) <= MOST_CANCELLED:
            return None
        return (f"there is no map of this error: what was made of it here and there ({CAUSES[cause]}) is {times:.2g} "
                f"times as large and cancels, and up to {MOST_CANCELLED:g} times can be shown; take an earlier end or "
                "another field")

    def binned(self, cause: str, rows: int) -> np.ndarray:
        """Shares (rows, cells) of the error by time, upwards, and cell of the material; steps go whole into rows."""
        row = (np.arange(len(self.times)) * rows) // len(self.times)
        cell = np.floor(self.X / self.scene.spacing).astype(int)
        found = np.zeros((rows, self.scene.cells))
        np.add.at(found, (row[:, None], cell[None, :]), self._of(cause) / self.size)
        return found

    def until(self, cause: str) -> np.ndarray:
        """The cause's share (n,) that was made until the end of each step."""
        return np.cumsum(self._of(cause).sum(axis=1)) / self.size

    def to_dict(self) -> dict:
        """What is said of it in JSON: the error in its unit, what each cause has made of it, and how much cancels."""
        return {"field": self.field, "particle": self.particle, "error": self.size,
                "shares": {cause: self.share(cause) for cause in CAUSES}, "shown": self.main_cause,
                "cancelled": self.cancelled(self.main_cause), "not_valid": self.not_valid()}

    def _of(self, cause: str) -> np.ndarray:
        return self.made[:, list(CAUSES).index(cause)]
