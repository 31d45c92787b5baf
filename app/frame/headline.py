"""What is said of a run: a headline and further facts, made of words with places in braces for numbers, which the page
fills with those of a frame and the script of an exported file with those of a picture.

How wrong comes first, in parts of a quantity's size; then whether an estimate knows it; then of which size that is. All
of it is either of one moment or of the run so far, and says which.
"""

import math
import re
from collections.abc import Hashable, Mapping
from dataclasses import dataclass

from app.language.translation import lazy, tr
from app.words import QUANTITIES, format_ratio, per_cent, short_reason, with_unit
from solvers.scene.scene import Scene
from solvers.solver.rounding import rounding

ROUND_OFF = 1e-9  # of a quantity's size, and far above what a patch test that is passed has
UNSTABLE, LAST = lazy("the run went unstable and has stopped at t = {time} s"), lazy("this is its last picture")
LOST = lazy("the run is lost from t = {since} s on")
#: Of when a headline is: what it begins with.
SO_FAR, NOW, PAUSED, BACK = lazy("so far "), lazy("now "), lazy("at t = {time} s "), lazy("{ago} periods back ")
LESS, MORE = lazy("finds {share} of it"), lazy("estimates {factor} times as much")
ALL_OF_IT = 1.005  # index up to which an estimate finds what there is

ENDS = (".", "?", "!")  # of a sentence

Span = tuple[str, str]  # a kind, "" or one of KINDS, and a text
#: What a text in a place is, by the place's name: for the eye only, the words say it too.
KINDS = {"wrong": "number", "off": "truth", "by": "estimate", "share": "figure", "factor": "figure", "lost": "bad"}
#: Places that are filled later, with the numbers of a moment.
PLACES = {name: f"{{{name}}}" for name in ("wrong", "off", "by", "found", "true")}


@dataclass(frozen=True)
class Headline:
    """A headline in spans, and facts in words, each of which makes a sentence."""

    headline: tuple[Span, ...] = ()
    facts: tuple[str, ...] = ()
    moment: Hashable = None  # what it is of: another one is worth being read aloud

    @classmethod
    def of(cls, headline: str, *facts: str, **places: str) -> "Headline":
        """With texts in the headline's places, and without facts that are empty."""
        return cls(tuple(to_spans(headline, places)), tuple(filter(None, facts)))

    def __bool__(self) -> bool:
        return bool(self.headline)

    @property
    def shown(self) -> list[Span]:
        """The headline as a sentence."""
        if not self.headline:
            return []
        (kind, first), *rest = self.headline
        spans = [(kind, _capital(first)), *rest]
        return spans if spans[-1][1].endswith(ENDS) else [*spans, ("", ".")]

    @property
    def sentences(self) -> list[str]:
        """The facts as sentences."""
        return [_capital(fact) + "." * (not fact.endswith(ENDS)) for fact in self.facts]

    def __str__(self) -> str:
        return " ".join(["".join(text for _, text in self.shown), *self.sentences])


@dataclass(frozen=True)
class ErrorWords:
    """How wrong a quantity is: ``told`` with {wrong}, the true error over the ``size`` that a quantity has, or where
    nobody knows it the estimate, and with {found}, what the estimate says of the true error
    (:func:`over_or_underestimates`); ``names`` are the other places of its. ``of`` has {true} and, in words, the size;
    ``why`` is a fact of what is missing. ``unmeasured`` is said as long as there are no numbers; ``still`` and
    ``trace`` as long as the true error is at most ``least``: then a motion without swings is what it should be but for
    round-off."""

    told: str
    names: Mapping[str, str]
    size: float
    of: str
    why: str
    unmeasured: str
    still: str
    trace: str
    least: float


def error_words(scene: Scene, quantity: str, estimator: str | None, no_estimate: str, no_truth: str) -> ErrorWords:
    """What is said of the errors of a quantity; arguments as of :func:`app.frame.captions.make_captions`."""
    words, size = QUANTITIES[quantity], scene.size_of(quantity)
    noun = words.noun
    why = no_truth
    if no_truth and no_estimate:
        told, why = tr("nothing is known of the error of the {noun}", noun=noun), f"{no_truth}; {no_estimate}"
    elif no_truth:
        told = tr("{by} estimates that the {noun} is {wrong} wrong", noun=noun, **PLACES)
    elif no_estimate:
        told = tr("the {noun} is {wrong} {off}; {silence}", noun=noun, silence=short_reason(no_estimate), **PLACES)
    else:
        told = tr("the {noun} is {wrong} {off}; {by} {found}", noun=noun, **PLACES)
    return ErrorWords(told, {"by": estimator or "", "off": tr("wrong")}, size,
                      tr("{true} of {size} at most", size=with_unit(size, words.unit), **PLACES), why,
                      tr("no error of the {noun} has been measured", noun=noun), tr("nothing happens, as expected"),
                      tr("the true error of the {noun} is {true}, round-off", noun=noun, **PLACES),
                      -1.0 if scene.swings else max(ROUND_OFF * size, rounding(scene, quantity, scene.steps)))


def format_errors(words: ErrorWords, unit: str, true: float, estimate: float, index: float,
                  before: str = "") -> Headline:
    """The words with numbers in their places.

    Parameters
    ----------
    words
        From :func:`error_words`.
    unit
        That of the norms.
    true, estimate, index
        Both errors' RMS norms of one moment, or their means over a time, and the second over the first; NaN is what
        nobody knows.
    before
        Of which moment or time: what the headline begins with, where there is anything to say.
    """
    if true <= words.least:
        return Headline.of(before + words.still, words.trace.format(true=_size(true, unit) if true else tr("zero")))
    norm = true if math.isfinite(true) else estimate
    if "{wrong}" not in words.told:
        return Headline.of(words.told, words.why)
    if not math.isfinite(norm) or ("{found}" in words.told and not math.isfinite(index)):
        return Headline.of(before + words.unmeasured, words.why)
    return Headline.of(before + words.told.replace("{found}", over_or_underestimates(index)),
                       words.of.format(true=_size(norm, unit)),
                   words.why, wrong=per_cent(norm / words.size), share=per_cent(index), factor=format_ratio(index),
                   **words.names)


def over_or_underestimates(index: float) -> str:
    """What an estimate says of a true error so many times smaller."""
    return tr(MORE if index >= ALL_OF_IT else LESS)


def _size(value: float, unit: str) -> str:
    return with_unit(value, unit, 2)


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def fill_template(text: str, **numbers: str) -> str:
    """The text with numbers in the places of their names."""
    return "".join(piece for _, piece in to_spans(text, numbers))


def to_spans(text: str, places: Mapping[str, str]) -> list[Span]:
    """The text in spans, with what is in the places of their names; a place of another name stays as it is."""
    pieces = re.split(r"\{(\w+)\}", text)  # every second one is the name of a place
    return [(KINDS.get(piece, ""), places[piece]) if k % 2 and piece in places
            else ("", f"{{{piece}}}" if k % 2 else piece) for k, piece in enumerate(pieces) if piece]
