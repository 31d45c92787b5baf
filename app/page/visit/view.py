"""What the stage's two halves show of a frame: which sizes of errors, under which title, or why there is nothing."""

from dataclasses import dataclass

import numpy as np

from app.problems.stage import Half
from app.words import QUANTITIES
from solvers.engine.frames import FrameArrays
from solvers.engine.messages import FrameReport
from solvers.scene.effects import EFFECTS
from solvers.scene.scene import Scene
from solvers.solver import samples

SIDE_BY_SIDE, DIFFERENCE = "estimate | truth", "estimate − truth | truth"
UNKNOWN = "true error unknown here: no exact solution is built in"
TRUTH_OFF = "true error not computed: its effect is off"
ESTIMATE_OFF = f"not estimated: the effect \"{EFFECTS['estimate'].label}\" is off"
NONE_CHOSEN = "no estimator is chosen"
ACCELERATION_OFF = f"not computed: the effect \"{EFFECTS['acceleration'].label}\" is off"

NOT_COMPARED = "not compared when this frame was made"


@dataclass(frozen=True)
class View:
    """Both halves and what the scale measures; and the estimated and true sizes (P,) for whoever reads off numbers."""

    left: Half
    right: Half
    measures: str
    estimated: np.ndarray | None
    true: np.ndarray | None


def look(report: FrameReport, arrays: FrameArrays, quantity: str, estimator: str | None, difference: bool) -> View:
    """The view of a frame: the errors of ``quantity``, by its key, as estimated by ``estimator`` and in truth."""
    scene, column = report.scene, samples.QUANTITIES.index(quantity)
    measures, named = f"size of the error of {QUANTITIES[quantity]}", f" by {estimator}" if estimator else ""
    no_truth = why_no_truth(scene, quantity)
    no_estimate = why_no_estimate(scene, report.not_valid, estimator, quantity)
    true, estimated = None if no_truth else np.abs(arrays.error[:, column]), None
    if estimator is not None and not no_estimate:
        estimated = np.abs(arrays.estimate[estimator][:, column])
        if not np.isfinite(estimated).any():
            estimated, no_estimate = None, f"{estimator} does not estimate the {QUANTITIES[quantity]}"
    left = Half(f"estimated error{named}", estimated, no_estimate)
    if difference:
        measures = f"size of the error, and of estimate − truth, of {QUANTITIES[quantity]}"
        silence = no_estimate or no_truth or NOT_COMPARED * (estimator not in arrays.difference)
        sizes = arrays.difference[estimator][:, column] if estimator in arrays.difference and not silence else None
        left = Half(f"estimate{named} − truth", sizes, silence)
    return View(left, Half("true error", true, no_truth), measures, estimated, true)


def why_no_truth(scene: Scene, quantity: str) -> str:
    """Why a scene has no true error of a quantity; "" where it has."""
    if not scene.solution_known:
        return UNKNOWN
    if not scene.has("truth"):
        return TRUTH_OFF
    return _why_no_acceleration(scene, quantity)


def why_no_estimate(scene: Scene, not_valid: dict[str, str], estimator: str | None, quantity: str) -> str:
    """Why an estimator says nothing of a quantity; "" where it should."""
    if estimator is None:
        return NONE_CHOSEN
    if "estimate" not in scene.effects:
        return ESTIMATE_OFF
    if estimator in not_valid:
        return f"{estimator}: {not_valid[estimator]}"
    if estimator not in scene.active_estimators:
        return f"{estimator} is being prepared"  # the frame is still one of the scene before
    return _why_no_acceleration(scene, quantity)


def _why_no_acceleration(scene: Scene, quantity: str) -> str:
    return ACCELERATION_OFF if quantity == "a" and not scene.has("acceleration") else ""
