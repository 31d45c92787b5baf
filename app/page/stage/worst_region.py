"""The worst region: of the regions into which a problem's material is divided, the one with the largest error.

A region's error is the root mean square over its particles, so that one outlier does not decide."""

import threading
from dataclasses import dataclass

import numpy as np

from app.frame.error_view_captions import FrameErrorView
from app.frame.headline import ROUND_OFF
from app.frame.stage import NOTHING, WorstRegionAnnotations, WorstRegionMark
from app.names_and_units import QUANTITIES, with_unit
from app.problems.views import VIEWS
from solvers.engine.engine_messages import FrameReport
from solvers.engine.shared_frames import FrameArrays
from solvers.scene.scene import Scene
from solvers.solver import soundness
from solvers.solver.rounding import largest_rounding_error

ALIKE = 0.8, 1.25  # range of an estimate's norm over the true one that looks right
LEAD = 1.05  # factor by which another region must be worse to take over, so that ties do not flicker


class SteadyMaximum:
    """Finds the region with the largest error, which changes only if another one's is 5 % larger."""

    def __init__(self) -> None:
        self._last: int | None = None

    def find(self, errors: np.ndarray) -> int | None:
        """Returns the index of the largest finite error (n,), or the last one's if about as large; None without any."""
        known = np.where(np.isfinite(errors), errors, 0.0)
        worst = int(np.argmax(known))
        if not known[worst] > 0:
            self._last = None
        elif self._last is None or known[worst] > LEAD * known[self._last]:
            self._last = worst
        return self._last


@dataclass(frozen=True, eq=False)
class BodyRegionErrors:
    """Region of a body: its name, whether each particle is in it (P,), and its RMS errors; None where not known."""

    name: str
    particles: np.ndarray
    estimated: float | None
    true: float | None


class WorstRegions:
    """The regions with the largest error in one visitor's run, by the estimate drawn and by the truth. Thread-safe."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self.scene: Scene | None = None  # of which they are
        self.by_estimate: BodyRegionErrors | None = None
        self.by_truth: BodyRegionErrors | None = None
        self._remarks: tuple[Scene | None, WorstRegionAnnotations] = None, NOTHING  # and of which scene: threads differ

    def annotations(self, scene: Scene) -> WorstRegionAnnotations:
        """Returns the notes found last for a picture; empty if they belong to another scene."""
        whose, remarks = self._remarks
        return remarks if scene == whose else NOTHING

    def find(self, report: FrameReport, arrays: FrameArrays, view: FrameErrorView, quantity: str) -> None:
        """Sets ``by_estimate``, ``by_truth`` and the notes, from a frame and the ``view`` of a quantity's errors."""
        with self._lock, np.errstate(all="ignore"):  # a run gone bad holds anything
            self._find(report, arrays, view, quantity)

    def _find(self, report: FrameReport, arrays: FrameArrays, view: FrameErrorView, quantity: str) -> None:
        if report.scene != self.scene:
            self.by_estimate = self.by_truth = None
            self.scene, self._worst = report.scene, (SteadyMaximum(), SteadyMaximum())
            at_rest = np.nan_to_num(arrays.position - arrays.displacement)
            self._regions = VIEWS[report.scene.problem].regions(at_rest)
        if len(self._regions.number) != len(arrays.position):
            return  # the view is of another frame
        self._remarks = None, NOTHING
        errors = [None if sizes is None or len(sizes) != len(arrays.position) else self._regions.rms_errors(sizes)
                  for sizes in (view.estimated, view.true)]
        self.by_estimate, self.by_truth = (self._region(worst, own, errors)
                                           for worst, own in zip(self._worst, errors, strict=True))
        estimate, truth = self.by_estimate, self.by_truth
        scene, unit = report.scene, QUANTITIES[quantity].unit
        least = 0.0 if scene.swings else max(ROUND_OFF * scene.size_of(quantity),
                                             largest_rounding_error(scene, quantity, scene.steps))

        def describe(region: BodyRegionErrors | None, estimated: bool) -> WorstRegionMark | None:
            size = (region.estimated if estimated else region.true) if region else None
            return WorstRegionMark(region.particles,
                                   with_unit(size, unit, 2)) if region and size and size > least else None

        alike = False  # whether the estimate looks as large as the truth
        if view.estimated is not None and view.true is not None:
            known = np.isfinite(view.estimated) & np.isfinite(view.true)
            index = float(np.linalg.norm(view.estimated[known]) / np.linalg.norm(view.true[known]))
            alike = ALIKE[0] <= index <= ALIKE[1]
        self._remarks = scene, WorstRegionAnnotations(
            (describe(estimate, True) if view.left.sizes is view.estimated else None,
             describe(truth, False)), report.status != soundness.OK, alike)

    def _region(self, worst: SteadyMaximum, own: np.ndarray | None,
                errors: list[np.ndarray | None]) -> BodyRegionErrors | None:
        at = None if own is None else worst.find(own)
        if at is None:
            return None
        return BodyRegionErrors(self._regions.names[at], self._regions.number == at,
                                *(None if e is None else float(e[at]) for e in errors))
