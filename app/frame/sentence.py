"""What is seen of a run, in one sentence: parts with places in braces for numbers, which the page fills with those of a
frame and the script of an exported file with those of a picture."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

from app.words import QUANTITIES, brief, times, with_unit
from solvers.scene.scene import Scene

ROUND_OFF = 1e-9  # of a quantity's size, and far above what a patch test that is passed has
UNSTABLE = "the run went unstable and has stopped at t = {time} s; this is its last picture"
LOST = "the run is lost from t = {since} s on"
PAUSED = "paused at t = {time} s: "
NOTHING_YET = "nothing yet"


@dataclass(frozen=True)
class ErrorWords:
    """How large the estimate is beside the truth: ``told`` with {index}, which ends in "times" or "of", or with
    {estimate} or {true} alone and why the other is missing; ``unmeasured`` as long as there is no index; ``still`` as
    long as the true error is at most ``least``: then a motion without swings is what it should be but for round-off."""

    told: str
    unmeasured: str
    still: str
    least: float


def error_words(scene: Scene, quantity: str, estimator: str | None, no_estimate: str, no_truth: str) -> ErrorWords:
    """What is said of the errors of a quantity; arguments as of :func:`app.frame.captions.captions`."""
    of = f"error of {QUANTITIES[quantity]}"
    if no_truth and no_estimate:
        told = f"nothing is known of the {of}: {no_truth}; {no_estimate}"
    elif no_truth:
        told = f"{estimator} estimates the {of} at {{estimate}}; {no_truth}"
    elif no_estimate:
        told = f"the true {of} is {{true}}; {brief(no_estimate)}"
    else:
        told = f"the estimate by {estimator} is {{index}} the true {of}"
    return ErrorWords(told, f"no {of} has been measured yet",
                      f"exactly nothing happens, as it should: the true {of} is {{true}}, round-off",
                      -1.0 if scene.swings else ROUND_OFF * scene.size_of(quantity))


def errors(words: ErrorWords, unit: str, true: float, estimate: float, index: float) -> str:
    """The words with numbers in their places.

    Parameters
    ----------
    words
        From :func:`error_words`.
    unit
        That of the norms.
    true, estimate, index
        The RMS norms of both errors, and their index so far; NaN is what nobody knows.
    """
    if true <= words.least:
        return fill(words.still, true=_size(true, unit) if true else "zero")
    if "{index}" in words.told and not math.isfinite(index):
        return words.unmeasured
    return fill(words.told, true=_size(true, unit), estimate=_size(estimate, unit), index=times(index))


def _size(value: float, unit: str) -> str:
    return with_unit(value, unit, 2) if math.isfinite(value) else NOTHING_YET


def fill(text: str, **numbers: str) -> str:
    """The text with numbers in the places of their names."""
    return re.sub(r"\{(\w+)\}", lambda place: numbers.get(place[1], place[0]), text)


def joined(parts: Sequence[str], before: str = "") -> str:
    """Parts as a sentence."""
    sentence = before + "; ".join(parts) + "."
    return sentence[:1].upper() + sentence[1:]
