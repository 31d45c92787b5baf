"""Scene: one that exists is valid; one that cannot be says which input is wrong and what is allowed."""

import json
import math
import pickle
from dataclasses import FrozenInstanceError, fields, replace

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.problems.vortex import VortexScene
from solvers.scene.effects import EFFECTS
from solvers.scene.scene import MOST_STEPS
from solvers.scene.validation import KEYS, SceneError

NUMBERS = [f.name for f in fields(BarScene) if f.type.split(" ")[0] in ("int", "float")]
WHOLE = [f.name for f in fields(BarScene) if f.type.split(" ")[0] == "int"]
LISTS = [f.name for f in fields(BarScene) if f.type.startswith("tuple")]
FLAG = "linearity_preserving"
CHOICES = [f.name for f in fields(BarScene) if BarScene.choices(f.name) and f.name not in LISTS]
NOT_NUMBERS = [math.nan, math.inf, -math.inf, -1, 0, "3", True, [1], 1j, 10**400]


def refusal(**values) -> SceneError:
    with pytest.raises(SceneError) as caught:
        BarScene(**values)
    return caught.value


def test_every_field_is_of_a_kind_that_these_tests_know():
    """A field of a new kind must get rules and tests of its own."""
    assert {f.type for f in fields(BarScene)} == {"str", "int", "float", "float | None", "float | str | None", "bool",
                                                  "tuple[str, ...]", "int | None", "int | float"}
    assert len(NUMBERS) >= 11 and set(CHOICES) >= {"problem", "method", "body_force", "velocity", "arch"}


@pytest.mark.parametrize("value", NOT_NUMBERS, ids=lambda value: repr(value)[:8])
@pytest.mark.parametrize("field", NUMBERS)
def test_number_fields_refuse_what_is_no_positive_number(field, value):
    """Every number of a scene but a velocity is positive and finite; the message names the input and the allowed range.
    """
    if field == "initial_velocity" and value in (0, -1) and value is not True:
        BarScene(motion="patch", initial_velocity=value)
        return
    error = refusal(**{field: value})
    assert error.field == field and error.value is value
    assert str(error).startswith(KEYS.get(field, field).replace("_", " "))
    assert "give a" in error.sentence and any(c.isdigit() for c in error.sentence)


@pytest.mark.parametrize("field", WHOLE)
def test_counts_refuse_fractions(field):
    assert "whole number" in refusal(**{field: 7.5}).sentence


@pytest.mark.parametrize("field", CHOICES)
@pytest.mark.parametrize("value", ["nonsense", "", None, 3, ["mpm"]], ids=str)
def test_choices_refuse_unknown_names_and_list_the_known(field, value):
    error = refusal(**{field: value})
    assert error.field == field and getattr(BarScene(), field) in error.sentence


@pytest.mark.parametrize("value", ["no", 0, 1, None], ids=repr)
def test_linearity_preserving_is_true_or_false(value):
    """A truthy "no" must not switch it on."""
    assert refusal(**{FLAG: value}).sentence == "give True or False"


@pytest.mark.parametrize("field", LISTS)
def test_lists_refuse_unknown_repeated_and_bare_names(field):
    known = BarScene.choices(field)[0]
    assert known in refusal(**{field: ("nonsense",)}).sentence
    assert "twice" in refusal(**{field: (known, known)}).sentence
    for bare in (None, 3):
        assert "list" in refusal(**{field: bare}).sentence


def test_a_name_is_a_list_of_one_and_a_plus_adds_to_the_default():
    scene = BarScene(estimators="companion", effects="+budget", remedies="null-space-filter, zero-drift")
    assert scene.estimators == ("companion",) and scene.remedies == ("null-space-filter", "zero-drift")
    assert scene.effects == (*BarScene().effects, "budget") and BarScene(effects=["+truth"]) == BarScene()
    assert "all names with a +" in refusal(effects=("+budget", "truth")).sentence
    assert "not known" in refusal(effects="+nonsense").sentence


def test_inputs_in_other_forms_are_explained():
    with pytest.raises(SceneError, match="by name, as in BarScene"):
        BarScene(40)
    assert str(refusal(cells="40")).startswith("cells '40': give a whole number")
    assert str(refusal(amplitude="1e-3")).startswith("amplitude '1e-3': give a number")


def test_numbers_of_numpy_are_numbers():
    """The scene has plain ones: its JSON and its hash are the same."""
    scene = BarScene(cells=np.int64(50), ppc=np.uint8(3), amplitude=np.float64(0.01), dt=np.float64(1e-3),
                     linearity_preserving=np.bool_(True))
    plain = BarScene(cells=50, ppc=3, amplitude=0.01, dt=1e-3, linearity_preserving=True)
    assert scene == plain and hash(scene) == hash(plain) and json.dumps(scene.to_dict()) == json.dumps(plain.to_dict())
    with pytest.raises(SceneError, match="whole number"):
        BarScene(cells=np.float64(50.5))
    with pytest.raises(SceneError, match="above"):
        BarScene(amplitude=np.float64("nan"))


