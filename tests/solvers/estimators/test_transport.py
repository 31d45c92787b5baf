"""The transport estimator (the paper's) and the measures that judge any estimator. How near it comes to the exact
solutions is in test_accuracy.py."""

import math
from dataclasses import replace

import numpy as np
import pytest

from solvers.estimators.estimator_arrays import unpack_arrays
from solvers.problems.bar.scene import BarScene
from solvers.problems.bar.solver import BarSolver
from solvers.problems.bar.state import HOOKS
from solvers.problems.ring import RingScene
from solvers.problems.vortex import VortexScene
from solvers.running.run import build
from solvers.solver import error_series, samples
from tests.support.reference_bar import NUMBERS

SMALL = NUMBERS["table1"]["small"]
TABLE_SCENE = BarScene(linearity_preserving=True, body_force="node", dt=2.5e-5, t_end=1.0,
                    modulus=SMALL["modulus"], amplitude=SMALL["amplitude"])


def test_error_index_is_a_ratio_of_sums():
    """Eq 35: sum over time of the estimated norms over that of the true ones; none where there is no truth."""
    assert error_series.error_index(np.array([0.0, 1.0, 2.0]), np.array([0.0, 2.0, 4.0])) == 0.5
    assert error_series.error_index(np.array([1.0, 3.0]), np.array([2.0, 2.0])) == 1.0  # not the mean of the ratios
    assert error_series.error_index(np.ones(3), np.zeros(3)) is None
    assert error_series.error_index(np.array([1.0, math.nan]), np.ones(2)) is None
    assert error_series.error_index(np.ones(2), np.array([1.0, math.nan])) is None


def test_distance_sees_what_an_index_cannot():
    """An estimate of the right size and the wrong sign has index 1 and distance 2; silence has 0 and 1."""
    truth = np.array([[1.0, -1.0], [2.0, 2.0]])
    for estimate, index, distance in ((truth, 1, 0), (-truth, 1, 2), (0 * truth, 0, 1)):
        sizes = [np.linalg.norm(field, axis=1) for field in (estimate, truth, estimate - truth)]
        assert error_series.error_index(sizes[0], sizes[1]) == index
        assert error_series.error_index(sizes[2], sizes[1]) == pytest.approx(distance)


def test_summary_leaves_out_the_start():
    """The error at t = 0 is zero by definition and would only dilute the mean."""
    assert error_series.summary(np.array([0.0, 1.0, 3.0, 2.0])) == {"final": 2.0, "max": 3.0, "mean": 2.0}
    nothing = {"final": None, "max": None, "mean": None}
    assert error_series.summary(np.array([0.0])) == error_series.summary(np.array([0.0, math.nan])) == nothing


@pytest.mark.parametrize("linear", [False, True], ids=["plain", "linear"])
@pytest.mark.parametrize("method", ["mpm", "ugimp", "cpgimp"])
def test_a_rigid_motion_has_no_error(method, linear):
    """v = const is exact for every method, so the estimate stays at rounding, through cells and the seam."""
    solver = BarSolver(BarScene(method=method, linearity_preserving=linear, body_force="none", cells=12, cfl=0.2,
                                estimators=("transport",)))
    solver._arrays.velocity[:] = 0.3
    solver.advance(100)
    assert solver.time * 0.3 > solver.scene.spacing
    # second differences of rounding, 1e-16/h^2, over 100 steps; a real estimate would be 1e-3 and more
    assert np.abs(solver._arrays.estimate).max() < 1e-10


def test_it_begins_with_nothing_though_a_vortexs_acceleration_does_not():
    """a(0) is all body force: without stress there is no defect of a mapping to carry. And at the very start nobody has
    computed an acceleration, and nobody can be wrong about it."""
    scene = VortexScene(estimators=("transport",), cells=24, amplitude=0.25, cfl=0.2, t_end=1.0, sample_every=1)
    solver = build(scene)
    series = samples.read_rows(solver.measure(), scene, scene.particles)
    assert series["error_a"] == series["transport/estimate_a"] == series["transport/difference_a"] == 0
    solver.advance(1)
    first = np.abs(solver._arrays.estimate_acceleration).max()
    assert np.abs(solver._arrays.acceleration).max() > 0.1 * scene.size_of("a")
    solver.advance(20)
    assert first < 1e-9 * np.abs(solver._arrays.estimate_acceleration).max()


def test_it_says_where_its_terms_vanish_or_are_no_small_part_of_the_acceleration():
    """From sums of squares over its steps; nothing is said before the first of them. With the share s of a computed
    acceleration that is error, what is made of that is 1/(1 - s) times what the exact one would give."""
    solver = BarSolver(replace(TABLE_SCENE, cells=20, estimators=("transport",)))
    assert solver.not_valid() == {}
    solver.advance(200)
    assert solver.not_valid() == {}
    squares = unpack_arrays(HOOKS, solver._arrays.memory)["transport_squares"]
    for share, word in ((0.0, "vanish"), (0.34, "off by 0.34 times its size"), (math.nan, "off by nan times its size")):
        squares[0] = share**2 * squares[1]
        assert word in solver.not_valid()["transport"]
    squares[0] = 0.33**2 * squares[1]
    assert solver.not_valid() == {}


def test_a_run_shorter_than_a_sample_interval_has_an_estimate():
    scene = VortexScene(cells=52, cfl=0.1, periods=0.025, amplitude=0.25, estimators=("transport",))
    assert 1 < scene.steps < scene.sample_interval
    solver = build(scene)
    solver.advance(scene.steps)
    assert unpack_arrays(solver.HOOKS, solver._arrays.memory)["transport_squares"][1] > 0


@pytest.mark.parametrize("scene", [
    BarScene(method="mpm", cells=40, amplitude=0.025, cfl=0.3, periods=0.3, estimators=("transport",)),
    RingScene(cells=12, cfl=0.3, periods=0.1, estimators=("transport",))], ids=["crossings", "free rim"])
def test_it_refuses_where_it_takes_noise_or_a_rim_for_the_error(scene):
    """Its sums are those of its errors at the nodes over the acceleration there, most of which would be error."""
    solver = build(scene)
    solver.advance(scene.steps)
    assert "times its size" in solver.not_valid()["transport"]
