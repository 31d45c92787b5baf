"""The kernels of the plane problems are the method: sums that must be kept, fields that must be reproduced, planes."""

import functools
from dataclasses import replace

import numpy as np
import pytest
import taichi as ti

from solvers.estimators.estimator_arrays import unpack_arrays
from solvers.kernels import runtime
from solvers.kernels.dtypes import quads
from solvers.problems import PROBLEMS
from solvers.problems.planar.method import phases
from solvers.problems.planar.method.cpdi import NODES
from solvers.problems.planar.method.error_and_energy_sums import squared_norms
from solvers.problems.planar.method.stored_weights import weights_by_particle
from solvers.problems.planar.particle_layout import half_edges
from solvers.problems.planar.scene import GHOSTS
from solvers.problems.planar.snapshot_errors import body_force
from solvers.problems.planar.solver import PlanarSolver
from solvers.problems.ring import RingScene
from solvers.problems.vortex import VortexScene
from solvers.running.run import build
from solvers.solver.samples import read_rows
from solvers.solver.state_arrays import aligned_copy

BARE = {"cells": 16, "estimators": (), "effects": ()}
RING, VORTEX = RingScene(**BARE), VortexScene(**BARE)
SCENES = {scene.problem: scene for scene in (RING, VORTEX)}
RING_METHODS = RingScene.choices("method")
EVERY = [replace(scene, method=method) for scene in SCENES.values() for method in scene.choices("method")]
ROUNDING = np.finfo(float).eps
every_method = pytest.mark.parametrize("scene", EVERY, ids=lambda scene: f"{scene.problem} {scene.method}")
every_problem = pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES)


@functools.cache
def kernels(Solver: type[PlanarSolver]) -> tuple:
    """Two mappings by themselves: to the nodes at a time, and back."""
    State, TRAITS = Solver.KERNELS.state, Solver.PARTS.traits

    @ti.kernel
    def map_to_nodes(time: ti.f64, body: State, on: ti.template()):
        ti.loop_config(serialize=True)
        for _ in range(1):
            TRAITS.forces(body, time, on)
            phases.particles_to_nodes(body, 0, TRAITS, on)

    @ti.kernel
    def map_back(body: State, value: quads, by_x: quads, by_y: quads, on: ti.template()):
        ti.loop_config(serialize=True)
        for p in range(body.particles):
            value[p], by_x[p], by_y[p] = phases.gather(body, p, body.node_motion, on)

    return map_to_nodes, map_back


def to_nodes(solver: PlanarSolver, time: float = 0.0) -> None:
    kernels(type(solver))[0](time, solver._stepping.pack, solver._switches)


def at_particles(solver: PlanarSolver) -> list[np.ndarray]:
    """The nodes' four numbers at the particles, and their derivatives in x and y, each (P, 4)."""
    parts = [aligned_copy(np.zeros((len(solver._arrays.mass), 4))) for _ in range(3)]
    kernels(type(solver))[1](solver._stepping.pack, *parts, solver._switches)
    return parts


def stirred(scene) -> PlanarSolver:
    """A body in an irregular state, which no symmetry helps."""
    rng, solver = np.random.default_rng(5), build(scene)
    a = solver._arrays
    P = len(a.mass)
    a.position_velocity[:, :2] += rng.uniform(-0.2, 0.2, (P, 2)) * scene.spacing
    a.position_velocity[:, 2:] += rng.normal(0, 3, (P, 2))
    a.deformation_gradient += rng.uniform(-0.1, 0.1, (P, 4))
    return solver


def node_places(solver: PlanarSolver) -> np.ndarray:
    line = (np.arange(solver.scene.cells + 1) - solver._arrays.origin) * solver.scene.spacing
    y, x = np.meshgrid(line, line, indexing="ij")
    return np.stack([x.ravel(), y.ravel()], axis=1)


def kirchhoff(solver: PlanarSolver) -> np.ndarray:
    """V sigma of the particles (P, 2, 2), by the law of the material."""
    a, scene = solver._arrays, solver.scene
    F = a.deformation_gradient.reshape(-1, 2, 2)
    volume = a.mass / scene.density * np.linalg.det(F)
    return volume[:, None, None] * PROBLEMS[scene.problem].reference.stress(scene, F)