@pytest.mark.parametrize("kind", [BarScene, RingScene, VortexScene])
def test_help_tells_meaning_unit_choices_and_default_of_each_field(kind):
    said = kind.__doc__
    for field in fields(kind):
        if field.name != "problem":
            assert f"\n{field.name} : " in said and all(
                name in said for name in kind.choices(field.name) if field.name != "estimators")
    assert "in Pa" in said and "Default: " in said and "--" not in said.replace("----------", "")


def test_a_list_makes_the_same_hashable_scene_as_a_tuple():
    """Command line and page hand over lists; scenes are keys of caches."""
    assert hash(BarScene(estimators=["companion"], effects=list(EFFECTS))) == hash(BarScene())


@pytest.mark.parametrize(("inside", "outside", "field"), [
    ({"cells": 4}, {"cells": 3}, "cells"),
    ({"cells": 100_000, "ppc": 1}, {"cells": 100_001, "ppc": 1}, "cells"),
    ({"ppc": 64}, {"ppc": 65}, "ppc"),
    ({"cells": 15_625, "ppc": 64}, {"cells": 15_626, "ppc": 64}, "ppc"),
    ({"amplitude": 0.159}, {"amplitude": 0.16}, "amplitude"),
    ({"modulus": 1.1e-6}, {"modulus": 1e-6}, "modulus"), ({"modulus": 1e12}, {"modulus": 1.1e12}, "modulus"),
    ({"density": 1.1e-6}, {"density": 1e-6}, "density"), ({"density": 1e12}, {"density": 1.1e12}, "density"),
    ({"cfl": 10.0}, {"cfl": 10.1}, "cfl"), ({"dt": 0.124}, {"dt": 0.126}, "dt"),
    ({"cfl": 1e-9, "periods": 1e-4}, {"cfl": 9e-10, "periods": 1e-4}, "cfl"),
    ({"dt": 1.3e-11, "t_end": 1e-6}, {"dt": 1.2e-11, "t_end": 1e-6}, "dt"),
    ({"dt": 1e-3, "t_end": 1.9e6, "sample_every": 10**6}, {"dt": 1e-3, "t_end": 2.1e6, "sample_every": 10**6}, "t_end"),
    ({"cfl": 0.1, "periods": 2.4e6, "sample_every": 10**6},
     {"cfl": 0.1, "periods": 2.6e6, "sample_every": 10**6}, "periods"),
    ({"threads": 1024}, {"threads": 1025}, "threads"),
    ({"sample_every": 1}, {"sample_every": MOST_STEPS + 1}, "sample_every"),
    ({"dt": 1e-3, "t_end": 1000.0, "sample_every": 1},
     {"dt": 1e-3, "t_end": 1001.0, "sample_every": 1}, "sample_every"),
    ({"method": "cpgimp", "velocity": "corners"}, {"method": "ugimp", "velocity": "corners"}, "velocity"),
], ids=str)
def test_limits(inside, outside, field):
    """The last value inside is a scene, the first outside names its field and what is allowed."""
    BarScene(**inside)
    error = refusal(**outside)
    assert error.field == field and ("give" in error.sentence or "allowed" in error.sentence)


@pytest.mark.parametrize(("one", "other"), [("dt", "cfl"), ("t_end", "periods")])
def test_exclusive_pairs(one, other):
    """Two inputs that say the same thing must not contradict each other."""
    assert "one of the two" in refusal(**{one: 0.01, other: 0.1}).sentence


def test_a_scene_cannot_be_changed_behind_its_rules():
    with pytest.raises(FrozenInstanceError):
        BarScene().cells = 3
    with pytest.raises(SceneError):
        replace(BarScene(), cells=3)


def test_derived_quantities():
    """c = sqrt(E/rho), w = c pi, period 2 pi/w = 2/c; dt from cfl and back; whole steps to the nearest."""
    scene = BarScene(cells=50, ppc=3, modulus=9.0, density=4.0, cfl=0.1, periods=2)
    assert (scene.spacing, scene.wave_speed, scene.particles) == (0.02, 1.5, 150)
    assert scene.angular_frequency == 1.5 * math.pi and scene.period == pytest.approx(2 / 1.5, rel=1e-15)
    assert scene.time_step == pytest.approx(0.1 * 0.02 / 1.5, rel=1e-15)
    assert scene.steps == round(2 * scene.period / scene.time_step) == 2000
    assert BarScene(dt=2.5e-5, t_end=1.0).steps == 40_000
    assert BarScene(dt=2.5e-5, modulus=1000.0, cells=160).courant_number == pytest.approx(0.126491106, rel=1e-8)
    assert BarScene(cfl=1.0, t_end=1e-9).steps == 1


