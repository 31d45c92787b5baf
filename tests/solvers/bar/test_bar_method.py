"""The bar's kernel is the method of the formulas: compared with numpy, conserved sums, eq 17's conditions."""

from dataclasses import replace

import numpy as np
import pytest

from solvers.problems.bar.scene import BarScene
from solvers.problems.bar.solver import BarSolver
from solvers.scene.scene import Scene
from tests.support.reference_bar import Bar

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
    slip in a formula would make, dt^2 a = 1e-5."""
    scene = replace(BASE, method=method, velocity=velocity, body_force=body_force, linearity_preserving=linear)
    solver, bar = stirred(scene)
    solver.advance(STEPS)
    for n in range(STEPS):
        bar.step(n)
    a = solver._arrays
    for ours, theirs in ((a.position, bar.x), (a.velocity, bar.v), (a.deformation_gradient, bar.F)):
        assert np.abs(ours - theirs).max() < 4e-11


@pytest.mark.parametrize("method", METHODS)
def test_linearity_preservation(method):
    """On a deformed state, sum D = 0 and sum D x = 1 at every node, D from the kernel's own sums (eq 17).

    The kernel's moments are read after one step and put into D = (D* - S sum D*/sum S) V_i/den; rounding of
    terms up to 1/h. Plain D misses both by far more."""
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
