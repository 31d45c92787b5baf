"""A run and two companions at its particles: fields, errors and sums against numpy, for motions that meshes hold."""

import numpy as np
import pytest

from solvers.bodies.body_file import library_text, parse_body
from solvers.bodies.companion import BodyCompanion
from solvers.bodies.goal import Goal
from solvers.bodies.material_points import MaterialPoints
from solvers.bodies.particle_comparison import ParticleComparison
from solvers.bodies.spectral_mesh import even_cuts

PLATE = parse_body(library_text("plate_with_hole"))
GRADIENTS = np.array([[[0.1, -0.2], [0.3, 0.05]], [[0.12, -0.21], [0.28, 0.06]]])  # of u of both companions
FACTOR, LEAD = 0.4, 0.01


@pytest.fixture(scope="module")
def compared():
    """A comparison on a curved body with uneven elements, and the fields of run and companions (P, 8)."""
    rng = np.random.default_rng(5)
    run = MaterialPoints(PLATE, 1, np.array([(5, 7), (5, 7)]), half_start=False)
    run.velocity_lead, X = LEAD, run.lattice.position
    companions = [BodyCompanion(PLATE, even_cuts(np.array([(2, 3)] * 2)), order, 0.1) for order in (4, 6)]
    for one, gradient in zip(companions, GRADIENTS, strict=True):
        one.motion[:] = one.mesh.points @ np.hstack([gradient.T, 7 * gradient])
    state = run.state
    state.acceleration[:] = rng.normal(size=(len(X), 2))
    state.deformation_gradient[:] = [1.0, 0.0, 0.0, 1.0] + 0.1 * rng.normal(size=(len(X), 4))
    state.position_velocity[:] += 0.1 * rng.normal(size=(len(X), 4))
    goals = {"first": Goal("end y", (0.8, 0.9)), "second": Goal("max |sigma_xy|", tuple(X[40]))}
    fields = [np.hstack([run.displacement, run.velocity, stress(run.deformation_gradient)])]
    fields += [np.hstack([X @ gradient.T, 7 * X @ gradient, stress(np.tile(np.eye(2) + gradient, (len(X), 1, 1)))])
               for gradient in GRADIENTS]
    return run, companions, ParticleComparison(run, companions, FACTOR, goals), fields


def stress(F):
    xx, xy, yy = PLATE.material.cauchy_stress(F.reshape(-1, 4).T)
    return np.stack([xx, xy, xy, yy], axis=1)


def sizes(fields):
    return np.stack([np.linalg.norm(fields[:, columns], axis=1) for columns in (slice(2), slice(2, 4), slice(4, 8))], 1)


def test_errors_and_differences(compared):
    """x against u_fine + K (u_fine - u_coarse); elements miss the body's arc by 1e-9 of its size."""
    _, _, comparison, (run, coarse, fine) = compared
    found = comparison.compare()
    error = run - fine
    error[:, :2] -= FACTOR * (fine - coarse)[:, :2]
    assert comparison.error_sizes == pytest.approx(sizes(error), rel=1e-6)
    for ours, those in zip(found, (fine - coarse, run - fine, error), strict=True):
        assert ours == pytest.approx(np.sqrt((sizes(those)**2).mean(axis=0)), rel=1e-6)


def test_goals_have_the_values_at_their_particles(compared):
    _, _, comparison, fields = compared
    comparison.compare()
    found, _ = comparison.goals["second"].last_value_and_bar(False)
    assert found == pytest.approx(fields[0][40, 5], rel=1e-9)
    value, bar = comparison.goals["first"].last_value_and_bar(True)
    J = [0.9 + GRADIENTS[k][1] @ (0.8, 0.9) for k in (0, 1)]  # of a linear motion any interpolation is exact
    assert bar == pytest.approx(abs(value - J[1]) + abs(J[1] - J[0]), rel=1e-9)


def test_material_turned_inside_out_has_no_stress(compared):
    run, _, comparison, _ = compared
    before = run.state.deformation_gradient[3].copy()
    run.state.deformation_gradient[3] = 1.0, 0.0, 0.0, -1.0
    found = comparison.compare()
    run.state.deformation_gradient[3] = before
    assert np.isnan(comparison.error_sizes[3, 2]) and np.isnan(found.found[2]) and np.isfinite(found.apart).all()