@pytest.mark.parametrize(("cfl", "interval"), [(1e-3, 10), (0.05, 10), (0.1, 5), (0.2, 2), (0.3, 1), (1.5, 1)])
def test_estimate_interval(cfl, interval):
    """k = clamp(h/(2 c dt), 1, 10): an estimator steps twice while a wave crosses a cell."""
    scene = BarScene(cfl=cfl)
    assert scene.estimate_interval == interval and scene.sample_interval % interval == 0


@pytest.mark.parametrize(("scene", "steps"), [
    (BarScene(cfl=0.01), 40), (BarScene(sample_every=7), 7), (BarScene(cfl=0.05), 20),
    (BarScene(cells=80, cfl=0.3), 20), (BarScene(cfl=0.3), 13), (BarScene(cells=20, cfl=1.5), 1)])
def test_samples_are_two_hundred_a_period_or_as_said(scene, steps):
    """At the estimators' own steps. A sample with estimates costs several steps: every twentieth is enough, unless a
    period has fewer than 400."""
    assert scene.sample_interval == steps


def test_effects_that_need_others():
    """The acceleration error needs the truth; without the effect ``estimate`` no estimator runs."""
    assert not BarScene(effects=("acceleration",)).has("acceleration")
    assert BarScene(effects=("acceleration", "truth")).has("acceleration")
    assert BarScene(effects=("truth",)).active_estimators == () and not BarScene(effects=("truth",)).has("estimate")
    assert not BarScene(estimators=()).has("estimate") and BarScene().active_estimators == ("companion",)


def test_a_scene_that_is_sent_again_is_the_same_object():
    """What it is sent as has none of what was worked out; numbers that are equal but not alike stay apart."""
    for scene in (BarScene(t_end=1), BarScene(t_end=1.0), RingScene(estimators=("recovered",))):
        known = pickle.loads(pickle.dumps(scene))
        assert known == scene and known is pickle.loads(pickle.dumps(scene)) and scene.time_step == known.time_step
        assert json.dumps(known.to_dict()) == json.dumps(scene.to_dict())
        assert known is pickle.loads(pickle.dumps(scene))


def test_to_dict_has_every_input_filled_in():
    """The JSON object shows what ran: every field under its flag's name, defaults replaced by numbers."""
    scene = BarScene()
    values = json.loads(json.dumps(scene.to_dict(), allow_nan=False))
    assert set(values) == {KEYS.get(f.name, f.name) for f in fields(BarScene)}
    assert values["ppc"] == 4 and values["estimator"] == ["companion"] and values["cfl"] == 0.05
    assert [name for name, value in values.items() if value is None] == ["stretch", "initial_velocity"]
    assert (values["dt"], values["t_end"]) == (scene.time_step, scene.end_time)
    assert values["periods"] == pytest.approx(5) and values["sample_every"] == scene.sample_interval
    numbers = ("cells", "amplitude", "modulus", "density", "dt", "t_end", "sample_every")
    again = {k: values[k] for k in numbers}
    twin = BarScene(**again)  # what is printed reproduces the run
    for name in ("steps", "time_step", "sample_interval"):
        assert getattr(twin, name) == getattr(scene, name)


anything = st.one_of(st.none(), st.floats(), st.floats(1e-12, 1e12), st.integers(-3, 10**6))


@given(numbers=st.fixed_dictionaries({}, optional={name: anything for name in NUMBERS}))
@example(numbers={"dt": 1e-320, "t_end": 1e-320})
@example(numbers={"dt": 1e-12, "t_end": 1e-9})
@example(numbers={"cfl": 5e-324})
@example(numbers={"t_end": 1e308})
def test_any_numbers_make_a_usable_scene_or_a_scene_error(numbers):
    """No other exception, nothing infinite, and every count fits the kernel's 32-bit integers."""
    try:
        scene = BarScene(**numbers)
    except SceneError as error:
        assert error.field in NUMBERS and error.sentence
        return
    json.dumps(scene.to_dict(), allow_nan=False)
    assert scene.time_step > 0 and scene.end_time > 0
    for count in (scene.steps, scene.sample_interval, scene.estimate_interval, scene.particles):
        assert 1 <= count < 2**31


@pytest.mark.parametrize("scene", [RingScene(body_force="two-tone"), RingScene(body_force="none")],
                         ids=lambda s: f"{s.problem}-{s.body_force}")
def test_without_a_built_in_solution_there_is_no_truth(scene):
    """A force or a free motion that nobody has solved: the truth is off and said to be, the estimates go on."""
    assert not scene.has("truth") and scene.has("acceleration") and scene.has("estimate")
    assert scene.warnings() == [f"body force {scene.body_force}: no exact solution is built in, so the true error is "
                                "unknown"]


def test_the_free_bar_has_a_solution_of_its_own():
    """At twice the frequency, begun with the same velocity; that it is one is in test_exact_solutions.py."""
    forced, free = BarScene(), BarScene(body_force="none")
    assert free.has("truth") and not free.warnings() and free.angular_frequency == 2 * forced.angular_frequency
    assert free.motion_amplitude * free.angular_frequency == forced.amplitude * forced.angular_frequency
