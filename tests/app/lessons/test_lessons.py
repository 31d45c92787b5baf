"""Lessons make claims; here they are run."""

from __future__ import annotations

import re

import pytest

from app.lessons import class_plans
from app.lessons.answer_marking import answer_expressions, right_answer
from app.lessons.catalogue import lesson_names, load_lessons
from app.lessons.lesson import CHOICE
from app.lessons.lesson_check import check_lesson
from app.lessons.lesson_runs import RunCache, scene_texts
from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.running.run import run
from tests.support.paths import LESSONS

#: Right answers with a lesson's first numbers, to two per cent: what a mark is given for does not change by chance.
RIGHT: dict[str, dict[str, float]] = {
    "01-one-step": {
        "where-does-the-mass-of-particle-10-go": 1, "the-mass-of-a-node": 125, "how-far-and-how-fast": 0.878,
        "a-particle-in-tension": 0.16, "the-error-at-the-end": 4.74},
    "02-what-is-an-error": {
        "the-norm-at-the-end": 36.9, "the-error-of-the-velocity": 1.51, "the-distance-of-transport": 0.289,
        "the-estimate-of-companion": 121},
    "03-order": {
        "a-ratio-of-two-norms": 17.1, "the-floor": 81, "shorter-and-shorter-steps": 0.785, "what-was-gained": 0.785},
    "04-grid-crossing": {
        "the-stress-of-the-hat-functions": 0.0602, "where-does-the-trouble-begin": 3.125,
        "leave-it-where-the-first-particle-crosses": 0.003125, "how-much-of-the-stress-is-wrong": 19.5},
    "05-who-is-to-blame": {
        "the-share-of-crossings": 96.9, "the-result": 71.2, "what-caused-the-error-of-v": 87.2,
        "the-error-on-160-cells": 354, "the-error-on-160-cells-force-at-the-particles": 3.28,
        "your-own-amplitude": 55.5},
    "06-ring": {"the-acceleration-of-cpdi": 66.1, "what-crossings-did-to-the-hats": 1.640},
    "07-what-accuracy-costs": {
        "twice-the-cells": 3.99, "how-many-steps": 533, "your-best-w": 9652, "bet-1-a-finer-grid": 31.7,
        "bet-2-hat-functions": 1372, "bet-3-a-ring": 356},
    "08-how-it-breaks": {"how-long-was-it-accurate": 5.85},
    "09-four-judges": {
        "which-estimate-is-valid-but-far-off": 0.722, "the-estimate-zero": 1},
    "10-how-sure-are-you": {
        "bet-1-a-gentle-bar": 4.456e-8, "bet-2-b-splines": 1.285e-6, "bet-3-force-at-the-nodes": 1.767e-4,
        "bet-4-a-quiet-ring": 8.122e-7, "the-result-of-bet-3": 1.767e-4, "bet-5-a-strong-ring": 3.008e-5,
        "bet-6-a-large-amplitude": 9.061e-5, "bet-7-a-coarse-bar": 1.580e-5, "bet-8-a-ring-with-hats": 9.638e-4,
        "the-result-of-bet-8": 9.638e-4, "the-error-on-the-coarser-grid": 0.965},
    "11-cantilever": {
        "how-far-does-the-tip-go-down": 1.815, "the-height-on-4-cells-per-metre": -1.312,
        "the-bar-on-16-cells-per-metre": 0.01}}
#: And the right options, kept by hand: in words, for their numbers change with the order in which they stand.
CHOSEN: dict[str, dict[str, str]] = {
    "01-one-step": {
        "which-velocity-comes-back": "The same as before", "the-two-slopes": "0",
        "which-velocity-should-move-the-particle": "Grid velocity, by far"},
    "02-what-is-an-error": {
        "how-wrong-is-the-position-of-a-particle": "0.1 % to 2 % of A", "three-errors-three-units": "Velocity v",
        "can-a-run-estimate-its-own-error": "Its index is between 0.95 and 1.05",
        "without-the-exact-solution": "Within 5 %"},
    "03-order": {
        "twice-as-many-cells": "It falls to a quarter", "the-stress": "Near 1",
        "what-does-the-stress-field-look-like": "It has steps: nearly the same value within a cell",
        "more-and-more-cells": "About 1.3 %"},
    "04-grid-crossing": {
        "a-gentle-test": "It falls to about a quarter each time: second order",
        "how-many-particles-crossed-a-cell-boundary": "None", "the-same-test-a-larger-amplitude": "It grows",
        "a-bar-that-should-do-nothing": "Nothing: it stays 20 Pa, exact to round-off"},
    "05-who-is-to-blame": {
        "hat-functions-what-caused-the-error-of-x": "Crossings",
        "two-budgets-one-test": "0.1 mm or less, as the page's budget predicts",
        "ugimp-one-run-two-questions": "The coarse grid causes most in x, crossings in v",
        "a-suspect-at-the-scene": "The body force",
        "the-force-moves-the-crossings-stay": "It falls to about a sixteenth"},
    "06-ring": {
        "ugimp-on-a-finer-grid": "No smaller", "which-method-would-you-choose": "uGIMP on 24, CPDI on 48",
        "the-acceleration-at-48-cells": "It doubles", "an-estimator-at-the-rim": "It grows beyond 5",
        "where-does-transport-estimate-large-errors": "At the two rims",
        "two-suspects-kept-apart": "cpGIMP to about a quarter, uGIMP to about a half"},
    "07-what-accuracy-costs": {
        "a-step-ten-times-longer": "It stays nearly the same", "which-error": "The grid",
        "the-cheapest-run": "To about a quarter", "subtract-what-you-know": "160", "what-is-left": "Less"},
    "08-how-it-breaks": {
        "a-time-step-above-its-bound": "The second run breaks within the first period",
        "what-was-the-verdict": "unstable", "one-particle-per-cell": "No, it still breaks",
        "after-how-many-periods": "The first", "what-is-invisible-to-the-grid": "+, −, −, +",
        "what-did-the-filter-alone-do": "It breaks too", "a-ring-that-does-not-stay-round": "Neither"},
    "09-four-judges": {
        "which-estimators-are-not-valid": "two-grid and recovered", "what-would-be-left": "More than half",
        "a-bar-that-is-left-alone": "lost",
        "which-estimators-are-valid": "recovered and companion"},
    "10-how-sure-are-you": {"the-estimators-bet": "Bet 3, the force at the nodes"},
    "11-cantilever": {
        "what-does-the-bar-do-on-a-grid-twice-as-fine": "It falls to about a half",
        "does-the-new-value-lie-within-the-old-bar": "Yes, within the bar", "three-grids-that-agree": "About 10 mm"}}
