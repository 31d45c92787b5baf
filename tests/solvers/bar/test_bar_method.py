"""The bar's kernel is the method of the formulas: compared with numpy, conserved sums, eq 17's conditions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from solvers.problems.bar.scene import BarScene
from solvers.problems.bar.solver import BarSolver
from solvers.scene.scene import Scene
from tests.reference import Bar

STEPS = 40
BASE = BarScene(cells=12, amplitude=0.1, cfl=0.2, periods=2, density=1.7, estimators=(), effects=())
METHODS = ["mpm", "ugimp", "cpgimp", "bspline"]


def stirred(scene: Scene) -> tuple[BarSolver, Bar]:
    """Two copies of a bar in the same irregular state, which no symmetry helps."""
    rng, solver = np.random.default_rng(5), BarSolver(scene)
    a = solver._arrays
    a.position += rng.uniform(-0.2, 0.2, scene.particles) * scene.spacing / scene.ppc
    a.velocity += 0.05 + rng.normal(0, 0.02, scene.particles)
    a.deformation_gradient *= rng.uniform(0.9, 1.1, scene.particles)
    state = (array.copy() for array in (a.material_position, a.position, a.velocity, a.deformation_gradient))
    return solver, Bar(scene, *state)


@pytest.mark.parametrize("linear", [False, True], ids=["plain", "linear"])
@pytest.mark.parametrize("body_force", ["material", "node", "none"])
@pytest.mark.parametrize(("method", "velocity"), [*((m, "grid") for m in METHODS), ("ugimp", "particle"),
                                                  ("cpgimp", "corners")])
def test_kernel_follows_the_formulas(method, velocity, body_force, linear):
    """40 steps equal those of the dense numpy formulas.

    Both round differently. A rounding of x (1e-16) is divided by the domain (h/8) twice on its way into F and
    v, and 40 steps add up: 1e-16 x 100^2 x 40 = 4e-11 bounds the difference; it is 1000 times less than any
    slip in a formula would make, dt^2 a = 1e-5.
    """
    scene = replace(BASE, method=method, velocity=velocity, body_force=body_force,
                    linearity_preserving=linear)
    solver, bar = stirred(scene)
    solver.advance(STEPS)
    for n in range(STEPS):
        bar.step(n)
    a = solver._arrays
    for ours, theirs in ((a.position, bar.x), (a.velocity, bar.v), (a.deformation_gradient, bar.F)):
        assert np.abs(ours - theirs).max() < 4e-11


@pytest.mark.parametrize("velocity", ["grid", "particle"])
@pytest.mark.parametrize("method", METHODS)
def test_momentum_is_conserved_without_body_force(method, velocity):
    """Internal forces cancel because gradients sum to zero: sum m v is constant to rounding.

    Each step adds sum over nodes of forces up to sigma/h that cancel: eps x sqrt(terms) of them; the bound
    takes eps x P x dt c^2/h x steps.
    """
    solver, bar = stirred(replace(BASE, method=method, velocity=velocity, body_force="none"))
    scene = solver.scene
    solver.advance(STEPS)
    impulse = STEPS * scene.time_step * scene.wave_speed**2 / scene.spacing
    bound = np.finfo(float).eps * scene.particles * impulse
    assert abs(solver._arrays.velocity.sum() - bar.v.sum()) <= bound


@pytest.mark.parametrize("body_force", ["material", "node"])
def test_momentum_changes_by_the_body_force(body_force):
    """One step adds dt sum m_p b(X_p) (material), or dt sum m_i b(x_i) (node) where the nodes now are.

    A lopsided material force is used, as the bar's own sums to nothing.
    """
    solver, bar = stirred(replace(BASE, body_force=body_force))
    scene, start = solver.scene, 7
    solver.step = start
    solver._arrays.sine += 0.3
    push = 3 * bar.w**2 * scene.amplitude * np.sin(bar.w * start * scene.time_step)
    S, _, _ = bar.matrices()
    expected = {"material": solver._arrays.sine.sum(),
                "node": S.sum(0) @ np.sin(2 * np.pi * bar.nodes)}[body_force]
    solver.advance(1)
    gained = (solver._arrays.velocity - bar.v).sum()
    assert gained == pytest.approx(scene.time_step * push * expected, rel=1e-10)
    assert abs(gained) > 1e-6


def test_linearity_preservation_gives_up_exact_momentum():
    """Eq 17 divides each node's force by its own number, so that forces no longer cancel: a known price."""
    solver, bar = stirred(replace(BASE, body_force="none", linearity_preserving=True))
    solver.advance(STEPS)
    assert abs(solver._arrays.velocity.sum() - bar.v.sum()) > 1e-6


