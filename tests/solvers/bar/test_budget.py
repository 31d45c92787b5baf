"""The error budget of the bar: it adds up, it names the right cause, and what it foretells comes."""

import json
from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

from solvers.problems.bar.scene import BarScene
from solvers.problems.bar.solver import BarSolver
from solvers.running.budget_cause_removal import run_budget
from solvers.scene.error_causes import CAUSES, FIELDS
from solvers.scene.estimator_limits import reason
from solvers.scene.stabilisations import CENTRED, COUPLED, FILTER, FROZEN
from solvers.solver import budget_shares
from tests.budget import EFFECTS, GOOD, drawn

SCENE = BarScene(periods=1, estimators=(), effects=EFFECTS)
PATCH = replace(SCENE, motion="patch", method="mpm", cells=20, ppc=2.5, modulus=1000.0, cfl=0.2, t_end=0.5,
                periods=None)
#: Without the truth: against the companion.
ALONE = {"estimators": ("companion",), "effects": ("estimate", "budget")}
#: Shares of the mean square over the run, from a prototype in numpy of the same definitions, of which each step was the
#: solver's: scene, then crossings in x, v and F, and the coarse grid in x.
KNOWN = {
    "hat, 1/4 period": (replace(SCENE, method="mpm", periods=0.25), 0.978, 0.997, 1.001, 0.022),
    "hat": (replace(SCENE, method="mpm"), 0.968, 0.998, 1.004, 0.032),
    "hat, 80 cells": (replace(SCENE, method="mpm", cells=80, periods=0.3), 0.996, 1.000, 1.003, 0.004),
    "ugimp": (SCENE, 0.136, 0.872, 0.713, 0.865),
    "ugimp, 3 periods": (replace(SCENE, periods=3), 0.218, 0.878, 0.763, 0.784),
    "ugimp, 80 cells": (replace(SCENE, cells=80), 0.595, 0.982, 0.974, 0.405),
    "ugimp, particle": (replace(SCENE, velocity="particle", periods=0.5), 0.168, 0.847, 0.671, 0.831),
    "cpgimp": (replace(SCENE, method="cpgimp"), -0.038, 0.006, -0.001, 1.039),
    "bspline": (replace(SCENE, method="bspline"), 0.041, 0.928, 0.948, 0.959),
    "hat, small": (replace(SCENE, method="mpm", amplitude=2.5e-4), 0.042, -0.001, 0.018, 0.958),
    "hat, LP": (replace(SCENE, method="mpm", linearity_preserving=True, periods=0.25), -0.006, 0.096, 0.088, 1.006)}


#: Every branch of what carries the errors on, beside the methods: two remedies need room of their own, corners move
#: particles, and the bodies of linearity preservation are sums.
BRANCHES = [{}, {"linearity_preserving": True}, {"remedies": (FROZEN,)},
            {"remedies": (FILTER, COUPLED, CENTRED), "velocity": "particle"},
            {"method": "cpgimp", "velocity": "corners", "body_force": "node"}]


def largest_gap(series: dict[str, np.ndarray], until: float = np.inf) -> float:
    """The most that the causes' parts miss of the error of any field, over it, at samples after the start and while the
    error of x is below ``until``. Errors of round-off, which is 1e-16 of x, of v in wave speeds and of F, count as
    1e-9: so far from it, a millionth can be told."""
    sound = np.maximum.accumulate(series["budget/error_x"]) < until
    sound[0] = False
    return max(float(np.max(np.abs(sum(series[f"budget/part_{field}_{cause}"] for cause in CAUSES) - error)[sound]
                            / np.maximum(error, 1e-9)[sound], initial=0.0))
               for field in FIELDS for error in [series[f"budget/error_{field}"]])


def comes(scene: BarScene, cause: str) -> bool:
    """Whether the run without a cause has the error that the budget says, and nobody has that cause's part any more."""
    found = run_budget(scene, cause)
    taken, left = found.to_dict()["take_away"], found.again.series
    assert taken["class"] == cause
    return largest_gap(left) <= 1e-6 and all(
        abs(taken["predicted"][field] - taken["again"][field]) <= GOOD * taken["before"][field]
        and not left[f"budget/size_{field}_{cause}"].any() for field in FIELDS)


@pytest.mark.parametrize("amplitude", [0.0034, 0.006])
def test_only_runs_that_counted_can_say_that_nothing_has_crossed(amplitude, simulate):
    """With 36 cells and four particles each, particles cross from A = h/8 = 3.47 mm on."""
    scene = replace(SCENE, method="mpm", cells=36, ppc=4, amplitude=amplitude, periods=0.25)
    counted = replace(scene, effects=(*EFFECTS, "crossings"))
    assert budget_shares.has_crossed(simulate(counted).series) == (amplitude > 1 / 36 / 8)
    assert budget_shares.has_crossed(simulate(scene).series), "nobody has counted"


