"""Why there is no number: every reason that the page, an exported file and the pictures give."""

from collections.abc import Collection, Mapping

from app.language.heard import heard
from app.language.spoken import later, tr
from app.words import QUANTITIES
from solvers.scene.scene import Scene

#: These say what they say in the visitor's language by ``tr``, where they are said.
UNKNOWN = later("true error unknown here: no exact solution is built in")
TRUTH_OFF = later("true error not computed: its effect is off")
ESTIMATE_OFF = later("not estimated: the effect \"estimate\" is off")
NONE_CHOSEN = later("no estimator is chosen")
OFF = later("not computed: the effect \"acceleration error\" is off")  # of accelerations
NOT_COUNTED = later("not counted: the effect \"grid crossings\" is off")
NOT_COMPARED = later("not compared when this frame was made")
NO_INDEX = later("empty: no exact solution is built in")
NOTHING_TO_SHOW = "nothing to show: every error is zero, or was not computed"
EMPTY_HALVES = ("not estimated", "truth not computed")  # where there is little room, the estimate's and the truth's
TRUE, ESTIMATED = later("true"), later("estimated")  # rows beside those of estimators


def why_no_truth(scene: Scene, quantity: str) -> str:
    """Why a scene has no true error of a quantity; "" where it has."""
    if not scene.solution_known:
        return tr(UNKNOWN)
    if not scene.has("truth"):
        return tr(TRUTH_OFF)
    return why_no_field(scene, quantity)


def why_no_estimate(scene: Scene, not_valid: Mapping[str, str], estimator: str | None, quantity: str) -> str:
    """Why an estimator says nothing of a quantity; "" where it should."""
    if estimator is None:
        return tr(NONE_CHOSEN)
    if "estimate" not in scene.effects:
        return tr(ESTIMATE_OFF)
    if estimator in not_valid:
        return f"{estimator}: {heard(not_valid[estimator])}"
    if estimator not in scene.active_estimators:
        return tr("{estimator} is being prepared", estimator=estimator)  # the frame is still one of the scene before
    return why_no_field(scene, quantity)


def why_no_field(scene: Scene, quantity: str) -> str:
    """Why nobody knows the particles' own values of a quantity; "" where they are known."""
    return tr(OFF) if quantity == "a" and not scene.has("acceleration") else ""


def not_estimated(quantity: str) -> str:
    """What is said of an estimator that has no number of a quantity, after its name."""
    return tr("does not estimate the {quantity}", quantity=QUANTITIES[quantity])


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
        found[name] = heard(not_valid.get(name, "")) or why_no_estimate(scene, not_valid, name, quantity) \
            or not_estimated(quantity) * (name in silent)
    return found if scene.estimators else {**found, ESTIMATED: tr(NONE_CHOSEN)}


def why_no_index(scene: Scene, valid: Collection[str], quantity: str) -> str:
    """Why the plot of the error index is empty, with the estimators that are ``valid``; "" where it is not."""
    if not scene.solution_known:
        return tr(NO_INDEX)
    if why_no_truth(scene, quantity):
        return tr("empty: the true error is not computed")
    return "" if valid else tr("empty: no valid estimate") if scene.estimators else tr("empty: no estimate")
