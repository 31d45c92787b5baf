"""What stands beside a picture of a run: titles of its halves, what its scale measures, captions of its field plot."""

from dataclasses import dataclass

from app.frame.silences import OFF, why_no_field
from app.words import QUANTITIES
from solvers.scene.scene import Scene

SIDE_BY_SIDE, DIFFERENCE = "estimate | truth", "estimate − truth | truth"


@dataclass(frozen=True)
class Captions:
    """The titles of the estimate's half and of the truth's, why either shows nothing ("" where it does not), and what
    the colours measure."""

    titles: tuple[str, str]
    silences: tuple[str, str]
    measures: str


def captions(quantity: str, estimator: str | None, difference: bool, no_estimate: str, no_truth: str) -> Captions:
    """Those of the errors of a quantity.

    Parameters
    ----------
    quantity
        Key of x, v, sigma or a.
    estimator
        Whose estimate it is, None where nobody's.
    difference
        Whether estimate minus truth is shown, and not the estimate.
    no_estimate, no_truth
        Why either is not known (``app.frame.silences``), "" where it is.
    """
    named, of = f" by {estimator}" if estimator else "", f"of {QUANTITIES[quantity]}"
    if difference:
        return Captions((f"estimate{named} − truth", "true error"), (no_estimate or no_truth, no_truth),
                        f"size of the error, and of estimate − truth, {of}")
    return Captions((f"estimated error{named}", "true error"), (no_estimate, no_truth), f"size of the error {of}")


def field_caption(scene: Scene, component: str, quantity: str, magnified: int) -> str:
    """What a plot of a ``component`` of a quantity's field shows, with deviations from the exact one ``magnified``."""
    name = "displacement u" if quantity == "x" else str(QUANTITIES[quantity])  # the field of positions x
    name = f"{component} {name}".strip() + " − vt" * (quantity == "x" and not scene.swings)
    if why_no_field(scene, quantity):
        return f"{name} {OFF}"
    if not scene.solution_known:
        return f"{name} of the particles (no exact curve is known)"
    if magnified > 1:
        return f"{name}: particles' deviation from exact × {magnified}"
    return f"{name}: particles (dots) on the exact curve"


def counting(caption: str, unknown: int | str) -> str:
    """The caption, with how many particles have no number, unless it says itself that none has."""
    return caption if not unknown or caption.endswith(OFF) else f"{caption}; {unknown} without a number"


def marks_note(marked: str, every: int) -> str:
    """What marks of particles mean, of which one in ``every`` is marked."""
    return marked + f" (1 in {every})" * (every > 1)
