"""All words of the stage and what is said beside it come from the catalogue: in a language in which each of its texts
stands between ⟦ and ⟧, nothing but names and numbers stands outside."""

import re
from dataclasses import astuple, replace
from types import SimpleNamespace

import numpy as np
import pytest

from app import names_and_units
from app.frame import budget_chart_data, error_view_captions, headline
from app.frame.slow_motion.step_phases import PHASES
from app.language.translation import tr, use_language
from app.problems.suggested_experiment import SuggestionNotApplicable
from app.problems.views import VIEWS
from app.shareable_state import State
from solvers.problems import PROBLEMS
from solvers.scene.estimator_registry import ESTIMATORS
from solvers.scene.scene import Scene
from tests.support.pseudo_translation import CODE

NAMES = re.compile("|".join([*ESTIMATORS, *(method.name for method in names_and_units.METHODS.values()), "CFL",
                             "E ln F", "sigma", *(f"{prefix}{unit}" for unit in ("Pa", "rad") for prefix in "mkMG"),
                             "rad"]))


def outside(text: str) -> str:
    """What of a text is not of the catalogue, and no name."""
    while (less := re.sub("⟦[^⟦⟧]*⟧", "", text)) != text:
        text = less
    return " ".join(re.findall("[A-Za-z]{3,}", NAMES.sub("", text)))


def scenes(kind: type[Scene]) -> list[Scene]:
    """What is otherwise about a scene of a kind, one by one."""
    usual = kind()
    found = [replace(usual, body_force=kind.choices("body_force")[-1]), replace(usual, effects=()),
             replace(usual, estimators=()), replace(usual, dt="auto"), replace(usual, cells=12),
             replace(usual, velocity="particle"), *(replace(usual, method=method) for method in kind.choices("method")),
             *(replace(usual, remedies=(remedy,)) for remedy in kind.REMEDIES if remedy != "coupled-deformation")]
    if "motion" in kind.__dataclass_fields__:
        found.append(kind(motion="patch", estimators=("companion",)))
    return found


@pytest.mark.parametrize("problem", PROBLEMS)
def test_what_is_said_of_a_run_and_its_errors(problem):
    kind, stage = PROBLEMS[problem].scene, VIEWS[problem].stage
    with use_language(CODE):
        for scene in scenes(kind):
            assert not outside(f"{names_and_units.difference_text(scene, kind())} {names_and_units.motion_text(scene)} "
                               f"{stage.scale_note(scene)}")
            for quantity in names_and_units.QUANTITIES:
                for estimator in (None, *kind.ESTIMATORS):
                    no_truth = error_view_captions.why_no_truth(scene, quantity)
                    no_estimate = error_view_captions.why_no_estimate(scene, scene.not_valid, estimator, quantity)
                    told = astuple(error_view_captions.make_captions(quantity, estimator, estimator is None,
                                                                     no_estimate,
                                                          no_truth))
                    said = headline.error_headline_templates(scene, quantity, estimator, no_estimate, no_truth)
                    plot = error_view_captions.field_plot_caption(scene, quantity)
                    run = headline.format_error_headline(said, "m", headline.InstantErrors(0.2, 0.1), tr(headline.NOW))
                    assert not outside(f"{told} {plot} {error_view_captions.add_unknown_count(plot.remark, 3)} {run}")


@pytest.mark.parametrize("problem", PROBLEMS)
def test_what_a_problem_says_of_itself_and_asks(problem):
    view, kind = VIEWS[problem], PROBLEMS[problem].scene
    with use_language(CODE):
        said = [*view.regions(np.ones((1, kind.DIMENSIONS))).names, *map(tr, view.details.values()),
                tr(view.amplitude_hint), tr(view.modulus_hint), tr(view.division), tr(view.stage.HALVES),
                error_view_captions.crossing_marks_legend(view.stage.MARKED, 3),
                *names_and_units.choice_labels(kind, "body_force").values()]
        for scene in scenes(kind):
            state = State(scene)
            for spark in view.suggestions(state):
                said.append(tr(spark.title))
                try:
                    offer = spark.offer(state)
                    said += [offer.title, offer.hint]
                except SuggestionNotApplicable as reason:
                    said.append(str(reason))
                for ratio in (0.25, 0.5, 2.0, np.nan):
                    ran = SimpleNamespace(ratio=ratio, series={}, pinned={}, quantity_noun=tr("stress"), state=state,
                                          not_valid=scene.not_valid, index=lambda _, ratio=ratio: ratio)
                    said += spark.answer(ran)  # type: ignore[arg-type]
        assert not list(filter(None, map(outside, said)))


def test_what_is_said_of_a_step_in_slow_motion_and_of_causes():
    with use_language(CODE):
        said = [*map(tr, (budget_chart_data.QUESTION, budget_chart_data.CAPTION, *budget_chart_data.MEANINGS.values())),
                *(tr(phase.title) for phase in PHASES), *(tr(one.name) for phase in PHASES for one in phase.columns),
                *(phase.words(scene) for phase in PHASES for problem in PROBLEMS.values()
                  for scene in scenes(problem.scene))]
        assert not list(filter(None, map(outside, said)))


@pytest.mark.parametrize("problem", PROBLEMS)
def test_what_moves_and_how_estimators_see_it_is_explained_in_german(problem):
    with use_language("de"):
        assert " wie\n<math" in VIEWS[problem].about or " den Winkel\n<math" in VIEWS[problem].about
    for estimator in ESTIMATORS.values():
        english, german = estimator.explanation, estimator.explanation_in("de")
        assert all(f"<b>{word}</b>" in german for word in ("Setzt voraus", "Sieht", "Übersieht"))
        assert [len(re.findall(tag, german)) for tag in ("<math", "<mfrac", "<msub>")] \
            == [len(re.findall(tag, english)) for tag in ("<math", "<mfrac", "<msub>")]
        assert estimator.explanation_in("xx") == english
