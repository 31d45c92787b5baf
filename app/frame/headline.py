"""Headline and facts about a run, as templates for the numbers of a frame or of an exported file's picture.

The relative error comes first, then how much of it the estimate finds, then the quantity's size. All numbers are of one
moment or of the run so far, as the headline says."""

import math
import re
from collections.abc import Hashable, Mapping
from dataclasses import dataclass

import numpy as np

from app.frame.error_view_captions import FrameErrorView
from app.frame.primitives import SEPARATOR, Span, Spans
from app.language.translation import lazy, tr
from app.names_and_units import QUANTITIES, format_ratio, per_cent, short_reason, with_unit
from solvers.scene.scene import Scene
from solvers.solver.rounding import largest_rounding_error

ROUND_OFF = 1e-9  # of a quantity's size; far above the error of a patch test that is passed
UNSTABLE, LAST = lazy("the run went unstable and has stopped at t = {time} s"), lazy("this is its last picture")
LOST = lazy("the run is lost from t = {since} s on")
#: First words of a headline: the time it is about.
NOW, PAUSED, BACK = lazy("now "), lazy("at t = {time} s "), lazy("{ago} periods back ")
LESS, MORE = lazy("finds {share} of it"), lazy("estimates {factor} times as much")
TWICE = 2.0  # index from which an estimate is told as a factor, and no longer in per cent of the error
DURATION = "duration"  # kind of the span with a run's time, which leads to Cost
OVER, RUN_LOST = lazy("over 100 % wrong"), lazy("run is lost")

ENDS = (".", "?", "!", "…")  # of a sentence

#: Style of a placeholder's text by its name; redundant to the words.
KINDS = {"wrong": "number", "off": "truth", "by": "estimate", "share": "figure", "factor": "figure", "lost": "bad",
         "who": "who"}
#: Placeholders that are filled later, with numbers.
PLACES = {name: f"{{{name}}}" for name in ("wrong", "off", "by", "found", "true")}


@dataclass(frozen=True)
class HeadlineWithFacts:
    """Headline about a run in spans, (kind, text) each, and facts, each of which becomes a sentence below it."""

    headline: Spans = ()
    facts: tuple[str, ...] = ()
    moment: Hashable = None  # identifies the situation: a new one is read aloud

    @classmethod
    def from_template(cls, headline: str, *facts: str, **places: str) -> "HeadlineWithFacts":
        """Returns a headline from its template, filled with ``places`` by their names, and facts; drops empty ones."""
        return cls(tuple(to_spans(headline, places)), tuple(filter(None, facts)))

    def __bool__(self) -> bool:
        return bool(self.headline)

    @property
    def spans(self) -> list[Span]:
        """Spans of the headline as a sentence, with a capital and a full stop."""
        if not self.headline:
            return []
        (kind, first), *rest = self.headline
        spans = [(kind, _capitalise(first)), *rest]
        return spans if spans[-1][1].endswith(ENDS) else [*spans, ("", ".")]

    @property
    def fact_sentences(self) -> list[str]:
        """Facts as sentences, with a capital and a full stop."""
        return [_capitalise(fact) + "." * (not fact.endswith(ENDS)) for fact in self.facts]

    def __str__(self) -> str:
        return " ".join(["".join(text for _, text in self.spans), *self.fact_sentences])


@dataclass(frozen=True)
class ErrorHeadlineTemplates:
    """Translated templates of sentences about the error of a quantity. ``told``, the headline, has the places {wrong},
    the true error (or else the estimate) over the quantity's ``size`` (in its unit), and {found}, the comparison with
    the estimate (:func:`over_or_underestimates`); ``names`` has the texts of its other places. ``of`` has {true} and
    the size; ``why`` is the reason for a missing number, ``unmeasured`` the headline then; ``still`` and ``trace`` are
    headline and fact for a true error of at most ``least``, round-off of a scene at rest."""

    told: str
    names: Mapping[str, str]
    size: float
    of: str
    why: str
    unmeasured: str
    still: str
    trace: str
    least: float


def error_headline_templates(scene: Scene, quantity: str, estimator: str | None, no_estimate: str,
                             no_truth: str) -> ErrorHeadlineTemplates:
    """Returns the templates for the errors of a quantity (key x, v, sigma or a) by an estimator's name, or None;
    ``no_estimate`` and ``no_truth`` are the reasons if either is missing, else ""."""
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
    return ErrorHeadlineTemplates(told, {"by": estimator or "", "off": tr("wrong")}, size,
                                  tr("{true} of {size} at most", size=with_unit(size, words.unit), **PLACES), why,
                                  tr("no error of the {noun} has been measured", noun=noun),
                                  tr("nothing happens, as expected"),
                                  tr("the true error of the {noun} is {true}, round-off", noun=noun, **PLACES),
                                  -1.0 if scene.swings else max(ROUND_OFF * size,
                                                                largest_rounding_error(scene, quantity, scene.steps)))