@pytest.mark.parametrize("name", KNOWN)
def test_shares_are_those_of_the_prototype(name, simulate):
    scene, x, v, F, grid = KNOWN[name]
    result = simulate(scene)
    found = result.budget
    measured = [found["x"]["crossings"], found["v"]["crossings"], found["F"]["crossings"], found["x"]["coarse_grid"]]
    assert measured == pytest.approx([x, v, F, grid], abs=0.02)
    assert all(sum(found[field].values()) == pytest.approx(1, abs=1e-6) for field in FIELDS)
    assert largest_gap(result.series) <= 1e-6


@pytest.mark.parametrize("inputs", BRANCHES, ids=str)
def test_it_adds_up_and_to_watch_it_changes_no_bit(inputs, simulate):
    scene = replace(SCENE, **inputs)
    assert largest_gap(simulate(scene).series) <= 1e-6
    watched, bare = (BarSolver(replace(scene, effects=effects)) for effects in (EFFECTS, ()))
    for solver in (watched, bare):
        solver.advance(400)
    for name in ("position", "velocity", "deformation_gradient"):
        np.testing.assert_array_equal(watched._arrays.members()[name], bare._arrays.members()[name])
    assert watched.bytes > bare.bytes + 10 * bare._arrays.position.nbytes  # off, it takes no memory


@pytest.mark.slow
@pytest.mark.parametrize("method", BarScene.choices("method"))
def test_the_causes_add_up_in_many_scenes(method, simulate):
    """At every sample, up to where a run is lost: beyond that rounding grows with the error. A patch test that passes
    has no error but round-off, which is no cause's and of which the budget says so."""
    for scene in islice(drawn(2, BarScene, method), 40):
        series = simulate(scene).series
        assert (
            "round-off" in budget_shares.why_not_valid(series)
            if budget_shares.rms_error_over_run(series, "x") <= budget_shares.ROUND_OFF
            else largest_gap(series, until=0.1) <= 1e-6
        ), scene


def test_a_body_force_at_the_nodes_makes_the_error(simulate):
    found = simulate(replace(SCENE, body_force="node", linearity_preserving=True, periods=0.25)).budget
    assert found["x"]["body_force"] == pytest.approx(0.997, abs=0.02)
    assert abs(found["x"]["crossings"]) < 0.02 and abs(found["x"]["coarse_grid"]) < 0.02


@pytest.mark.parametrize(("inputs", "most"), [
    *(({"method": method, "amplitude": 2.5e-4}, 0.05) for method in ("ugimp", "cpgimp", "bspline")),
    ({"remedies": (FROZEN,)}, 1e-6)], ids=str)
def test_where_nothing_crosses_crossings_make_nothing(inputs, most, simulate):
    """With frozen weights boxes are the pieces: 0 to round-off."""
    found = simulate(replace(SCENE, **inputs)).budget
    assert all(abs(found[field]["crossings"]) <= most for field in FIELDS)


def test_a_patch_test_is_crossings_and_nothing_else(simulate):
    found = simulate(PATCH).budget
    assert all(found[field]["crossings"] == pytest.approx(1, abs=5e-4) for field in FIELDS)
    exact = replace(PATCH, ppc=2)  # whole particles per cell: the patch test passes
    assert "round-off" in simulate(exact).budget["not_valid"]


def test_a_result_says_whose_parts_the_error_has_at_the_end_and_what_is_left_without_each():
    found = run_budget(SCENE, "crossings")
    said, taken = found.result.to_dict()["budget"], found.take_away()
    for field in FIELDS:
        total = sum(said["at_end"][field].values())
        assert total == pytest.approx(found.result.series[f"budget/error_{field}"][-1], rel=1e-6)
    assert sum(said["at_end"]["x"].values()) == pytest.approx(found.result.error["x"]["final"], rel=1e-6)
    assert said["reference"] == "exact" and said["not_valid"] is None and said["rms"] == taken["before"]
    assert {field: said["predicted"][field]["crossings"] for field in FIELDS} == taken["predicted"]


def test_against_the_companion_it_is_the_same(simulate):
    """The causes add up to what the companion estimates, and their shares are those against the exact solution."""
    exact, alone = (simulate(replace(SCENE, method="mpm", **more)) for more in ({}, ALONE))
    assert alone.budget["reference"] == "companion" and largest_gap(alone.series) <= 1e-6
    for field in FIELDS:
        assert alone.budget[field] == pytest.approx(exact.budget[field], abs=0.02)
    np.testing.assert_allclose(alone.series["budget/error_x"], alone.series["companion/estimate_x"], rtol=1e-12)


TWO_TONES = replace(SCENE, body_force="two-tone", method="mpm", periods=0.5, **ALONE)


@pytest.mark.parametrize("cause", CAUSES)
def test_two_tones_have_a_budget_without_a_known_answer(cause, simulate):
    found = simulate(TWO_TONES).budget
    assert found["reference"] == "companion" and found["v"]["crossings"] > 0.9
    assert comes(TWO_TONES, cause)


