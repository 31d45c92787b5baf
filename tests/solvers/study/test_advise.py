"""The advisor: what it expects of runs it has not made, and that its answers hold."""

import json
import math
from dataclasses import replace
from types import SimpleNamespace

import pytest

from app.cli import main
from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.problems.vortex import VortexScene
from solvers.running.run import run
from solvers.study.advise import Candidate, SearchGoal, _cheapest, _runner_up, advise, refinement_families
from solvers.study.refinement_error_and_cost import RefinementFamily, RefinementPoint
from solvers.study.sweep_and_search_worker import COURANT_NUMBERS, PARTICLES_PER_CELL

#: Nanoseconds of a particle-step, as measured once.
STEP = {"ugimp": 15.0, "cpgimp": 10.0, "bspline": 8.5, "cpdi": 32.0, "mpm": 8.0, "cpgimp-v": 20.0}
BAR = BarScene(amplitude=2.5e-4, periods=1, estimators=(), effects=())
RING = RingScene(estimators=(), effects=())
MADE: dict[tuple, RefinementPoint] = {}  # what a member of a family has given, for all tests
VORTEX = VortexScene(amplitude=0.3, periods=0.2, estimators=(), effects=())


def family(*points: tuple[int, float]) -> RefinementFamily:
    """A family that has been measured at these cells, at a nanosecond a particle-step."""
    return RefinementFamily(BarScene(cfl=0.1), "x", 2, [RefinementPoint(cells, error, 1e-9) for cells, error in points])


def test_errors_are_interpolated_by_powers():
    known = family((10, 4e-3), (20, 1e-3), (40, 2.5e-4))
    assert known.error(20) == 1e-3
    assert known.error(14) == pytest.approx(4e-3 * (10 / 14) ** 2)
    assert known.error(80) == pytest.approx(2.5e-4 / 4)
    assert known.error(8) == math.inf  # coarser than anything known


@pytest.mark.parametrize(("points", "order"), [
    ([(10, 8e-3), (20, 1e-3)], 2.0),  # no method is of third order, whatever two coarse grids pretend
    ([(10, 2e-3), (20, 1e-3)], 1.0),
    ([(10, 1.1e-3), (20, 1e-3)], 0.0),  # hardly falls: nothing to hope for from finer grids
    ([(10, 1e-3), (20, 2e-3)], 0.0),
    ([(10, math.inf), (20, 1e-3)], 0.0),
    ([(10, 1e-3), (20, math.inf)], 0.0)])
def test_the_order_is_trusted_within_reason(points, order):
    assert family(*points).order() == pytest.approx(order)


def test_cells_for_a_tolerance():
    known = family((10, 4e-3), (20, 1e-3), (40, 2.5e-4))
    assert known.cells_for(1e-3) == 20
    assert known.cells_for(0.5e-3) == 30  # 20 sqrt 2 = 28.3, and even
    assert known.cells_for(1e-5) == 200
    assert known.cells_for(1e-30) is None  # more cells than there can be
    assert family((10, 1e-3), (20, 1e-3)).cells_for(1e-4) is None


def test_the_cheapest_run_has_a_margin_to_the_tolerance():
    """28 cells are expected at 5.1e-4, too close below 5.2e-4; what has been measured needs no margin."""
    known, goal = family((10, 4e-3), (20, 1e-3)), SearchGoal("x", 5.2e-4, 60.0)
    assert known.cells_for(goal.tolerance) == 28 and _cheapest(known, goal).cells == 30
    assert _cheapest(family((10, 4e-3), (20, 1e-3), (28, 5.1e-4)), goal).cells == 28


def test_a_runner_up_is_dearer_by_what_is_said():
    """An error of 1e-3 on 20 cells, and of the other method on 40 with a third of a cell's time: 1.3 times."""
    other = RefinementFamily(BarScene(cfl=0.1, method="mpm"), "x", 2,
                             [RefinementPoint(10, 8e-3, 1e-9 / 3), RefinementPoint(40, 1e-3, 1e-9 / 3)])
    best = family((10, 4e-3), (20, 1e-3))
    goal = SearchGoal("x", 1e-3, 100.0)
    chosen = Candidate(best, 20, 1e-3, best.seconds(20))
    runner_up, why = _runner_up([other], chosen, goal, met=True)
    assert runner_up is not None and runner_up.cells == 40
    assert runner_up.seconds / chosen.seconds == pytest.approx(4 / 3) and why.endswith(": 1.3 times the time")


def test_time_grows_as_cells_squared_on_a_bar():
    known = family((10, 4e-3), (20, 1e-3))
    assert known.seconds(40) == pytest.approx(4 * known.seconds(20), rel=1e-2)  # whole steps
    assert known.seconds(10**6) == math.inf  # beyond what a scene may hold
    cells = known.cells_within(known.seconds(40))
    assert cells == 40


