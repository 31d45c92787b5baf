"""Formulas that people type, and motions made of them: what they mean, and how each that cannot be is refused."""

import math

import numpy as np
import pytest
import taichi as ti
from hypothesis import given, settings

from solvers import run
from solvers.motion import typed_motion
from solvers.motion.formula import FormulaError, parse_formula
from solvers.problems.bar.scene import BarScene
from solvers.problems.planar.particle_layout import particle_layout
from solvers.problems.planar.scene import motion_table
from solvers.problems.square import SquareScene
from solvers.scene.validation import SceneError
from tests.support.random_scenes import typed_motions

VALUES = {"X": 0.3, "Y": -0.7, "t": 1.2}


@pytest.mark.parametrize(("text", "value"), [
    ("1", 1.0), (" -X + 2*Y ", -0.3 - 1.4), ("X**3/Y - t", 0.3**3 / -0.7 - 1.2), ("sin(pi*X)*cos(t)**2",
     math.sin(0.3 * math.pi) * math.cos(1.2)**2), ("exp(-t)*sqrt(X)+log(t)", math.exp(-1.2) * 0.3**0.5 + math.log(1.2)),
    ("2e-3*X**-2", 2e-3 / 0.09), ("-X**2", -0.09), ("+(+X)", 0.3), ("1_0*X", 3.0)])
def test_a_formula_means_what_it_says(text, value):
    plain, formula = parse_formula(text, tuple(VALUES))
    assert formula(VALUES) == pytest.approx(value, rel=1e-15)
    assert " " not in plain and parse_formula(plain, tuple(VALUES))[1](VALUES) == formula(VALUES)


#: Texts that are no formula, and a word of the sentence that says so. None of them may be evaluated.
WRONG = {
    "": "no formula", "X +": "no formula", "sin(": "no formula", "X = 2": "no formula", "import os": "no formula",
    "2 X": "no formula", "X; Y": "no formula", "X\nY": "no formula", "\x00": "no formula", "$": "no formula",
    "x": "the name x", "e": "the name e", "theta*X": "the name theta", "__name__": "the name __name__",
    "π*X": "the name π",
    "tan(X)": "calls tan", "abs(X)": "calls abs", "__import__('os').system('id')": "calls ...",
    "eval('1')": "calls eval",
    "open('/etc/passwd')": "calls open", "sin(X).real": "more than numbers", "X.__class__": "more than numbers",
    "[X for X in (1,)]": "more than numbers", "(lambda: X)()": "calls ...", "X if Y else t": "more than numbers",
    "X and Y": "more than numbers", "X < Y": "more than numbers", "X // 2": "more than numbers",
    "X % 2": "more than numbers", "X @ Y": "more than numbers", "X | Y": "more than numbers", "~X": "more than numbers",
    "f'{X}'": "more than numbers", "(X, Y)": "more than numbers", "X[0]": "more than numbers",
    "'X'": "no real number", "True": "no real number", "None": "no real number", "2j*X": "no real number",
    "...": "no real number", "1e999": "too large", "9" * 390: "too large", "X**0.5": "whole number",
    "X**Y": "whole number",
    "X**99": "whole number", "2**X": "whole number", "(-8)**(1/3)": "whole number", "X**True": "whole number",
    "sin(X, Y)": "something else than one", "sin()": "something else than one", "sin(X=1)": "something else than one",
    "sin(*X)": "something else than one", "X" + "+X" * 150: "too many parts", "X" * 1000: "at most",
    "-" * 390 + "X": "too many parts", "9**9**9**9": "whole number",
}


@pytest.mark.parametrize("text", WRONG, ids=lambda text: ascii(text)[:30])
def test_what_is_no_formula_is_refused_in_a_sentence(text, monkeypatch):
    for name in ("eval", "exec"):
        monkeypatch.setattr(f"builtins.{name}", lambda *given, name=name: pytest.fail(f"{name} was called"))
    with pytest.raises(FormulaError) as refused:
        parse_formula(text, tuple(VALUES))
    assert WRONG[text] in str(refused.value) and str(refused.value).isprintable()


# ---- motions ------------------------------------------------------------------------------------------------------

#: Formulas that are no motion of a body between planes.
NO_MOTION = {
    "0": "does not move", "0*X*t": "does not move", "0.02*sin(2*pi*X)*cos(w*t)": "not zero at t = 0",
    "0.02*sin(2*pi*X)": "not zero at t = 0", "0.01*X*sin(w*t)": "moves across the sides X",
    "0, 0.01*sin(w*t)": "moves across the sides Y", "0.01*sin(pi*X)*sin(pi*Y)*sin(w*t)": "shears the sides Y",
    "0,0.01*sin(pi*X)*sin(pi*Y)*sin(w*t)": "shears the sides X", "0.2*sin(2*pi*X)*sin(w*t)": "folds the body over",
    "0.02*sin(2*pi*X)*t": "no period", "0.02*sin(2*pi*X)*sin(t*sqrt(2))*sin(w*t)": "no period",
    "1e-3*sin(2*pi*X)*(sin(2*pi*t)+sin(8000*pi*t)), 0": "changes too fast",
    "0.02*sin(2*pi*X)*sin(w*t)/X": "not finite", "log(X)*sin(w*t)": "not finite", "sqrt(X-2)*sin(w*t)": "not finite",
    "exp(999*X)*sin(w*t)": "not finite", "X, Y, t": "more than two components", "1, 2, 3": "more than two components",
    "0.02*sin(2*pi*X)*sin(w*t),": "no formula", "," : "no formula", "q*t": "the name q"}
