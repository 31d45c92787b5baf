"""What stands beside a picture of a run: titles of its halves, what its scale measures, captions of its field plot."""

from dataclasses import dataclass

from app.frame.silences import OFF, why_no_field
from app.language.spoken import kept, later, tr
from app.words import QUANTITIES
from solvers.scene.scene import Scene

SIDE_BY_SIDE, DIFFERENCE = later("estimate | truth"), later("estimate − truth | truth")
ESTIMATE, TRUTH = (later("Estimate"), later("Estimate − truth")), later("Truth")  # the halves' names
EXACT_SOLUTION = later("exact solution")
PARTICLES, CURVE = later("particles"), later("exact curve")  # keys of the field plot
#: What a look at two equal halves says: of a run, and of one that is lost.
ALIKE = later("{} alike? Then the estimate is right.")
ALIKE_LOST = later("{} alike: the estimate is right, the run is not.")
#: What of a vector a plot may be of.
COMPONENTS = {"radial": later("radial {noun}"), "angular": later("angular {noun}")}


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


@kept(64)  # it is asked for with every frame
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
    by = tr("by {estimator}", estimator=estimator) if estimator else "", tr(EXACT_SOLUTION)
    titles = tr(ESTIMATE[difference]), tr(TRUTH)
    if difference:
        return Captions(titles, by, (no_estimate or no_truth, no_truth),
                        tr("size of the error, and of estimate − truth, of {quantity}", quantity=QUANTITIES[quantity]))
    return Captions(titles, by, (no_estimate, no_truth),
                    tr("size of the error of {quantity}", quantity=QUANTITIES[quantity]))


def field_words(scene: Scene, component: str, quantity: str) -> FieldWords:
    """What a plot of a ``component`` of a quantity's field shows."""
    noun = QUANTITIES[quantity].noun
    name = tr(COMPONENTS[component], noun=noun) if component else noun
    name = name[:1].upper() + name[1:]
    if off := why_no_field(scene, quantity):
        return FieldWords(name, off)
    if not scene.solution_known:
        return FieldWords(name, tr("no exact curve is known"))
    return FieldWords(name, "" if scene.swings else tr("deviation from the exact one"))


def counting(remark: str, unknown: int | str) -> str:
    """The remark, with how many particles have no number, unless it says itself that none has."""
    if not unknown or remark == tr(OFF):
        return remark
    if not remark:
        return tr("{unknown} without a number", unknown=unknown)
    return tr("{remark}; {unknown} without a number", remark=remark, unknown=unknown)


def marks_note(marked: str, every: int) -> str:
    """What marks of particles mean, of which one in ``every`` is marked."""
    return tr("{marked} (1 in {every})", marked=tr(marked), every=every) if every > 1 else tr(marked)