@every_method
def test_linear_fields_are_reproduced(scene):
    """Every mapping is exact for linear nodal fields: value at x_p and gradient, on any state, with a node in the
    middle of the vortex or none. Rounding of weights (1e-16) is divided by the smallest domain: 1e-16 / (h/10) of the
    field's 10; places of the vortex are some times as large."""
    slopes = np.array([[3.0, -2.0], [1.0, 5.0], [-4.0, 0.5], [2.0, 7.0]])
    for cells in (16, 17):
        solver = stirred(replace(scene, cells=cells))
        to_nodes(solver)
        solver._arrays.node_motion[:] = 1.5 + node_places(solver) @ slopes.T
        value, by_x, by_y = at_particles(solver)
        off = np.abs(value - 1.5 - solver._arrays.position_velocity[:, :2] @ slopes.T).max()
        assert off < (1e-13 if scene.problem == "ring" else 1e-12)
        assert np.abs(by_x - slopes[:, 0]).max() < 1e-11 and np.abs(by_y - slopes[:, 1]).max() < 1e-11


@every_method
def test_sums_at_the_nodes_are_the_particles(scene):
    """Mass and momentum are kept, force adds to sum m b, and sum f_i x_i to sum m b x - V sigma (the virial).

    These say that weights sum to one, gradients to zero, and that a linear field has its own gradient. Bounds are
    1000 roundings of the sum of sizes."""
    scene = replace(scene, density=1300.0, **({"poisson_ratio": 0.4} if scene.problem == "vortex" else {}))
    solver, time = stirred(scene), 0.2 * scene.period
    a = solver._arrays
    to_nodes(solver, time)
    m, v, x = a.mass[:, None], a.position_velocity[:, 2:], a.position_velocity[:, :2]
    b, tau = PROBLEMS[scene.problem].reference.body_force(scene, a.material_position, time), kirchhoff(solver)
    force = a.node_sums[:, 2:4]
    scale = 1000 * ROUNDING
    assert abs(a.node_sums[:, 4].sum() - m.sum()) < scale * m.sum()
    assert np.abs(a.node_sums[:, :2].sum(0) - (m * v).sum(0)).max() < scale * np.abs(m * v).sum()
    assert np.abs(force.sum(0) - (m * b).sum(0)).max() < scale * np.abs(force).sum()
    virial = force.T @ node_places(solver)
    assert np.abs(virial - (m * b).T @ x + tau.sum(0)).max() < scale * np.abs(force).sum()
    assert np.abs(tau.sum(0)).max() > 1e3 * scale * np.abs(force).sum()


@pytest.mark.parametrize("remedies", [(), ("frozen-weights",)], ids=["moving", "frozen"])
@pytest.mark.parametrize("method", RING_METHODS)
def test_particles_take_their_step_from_the_nodes(method, remedies):
    """v += dt sum S a, x += dt sum S v with the nodes' new velocities, on any state: rounding. F <- (I + dt L) F with
    gradients in space, or F <- F + dt L where weights stay those at rest, and gradients are in the material."""
    solver = stirred(replace(RING, method=method, remedies=remedies))
    a, dt = solver._arrays, solver.scene.time_step
    motion, F = a.position_velocity.copy(), a.deformation_gradient.copy()
    solver.advance(1)
    moved, stretched = a.position_velocity.copy(), a.deformation_gradient.copy()
    a.deformation_gradient[:] = F  # by which domains reach where they did
    here, by_x, by_y = at_particles(solver)
    L, F = np.stack([by_x[:, :2], by_y[:, :2]], axis=2), F.reshape(-1, 2, 2)
    np.testing.assert_allclose(moved, motion + dt * here, rtol=0, atol=1e-12 * np.abs(motion).max())
    expected = F + dt * (L if remedies else L @ F)
    np.testing.assert_allclose(stretched.reshape(-1, 2, 2), expected, rtol=0, atol=1e-12)
    assert dt * np.abs(L).max() > 1e-3


def mappings(solver: PlanarSolver) -> list[np.ndarray]:
    """S, S_x and S_y of the weights that the last step kept, particles (P) by nodes (N): four unit fields at a time."""
    a = solver._arrays
    P, N = len(a.mass), len(a.node_motion)
    found = [np.zeros((P, N + 4)) for _ in range(3)]
    for first in range(0, N, 4):
        units = np.arange(first, min(first + 4, N))
        a.node_motion[:] = 0
        a.node_motion[units, units - first] = 1
        for matrix, part in zip(found, at_particles(solver), strict=True):
            matrix[:, first:first + 4] = part
    return [matrix[:, :N] for matrix in found]


