"""What stands beside a picture of a run: titles of its halves, what its scale measures, captions of its field plot."""

from dataclasses import dataclass

from app.frame.silences import OFF, why_no_field
from app.words import QUANTITIES
from solvers.scene.scene import Scene

SIDE_BY_SIDE, DIFFERENCE = "estimate | truth", "estimate − truth | truth"


ESTIMATE, TRUTH = ("Estimate", "Estimate − truth"), "Truth"  # the halves' names
EXACT_SOLUTION = "exact solution"
PARTICLES, CURVE = "particles", "exact curve"  # keys of the field plot
#: What a look at two equal halves says: of a run, and of one that is lost.
ALIKE, ALIKE_LOST = "{} alike? Then the estimate is right.", "{} alike: the estimate is right, the run is not."


@dataclass(frozen=True)
class Captions:
    """The titles of the estimate's half and of the truth's, whose either is, why either shows nothing ("" where it does
    not), and what the colours measure."""

    titles: tuple[str, str]
    by: tuple[str, str]
    silences: tuple[str, str]
    measures: str


@dataclass(frozen=True)
class FieldWords:
    """What a plot of a field is called, with a remark on what it shows, if any is needed."""

    name: str
    remark: str = ""

    def __str__(self) -> str:
        return f"{self.name}: {self.remark}" if self.remark else self.name


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
    by, of = (f"by {estimator}" if estimator else "", EXACT_SOLUTION), f"of {QUANTITIES[quantity]}"
    if difference:
        return Captions((ESTIMATE[1], TRUTH), by, (no_estimate or no_truth, no_truth),
                        f"size of the error, and of estimate − truth, {of}")
    return Captions((ESTIMATE[0], TRUTH), by, (no_estimate, no_truth), f"size of the error {of}")


def field_words(scene: Scene, component: str, quantity: str) -> FieldWords:
    """What a plot of a ``component`` of a quantity's field shows."""
    noun = QUANTITIES[quantity].noun
    name = (f"{component} {noun}" if component else noun).capitalize()
    if why_no_field(scene, quantity):
        return FieldWords(name, OFF)
    if not scene.solution_known:
        return FieldWords(name, "no exact curve is known")
    return FieldWords(name, "" if scene.swings else "deviation from the exact one")


def counting(remark: str, unknown: int | str) -> str:
    """The remark, with how many particles have no number, unless it says itself that none has."""
    if not unknown or remark == OFF:
        return remark
    return "; ".join(filter(None, (remark, f"{unknown} without a number")))


def marks_note(marked: str, every: int) -> str:
    """What marks of particles mean, of which one in ``every`` is marked."""
    return marked + f" (1 in {every})" * (every > 1)
