"""Sentences of the solvers in the visitor's language."""

import random
import re
from dataclasses import replace
from functools import partial
from types import SimpleNamespace

import pytest

from app.frame.error_view_captions import why_no_estimate
from app.language.translation import translate_message, use_language
from app.names_and_units import reword_for_page, short_reason
from solvers import BarScene, RingScene, SquareScene, VortexScene
from solvers.problems import PROBLEMS
from solvers.running.cures import advice_sentence, candidate_cures
from solvers.scene.effects import EFFECTS
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError
from solvers.solver.base import Solver
from solvers.solver.soundness import CONTRADICTIONS, NOUNS, SoundnessFinding
from solvers.translatable_message import Message, join_messages
from solvers.untrusted.quoting import FileError

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


@pytest.mark.parametrize(("kind", "inputs"), REFUSED)
def test_a_refusal_is_heard_as_a_whole(kind: type[Scene], inputs: dict):
    with pytest.raises(SceneError) as refused:
        kind(**inputs)
    with use_language("de"):
        said = reword_for_page(str(refused.value))
    assert not ENGLISH.search(said), said
    assert translate_message(str(refused.value)) == str(refused.value)


@pytest.mark.parametrize("problem", [pytest.param(name, marks=pytest.mark.slow) if name == "vortex" else name
                                     for name in PROBLEMS])
def test_of_any_scene_warnings_and_estimators_that_do_not_hold_are_heard(problem):
    found = {sentence for seed in range(150) for sentence in said_of(problem, random.Random(seed))}
    assert len(found) > 10
    with use_language("de"):
        assert not [said for said in map(reword_for_page, found) if ENGLISH.search(said)]


@pytest.mark.parametrize("rule", CONTRADICTIONS.values(), ids=CONTRADICTIONS)
@pytest.mark.parametrize("scene", [
    RingScene(method="mpm"), RingScene(method="ugimp"), RingScene(method="cpdi"), RingScene(amplitude=0.3),
    VortexScene(method="ugimp", ppc=1), SquareScene(method="mpm")], ids=lambda scene: f"{scene.problem} {scene.method}")
def test_why_a_run_is_lost_is_heard_with_all_its_parts(rule, scene):
    solver = SimpleNamespace(_position_text=lambda particle: "0.1250, 0.3000", scene=scene)
    finding = SoundnessFinding(0.34, Message(rule.sentence, size="0.21"), 0.21, 5)
    solver._known_weakness = partial(Solver._known_weakness, solver)
    found = Solver.loss_sentence(solver, finding)  # type: ignore[arg-type]
    cures = candidate_cures(scene, rule.name, 0.34)
    tried = [replace(cure, tried=True, held=held) for cure, held in zip(cures, (True, False), strict=False)]
    parts = advice_sentence(tried[:1]), advice_sentence([*tried[1:], *cures])
    sentence = join_messages("; ", (found, *parts))
    with use_language("de"):
        said = reword_for_page(sentence)
    assert "Partikel 5 (X = 0,1250; 0,3000)" in said
    assert not ENGLISH.search(said), said
    assert not re.search(r"--|null-space|coupled", said)


def test_what_stands_in_a_sentence_is_heard_too_and_names_stay():
    with use_language("de"):
        error = FileError("f.csv", "has no names in its first line; begin with a line such as id,x,vx")
        assert translate_message(Message("The file {name} {sentence}", name="f.csv", sentence=error.sentence)) \
            == "Die Datei f.csv hat keine Namen in ihrer ersten Zeile; fang mit einer Zeile wie id,x,vx an"
        assert translate_message(join_messages(" and ",
                                               NOUNS.values())) == "Geschwindigkeit und Spannung und Beschleunigung"


def test_numbers_in_a_sentence_have_the_marks_of_its_language_and_names_keep_theirs():
    with use_language("de"):
        for value, said in (("0.159", "0,159"), ("1e-12", "1e-12"), ("12,000", "12.000"), ("f.2.csv", "f.2.csv"),
                            ("0.125, -0.3", "0,125; -0,3"), ("1, 2", "1, 2")):
            assert translate_message(Message("{number}: nobody knows this", number=value)).startswith(f"{said}:")


@pytest.mark.parametrize("sentence", ["", "nobody knows this", "so: is this; and, this (too)", "{} {name}", "x" * 5000])
def test_what_nobody_knows_stays_as_it_is(sentence):
    with use_language("de"):
        assert translate_message(sentence) == sentence


def test_an_estimator_that_does_not_hold_says_so_in_few_words_in_any_language():
    scene = BarScene(method="bspline", estimators=("transport",))
    for code, said in (("en", "transport is not valid here"), ("de", "transport gilt hier nicht")):
        with use_language(code):
            assert short_reason(why_no_estimate(scene, scene.not_valid, "transport", "x")) == said


def test_what_is_off_is_called_as_the_effect_is():
    from app.frame import error_view_captions

    for sentence, effect in ((error_view_captions.ESTIMATE_OFF, "estimate"), (error_view_captions.OFF, "acceleration"),
                             (error_view_captions.NOT_COUNTED, "crossings")):
        assert f'"{EFFECTS[effect].label}"' in sentence
