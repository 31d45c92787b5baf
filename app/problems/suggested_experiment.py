"""Suggestions: experiments that a problem offers. One click starts one, and the runs' own numbers answer."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from app.language.translation import lazy, tr, translate_message
from app.names_and_units import QUANTITIES, format_factor, format_number, format_ratio
from app.shareable_state import State
from solvers.scene.validation import SceneError

QUARTER = (0.22, 0.28)  # range of ratios called a quarter
SAME = 0.005  # distance from 1 within which a ratio is shown as 1.00


class SuggestionNotApplicable(Exception):
    """Raised if a suggestion does not apply to the page's present state; the message is a short translated reason."""


@dataclass(frozen=True)
class Offer:
    """Offer of a suggestion in a certain state of the page, in the visitor's language: ``title``, a short ``hint`` at
    the result to expect, and the ``state`` to go to, in which the run to compare with is pinned."""

    title: str
    hint: str
    state: State


@dataclass(frozen=True)
class ComparedRuns:
    """Results of a suggested run and of the pinned run beside it: the page's ``state``, the ``series`` of both by name,
    (T,) each, over the requested periods, the ``ratio`` of the errors of the quantity on the stage (the run's mean over
    the pinned one's), and a reason for each of the run's estimators that is ``not_valid``."""

    state: State
    series: Mapping[str, np.ndarray]
    pinned: Mapping[str, np.ndarray]
    ratio: float
    not_valid: Mapping[str, str]

    def index(self, estimator: str) -> float:
        """Returns an estimator's last index, estimate over true error, of the quantity shown; NaN if unknown."""
        values = self.series.get(f"{estimator}/index_{self.state.quantity}", np.zeros(0))
        return float(values[-1]) if len(values) else math.nan

    @property
    def quantity_noun(self) -> str:
        return QUANTITIES[self.state.quantity].noun


Answer = tuple[str, ...]  # a sentence, a second one to think about, and maybe a question that the error budget answers


@dataclass(frozen=True)
class SuggestedExperiment:
    """Suggested experiment with a unique ``key`` and a translatable ``title`` for when it does not apply.

    ``offer`` returns the offer in a state of the page, or raises :class:`SuggestionNotApplicable`; ``answer`` returns
    two sentences on the results once both runs have lasted ``periods``. A run that is lost has no answer if that was
    the purpose (``breaks``). ``icon`` is the name of a drawing (``sparks.js``)."""

    key: str
    icon: str
    title: str
    offer: Callable[[State], Offer]
    answer: Callable[[ComparedRuns], Answer]
    periods: float = 1.0
    breaks: bool = False


def changed_state(state: State, changes: Mapping[str, Any], pinned: bool = True, **view: Any) -> State:
    """Returns the page's state with ``changes`` to its scene's fields, from t = 0 on, and ``view`` to its own; the
    scene before is pinned if ``pinned``. Raises :class:`SuggestionNotApplicable` for an invalid scene."""
    before = replace(state.scene, periods=None, t_end=None)
    try:
        after = replace(before, **changes)
    except SceneError as error:
        raise SuggestionNotApplicable(translate_message(error.sentence)) from None
    return replace(state, **{"scene": after, "pinned": before if pinned and after != before else None,
                             "compared": None, "speed": None, "stops": False, "traced": None, "magnified": 1,
                             "difference": False, **view})


def work_ratio(runs: ComparedRuns) -> float:
    """Returns a run's particle steps (particles times steps) per period over the pinned run's; NaN without one."""
    def a_period(scene: Any) -> float:
        return scene.particles * scene.period / scene.time_step

    return math.nan if runs.state.pinned is None else a_period(runs.state.scene) / a_period(runs.state.pinned)


def _halving_cells_answer(runs: ComparedRuns) -> Answer:
    """Returns the answer to a comparison with cells half as wide: how the error has changed, and what theory says."""
    by, hint = runs.ratio, tr("Largest error in the first period. Theory: 0.25 times, for {work} times the work.",
                              work=format_number(work_ratio(runs)))
    if not math.isfinite(by):
        return tr("Unknown: there is no true error to compare."), hint
    if by >= 1 + SAME:
        return tr("It rose to {factor} times as much.", factor=format_factor(by)), hint, tr("Why?")
    if QUARTER[0] <= by <= QUARTER[1]:
        return tr("It fell to {factor}: a quarter.", factor=format_factor(by)), hint
    return tr("It fell to {factor}, not to a quarter.", factor=format_factor(by)), hint, tr("Why?")


def suggest_halving_cells(most: int) -> SuggestedExperiment:
    """Returns the suggestion to make cells half as wide, up to ``most`` cells along a side."""
    def offer(state: State) -> Offer:
        cells = 2 * state.scene.cells
        if cells > most:
            raise SuggestionNotApplicable(tr("{most} cells are the most here", most=most))
        return Offer(tr("Halve the cells"), tr("theory: error falls to a quarter"),
                     changed_state(state, {"cells": cells}))

    return SuggestedExperiment("halve", "halve", lazy("Halve the cells"), offer, _halving_cells_answer)


def suggest_breaking(hint: str, changes: Mapping[str, Any], periods: float) -> SuggestedExperiment:
    """Returns the suggestion to try a run that will fail: a translatable ``hint``, the ``changes`` to fields of the
    scene, and the ``periods`` after which a run that still holds is answered."""
    title = lazy("Break it")

    def offer(state: State) -> Offer:
        wanted = changes if "companion" not in state.scene.choices("estimators") else {
            **changes, "estimators": ("companion",), "remedies": ()}
        if all(getattr(state.scene, name) == value for name, value in wanted.items()):
            raise SuggestionNotApplicable(tr("it is on the stage"))
        return Offer(tr(title), tr(hint), changed_state(state, wanted, pinned=False, quantity="x", estimator=None))

    def answer(runs: ComparedRuns) -> Answer:
        index = runs.index("companion")
        said = format_ratio(index) if math.isfinite(index) else ""
        knows = tr("Companion estimates {index} times the true error.", index=said) if said else ""
        return tr("It was stable for {periods:g} periods. Continue?", periods=periods), knows

    return SuggestedExperiment("break", "break", title, offer, answer, periods, breaks=True)