#: And none of a bar.
NO_LINE = {text: why for text, why in NO_MOTION.items() if "sides" not in why and "," not in text} | {
    "1e-3*sin(2*pi*X)*(sin(2*pi*t)+sin(8000*pi*t))": "changes too fast", "X, 0": "more than one component",
    "0.01*Y*sin(w*t)": "the name Y", "0.01*sin(pi*X)*sin(w*t)": "is not periodic", "0.01*X*sin(w*t)": "is not periodic",
    "0.01*sin(w*t)": "without deforming", "(0.3+0.01*sin(2*pi*X))*sin(w*t)": "more than 0.25 m"}


@pytest.mark.parametrize(("kind", "text", "why"), [
    (kind, *one) for kind, wrong in ((SquareScene, NO_MOTION), (BarScene, NO_LINE)) for one in wrong.items()])
def test_what_is_no_motion_is_refused(kind, text, why):
    with pytest.raises(SceneError) as refused:
        kind(displacement=text)
    assert refused.value.field == "displacement" and why in refused.value.sentence
    assert not refused.value.sentence.endswith(".") and "\n" not in str(refused.value)


@pytest.mark.parametrize("value", [0.02, 0, None, True, (), ("X",), b"X", math.nan])
@pytest.mark.parametrize("kind", [BarScene, SquareScene])
def test_what_is_no_text_is_refused(kind, value):
    with pytest.raises(SceneError, match="is no text"):
        kind(displacement=value)


def test_the_built_in_motion_can_be_typed():
    """And is the same to rounding, with A for a slider."""
    typed = SquareScene(cells=12, cfl=0.3, displacement="A * sin(2*pi*X) * sin(w*t), -A*sin(2*pi*Y)*sin(w*t)",
                        estimators=())
    assert typed.displacement == "A*sin(2*pi*X)*sin(w*t),-A*sin(2*pi*Y)*sin(w*t)"
    own = SquareScene(cells=12, cfl=0.3, estimators=())
    assert typed.period == pytest.approx(own.period) and typed.steps == own.steps
    results = [run(scene, prices=False) for scene in (own, typed)]
    assert results[1].error["x"]["max"] == pytest.approx(results[0].error["x"]["max"], rel=1e-9)


@settings(max_examples=12)
@given(typed_motions())
def test_the_table_of_any_motion_is_the_motion(text):
    """That it balances momentum too is in tests/solvers/scene/test_exact_solutions.py."""
    scene = SquareScene(displacement=text, cells=8, modulus=1e3)
    t = 0.37 * scene.period
    u = scene.EXACT.displacement(scene, particle_layout(scene).position, t)
    np.testing.assert_allclose(motion_table(scene)(t)[:, :2], u, atol=1e-11 * max(1e-6, np.abs(u).max()))


def test_the_period_is_the_shortest():
    for text, periods in (("0.01*sin(2*pi*X)*sin(w*t)", 1), ("0.01*sin(2*pi*X)*sin(2*w*t)", 0.5),
                          ("0.01*sin(2*pi*X)*sin(w*t/3)", 3), ("0.01*sin(2*pi*X)*(1-cos(w*t))", 1)):
        scene = SquareScene(displacement=text)
        assert scene.period == pytest.approx(periods * 2 * math.pi / scene.base_frequency), text


@pytest.mark.parametrize(("kind", "other"), [
    (SquareScene, "0.004*sin(3*pi*X)*cos(pi*Y)*sin(2*w*t), 0.003*sin(pi*Y)*sin(w*t)"),
    (BarScene, "0.004*sin(4*pi*X+1)*(1-cos(2*w*t))+0.003*cos(2*pi*X)*sin(w*t)")])
def test_another_motion_compiles_nothing(kind, other):
    """What a formula says is in tables, which kernels take as they come."""
    def motion(text):
        scene = kind(cells=10, cfl=0.3, periods=0.1, displacement=text, estimators=("companion",), modulus=1e7)
        return run(scene, prices=False)

    motion("0.01*sin(2*pi*X)*sin(w*t)")
    program = ti.lang.impl.get_runtime()
    before = [len(kernel.compiled_kernels) for kernel in program.kernels if hasattr(kernel, "compiled_kernels")]
    result = motion(other)
    after = [len(kernel.compiled_kernels) for kernel in program.kernels if hasattr(kernel, "compiled_kernels")]
    assert before and before == after
    assert result.index["companion"]["x"] == pytest.approx(1, abs=0.02)


def test_a_long_text_is_refused():
    with pytest.raises(FormulaError, match="at most"):
        typed_motion.parse_motion("0.02*" + "1*" * 300 + "sin(w*t)")
