"""Suggestions of plane problems, by name; the file of each problem lists its own (``ViewSettings.sparks``)."""

from dataclasses import replace

from app.language.translation import lazy, tr, translate_message
from app.names_and_units import format_factor, format_ratio, per_cent
from app.problems import suggested_experiment
from app.problems.suggested_experiment import Answer, ComparedRuns, Offer, SuggestedExperiment, changed_state
from app.shareable_state import State
from solvers.problems.planar.problem import ViewSettings


def planar_suggestions(settings: ViewSettings) -> tuple[SuggestedExperiment, ...]:
    """Returns the suggestions that a plane problem's settings list by key, within the range of its sliders."""
    fewest, most, _ = settings.cells
    known = (suggested_experiment.suggest_halving_cells(most), _suggest_doubling_cells(2 * fewest),
             suggested_experiment.suggest_breaking(*settings.breaking), TRANSPORT, STAIRCASE, TILE)
    by_key = {one.key: one for one in known}
    return tuple(by_key[key] for key in settings.sparks)


def _transport_estimator_offer(state: State) -> Offer:
    judges = state.scene.estimators
    if (state.estimator or next(iter(judges), None)) == "transport":
        raise suggested_experiment.SuggestionNotApplicable(tr("it is on the stage"))
    changed = changed_state(state, {"estimators": (*judges, *({"transport"} - set(judges)))}, pinned=False)
    return Offer(tr("Ask transport, too"), tr("the method's own equations"), replace(changed, estimator="transport"))


def _transport_estimator_answer(runs: ComparedRuns) -> Answer:
    if "transport" in runs.not_valid:
        return tr("Transport: {reason}.", reason=translate_message(runs.not_valid["transport"])), \
            tr("It is not valid here and reports this.")
    index, companion = runs.index("transport"), runs.index("companion")
    if index != index:
        return tr("Transport does not estimate the {noun}.",
                  noun=runs.quantity_noun), tr("It reports this instead of a number.")
    said = tr("Transport estimates {times} times the true error.", times=format_ratio(index)) if index >= 1 else \
        tr("Transport estimates {share} of the true error.", share=per_cent(index))
    if companion == companion:
        return said, tr("Companion estimates {times} times. Which one would you trust without the true error?",
                        times=format_ratio(companion))
    return said, tr("Which one would you trust without the true error?")


TRANSPORT = SuggestedExperiment("transport", "judge", lazy("Ask transport, too"), _transport_estimator_offer,
                                _transport_estimator_answer, 0.5)


def _suggest_doubling_cells(fewest: int) -> SuggestedExperiment:
    """Returns the suggestion to make cells twice as wide, down to so many cells along a side."""
    def offer(state: State) -> Offer:
        if state.scene.cells < 2 * fewest:
            raise suggested_experiment.SuggestionNotApplicable(tr("{fewest} cells are the fewest here", fewest=fewest))
        return Offer(tr("Double the cells' width"), tr("theory: 4 times the error"),
                     changed_state(state, {"cells": state.scene.cells // 2}))

    return SuggestedExperiment("widen", "halve", lazy("Double the cells' width"), offer, _doubling_cells_answer, 0.2)


def _doubling_cells_answer(runs: ComparedRuns) -> Answer:
    return tr("Its error is {factor} times as large; theory: 4 times.", factor=format_factor(runs.ratio)), \
        tr("It takes {factor} of the particle steps: fewer particles, and fewer steps.",
           factor=format_factor(suggested_experiment.work_ratio(runs)))


def _staircase_rim_offer(state: State) -> Offer:
    if getattr(state.scene, "layout", "") == "cartesian":
        return Offer(tr("Rims that are round"), tr("particles along circles"),
                     changed_state(state, {"layout": "polar"}))
    return Offer(tr("Rims like a staircase"), tr("particles along the grid"),
                 changed_state(state, {"layout": "cartesian"}))


def _staircase_rim_answer(runs: ComparedRuns) -> Answer:
    return tr("Its error is {factor} times as large.", factor=format_factor(runs.ratio)), \
        tr("Only the particles' initial positions differ: see the rims.")


STAIRCASE = SuggestedExperiment("staircase", "stairs", lazy("Rims like a staircase"), _staircase_rim_offer,
                                _staircase_rim_answer, 0.2)


def _domain_tiling_offer(state: State) -> Offer:
    if state.scene.method == "ugimp":
        return Offer(tr("Domains that tile"), tr("CPDI's parallelograms"), changed_state(state, {"method": "cpdi"}))
    return Offer(tr("Boxes that do not tile"), tr("uGIMP: boxes keep their size"),
                 changed_state(state, {"method": "ugimp"}))


def _domain_tiling_answer(runs: ComparedRuns) -> Answer:
    said = tr("Its error is {factor} times as large.", factor=format_factor(runs.ratio))
    if runs.state.scene.method == "ugimp":
        return said, tr("Boxes that keep their size leave gaps where the material stretches. Would smaller cells help?")
    return said, tr("Parallelograms follow the material and leave no gap.")


TILE = SuggestedExperiment("tile", "tile", lazy("Boxes that do not tile"), _domain_tiling_offer, _domain_tiling_answer)