@pytest.fixture
def rates(monkeypatch):
    """Times are steps times particles times a rate, which is given here and not measured: a processor may be twice as
    fast when the search has ended as when it began. No run is made twice."""
    def measured(family: RefinementFamily, cells: int) -> RefinementPoint:
        key = family.member(cells), family.quantity
        if key in MADE:
            return family.add_and_time_point(MADE[key])
        MADE[key] = measure(family, cells)
        return MADE[key]

    measure = RefinementFamily.measure
    monkeypatch.setattr(RefinementFamily, "measure", measured)
    monkeypatch.setattr("solvers.study.refinement_error_and_cost._seconds_per_particle_step",
                        lambda scene: 1e-9 * STEP[scene.method])


def brute_force(choices: list[RefinementFamily], goal: SearchGoal, most: int) -> float:
    """Seconds of the cheapest member of up to ``most`` cells whose estimate meets the goal: in each family the fewest
    cells, found by ever finer grids until one meets it or is dearer than the best, and then by bisection."""
    best = math.inf
    for choice in choices:
        tried, unit = RefinementFamily(choice.scene, choice.quantity, choice.multiple), choice.multiple

        def meets(cells: int, tried: RefinementFamily = tried) -> bool:
            return tried.measure(cells).error <= goal.tolerance

        few, cells = unit, 2 * unit * round(6 / unit)
        while cells <= most and tried_seconds(choice.scene, cells) < best and not meets(cells):
            few, cells = cells, unit * round(1.4 * cells / unit)
        if cells > most or tried_seconds(choice.scene, cells) >= best:
            continue
        while cells - few > unit:
            middle = unit * ((few + cells) // (2 * unit))
            few, cells = (few, middle) if meets(middle) else (middle, cells)
        best = min(best, tried_seconds(choice.scene, cells))
    return best


def tried_seconds(scene, cells: int) -> float:
    scene = replace(scene, cells=cells)
    return scene.steps * scene.particles * 1e-9 * STEP[scene.method]


#: Chosen before the search was run on them: a quantity each, and the part of its size that is allowed.
@pytest.mark.parametrize(("base", "methods", "quantity", "part", "most"), [
    (replace(BAR, amplitude=5e-3), [("cpgimp", False), ("bspline", False)], "x", 2e-3, 160),
    pytest.param(replace(BAR, amplitude=0.03, periods=2), None, "v", 1e-2, 160, marks=pytest.mark.slow),
    pytest.param(replace(RING, amplitude=0.03, periods=0.5), None, "x", 5e-3, 60, marks=pytest.mark.slow),
    pytest.param(VORTEX, None, "x", 2e-2, 60, marks=pytest.mark.slow)],
    ids=["bar", "bar, all methods", "ring", "vortex"])
def test_no_run_is_cheaper_by_a_quarter(base, methods, quantity, part, most, rates):
    """Of all that a search chooses from unless it is told: one to four particles per cell, steps of cfl .1 to .6. It
    took 1.1 to 4.9 times the time of the cheapest run when it tried two to four, and no more than cfl .5."""
    choices = refinement_families(base, methods or base.candidates(), PARTICLES_PER_CELL, COURANT_NUMBERS, quantity)
    goal = SearchGoal(quantity, part * base.size_of(quantity), budget=20.0)
    advice = advise([RefinementFamily(c.scene, c.quantity, c.multiple) for c in choices], goal)
    assert advice.met and advice.chosen.is_measured and advice.chosen.error <= goal.tolerance
    assert advice.chosen.seconds <= 1.25 * brute_force(choices, goal, most)
    truth = run(replace(advice.chosen.scene, estimators=(), effects=("truth", "acceleration")), prices=False)
    assert truth.error[quantity]["max"] <= 1.01 * goal.tolerance


def test_what_cannot_win_is_run_once(rates):
    """A search that chooses from a hundred families makes little more than one coarse run of each."""
    choices = refinement_families(BAR, [("cpgimp", False), ("bspline", False)], PARTICLES_PER_CELL, COURANT_NUMBERS,
                                  "x")
    advice = advise(choices, SearchGoal("x", 1e-2 * BAR.amplitude, budget=20.0))
    assert advice.looks < 1.5 * len(choices) < 75


def test_beyond_reach_it_names_the_best():
    choices = refinement_families(BAR, [("ugimp", True), ("mpm", False)], (2,), (0.4,), "x")
    goal = SearchGoal("x", 1e-9 * BAR.amplitude, budget=0.01)
    advice = advise(choices, goal)
    assert not advice.met and advice.chosen.error > goal.tolerance
    assert advice.chosen.seconds <= goal.budget
    measured = [p.error for c in choices for p in c.points if c.seconds(p.cells) <= goal.budget]
    assert advice.chosen.error <= min(measured)


def usual(base, tolerance: float, **how):
    """The advice for a tolerance over A among all that a search chooses from, and what it has told of, in its order."""
    choices, points = refinement_families(base, base.candidates(), PARTICLES_PER_CELL, COURANT_NUMBERS, "x"), []
    goal = SearchGoal("x", tolerance * base.size_of("x"), budget=20.0)
    return advise(choices, goal, on_point=lambda one, point: points.append((one.scene, point)), **how), points


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3])
def test_a_first_answer_comes_long_before_the_last(tolerance, rates):
    """One family of each method is followed first; what comes later is cheaper, or not said."""
    advice, points = usual(BAR, tolerance)
    meets = [k for k, (_, point) in enumerate(points) if point.error <= tolerance * BAR.amplitude]
    assert meets[0] < 6 and len(points) == advice.looks > 80  # one method, on at most six grids
    scouted = points[:meets[0] + 1]
    assert len({scene for scene, _ in scouted}) == 1 and scouted[0][0].linearity_preserving  # the method that is last
    assert [point.cells for _, point in scouted[:1]] == [10]


