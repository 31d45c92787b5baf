"""The ring's exact solution and layouts: checked against the equations they must satisfy, by differences."""

from __future__ import annotations

import numpy as np
import pytest

from solvers.problems.planar.layout import particle_layout
from solvers.problems.ring import exact
from solvers.problems.ring.scene import RingScene

SCENE = RingScene(amplitude=0.15, density=1300.0, modulus=3e6)
TIME = 0.37 * SCENE.period
AREA = np.pi / 4 * (exact.OUTER**2 - exact.INNER**2)
POINTS = np.array([[0.43, 0.05], [0.35, 0.35], [0.1, 0.55], [0.3, 0.42]])
STEP = 1e-4  # central differences: error of order STEP^2 = 1e-8 from truncation, 1e-12 from rounding


def gradient(function, X: np.ndarray) -> np.ndarray:
    """d f_i/d X_j by central differences, (P, ..., 2)."""
    shifts = STEP * np.eye(2)
    return np.stack([(function(X + d) - function(X - d)) / (2 * STEP) for d in shifts], axis=-1)


def deformation(X: np.ndarray) -> np.ndarray:
    return np.eye(2) + gradient(lambda Y: exact.displacement(SCENE, Y, TIME), X)


def first_piola(X: np.ndarray) -> np.ndarray:
    """P = mu (F - F^-T), the neo-Hookean stress with lambda = 0."""
    F = deformation(X)
    return 0.5 * SCENE.modulus * (F - np.linalg.inv(F).transpose(0, 2, 1))


def test_momentum_balance_in_cartesian_components():
    """rho u_tt = Div P + rho b, with F and Div P from differences of u alone: 1e-6 of the largest term."""
    P_X = gradient(first_piola, POINTS)
    divergence = P_X[:, :, 0, 0] + P_X[:, :, 1, 1]
    R = np.linalg.norm(POINTS, axis=1)
    b = POINTS / R[:, None] * exact.body_force(SCENE, R, TIME)[:, None]
    inertia = SCENE.density * exact.acceleration(SCENE, POINTS, TIME)
    assert np.abs(inertia - divergence - SCENE.density * b).max() < 1e-6 * np.abs(divergence).max()


def test_velocity_and_acceleration_are_time_derivatives():
    """Central differences in time, period/1e4 apart: relative error (2 pi 1e-4)^2/6 = 7e-8."""
    d = 1e-4 * SCENE.period
    for of, derivative in ((exact.displacement, exact.velocity), (exact.velocity, exact.acceleration)):
        slope = (of(SCENE, POINTS, TIME + d) - of(SCENE, POINTS, TIME - d)) / (2 * d)
        np.testing.assert_allclose(slope, derivative(SCENE, POINTS, TIME), rtol=1e-6)


def test_stress_follows_from_the_deformation():
    """sigma = mu/J (F F^T - I) with F by differences (error 1e-8 of the modulus)."""
    F = deformation(POINTS)
    sigma = 0.5 * SCENE.modulus * (F @ F.transpose(0, 2, 1) - np.eye(2)) / np.linalg.det(F)[:, None, None]
    ours = exact.stress(SCENE, POINTS, TIME)
    assert np.abs(sigma.reshape(-1, 4)[:, [0, 1, 3]] - ours).max() < 1e-6 * SCENE.modulus


@pytest.mark.parametrize("radius", [exact.INNER, exact.OUTER])
def test_surfaces_carry_no_traction(radius):
    """sigma e_R = 0 at both radii, to rounding of the modulus; the hoop stress there is not zero."""
    angle = np.linspace(0.1, 1.4, 5)
    n = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    xx, xy, yy = exact.stress(SCENE, radius * n, TIME).T
    traction = np.stack([xx * n[:, 0] + xy * n[:, 1], xy * n[:, 0] + yy * n[:, 1]])
    assert np.abs(traction).max() < 1e-13 * SCENE.modulus
    assert np.abs(xx + yy).max() > 1e-3 * SCENE.modulus


@pytest.mark.parametrize("per_cell", [1, 2, 4])
@pytest.mark.parametrize("layout", ["polar", "cartesian"])
def test_layouts_fill_the_ring(layout, per_cell):
    """Polar volumes sum to the area exactly (midpoint rule of R); Cartesian ones miss part of a rim of width h/ppc.

    A staircase errs by at most half a particle's side along the rim, pi/2 (a + b): a bound never reached by chance.
    """
    for cells in (12, 24, 48):
        scene = RingScene(cells=cells, layout=layout, ppc=per_cell)
        made = particle_layout(scene)
        side = scene.spacing / per_cell
        rim = 0.5 * np.pi * (exact.INNER + exact.OUTER)
        assert abs(made.volume.sum() - AREA) < (1e-12 if layout == "polar" else 0.5 * side * rim)
        R = np.linalg.norm(made.position, axis=1)
        assert np.abs(made.radii[made.radius] - R).max() < 1e-11  # radii are grouped to 12 digits
        assert R.min() > exact.INNER and R.max() < exact.OUTER and made.position.min() > 0


@pytest.mark.parametrize("layout", ["polar", "cartesian"])
def test_parallelograms_have_their_particles_volume(layout):
    """|r1 x r2| is the volume, the edges are the lattice's own: parallel to e_theta and e_R, or to the axes."""
    made = particle_layout(RingScene(cells=24, layout=layout))
    a, b = made.edges[:, :2], made.edges[:, 2:]
    np.testing.assert_allclose(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], made.volume, rtol=1e-12)
    assert np.abs((a * b).sum(1)).max() < 1e-15
    if layout == "polar":
        assert np.abs((a * made.position).sum(1)).max() < 1e-15


def test_edges_meet_their_neighbours():
    """Across the ring a domain's outer end is the next one's inner end; the lattice runs radius first."""
    made = particle_layout(RingScene(cells=24))
    across = len(made.radii)
    ends = made.position[:across] + 0.5 * made.edges[:across, 2:]
    starts = made.position[:across] - 0.5 * made.edges[:across, 2:]
    assert np.abs(ends[:-1] - starts[1:]).max() < 1e-15
    assert np.linalg.norm(ends[-1]) == pytest.approx(exact.OUTER, abs=1e-14)
    assert np.linalg.norm(starts[0]) == pytest.approx(exact.INNER, abs=1e-14)