def format_error_headline(words: ErrorHeadlineTemplates, unit: str, errors: "InstantErrors",
                          before: str = "") -> HeadlineWithFacts:
    """Returns the headline with numbers in the templates ``words``: the ``errors``, in ``unit`` (without prefix).
    ``before`` are the first words of the headline: the moment."""
    true, index = errors.true, errors.index
    if true <= words.least:
        size = _format_size(true, unit) if true else tr("zero")
        return HeadlineWithFacts.from_template(before + words.still, words.trace.format(true=size))
    norm = true if math.isfinite(true) else errors.estimated
    if "{wrong}" not in words.told:
        return HeadlineWithFacts.from_template(words.told, words.why)
    if not math.isfinite(norm) or ("{found}" in words.told and not math.isfinite(index)):
        return HeadlineWithFacts.from_template(before + words.unmeasured, words.why)
    return HeadlineWithFacts.from_template(
        before + words.told.replace("{found}", over_or_underestimates(index)),
        words.of.format(true=_format_size(norm, unit)), words.why, wrong=per_cent(norm / words.size),
        share=per_cent(index), factor=format_ratio(index), **words.names)


def over_or_underestimates(index: float) -> str:
    """Returns the template that compares an estimate with the true error, for an index (estimate over true error): with
    the place {factor} if it is 2 or more, otherwise with {share}, as in titles."""
    return tr(MORE if index >= TWICE else LESS)


@dataclass(frozen=True)
class InstantErrors:
    """Errors of a quantity at one instant: root mean squares over the particles of the ``true`` and the ``estimated``
    error, in its unit; NaN if unknown. Headline, title of a lane and card of an estimator show these."""

    true: float
    estimated: float

    @classmethod
    def of_view(cls, view: FrameErrorView) -> "InstantErrors":
        return cls(root_mean_square(view.true), root_mean_square(view.estimated))

    @property
    def index(self) -> float:
        """Estimated over true error; NaN if either is unknown, or the true one is zero."""
        return self.estimated / self.true if self.true else math.nan


def root_mean_square(sizes: np.ndarray | None) -> float:
    """Returns the root mean square of sizes (P,) of errors, in their unit; NaN for None."""
    with np.errstate(all="ignore"):  # a run gone bad holds anything
        return math.nan if sizes is None else float(np.sqrt(np.mean(sizes.astype(float) ** 2)))


def lane_facts(errors: InstantErrors, size: float, estimator: str | None, lost: bool, seconds: float) -> Spans:
    """Returns what the title of a run tells at its right end: how wrong it is, of the quantity's ``size``, how much of
    that the ``estimator`` finds, and the run's time so far in ``seconds`` (0 if not measured)."""
    wrong, parts = errors.true / size, list[Spans]()
    if lost or wrong > 1:
        return (("bad", tr(RUN_LOST if lost else OVER)),)
    if math.isfinite(wrong):
        parts.append(tuple(to_spans(tr("{wrong} wrong"), {"wrong": per_cent(wrong)})))
    elif math.isfinite(errors.estimated):
        parts.append(tuple(to_spans(tr("{who} estimates {wrong}"), {
            "who": estimator or "", "wrong": per_cent(errors.estimated / size)})))
    if math.isfinite(errors.index):
        told = tr("{who} finds {share}") if errors.index < TWICE else tr("{who} estimates {factor} times as much")
        parts.append(tuple(to_spans(told, {"who": estimator or "", "share": per_cent(errors.index),
                                           "factor": format_ratio(errors.index)})))
    if seconds:
        parts.append(((DURATION, with_unit(seconds, "s", 2)),))
    return tuple(span for k, part in enumerate(parts) for span in (*((SEPARATOR,) if k else ()), *part))


def _format_size(value: float, unit: str) -> str:
    return with_unit(value, unit, 2)


def _capitalise(text: str) -> str:
    return text[:1].upper() + text[1:]


def fill_template(text: str, **numbers: str) -> str:
    """Returns a text with its placeholders {name} replaced by ``numbers``; those without a number stay."""
    return "".join(piece for _, piece in to_spans(text, numbers))


def to_spans(text: str, places: Mapping[str, str]) -> list[Span]:
    """Returns a text as spans, (kind, text) each, with placeholders {name} replaced by the texts in ``places``, whose
    kind the name sets; placeholders without a text stay."""
    pieces = re.split(r"\{(\w+)\}", text)  # every second piece is a placeholder's name
    return [(KINDS.get(piece, ""), places[piece]) if k % 2 and piece in places
            else ("", f"{{{piece}}}" if k % 2 else piece) for k, piece in enumerate(pieces) if piece]