def test_what_is_known_is_not_run_again(rates):
    """The same search makes no run and ends alike; another tolerance makes those only that are new."""
    advice, points = usual(BAR, 1e-2)
    known = {(scene, point.cells): point for scene, point in points}
    looks = []

    def recall(family: RefinementFamily, cells: int) -> RefinementPoint | None:
        return known.get((family.scene, cells))

    again, told = usual(BAR, 1e-2, recall=recall, on_look=lambda *look: looks.append(look))
    assert not looks and told == points
    assert (again.chosen.scene, again.chosen.error, again.looks) == (
        advice.chosen.scene, advice.chosen.error, advice.looks)
    finer, told = usual(BAR, 1e-3, recall=recall, on_look=lambda *look: looks.append(look))
    assert len(looks) == len([1 for scene, point in told if (scene, point.cells) not in known]) < 0.5 * finer.looks
    assert finer.chosen.scene == usual(BAR, 1e-3)[0].chosen.scene


def test_a_known_run_without_a_time_is_timed(monkeypatch):
    timed = []
    monkeypatch.setattr("solvers.study.refinement_error_and_cost._seconds_per_particle_step",
                        lambda scene: timed.append(scene) or 1e-9)
    one = RefinementFamily(BarScene(cfl=0.1), "x", 2)
    assert one.add_and_time_point(RefinementPoint(10, 1e-3,
                                                  math.nan)).seconds_per_particle_step == 1e-9 and len(timed) == 1
    assert one.add_and_time_point(RefinementPoint(20, 1e-4, 2e-9)).seconds_per_particle_step == 2e-9 and len(timed) == 1


def test_what_a_coarse_grid_meets_is_not_run_twice(rates):
    """Of the runner-up one member is known and meets the goal: a second look at it would find no order."""
    advice, points = usual(BAR, 1e-1)
    assert advice.met and len({(scene, point.cells) for scene, point in points}) == len(points)


# ---- the command ----------------------------------------------------------------------------------------------

QUICK = ["--method", "cpgimp", "--ppc", "2", "--cfl", "0.4", "--periods", "1", "--quiet"]


def test_json_has_the_recommendation(capsys):
    assert main(["advise", "bar", "--tolerance", "1e-2", *QUICK, "--json", "-"]) == 0
    printed = capsys.readouterr().out
    advice = json.loads(printed)
    assert printed.count("\n") == 1 and advice["schema"] == "mpm-lab/advice/1" and advice["status"] == "ok"
    assert advice["recommended"]["method"] == "cpgimp" and advice["verified"]["relative"] <= 1e-2
    assert advice["predicted"]["seconds"] > 0 and advice["why"] == "no other method was asked for"
    assert advice["command"].startswith("mpm-lab run bar --method cpgimp --cells ")
    assert main([*advice["command"].split()[1:], "--json", "-"]) == 0  # what it recommends can be typed
    assert json.loads(capsys.readouterr().out)["scene"]["cells"] == advice["recommended"]["cells"]


def test_a_tolerance_in_the_unit(capsys):
    assert main(["advise", "bar", "--tolerance", "1e-3", "--no-relative", *QUICK]) == 0
    assert "of its size" in capsys.readouterr().out


def test_beyond_reach_is_exit_1(capsys):
    assert main(["advise", "bar", "--tolerance", "1e-9", "--budget", "0.01", *QUICK]) == 1
    told = capsys.readouterr()
    assert "the best within reach is" in told.err and told.out.startswith("closest")


def test_corrected_results_are_families_of_their_own():
    """Their error is what is left of the true one, and their time that of a run with the estimator."""
    plain, corrected = refinement_families(BarScene(periods=0.3), [("ugimp", True)], (2,), (0.5,), "x", "recovered")
    assert (plain.corrected, corrected.corrected) == ("", "recovered") and corrected.multiple == plain.multiple
    timed = corrected._bare_scene(20)
    assert (timed.estimators, timed.courant_number) == (("recovered",), 0.5)
    assert 0 < corrected.measure(20).error < 0.2 * plain.measure(20).error


def test_a_broken_run_has_no_error_that_a_tolerance_could_meet(monkeypatch):
    """Though numbers are there, and small ones: of a lost run as of an unstable one."""
    sizes = {"companion": {"x": {"max": 1e-9}}}
    for status, error in (("ok", 1e-9), ("lost", math.inf), ("unstable", math.inf)):
        result = SimpleNamespace(estimate=sizes, status=status, reason=None, corrected={})
        monkeypatch.setattr("solvers.running.run.run", lambda *_, result=result, **__: result)
        monkeypatch.setattr(RefinementFamily, "add_and_time_point", lambda self, point: point)
        assert family().measure(40).error == error
