"""The companion of a body: its errors against exact motions, laws of mechanics, and patches of every orientation."""

import dataclasses

import numpy as np
import pytest

from solvers.bodies.body_file import library_text, parse_body
from solvers.bodies.companion import BodyCompanion
from solvers.bodies.material_points import MaterialPoints
from solvers.bodies.particle_comparison import ParticleComparison
from solvers.bodies.patch import Patch
from solvers.bodies.spectral_mesh import SpectralMesh, default_cuts, even_cuts
from tests.solvers.bodies import exact_bodies

SAMPLES = 20
BLOCK, PLATE, SECTOR = (parse_body(library_text(name))
                        for name in ("thrown_block", "plate_with_hole", "swinging_sector"))


def largest_rms_errors(body, motion, cuts, order, counts):
    """Of x and v over all samples, at so many particles along xi and eta, which have the exact motion."""
    companion = BodyCompanion(body, cuts, order, body.t_end / SAMPLES)
    run = MaterialPoints(body, SAMPLES, np.array([counts]), half_start=False)
    comparison, errors = ParticleComparison(run, [companion, companion], 0.0, {}), []
    for _ in range(SAMPLES):
        companion.advance()
        u, v, *_ = motion(run.lattice.position, companion.time)
        run.state.position_velocity[:] = np.hstack([run.lattice.position - run.corner + u, v])
        errors.append(comparison.compare().found[:2])
    return np.max(errors, axis=0)


@pytest.mark.parametrize(("elements", "order", "x"), [(2, 4, 6.927e-4), (2, 6, 3.235e-5), (2, 8, 1.165e-6),
                                                      (4, 4, 1.135e-5)])
def test_the_axis_aligned_motion(elements, order, x):
    """Values of an independent prototype; orders fall by a factor of twenty each, as they do for smooth motions."""
    body = exact_bodies.square()
    found = largest_rms_errors(body, exact_bodies.square_motion, even_cuts([(elements, elements)]), order, (24, 24))
    assert found[0] == pytest.approx(x, rel=1e-3)


@pytest.mark.parametrize(("counts", "order", "x", "v"), [
    ((1, 2), 4, 1.061e-6, 5.323e-4), ((2, 3), 4, 8.512e-8, 2.899e-5), ((2, 4), 6, 1.08e-10, 4.57e-8)])
def test_the_quarter_of_a_ring(counts, order, x, v):
    """Arcs, rollers on two axes, free rims; the errors of an independent prototype, but for the last, which is that of
    the steps in time: the prototype's, 2.2e-11 and 9e-9, are shorter by a third."""
    found = largest_rms_errors(exact_bodies.quarter_ring(), exact_bodies.ring_motion, even_cuts([counts]), order,
                               (8, 40))
    assert (found < 1.05 * np.array([x, v])).all() and (found > 0.5 * np.array([x, v])).all()


@pytest.mark.parametrize("body", [BLOCK, PLATE], ids=["block", "plate"])
def test_a_free_body_falls_as_one(body):
    """On any mesh a uniform motion is exact, and Nystrom's method is exact for a parabola."""
    free = tuple(Patch(patch.corners, arc=patch.arc) for patch in body.patches)
    body = dataclasses.replace(body, patches=free, gravity=(1.0, -3.0), velocity=("2", "1"), goals={})
    companion = BodyCompanion(body, default_cuts(body), 4, 0.1)
    companion.advance()
    assert companion.u == pytest.approx(np.tile([0.2 + 0.005, 0.1 - 0.015], (len(companion.u), 1)), abs=1e-12)


def test_momentum_and_angular_momentum_are_conserved():
    companion = BodyCompanion(BLOCK, even_cuts([(2, 2)]), 6, 0.5)
    mesh = companion.mesh
    share = 1 / mesh.inverse_mass[:, 0] / np.bincount(mesh.master)[mesh.master]  # of each copy of a point

    def momenta():
        (x, y), (u, v) = (mesh.points + companion.u).T, companion.v.T
        return np.array([share @ u, share @ v, share @ (x * v - y * u)])

    before = momenta()
    companion.advance()
    assert momenta() == pytest.approx(before, rel=1e-7)  # of the step in time; momentum itself to rounding
    assert share.sum() == pytest.approx(1000, rel=1e-12)


def turned(patch, times):
    """The same patch with another corner first."""
    at = np.roll(np.arange(4), -times)
    names = ("south", "east", "north", "west")
    # Side n runs from corner n to n + 1 around the patch.
    arc = {names[(names.index(name) - times) % 4]: centre for name, centre in patch.arc.items()}
    return Patch(tuple(patch.corners[k] for k in at), tuple(patch.sides[k] for k in at), arc)


@pytest.mark.parametrize("times", [1, 2, 3])
def test_the_orientation_of_patches_does_not_matter(times):
    """The plate's second patch begins at another corner: joined sides then run in other directions."""
    found = []
    for second in (PLATE.patches[1], turned(PLATE.patches[1], times)):
        body = dataclasses.replace(PLATE, patches=(PLATE.patches[0], second))
        companion = BodyCompanion(body, even_cuts(np.array([(1, 1), (1, 1)])), 6, 0.05)
        assert len(np.unique(companion.mesh.master)) == 2 * 49 - 7
        companion.advance()
        found.append(companion.u[np.lexsort(companion.mesh.points.round(9).T)])
    assert np.abs(found[0]).max() > 0.01 and found[1] == pytest.approx(found[0], abs=1e-12)


def test_areas_and_constrained_components():
    mesh = SpectralMesh(PLATE, even_cuts(np.array([(1, 1), (1, 1)])), 8)
    masters = np.unique(mesh.master)
    held = mesh.inverse_mass[masters] == 0
    X = mesh.points[masters]
    assert (held[:, 1] == (np.abs(X[:, 1]) < 1e-12)).all() and (held[:, 0] == (np.abs(X[:, 0]) < 1e-12)).all()
    both = ~held.any(axis=1)
    area = (1 / mesh.inverse_mass[masters][both, 0]).sum() / 1000
    edges = (1 / mesh.inverse_mass[masters].max(axis=1)[~both]).sum() / 1000
    assert area + edges == pytest.approx(1 - np.pi / 64, rel=1e-9)


def test_the_least_stretch_of_a_pressed_sector():
    mesh = SpectralMesh(SECTOR, default_cuts(SECTOR), 4)
    stretch, place = mesh.least_stretch(mesh.points * [-0.25, 0.5])
    assert stretch == pytest.approx(0.75, abs=1e-9) and place.shape == (2,)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_companion_that_is_not_finite_takes_no_step(value):
    companion = BodyCompanion(BLOCK, even_cuts([(2, 2)]), 6, 0.5)
    companion.v[7, 0] = value
    companion.advance()
    assert not companion.u.any() and not np.isfinite(companion.v[7, 0])


def test_the_stretch_of_a_body_inside_out_is_negative():
    mesh = SpectralMesh(BLOCK, even_cuts([(2, 2)]), 4)
    assert mesh.least_stretch(mesh.points * [-1.25, 0.0])[0] == pytest.approx(-0.25, abs=1e-12)