def test_without_an_answer_or_a_companion_there_is_no_budget():
    refused = replace(TWO_TONES, estimators=())
    assert not refused.has("budget") and any("companion" in sentence for sentence in refused.warnings())


@pytest.mark.parametrize(("inputs", "cause"), [
    ({"method": "mpm"}, "crossings"), ({}, "crossings"), ({}, "coarse_grid"), ({"method": "bspline"}, "crossings"),
    ({"body_force": "node", "linearity_preserving": True, "periods": 0.25}, "body_force"), ({}, "time_step"),
    ({"remedies": (FILTER, COUPLED, CENTRED), "velocity": "particle"}, "coarse_grid")], ids=str)
def test_what_is_foretold_comes(inputs, cause):
    assert comes(replace(SCENE, **inputs), cause)


def test_estimators_of_the_step_leave_a_run_without_a_cause_alone(simulate):
    """Those of the motion go on: their index of x stays within a tenth."""
    scene = replace(SCENE, method="mpm", estimators=("transport", "recovered"), effects=(*EFFECTS, "estimate"),
                    take_away="crossings")
    result = simulate(scene)
    assert set(result.not_valid) == {"transport"} and result.index["recovered"]["x"] == pytest.approx(1, abs=0.1)
    assert all("taken out" in reason(scene.LIMITS, name, scene) for name in ("transport", "two-grid"))


def test_without_the_force_at_the_nodes_it_is_the_force_at_material_points():
    """To round-off: what is taken away is b at the node less the mean of b over its particles."""
    node, material = (BarSolver(replace(SCENE, linearity_preserving=True, body_force=force, take_away=cause))
                      for force, cause in (("node", "body_force"), ("material", "nothing")))
    for solver in (node, material):
        solver.advance(400)
    np.testing.assert_allclose(node._arrays.position, material._arrays.position, rtol=0, atol=1e-12)


def test_where_causes_cancel_it_says_so(simulate):
    going_bad = simulate(replace(SCENE, amplitude=0.1)).budget
    assert going_bad["not_valid"].startswith("not valid here: ") and "cancel" in going_bad["not_valid"]


def test_numbers_beyond_all_bounds_have_no_shares():
    """Of one field alone, where the others have theirs."""
    series = {f"budget/{kind}_{field}{cause}": np.ones(3) for field in FIELDS for kind, causes in (
        ("error", [""]), ("size", [f"_{name}" for name in CAUSES])) for cause in causes}
    series |= {name: 0.25 * values for name, values in series.items() if "size" in name}
    assert budget_shares.why_not_valid(series) is None
    assert "too large" in budget_shares.why_not_valid(series | {"budget/size_v_crossings": np.full(3, np.inf)})


def test_a_run_gone_bad_still_has_a_result(simulate):
    """Null where there is no number, and a sentence."""
    result = simulate(replace(SCENE, cfl=1.5, take_away="crossings"))
    found = result.to_dict()["budget"]
    assert result.status == "unstable" and json.dumps(found, allow_nan=False)
    assert found["not_valid"].startswith("not valid here: ")
    gone = {name: np.append(values, np.nan) for name, values in result.series.items()}
    assert (
        "too large" in budget_shares.why_not_valid(gone)
        and budget_shares.rms_error_over_run(gone, "x", without="crossings") is None
    )


def test_of_runs_gone_bad_the_time_that_both_have_is_compared():
    """Each by itself would be over a time of its own; and the reason says which of the two it is of."""
    found = run_budget(replace(SCENE, method="mpm", amplitude=0.14, periods=2), "crossings")
    taken, again = found.take_away(), found.again
    assert taken is not None and again is not None and again.status == found.result.status == "unstable"
    ends = [result.series["time"][-1] for result in (found.result, again)]
    assert again.reason.startswith("without crossings the run went unstable") and abs(ends[0] - ends[1]) > 0.1
    for key, result in (("before", found.result), ("again", again)):
        errors = result.series["budget/error_x"][result.series["time"] < min(ends)]  # the last sample is where it broke
        assert taken[key]["x"] == pytest.approx(np.sqrt(np.mean(errors**2)))
    assert budget_shares.rms_error_over_run(found.result.series, "x") > 1.5 * taken["before"]["x"]


def test_the_prediction_is_what_is_left_of_every_particle():
    """(e - e_c)^2 out of e^2, e_c e and e_c^2: two causes of +3 and -1 leave 2, and then 3 or -1."""
    series = {"budget/error_x": np.array([2.0]), "budget/part_x_crossings": np.array([3.0]),
              "budget/size_x_crossings": np.array([3.0])}
    assert budget_shares.rms_error_over_run(series, "x") == 2 and budget_shares.rms_error_over_run(
        series, "x", without="crossings"
    ) == pytest.approx(1)