@pytest.mark.parametrize("method", ["ugimp", "cpdi"])
def test_transport_has_the_papers_defects_at_the_nodes(method):
    """Eqs 46 and 47 with dense matrices, at nodes that no mirror image reaches: (sum D) f + (sum D r - 1) a in x and y,
    each term of which is a hundredth of it and more."""
    solver = stirred(replace(RING, method=method, body_force="none", estimators=("transport",), effects=("estimate",),
                             sample_every=1))
    a, scene = solver._arrays, solver.scene
    x, F = a.position_velocity[:, :2].copy(), a.deformation_gradient.copy()
    solver.advance(1)
    error = unpack_arrays(solver.HOOKS, a.memory)["transport_error"][:, :2].copy()
    acceleration = a.node_motion[:, 2:].copy()
    a.deformation_gradient[:] = F
    S, *slopes = mappings(solver)
    V, tau = a.mass / scene.density * np.linalg.det(F.reshape(-1, 2, 2)), kirchhoff(solver)
    places = node_places(solver)
    inside = (places.min(axis=1) > 3 * scene.spacing) & (S.T @ a.mass > 1e-3 * a.mass.max())
    mass, volume = (S.T @ a.mass)[inside], (S.T @ V)[inside]
    for k in (0, 1):
        D = -(V[:, None] * slopes[k])
        r = x[:, k][:, None] - places[:, k]
        constant = D.sum(0)[inside] / volume * (S.T @ tau[:, k, k])[inside] / mass
        linear = ((D * r).sum(0)[inside] / volume - 1) * acceleration[inside, k]
        np.testing.assert_allclose(error[inside, k], constant + linear, rtol=0, atol=1e-9 * np.abs(constant).max())
        assert min(np.abs(constant).max(), np.abs(linear).max()) > 0.01 * np.abs(error[inside, k]).max()


@every_problem
def test_body_force_in_the_kernel_is_the_exact_one(scene):
    """On every particle, at the step's time: 1e-12 of the largest."""
    solver = build(replace(scene, density=1300.0, modulus=3e6))
    solver.step = 77
    solver.advance(1)
    a, scene = solver._arrays, solver.scene
    b = PROBLEMS[scene.problem].reference.body_force(scene, a.material_position, 77 * scene.time_step)
    found = body_force(a, np.arange(len(b))) / a.mass[:, None]
    np.testing.assert_allclose(found, b, rtol=0, atol=1e-12 * np.abs(b).max())


@pytest.mark.parametrize("method", RING_METHODS)
def test_nothing_moves_across_the_planes(method):
    """Nodes on a plane have no normal motion; ghosts are mirror images; the tangential motion is free."""
    solver = stirred(replace(RING, method=method))
    solver.advance(3)
    n = RING.cells + 1
    grid = solver._arrays.node_motion.reshape(n, n, 4)  # [j, i]
    odd_x, odd_y = np.array([-1, 1, -1, 1]), np.array([1, -1, 1, -1])
    assert not grid[:, GHOSTS, [0, 2]].any() and not grid[GHOSTS, :, [1, 3]].any()
    assert np.abs(grid[GHOSTS, :, 0]).max() > 1 and np.abs(grid[:, GHOSTS, 1]).max() > 1
    for k in (0, 1):
        np.testing.assert_array_equal(grid[:, k], odd_x * grid[:, 2 * GHOSTS - k])
        np.testing.assert_array_equal(grid[k], odd_y * grid[2 * GHOSTS - k])


@every_method
def test_unstable_runs_stay_inside_their_arrays(scene):
    """Whatever positions and deformations a bad run has, every kept node lies in the grid."""
    solver = stirred(scene)
    a = solver._arrays
    a.position_velocity[::7, :2] = 1e9
    a.position_velocity[1::7, :2] = -1e9
    a.deformation_gradient[2::7] = 1e6
    to_nodes(solver)
    numbers = weights_by_particle(a.weights, scene.method, a.particles)
    kept, width = (numbers[:, NODES:NODES + 4], 1) if scene.method == "cpdi" else (a.first_node, 2)
    assert kept.min() >= 0
    assert kept.max() + width * (scene.cells + 2) < (scene.cells + 1) ** 2


