"""What the stage's two halves show of a frame: which sizes of errors, under which title, or why there is nothing."""

from dataclasses import dataclass

import numpy as np

from app.frame.captions import NOT_COMPARED, captions, not_estimated, why_no_estimate, why_no_truth
from app.frame.scale import known
from app.language.spoken import tr
from solvers.engine.frames import FrameArrays
from solvers.engine.messages import FrameReport
from solvers.solver import samples


@dataclass(frozen=True)
class Half:
    """One lane of the bar or half of a body in the plane, and whose it is: ``sizes`` (P,) of errors, or None and the
    reason in ``silence``."""

    title: str
    by: str
    sizes: np.ndarray | None
    silence: str = ""


@dataclass(frozen=True)
class View:
    """Both halves and what the scale measures; and the estimated and true sizes (P,) for whoever reads off numbers."""

    left: Half
    right: Half
    measures: str
    estimated: np.ndarray | None
    true: np.ndarray | None


def look(report: FrameReport, arrays: FrameArrays, quantity: str, estimator: str | None, difference: bool) -> View:
    """The view of a frame.

    Parameters
    ----------
    report, arrays
        The frame: what the engine says of it, and its particles.
    quantity, estimator, difference
        As of :func:`app.frame.captions.captions`.
    """
    scene, column = report.scene, samples.QUANTITIES.index(quantity)
    no_truth = why_no_truth(scene, quantity)
    no_estimate = why_no_estimate(scene, report.not_valid, estimator, quantity)
    true, estimated = None if no_truth else np.abs(arrays.error[:, column]), None
    if estimator is not None and not no_estimate:
        estimated = np.abs(arrays.estimate[estimator][:, column])
        if not known(estimated):
            estimated, no_estimate = None, f"{estimator} {not_estimated(quantity)}"
    apart = arrays.difference[estimator][:, column] if estimator in arrays.difference else None
    return view(quantity, estimator, estimated, true, no_estimate, no_truth, difference, apart)


def view(quantity: str, estimator: str | None, estimated: np.ndarray | None, true: np.ndarray | None, no_estimate: str,
         no_truth: str, difference: bool, apart: np.ndarray | None) -> View:
    """The view of sizes of errors.

    Parameters
    ----------
    quantity, estimator, no_estimate, no_truth, difference
        As of :func:`app.frame.captions.captions`.
    estimated, true, apart : (P,) array or None, in the unit of the quantity
        Sizes of both errors, and of estimate minus truth.
    """
    said = captions(quantity, estimator, difference, no_estimate, no_truth)
    silence = said.silences[0] or (tr(NOT_COMPARED) if difference and apart is None else "")
    shown = None if silence else apart if difference else estimated
    return View(Half(said.titles[0], said.by[0], shown, silence), Half(said.titles[1], said.by[1], true, no_truth),
                said.measures, estimated, true)
