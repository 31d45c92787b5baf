"""Where the error is worst: the material divided into regions that have names, and the one with the largest error.

The bar is divided into 20 lengths of 0.05 m, the quarter of the ring into 6 angles of 15 degrees, from the x axis on,
by 3 thirds of the wall. A region's error is the root of the mean square over its particles, so that one odd particle
does not make it the worst.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.page.view import View
from solvers.engine.frames import FrameArrays
from solvers.engine.messages import FrameReport
from solvers.ring.exact import INNER, OUTER
from solvers.scene import Scene

LENGTHS = 20  # of the bar
ANGLES, THIRDS = 6, ("inner", "middle", "outer")  # of the ring
LEAD = 1.05  # by which another region must be worse to take over: a tie must not flicker


@dataclass(frozen=True)
class Regions:
    """``names`` of the regions, and for each of P particles the ``number`` of the one where it was at rest."""

    names: tuple[str, ...]
    number: np.ndarray

    def errors(self, sizes: np.ndarray) -> np.ndarray:
        """The root of the mean square of sizes (P,) in each region; NaN where there is no particle."""
        with np.errstate(all="ignore"):  # a region may be empty, and a run gone bad holds anything
            squares = np.bincount(self.number, sizes.astype(float) ** 2, len(self.names))
            return np.sqrt(squares / np.bincount(self.number, minlength=len(self.names)))


def divide(scene: Scene, material_position: np.ndarray) -> Regions:
    """The regions of a scene whose particles were at ``material_position`` (P, D) at rest."""
    return (_bar if scene.problem == "bar" else _ring)(material_position)


def _bar(X: np.ndarray) -> Regions:
    number = np.clip((X[:, 0] * LENGTHS).astype(int), 0, LENGTHS - 1)
    return Regions(tuple(f"X = {k / LENGTHS:.2f}–{(k + 1) / LENGTHS:.2f} m" for k in range(LENGTHS)), number)


def _ring(X: np.ndarray) -> Regions:
    share = (np.hypot(X[:, 0], X[:, 1]) - INNER) / (OUTER - INNER)
    third = np.clip((share * len(THIRDS)).astype(int), 0, len(THIRDS) - 1)
    angle = np.clip((np.arctan2(X[:, 1], X[:, 0]) / (0.5 * np.pi) * ANGLES).astype(int), 0, ANGLES - 1)
    step = 90 // ANGLES
    names = tuple(f"{third} third, {k * step}–{(k + 1) * step}°"
                  for third in THIRDS for k in range(ANGLES))
    return Regions(names, third * ANGLES + angle)


class Worst:
    """The number of the worst region, kept until another one is clearly worse."""

    def __init__(self) -> None:
        self._last: int | None = None

    def of(self, errors: np.ndarray) -> int | None:
        """The region with the largest of the errors; None where there is no error to speak of."""
        known = np.where(np.isfinite(errors), errors, 0.0)
        worst = int(np.argmax(known))
        if not known[worst] > 0:
            self._last = None
        elif self._last is None or known[worst] > LEAD * known[self._last]:
            self._last = worst
        return self._last


@dataclass(frozen=True)
class Place:
    """A region's name and its errors, estimated and true; None where one is not known."""

    name: str
    estimated: float | None
    true: float | None


class WorstPlaces:
    """Where one visitor's run is worst, by the estimate that is drawn and by the truth."""

    def __init__(self) -> None:
        self._scene: Scene | None = None
        self.by_estimate: Place | None = None
        self.by_truth: Place | None = None

    def look(self, report: FrameReport, arrays: FrameArrays, view: View) -> None:
        """Find both in a frame."""
        if report.scene != self._scene:
            self._scene, self._worst = report.scene, (Worst(), Worst())
            self._regions = divide(report.scene, np.nan_to_num(arrays.position - arrays.displacement))
        if len(self._regions.number) != len(arrays.position):
            return  # the view is of another frame
        errors = [None if sizes is None or len(sizes) != len(arrays.position) else self._regions.errors(sizes)
                  for sizes in (view.estimated, view.true)]
        self.by_estimate, self.by_truth = (self._place(worst, own, errors)
                                           for worst, own in zip(self._worst, errors, strict=True))

    def _place(self, worst: Worst, own: np.ndarray | None, errors: list[np.ndarray | None]) -> Place | None:
        at = None if own is None else worst.of(own)
        if at is None:
            return None
        return Place(self._regions.names[at], *(None if e is None else float(e[at]) for e in errors))
