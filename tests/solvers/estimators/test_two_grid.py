"""The two-grid estimator: Richardson's extrapolation from the run and a second one with half the cells. How near it
comes to the exact solutions is in test_accuracy.py, where it is refused in test_refusals.py."""

from dataclasses import replace

import numpy as np
import pytest
import taichi as ti

from solvers.estimators import two_grid
from solvers.estimators.estimator_arrays import unpack_arrays
from solvers.estimators.two_grid_phase_lag import phase_lag
from solvers.kernels.dtypes import matrix, pairs, quads, real, reals
from solvers.kernels.packing import ArrayPacking
from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.running.run import build, run

NAME = "two-grid"
BAR = BarScene(linearity_preserving=True, cells=40, amplitude=2.5e-4, periods=1.0, estimators=(NAME,))
RING = RingScene(cells=24, dt=2e-5, estimators=(NAME,))


def test_velocities_belong_to_one_moment_at_a_long_step(simulate):
    """v of a run is half a step early, and of the second run by half of its own: at cfl .3, where this is half of the
    error of v, its index stays within a tenth of 1. Measured 1.01; .47 if it is forgotten."""
    assert simulate(replace(BAR, cfl=0.3)).to_dict()["index"]["v"] == pytest.approx(1, abs=0.1)


def test_the_error_is_taken_from_the_ratio_of_the_cells():
    """1/(r^2 - 1): a third with half of them, and not where half of them is no whole number."""
    assert two_grid.extrapolation_factor(BAR) == pytest.approx(1 / 3)
    assert two_grid.extrapolation_factor(replace(BAR, cells=41)) == pytest.approx(1 / (2.05**2 - 1))


@pytest.mark.parametrize("scene", [BAR, RING], ids=["bar", "ring"])
def test_inactive_it_holds_nothing(scene):
    solver = build(replace(scene, estimators=()))
    arrays = unpack_arrays(solver.HOOKS, solver._arrays.memory)
    assert max(len(a) for name, a in arrays.items() if name.startswith(("coarse_", "two_grid_"))) == 1


@pytest.mark.parametrize("scene, steps", [(BAR, 20), (RING, 0), pytest.param(RING, 20, marks=pytest.mark.slow)],
                         ids=["bar", "ring", "ring that steps on"])
def test_a_second_run_gone_bad_is_noticed(scene, steps):
    solver = build(scene)
    solver.advance(steps)
    assert solver.not_valid() == {}
    unpack_arrays(solver.HOOKS, solver._arrays.memory)["coarse_deformation_gradient"][0] = np.nan
    solver.advance(steps)  # and steps on with it, whatever it has become
    assert "second run" in solver.not_valid()[NAME]


def test_a_second_run_that_is_lost_is_noticed():
    """Two tones on a bar that they bring near inversion: finite numbers, and an estimate of .7 of the error."""
    scene = BarScene(method="cpgimp", body_force="two-tone", velocity="particle", cells=76, ppc=6, amplitude=0.1,
                     cfl=0.13, periods=0.6, estimators=(NAME,))
    assert not scene.not_valid
    assert "of the amplitude off" in run(scene, prices=False).not_valid[NAME]


@pytest.mark.parametrize("method, ppc", [("ugimp", 4), ("cpgimp", 1), ("bspline", 3), ("mpm", 6)])
def test_waves_fall_behind_as_linear_theory_says(method, ppc, simulate):
    """After whole periods a free bar of small amplitude is at rest in its middle, so that its error is sin(lag).

    The run's own lag is a quarter of the second run's. A twentieth is left for terms of h^4 and the error of the step.
    """
    scene = BarScene(method=method, ppc=ppc, body_force="none", linearity_preserving=True, cells=40, amplitude=1e-5,
                     cfl=0.05, periods=3.0, estimators=())
    error = simulate(scene).error["x"]["final"]
    assert error == pytest.approx(scene.motion_amplitude / 2**0.5 * np.sin(phase_lag(scene, 2 * np.pi) / 4), rel=0.05)


