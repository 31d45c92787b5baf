"""The MPM run of a body against values of an independent prototype, exact motions, and what its sides must do."""

import dataclasses

import numpy as np
import pytest

from solvers.bodies import companion, material_points, particle_comparison
from solvers.bodies.body_file import library_text, parse_body
from solvers.bodies.companion import BodyCompanion
from solvers.bodies.material_points import MaterialPoints
from solvers.bodies.particle_comparison import ParticleComparison
from solvers.bodies.spectral_mesh import default_cuts, even_cuts
from solvers.solver.base import ESCAPED
from tests.solvers.bodies import exact_bodies

SAMPLES = 30
BLOCK, BEAM, PLATE = (parse_body(library_text(name)) for name in ("thrown_block", "cantilever", "plate_with_hole"))


def cauchy(body, F):
    xx, xy, yy = body.material.cauchy_stress(F.reshape(-1, 4).T)
    return np.stack([xx, xy, xy, yy], axis=1)


def largest_rms_errors(body, errors_of):
    """Of x, v and sigma over all samples; ``errors_of(run)`` returns a function that gives those of the run now."""
    run = MaterialPoints(body, SAMPLES, body.lattice_counts, half_start=False)
    current_errors, errors = errors_of(run), []
    for _ in range(SAMPLES):
        run.advance()
        errors.append(current_errors())
    return np.max(errors, axis=0)


@pytest.mark.parametrize(("method", "cells", "values"), [
    ("ugimp", 8, (6.8344e-3, 6.7441, 1.3837e6)), ("ugimp", 16, (1.9058e-3, 2.0935, 4.8775e5)),
    ("cpgimp", 8, (6.6515e-3, 6.3878, 1.2922e6)), ("cpgimp", 16, (1.4742e-3, 1.2822, 2.7970e5)),
    ("cpdi", 8, (5.5742e-3, 6.3635, 1.2468e6)), ("cpdi", 16, (1.2400e-3, 1.2967, 2.5052e5))])
def test_the_axis_aligned_motion(method, cells, values):
    """Against the exact motion, between rollers on all sides; the prototype gives these values to five digits."""
    body = exact_bodies.square(method, cells)

    def errors_of(run):
        def current_errors():
            u, v, F = exact_bodies.square_motion(run.lattice.position, run.time)
            stress = cauchy(body, run.deformation_gradient) - cauchy(body, F)
            return [np.sqrt(np.sum(one**2, axis=1).mean()) for one in (run.displacement - u, run.velocity - v, stress)]
        return current_errors

    assert largest_rms_errors(body, errors_of) == pytest.approx(values, rel=1e-4)


@pytest.mark.parametrize(("method", "cells", "values"), [
    ("ugimp", 8, (0.10454, 1.0093, 1.0201e4)), ("ugimp", 16, (0.028604, 0.57098, 6.0302e3)),
    ("cpgimp", 8, (0.10176, 1.0001, 1.0200e4)), ("cpdi", 8, (0.11300, 1.0247, 1.0190e4)),
    ("cpdi", 16, (0.031568, 0.65234, 6.8127e3))])
def test_the_thrown_block(method, cells, values):
    """Against a companion of 4 x 4 elements of order 6, which is 2e-5 of the motion off."""
    body = dataclasses.replace(BLOCK, method=method, cells_per_metre=cells)
    fine = BodyCompanion(body, even_cuts([(4, 4)]), 6, body.t_end / SAMPLES)

    def errors_of(run):
        comparison = ParticleComparison(run, [fine, fine], 0.0, {})

        def current_errors():
            fine.advance()
            return comparison.compare().found
        return current_errors

    assert largest_rms_errors(body, errors_of) == pytest.approx(values, rel=2e-4)


def test_bodies_share_a_compilation():
    """Of the step with one method, and of companions and comparisons for all bodies and orders."""
    block = dataclasses.replace(BLOCK, cells_per_metre=4, t_end=0.01)
    beam = dataclasses.replace(BEAM, cells_per_metre=4, t_end=0.01)
    plate = dataclasses.replace(PLATE, cells_per_metre=4, t_end=0.01, method="cpdi")
    square = dataclasses.replace(exact_bodies.square("cpdi", 4), t_end=0.001)
    before = [None] * 3
    for body, order in ((block, 4), (beam, 6), (plate, 5), (square, 4)):
        run = MaterialPoints(body, 1, body.lattice_counts, half_start=True)
        other = BodyCompanion(body, default_cuts(body), order, body.t_end)
        run.advance()
        other.advance()
        ParticleComparison(run, [other, other], 0.0, {}).compare()
        counts = [len(one._primal.compiled_kernels) for one in (
            material_points.take_steps, companion.take_steps, particle_comparison.compare_at_particles)]
        assert counts == [old or new for old, new in zip(before, counts, strict=True)]
        before = counts


def test_a_free_body_falls_along_a_parabola_with_a_half_start():
    body = dataclasses.replace(BLOCK, velocity=("0", "0"), gravity=(1.0, -3.0), cells_per_metre=8)
    run = MaterialPoints(body, 4, body.lattice_counts, half_start=True)
    run.advance()
    t = run.time
    assert run.displacement == pytest.approx(np.tile([0.5 * t * t, -1.5 * t * t], (256, 1)), abs=1e-12)
    assert run.velocity == pytest.approx(np.tile([t, -3 * t], (256, 1)), abs=1e-12)


def test_a_body_that_leaves_its_domain_is_stopped():
    body = dataclasses.replace(BLOCK, domain=((-0.2, -0.2), (1.2, 1.2)), cells_per_metre=8)
    run = MaterialPoints(body, 2, body.lattice_counts, half_start=False)
    run.advance()
    kind, step, particle = run.verdict
    assert kind == ESCAPED and 0 < step < run.steps and 0 <= particle < 256


@pytest.mark.parametrize("turns", [1, 2, 3])
def test_sides_act_alike_in_all_directions(turns):
    """The cantilever, its gravity and its grid turned by quarters: the motion turns with it, to rounding."""
    def turn(points):
        for _ in range(turns):
            points = np.stack([-points[..., 1], points[..., 0]], axis=-1)
        return points

    def tuples(points):
        return tuple(map(tuple, points.tolist()))

    beam = dataclasses.replace(BEAM, cells_per_metre=4, t_end=0.2, goals={})
    patch = beam.patches[0]
    domain = turn(np.array(beam.domain))
    turned = dataclasses.replace(
        beam, patches=(dataclasses.replace(patch, corners=tuples(turn(np.array(patch.corners, float)))),),
        gravity=tuple(turn(np.array(beam.gravity, float))), domain=tuples(np.sort(domain, axis=0)))
    runs = [MaterialPoints(body, 2, body.lattice_counts, half_start=True) for body in (beam, turned)]
    for run in runs:
        run.advance()
    assert turn(runs[0].displacement) == pytest.approx(runs[1].displacement, abs=1e-10)
    clamped = np.argmin(runs[0].lattice.position[:, 0])
    assert np.abs(runs[0].displacement).max() > 0.05 and np.abs(runs[0].displacement[clamped]).max() < 0.005