#: Lessons that run what tests of the Cost tab, of budgets, of each estimator and of bets run, up to half a minute each.
LONG = ("05", "07", "08", "09", "10")


@pytest.fixture(scope="module")
def outcomes():
    """Runs are shared by the tests of this file; in the suite each lesson is checked with its first numbers."""
    found = RunCache(processes=2)
    yield found
    found.close()


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.slow) if name[:2] in LONG else name
                                  for name in lesson_names()])
def test_every_claim_of_a_lesson_holds(name, outcomes):
    """And what is asked has the right answers that it had."""
    lesson = load_lessons()[name]
    outcomes.prepare(scene_texts(lesson, lesson.variants[0]), lambda done, total: None)
    found = list(check_lesson(lesson, outcomes, variants=1))
    assert [str(check) for check in found if not check.holds] == []
    assert len(found) > 10
    numbers = lesson.variants[0]
    asked = {key: right_answer(lesson, step, numbers, outcomes).value for key, step in lesson.questions.items()
             if step.question.kind != CHOICE and answer_expressions(step.question, numbers)}
    assert asked == pytest.approx(RIGHT[name], rel=0.02, abs=0)
    assert {key: right_answer(lesson, step, numbers, outcomes).text for key, step in lesson.questions.items()
            if step.question.kind == CHOICE} == CHOSEN[name]


@pytest.mark.slow
@pytest.mark.parametrize("name", class_plans.class_plan_names())
def test_every_claim_of_a_page_for_a_class_holds(name, outcomes):
    """Most of its runs are those of lessons."""
    found = list(class_plans.check_class_plan(class_plans.load_class_plan(name), load_lessons(), outcomes))
    assert [str(check) for check in found if not check.holds] == [] and len(found) > 20


@pytest.mark.slow
@pytest.mark.parametrize("name", lesson_names())
def test_every_claim_holds_with_all_numbers(name, outcomes):
    assert [str(check) for check in check_lesson(load_lessons()[name], outcomes) if not check.holds] == []


def edited(name: str, **values) -> str:
    """The text of a script with other parameters, as a student would write them."""
    text = (LESSONS / "scripts" / name).read_text(encoding="utf-8")
    for parameter, value in values.items():
        line = re.compile(rf"^{parameter} = [^#\n]*?(?=  #|$)", re.MULTILINE)
        text, times = line.subn(f"{parameter} = {value!r}", text)
        assert times == 1, f"{name} has no line for {parameter}"
    return text


BAR = dict(method="bspline", cells=10, ppc=2, amplitude=1e-3, modulus=9.0, density=2.0, cfl=0.2, periods=0.5,
           body_force="node", linearity_preserving=True)
RING = dict(method="ugimp", cells=8, ppc=1, amplitude=0.05, modulus=4e6, density=500.0, cfl=0.2, periods=0.25,
            body_force="material", layout="cartesian")


@pytest.mark.parametrize("name, scene, parameters", [
    ("bar.py", BarScene, BAR), pytest.param("ring.py", RingScene, RING, marks=pytest.mark.slow)], ids=["bar", "ring"])
def test_a_script_that_is_edited(name, scene, parameters, tmp_path, monkeypatch, capsys):
    """It obeys every parameter, prints what ``run`` finds and leaves a picture; as it is, ``test_scripts`` runs it."""
    monkeypatch.chdir(tmp_path)
    done: dict = {}
    exec(compile(edited(name, **parameters), name, "exec"), done)
    assert all(getattr(done["scene"], parameter) == value for parameter, value in parameters.items())
    assert type(done["scene"]) is scene
    printed = capsys.readouterr().out
    result = run(done["scene"], prices=False)
    found = [result.error["x"]["max"], result.estimate[done["estimator"]]["x"]["max"]]
    assert all(f"{value:.3e}" in printed for value in found)
    assert f"{result.index[done['estimator']]['x']:.3f}" in printed
    assert (tmp_path / done["picture"]).read_bytes().startswith(b"\x89PNG")