def stencil_rows(targets: int, count: int, windows: tuple[int, int], ends: str) -> np.ndarray:
    """As matrices (2, targets, count), of the two kinds of weights."""
    t = two_grid.stencils(two_grid.target_point_positions(targets, count), count, windows, ends)
    rows, taps = np.zeros((2, targets, count)), np.arange(t["taps"])
    for q, (first, row) in enumerate(zip(t["first"], t["row"], strict=True)):
        rows[:, q, (first + taps) % count] = t["weights"][row + taps].T
    return rows


@pytest.mark.parametrize("targets", [12, 23, 50])
def test_stencils_are_exact_for_cubics_on_a_free_line(targets):
    """Both windows, from 24 points to more and fewer."""
    x, places = np.arange(24) / 24, two_grid.target_point_positions(targets, 24) / 24
    for degree in range(two_grid.CUBIC_COEFFICIENTS):
        np.testing.assert_allclose(stencil_rows(targets, 24, (8, 12), "free") @ x**degree, [places**degree] * 2,
                                   atol=1e-12)


@pytest.mark.parametrize("count, window", [(24, 4), (24, 8), (4, 8)])
def test_stencils_go_on_beyond_the_ends(count, window):
    """Around, or as mirror images that are even or odd: as on a line three times as long that holds these."""
    values, targets = np.random.default_rng(0).random(count), 2 * count // 3
    middle = np.arange(targets) + 3 * targets
    for ends, kind, sign in (("periodic", 0, 1), ("mirror", 0, 1), ("mirror", 1, -1)):
        image = sign * values[::-1] if ends == "mirror" else values
        wide = stencil_rows(7 * targets, 7 * count, (window, window), "free")[0] @ np.concatenate(
            [image, values, image, values, image, values, image])
        assert np.allclose(stencil_rows(targets, count, (window, window), ends)[kind] @ values, wide[middle])


def test_stencils_smooth_over_cells_and_interpolate_at_their_points():
    """A sawtooth over a cell of four points is mostly gone from a fit over four cells; four taps leave it as it is."""
    wave = np.tile([-1.5, -0.5, 0.5, 1.5], 10)
    for window, most, least in ((16, 0.3, 0.0), (4, 1.6, 1.4)):
        assert least <= np.abs(stencil_rows(40, 40, (window, window), "periodic")[0] @ wave).max() < most


def test_a_packing_gives_back_what_it_took():
    """Arrays by name out of one array a type; what cannot be packed is left alone."""
    members = {"n": ti.i32, "x": real, "a": reals, "b": reals, "c": pairs, "d": quads, "e": matrix}
    values = {"n": 7, "x": 2.5, "a": np.arange(3.0), "b": np.arange(5.0), "c": np.ones((2, 2)), "d": np.ones((4, 4)),
              "e": np.ones((2, 9))}
    packing = ArrayPacking(members)
    held = packing.pack(values)
    assert held.keys() == packing.types.keys() and len(held) == 5 and len(held["memory_reals"]) == 1 + 3 + 5
    parts = packing.unpack(held)
    assert parts.keys() == set("abcde")
    for name, array in parts.items():
        np.testing.assert_array_equal(array, values[name])
    parts["b"][:] = 9
    assert (held["memory_reals"][-5:] == 9).all()


def test_the_second_run_is_judged_by_its_own_error():
    """Four times that of the fine run: of .13 of the amplitude .52, of .12 less than the half that is lost."""
    scene, fine = BarScene(cells=40), np.ones(3)
    for share, words in ((0.12, None), (0.13, "0.52 of the amplitude"), (np.nan, "nan of the amplitude")):
        largest = np.array([(share * scene.motion_amplitude) ** 2])
        found = two_grid.coarse_run_verdict(scene, fine, 0 * fine, 0.5, largest)
        assert found is None if words is None else words in found
    assert "unstable" in two_grid.coarse_run_verdict(scene, np.array([1.0, np.nan]), 0 * fine, 0.5, np.zeros(1))


@pytest.mark.parametrize(("every", "steps"), [(4, 4), (7, 7), (20, 10), (11, 10)])
def test_the_second_run_arrives_with_the_samples(every, steps):
    """Its steps are the most that a sample's are a multiple of, up to ten; where none are, ten."""
    assert two_grid.steps_per_coarse_step(BarScene(cells=40, cfl=0.02, sample_every=every)) == steps
