"""Numbers that somebody wants of a run, with the error that the truth and the estimators say they have."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

from app.commands.dispatch import dispatch
from solvers import BarScene, RingScene, VortexScene, run
from solvers.problems import PROBLEMS
from solvers.running.quantities_of_interest import ENERGY, SAFETY, QuantityOfInterest, point_weights
from solvers.running.result import Result
from solvers.scene.validation import SceneError

SCENES = {"bar": (BarScene(periods=0.3, estimators=("companion",)), "displacement@0.3"),
          "ring": (RingScene(cells=24, periods=0.3, cfl=0.2, estimators=("companion",)), "displacement@0.35,0.3"),
          "vortex": (VortexScene(cells=24, periods=0.02, cfl=0.2, estimators=("companion",)), "displacement@-0.3,0.9")}


@pytest.fixture(scope="module", params=SCENES)
def reached(request):
    scene, point = SCENES[request.param]
    return run(scene, goals=("kinetic-energy", "mean-stress", point))


def test_the_energy_is_that_of_the_particles(reached):
    """m v^2/2 added up by hand, and its error the difference to the exact velocities at the same particles: the same
    sums in another order, so that 1e-12 of them is far beyond rounding."""
    scene, shot = reached.scene, reached.final
    reference = PROBLEMS[scene.problem].reference
    start = reference.start(scene)
    mass = scene.density * start.volume
    X = shot.material_position.reshape(len(mass), -1)
    energy = 0.5 * mass @ np.sum(shot.velocity.reshape(X.shape) ** 2, axis=1)
    exact = 0.5 * mass @ np.sum(reference.velocity(scene, X, reached.time).reshape(X.shape) ** 2, axis=1)
    goal = reached.goals["kinetic-energy"]
    assert goal["unit"] == "J" and goal["value"] == pytest.approx(energy, rel=1e-12)
    assert goal["true_error"] == pytest.approx(energy - exact, abs=1e-12 * energy)


def test_a_mean_is_over_the_volume_and_an_energy_over_the_mass():
    fields = SimpleNamespace(volume=np.array([1.0, 3.0]), mass=np.array([2.0, 10.0]))
    values = SimpleNamespace(stress=np.array([[1.0, 9.0, 3.0], [4.0, 9.0, 8.0]]),
                             velocity=np.array([[1.0, 1.0], [0.0, 3.0]]))
    assert QuantityOfInterest("mean-stress").functional(fields)(values) == (1 * 2 + 3 * 6) / 4
    assert QuantityOfInterest("kinetic-energy").functional(fields)(values) == 0.5 * (2 * 2 + 10 * 9)


def test_the_displacement_is_that_of_the_point(reached):
    """Between particles a polynomial is laid through them, off by their distance to the third power at least; so the
    true error here is within a tenth of the largest at a particle, and what the companion says is within that of it."""
    scene, point = SCENES[reached.scene.problem]
    goal = reached.goals[point]
    X = np.array([[float(word) for word in point.partition("@")[2].split(",")]])
    u = np.atleast_1d(PROBLEMS[scene.problem].reference.displacement(scene, X, reached.time).squeeze())
    exact = u[0] if len(u) == 1 else np.linalg.norm(u)
    largest = np.abs(reached.final.error[:, 0]).max()
    assert goal["value"] == pytest.approx(exact, abs=1.1 * largest)
    assert goal["true_error"] == pytest.approx(goal["value"] - exact, abs=0.1 * largest)
    assert goal["estimated_error"]["companion"] == pytest.approx(goal["true_error"], abs=0.1 * largest)


def test_a_bar_is_twice_the_estimated_error(reached):
    for goal in reached.goals.values():
        assert goal["bar"] == {name: SAFETY * abs(error) for name, error in goal["estimated_error"].items()}
        assert abs(goal["true_error"]) < goal["bar"]["companion"]


def test_they_are_saved_with_the_result(reached, tmp_path):
    reached.save(tmp_path / "run.npz")
    assert Result.load(tmp_path / "run.npz").goals == reached.goals
    assert json.loads(json.dumps(reached.to_dict(), allow_nan=False))["goals"] == reached.goals


def test_the_polynomial_is_exact_for_its_degree():
    """Cubics along a line, parabolas in the plane; to rounding of numbers of the size 1."""
    X = np.linspace(0.05, 0.95, 10)[:, None]
    for point in (0.31, 0.05, 1.0):
        assert point_weights(X, np.array([point])) @ (X**3 - X)[:, 0] == pytest.approx(point**3 - point, abs=1e-12)
    grid = np.stack(np.meshgrid(np.arange(5.0), np.arange(5.0)), axis=-1).reshape(-1, 2)
    x, y = grid.T
    found = point_weights(grid, np.array([1.3, 2.6])) @ (x * x - x * y + 2 * y)
    assert found == pytest.approx(1.69 - 3.38 + 5.2, abs=1e-12)


def test_who_does_not_hold_has_no_bar():
    scene = BarScene(periods=0.3, cells=14, estimators=("two-grid", "companion"))  # of too few cells
    goal = run(scene, goals=["kinetic-energy"]).goals["kinetic-energy"]
    assert "two-grid" not in goal["bar"] and goal["bar"]["companion"] is not None


@pytest.mark.parametrize("scene, name, says", [
    (BarScene(), "energy", "is no goal; give kinetic-energy, mean-stress or displacement@X"),
    (BarScene(), "displacement@here", "needs 1 coordinate in m"),
    (BarScene(), "displacement@nan", "needs 1 coordinate in m"),
    (BarScene(), "displacement@0.1,0.2", "needs 1 coordinate in m"),
    (RingScene(), "displacement@0.5", "needs 2 coordinates in m: give displacement@X,Y"),
    (BarScene(), "displacement@1.5", "is at no point of the body at rest"),
    (RingScene(), "displacement@0.1,0.1", "is at no point of the body at rest: A quarter of a ring")])
def test_what_is_no_goal(scene, name, says):
    with pytest.raises(SceneError, match=f"(?s){says}"):
        run(scene, goals=[name])


def test_an_energy_is_rounded_like_the_velocity_of_all_the_mass():
    """dE = m v dv with v = sqrt(2 E/m): twice for four times the mass, or for four times the energy."""
    goal, scene = QuantityOfInterest(ENERGY), BarScene()
    one, heavy, fast = (goal.rounding(scene, 100, E, m) for E, m in ((1.0, 1.0), (1.0, 4.0), (4.0, 1.0)))
    assert [heavy / one, fast / one] == pytest.approx([2, 2])


def test_the_command(capsys):
    """A table with a bar by each estimator and how often such bars held, if runs like it were drawn and it is ok; bad
    names before anything runs. The 95 % interval of 65 of 65 begins at 65/(65 + 1.96^2) = 94 %."""
    assert dispatch(["run", "bar", "--periods", "0.3", "--estimator", "companion", "--goal", "kinetic-energy", "--goal",
                     "displacement@0.25", "--quiet"]) == 0
    said = capsys.readouterr().out
    assert "kinetic-energy" in said and "displacement@0.25" in said and said.count("+- companion") == 2
    assert "held 65 of 65" in said and "2 times the estimated error" in said and "interval begins at 94 %" in said
    for flags, status, reason in ((["--periods", "4"], 0, "0.1 to 3 periods, and this one has 4"),
                                  (["--cfl", "1.2", "--periods", "2"], 3, "only runs that end as ok were counted")):
        assert dispatch(["run", "bar", *flags, "--estimator", "companion", "--goal", "kinetic-energy", "--quiet"]) \
            == status
        said = capsys.readouterr().out
        assert "+- companion" in said and " held " not in said and reason in said
    assert dispatch(["run", "bar", "--periods", "0.1", "--estimator", "none", "--goal", "mean-stress", "--quiet"]) == 0
    assert "2 times the estimated error" not in capsys.readouterr().out
    assert dispatch(["run", "bar", "--goal", "foo"]) == 2
    assert "--goal foo: is no goal" in capsys.readouterr().err