@pytest.mark.parametrize("scene", [RING, replace(RING, layout="cartesian"), VORTEX],
                         ids=["polar", "cartesian", "vortex"])
def test_snapshot_errors_are_computed_minus_exact(scene):
    """Every particle's error of x, v, sigma and a, from the exact fields at X and matrices: rounding of the fields.

    Radii are grouped to 12 digits in the Cartesian layout, so 1e-11 of a field's largest value."""
    solver = stirred(replace(scene, effects=("truth", "acceleration")))
    scene, a, exact = solver.scene, solver._arrays, solver.scene.EXACT
    solver.step, X = 37, a.material_position
    t, J = solver.time, np.linalg.det(a.deformation_gradient.reshape(-1, 2, 2))
    a.acceleration[:] = np.random.default_rng(6).normal(0, 1e3, X.shape)
    sigma = kirchhoff(solver) / (J * a.mass / scene.density)[:, None, None]
    u, v = a.position_velocity[:, :2] - X, a.position_velocity[:, 2:]
    fields = [(u, exact.displacement(scene, X, t)), (v, exact.velocity(scene, X, t)),
              (sigma.reshape(-1, 4)[:, [0, 1, 3]], exact.stress(scene, X, t)),
              (a.acceleration, exact.acceleration(scene, X, t - scene.time_step))]
    weights = [1, 1, [1, 2, 1], 1]  # the shear stress stands twice in the tensor
    for column, (computed, true), weight in zip(solver.snapshot().error.T, fields, weights, strict=True):
        size = np.sqrt((weight * (computed - true) ** 2).sum(1))
        assert np.abs(column - size).max() < 1e-11 * np.abs(computed).max()
        assert size.min() > 1e-6 * np.abs(computed).max()


@every_problem
def test_snapshots_and_samples_agree(scene):
    """Two ways to the same errors and estimates: kernels into samples, numpy into snapshots."""
    solver = build(replace(scene, effects=("truth", "acceleration", "estimate"), estimators=("transport",)))
    solver.advance(30)
    series, shot = read_rows(solver.measure(), solver.scene, len(solver._arrays.mass)), solver.snapshot()
    for k, name in enumerate(("x", "v", "sigma", "a")):
        assert np.sqrt(np.mean(shot.error[:, k] ** 2)) == pytest.approx(series[f"error_{name}"][0], rel=1e-9)
        if name != "sigma":  # of which transport says nothing
            size = np.sqrt(np.mean(shot.estimate["transport"][:, k] ** 2))
            assert size == pytest.approx(series[f"transport/estimate_{name}"][0], rel=1e-9)


def test_the_kernel_uses_the_boxes_that_are_drawn():
    """A GIMP weight's reach: the outer weights of the kernel are those of a box with the half edges of the layout."""
    scene = replace(VORTEX, method="cpgimp-v")
    solver = stirred(scene)
    to_nodes(solver)
    a, h = solver._arrays, scene.spacing
    half = half_edges(scene, a.deformation_gradient.reshape(-1, 2, 2), a.edges)[:, [0, 1], [0, 1]] / h
    place = a.position_velocity[:, :2] / h + 0.5 * scene.cells
    first = np.floor(place - half)
    end = np.maximum(0.0, place + half - first - 1)
    kept = weights_by_particle(a.weights, scene.method, a.particles)
    np.testing.assert_allclose(kept[:, 2:4], 0.25 * end**2 / half, atol=1e-13)  # the mean of the hat beyond


@ti.kernel
def sizes_of_a_tensor_and_vectors() -> ti.types.vector(4, ti.f64):
    return squared_norms(ti.Vector([1.0, 2.0, 3.0, 4.0]), ti.Vector([1.0, 3.0, 2.0]), ti.Vector([2.0, 1.0]))


def test_a_stress_has_its_shear_twice():
    """In the Frobenius norm of (1, 3; 3, 2); x, v and a are vectors."""
    runtime.start("cpu", 1)
    assert list(sizes_of_a_tensor_and_vectors()) == [5.0, 25.0, 1 + 2 * 9 + 4, 5.0]
