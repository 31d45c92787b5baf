"""Sentences of the solvers in the visitor's language."""

import random
import re

import pytest

from app.frame.captions import why_no_estimate
from app.language.message_translation import LONGEST, MOST_TEXTS, Translator, translate_message, translator_for
from app.language.translation import use_language
from app.words import on_page, short_reason
from solvers import BarScene, RingScene, VortexScene
from solvers.problems import PROBLEMS
from solvers.scene.effects import EFFECTS
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError
from solvers.solver.soundness import CONTRADICTIONS
from tests.sentences import PLACE, sentences

TEXTS = sorted({text for text, _ in sentences()})
PSEUDO = Translator({text: f"⟦{text}⟧" for text in TEXTS})
#: Words of English that no German sentence has; names of flags and estimators are the same in both.
ENGLISH = re.compile(r"\b(the|of|is|are|with|and|that|which|give|take|from|it|has)\b")
REFUSED = [
    (BarScene, {"cells": 0}), (BarScene, {"method": "cpd"}), (BarScene, {"motion": "patch", "amplitude": 0.1}),
    (BarScene, {"remedies": ("frozen-weights", "zero-drift")}), (BarScene, {"cfl": 40.0}), (BarScene, {"dt": "x"}),
    (BarScene, {"velocity": "corners"}), (BarScene, {"effects": ("spin",)}), (BarScene, {"dt": 1.0, "cfl": 1.0}),
    (BarScene, {"remedies": "zero"}), (BarScene, {"motion": "patch", "ppc": 2.51}), (BarScene, {"periods": 1e9}),
    (BarScene, {"motion": "patch", "stretch": 1.0}), (BarScene, {"sample_every": 1, "periods": 1e4}),
    (RingScene, {"cells": 9000, "ppc": 9}), (RingScene, {"amplitude": 0.4}),
    (VortexScene, {"amplitude": 3.0}), (VortexScene, {"estimators": ("two-grid",)}), (VortexScene, {"density": -1.0})]


def filled(text: str, chance: random.Random) -> dict[str, str]:
    """Something for each place of a template: numbers and names, as solvers put there."""
    return {name: chance.choice((f"{chance.uniform(0, 99):.3g}", f"q{chance.randint(1, 99)}"))
            for name in PLACE.findall(text)}


def said_of(problem: str, chance: random.Random) -> list[str]:
    """What there is to say of a scene drawn at random."""
    kind = PROBLEMS[problem].scene
    drawn = {name: chance.choice(kind.choices(name)) for name in ("method", "velocity", "body_force")}
    if "layout" in kind.__dataclass_fields__:
        drawn["layout"] = chance.choice(kind.choices("layout"))
    drawn["remedies"] = tuple(name for name in kind.REMEDIES if chance.random() < 0.2)
    try:
        scene = kind(**drawn, cells=chance.randint(8, 60), ppc=chance.randint(1, 4),
                     estimators=kind.choices("estimators"), cfl=chance.choice((None, 0.3, 1.5)),
                     amplitude=chance.choice((0.001, 0.03, 0.15, 0.3, 1.0)))
    except SceneError as refused:
        return [str(refused)]
    return [*scene.warnings(), *scene.not_valid.values()]


def test_what_is_made_of_a_template_is_heard_as_that_and_of_no_other():
    assert len(TEXTS) > 400
    made = [text.format(**filled(text, random.Random(text))) for text in TEXTS]
    assert not [sentence for sentence in made if PSEUDO(sentence) != f"⟦{sentence}⟧"]


@pytest.mark.parametrize(("kind", "inputs"), REFUSED)
def test_a_refusal_is_heard_as_a_whole(kind: type[Scene], inputs: dict):
    with pytest.raises(SceneError) as refused:
        kind(**inputs)
    with use_language("de"):
        said = on_page(str(refused.value))
    assert not ENGLISH.search(said), said
    assert translate_message(str(refused.value)) == str(refused.value)


@pytest.mark.parametrize("problem", [pytest.param(name, marks=pytest.mark.slow) if name == "vortex" else name
                                     for name in PROBLEMS])
def test_of_any_scene_warnings_and_estimators_that_do_not_hold_are_heard(problem):
    found = {sentence for seed in range(150) for sentence in said_of(problem, random.Random(seed))}
    assert len(found) > 10
    with use_language("de"):
        assert not [said for said in map(on_page, found) if ENGLISH.search(said)]


@pytest.mark.parametrize("rule", CONTRADICTIONS.values(), ids=CONTRADICTIONS)
@pytest.mark.parametrize("advice", [
    "take shorter steps (--dt auto takes 0.001 s, this run took 0.2 s); and give two or more particles per cell: one "
    "loses runs with short steps too", "choose a smaller amplitude or fewer periods",
    "give 3 or more particles per cell and direction, use the remedy null-space-filter, or choose CPDI, or the "
    "polar layout", "use the remedies null-space-filter,coupled-deformation, or choose CPDI"])
def test_why_a_run_is_lost_is_heard_with_all_its_parts(rule, advice):
    found = f"{rule.sentence.format(size='0.21')}, most at particle 5 (X = 0.1250, 0.3000); {advice}"
    with use_language("de"):
        for sentence in (found, f"the run is lost from t = 0.34 s on: {found}"):  # a headline has the beginning
            said = on_page(sentence)
            assert "Partikel 5 (X = 0.1250, 0.3000)" in said
            assert not ENGLISH.search(said), said
            assert not re.search(r"--|null-space|coupled", said)


def test_what_stands_in_a_sentence_is_heard_too_and_names_stay():
    with use_language("de"):
        assert translate_message(
            "The file of the ring.csv has no names in its first line; begin with a line such as id,x,vx") == \
            "Die Datei of the ring.csv hat keine Namen in ihrer ersten Zeile; fang mit einer Zeile wie id,x,vx an"
        assert translate_message(
            "velocity, stress and acceleration were not checked: switch on the effect truth or the estimator "
            "companion"
        ).startswith("Geschwindigkeit, Spannung und Beschleunigung wurden")


@pytest.mark.parametrize("sentence", ["", "nobody knows this", "so: is this; and, this (too)", "{} {name}", "x" * 5000])
def test_what_nobody_knows_stays_as_it_is(sentence):
    with use_language("de"):
        assert translate_message(sentence) == sentence


def test_a_sentence_that_quotes_anything_takes_a_bounded_time():
    """It counts the texts that are looked up, for the clock says what else runs."""
    looked = {}
    translator_for("de")._known(("has {x}, b: c (give and " * LONGEST)[:LONGEST], looked, 0)
    assert len(looked) == MOST_TEXTS


def test_an_estimator_that_does_not_hold_says_so_in_few_words_in_any_language():
    scene = BarScene(method="bspline", estimators=("transport",))
    for code, said in (("en", "transport is not valid here"), ("de", "transport gilt hier nicht")):
        with use_language(code):
            assert short_reason(why_no_estimate(scene, scene.not_valid, "transport", "x")) == said


def test_what_is_off_is_called_as_the_effect_is():
    from app.frame import captions

    for sentence, effect in ((captions.ESTIMATE_OFF, "estimate"), (captions.OFF, "acceleration"),
                             (captions.NOT_COUNTED, "crossings")):
        assert f'"{EFFECTS[effect].label}"' in sentence
