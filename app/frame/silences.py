"""Why there is no number: every reason that the page, an exported file and the pictures give."""

from collections.abc import Collection, Mapping

from app.words import QUANTITIES
from solvers.scene.effects import EFFECTS
from solvers.scene.scene import Scene

UNKNOWN = "true error unknown here: no exact solution is built in"
TRUTH_OFF = "true error not computed: its effect is off"
ESTIMATE_OFF = f"not estimated: the effect \"{EFFECTS['estimate'].label}\" is off"
NONE_CHOSEN = "no estimator is chosen"
OFF = f"not computed: the effect \"{EFFECTS['acceleration'].label}\" is off"  # of accelerations
NOT_COUNTED = f"not counted: the effect \"{EFFECTS['crossings'].label}\" is off"
NOT_COMPARED = "not compared when this frame was made"
NO_INDEX = "empty: no exact solution is built in"
NOTHING_TO_SHOW = "nothing to show: every error is zero, or was not computed"
EMPTY_HALVES = ("not estimated", "truth not computed")  # where there is little room, the estimate's and the truth's
TRUE, ESTIMATED = "true", "estimated"  # rows beside those of estimators


def why_no_truth(scene: Scene, quantity: str) -> str:
    """Why a scene has no true error of a quantity; "" where it has."""
    if not scene.solution_known:
        return UNKNOWN
    if not scene.has("truth"):
        return TRUTH_OFF
    return why_no_field(scene, quantity)


def why_no_estimate(scene: Scene, not_valid: Mapping[str, str], estimator: str | None, quantity: str) -> str:
    """Why an estimator says nothing of a quantity; "" where it should."""
    if estimator is None:
        return NONE_CHOSEN
    if "estimate" not in scene.effects:
        return ESTIMATE_OFF
    if estimator in not_valid:
        return f"{estimator}: {not_valid[estimator]}"
    if estimator not in scene.active_estimators:
        return f"{estimator} is being prepared"  # the frame is still one of the scene before
    return why_no_field(scene, quantity)


def why_no_field(scene: Scene, quantity: str) -> str:
    """Why nobody knows the particles' own values of a quantity; "" where they are known."""
    return OFF if quantity == "a" and not scene.has("acceleration") else ""


def not_estimated(quantity: str) -> str:
    """What is said of an estimator that has no number of a quantity, after its name."""
    return f"does not estimate the {QUANTITIES[quantity]}"


def why_no_numbers(scene: Scene, not_valid: Mapping[str, str], quantity: str,
                   silent: Collection[str]) -> dict[str, str]:
    """For the truth and each estimator asked for, why there is no number of a quantity; "" where there is.

    Parameters
    ----------
    scene
    not_valid
        Sentences of the estimators that do not hold (``Result.not_valid``).
    quantity
        Key of x, v, sigma or a.
    silent
        Estimators that have said nothing of it so far.
    """
    found = {TRUE: why_no_truth(scene, quantity)}
    for name in scene.estimators:
        found[name] = not_valid.get(name) or why_no_estimate(scene, not_valid, name, quantity) \
            or not_estimated(quantity) * (name in silent)
    return found if scene.estimators else {**found, ESTIMATED: NONE_CHOSEN}


def why_no_index(scene: Scene, valid: Collection[str], quantity: str) -> str:
    """Why the plot of the error index is empty, with the estimators that are ``valid``; "" where it is not."""
    if not scene.solution_known:
        return NO_INDEX
    if why_no_truth(scene, quantity):
        return "empty: the true error is not computed"
    return "" if valid else "empty: no valid estimate" if scene.estimators else "empty: no estimate"