@pytest.mark.parametrize("method", METHODS)
def test_linearity_preservation(method):
    """On a deformed state, sum D = 0 and sum D x = 1 at every node, D from the kernel's own sums (eq 17).

    The kernel's moments are read after one step and put into D = (D* - S sum D*/sum S) V_i/den; rounding of
    terms up to 1/h. Plain D misses both by far more.
    """
    solver, bar = stirred(replace(BASE, method=method, linearity_preserving=True))
    S, dS, r = bar.matrices()
    solver.advance(1)
    a, inside = solver._arrays, slice(1, BASE.cells + 1)
    moments, sums = a.node_moments[inside], a.node_sums[inside, 0]
    tilt = moments[:, 0] / sums
    den = moments[:, 1] - tilt * moments[:, 2]
    star = -dS * bar.F[:, None] * bar.V0
    D = (star - S * tilt) / den
    plain = star / a.node_volume[inside]
    bound = 1e-12 / bar.h
    assert np.abs(D.sum(0)).max() < bound and np.abs((D * r).sum(0) - 1).max() < bound
    assert np.abs(plain.sum(0)).max() > 0.1 and np.abs((plain * r).sum(0) - 1).max() > 1e-3


@pytest.mark.parametrize("method", METHODS)
def test_linear_stress_makes_its_slope(method):
    """With sigma = s x and LP, the nodal force is exactly s V_i away from the period's seam (eq 17's
    purpose).
    """
    solver, bar = stirred(replace(BASE, method=method, linearity_preserving=True, body_force="none"))
    slope = 0.4
    solver._arrays.deformation_gradient[:] = bar.F = 0.9 + slope * bar.x / BASE.modulus
    S, _, _ = bar.matrices()
    solver.advance(1)
    volume = S.T @ (bar.F * bar.V0)
    expected = slope * volume / (bar.m * S.sum(0))
    inner = slice(3, BASE.cells - 2)
    np.testing.assert_allclose(solver._arrays.node_motion[1:-3][inner, 1], expected[inner], rtol=1e-11)


@pytest.mark.parametrize("method", METHODS)
def test_nodal_mass_is_the_particles_mass(method):
    """Partition of unity through the periodic images: the nodes' sums of S add up to the number of
    particles.
    """
    solver, _ = stirred(replace(BASE, method=method))
    solver.advance(3)
    total = solver._arrays.node_sums[1:BASE.cells + 1, 0].sum()
    assert abs(total - BASE.particles) <= BASE.particles * 10 * np.finfo(float).eps


@pytest.mark.parametrize("method", METHODS)
def test_a_uniform_motion_is_kept(method):
    """Galilean invariance: v = const, F = 1 moves every particle by v t, through cells and through the
    seam.
    """
    solver = BarSolver(replace(BASE, method=method, body_force="none"))
    a = solver._arrays
    a.velocity[:] = 0.3
    solver.advance(STEPS)
    moved = 0.3 * solver.time
    assert moved > 0.5 * BASE.spacing
    assert np.abs(a.position - a.material_position - moved).max() < 1e-13  # 40 additions to x <= 1, rounded
    assert np.abs(a.deformation_gradient - 1).max() < 1e-12
