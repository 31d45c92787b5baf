"""The vortex's companion: its own accuracy, its estimates against exact and independent truths, and where it ends."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.polynomial import legendre

from solvers.estimators import companion
from solvers.estimators.memory import memory_parts
from solvers.estimators.spectral import Elements
from solvers.problems.vortex import exact
from solvers.problems.vortex.estimators import companion as companion_vortex
from solvers.problems.vortex.estimators import companion_mesh
from solvers.problems.vortex.method.material import SECOND_FREQUENCY, SECOND_SIZE
from solvers.problems.vortex.scene import VortexScene
from solvers.problems.vortex.solver import HOOKS
from solvers.running.run import build
from solvers.solver.samples import QUANTITIES

VORTEX = VortexScene(estimators=("companion",), cfl=0.1, t_end=1.0)  # A = 1: the middle turns by 57 degrees
# ---- its parts ------------------------------------------------------------------------------------------------


def own_nodes(scene: VortexScene, elements: Elements, monkeypatch) -> np.ndarray:
    """The companion's own p - R, q and their rates at its nodes at the end of a run."""
    monkeypatch.setattr(companion_mesh, "mesh", lambda: elements)
    solver = build(scene)
    while solver.step < scene.steps:
        solver.advance(min(scene.steps - solver.step, solver.longest_advance))
    solver.snapshot()
    nodes = memory_parts(HOOKS, solver._arrays.memory)["companion_nodes"]
    return nodes.reshape(companion.LAYERS, -1, 8)[companion.NOW, :, :4]


def on_axis(elements: Elements) -> np.ndarray:
    """The nodes on the x axis, where e_R and e_Theta are the axes."""
    return np.stack([elements.nodes, np.zeros_like(elements.nodes)], axis=1)


def test_it_marches_to_the_exact_solution_without_knowing_it(monkeypatch):
    """A = 1 at t = 0.5, when its own middle circle has turned by 57 degrees.

    With order p the error of u falls with the elements as p + 1 or faster, once these resolve the quartic angle; with
    those in use it is 3e-7 m. An independent program of the same equations, in numpy, had the same errors.
    """
    scene = replace(VORTEX, cells=12, t_end=0.5, effects=("estimate",))
    errors = []
    for elements in (Elements(0.75, 1.25, 8, 4), Elements(0.75, 1.25, 16, 4), companion_mesh.mesh()):
        u = own_nodes(scene, elements, monkeypatch)[:, :2]
        errors.append(np.abs(u - exact.displacement(scene, on_axis(elements), scene.steps * scene.time_step)).max())
    assert np.degrees(np.arctan2(u[:, 1], elements.nodes + u[:, 0]).max()) == pytest.approx(180 / np.pi, abs=0.01)
    assert errors[0] / errors[1] > 2**5
    assert errors[2] < 4e-7


def test_its_highest_frequency_is_found():
    """The power method, against numpy's eigenvalues of the assembled operator: from below, within 2 per cent."""
    elements = companion_mesh.mesh()
    N, D = len(elements.nodes), elements.derivative
    K = np.zeros((N, N))
    for row in elements.of_node:
        R = elements.nodes[row]
        K[np.ix_(row, row)] += D.T @ np.diag(elements.weights * R) @ D + np.diag(elements.weights / R)
    true = np.sqrt(np.linalg.eigvals(K / companion_mesh.masses(elements)[:, None]).real.max())
    assert 0.98 * true < companion_mesh.unit_frequency(elements) < 1.0001 * true


# ---- against the exact solution ---------------------------------------------------------------------------------


# ---- against an independent solution, where none is built in ----------------------------------------------------


def polar_solution(scene: VortexScene, steps: int, t: float, order: int = 20) -> tuple[np.ndarray, ...]:
    """R and, there, r, alpha, r', alpha', r_t, alpha_t at time t, from Lagrange's equations in r and alpha.

    W = mu/2 (F:F - 2 - 2 ln J) + lambda/2 ln^2 J with F:F = r'^2 + r^2 alpha'^2 + r^2/R^2 and J = r' r/R, one element,
    the classical Runge-Kutta method: nothing in common with the companion but Gauss-Lobatto points.
    """
    points = np.concatenate([[-1], np.sort(legendre.Legendre.basis(order).deriv().roots().real), [1]])
    V = legendre.legvander(points, order)
    D = np.stack([legendre.legval(points, legendre.legder(c)) for c in np.eye(order + 1)], axis=1) @ np.linalg.inv(V)
    D, R = D / 0.25, 1 + 0.25 * points
    m = 0.25 * 2 / (order * (order + 1) * V[:, -1]**2) * R
    (lam, mu), rho = exact.lame(scene), scene.density

    def force(t: float, alpha: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Along and across the present radius; b is given at the angle that the exact solution would have."""
        if scene.body_force == "none":
            return 0 * R, 0 * R
        along, across = exact.polar_force(scene, R, t)
        w = scene.angular_frequency
        second = SECOND_SIZE * w * w * scene.amplitude * np.sin(SECOND_FREQUENCY * w * t)
        across = across + second * R * exact.shape(R)[0]
        behind = exact.turn(scene, R, t).angle - alpha
        return (np.cos(behind) * along - np.sin(behind) * across, np.sin(behind) * along + np.cos(behind) * across)

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        r, alpha, speed, spin = y  # spin = r^2 alpha_t
        stretch, twist, turning = D @ r, D @ alpha, spin / r**2
        back = lam * np.log(stretch * r / R) - mu
        pull = -D.T @ (m * (mu * stretch + back / stretch)) / m - mu * (r * twist**2 + r / R**2) - back / r
        torque = -D.T @ (m * mu * r**2 * twist) / m
        along, across = force(t, alpha)
        return np.stack([speed, turning, pull / rho + r * turning**2 + along, torque / rho + r * across])

    rate_0 = exact.turn(scene, R, 0.0).rate
    y, H = np.stack([R, 0 * R, 0 * R, R**2 * rate_0]), t / steps
    for n in range(steps):
        k1 = rate(n * H, y)
        k2 = rate((n + 0.5) * H, y + 0.5 * H * k1)
        k3 = rate((n + 0.5) * H, y + 0.5 * H * k2)
        y = y + H / 6 * (k1 + 2 * k2 + 2 * k3 + rate((n + 1) * H, y + H * k3))
    r, alpha, speed, spin = y
    return tuple(np.linalg.solve(V, row) for row in (r, alpha, D @ r, D @ alpha, speed, spin / r**2))


@pytest.mark.parametrize(("force", "amplitude"), [("none", 0.2), ("two-tone", 0.5)])
def test_a_vortex_without_a_built_in_solution(force, amplitude):
    """To the particle, against Lagrange's equations; circles widen there, so that lambda is in the solution."""
    scene = replace(VORTEX, body_force=force, amplitude=amplitude, effects=("estimate",))
    solver = build(scene)
    solver.advance(scene.steps // 2)
    solver.snapshot()
    a, (lam, mu) = solver._arrays, exact.lame(scene)
    R = np.linalg.norm(a.material_position, axis=1)
    found = polar_solution(scene, 2000, solver.time)
    r, alpha, stretch, twist, speed, turning = (legendre.legval((R - 1) / 0.25, c) for c in found)
    assert np.abs(r / R - 1).max() > 0.005
    c, s = a.direction.T
    c, s = c * np.cos(alpha) - s * np.sin(alpha), s * np.cos(alpha) + c * np.sin(alpha)
    e, e_t = np.stack([c, s], axis=1), np.stack([-s, c], axis=1)
    x, v = r[:, None] * e, speed[:, None] * e + (r * turning)[:, None] * e_t
    J, shear = stretch * r / R, r * twist
    bulk = (lam * np.log(J) - mu) / J
    rr, rt, tt = mu / J * stretch**2 + bulk, mu / J * stretch * shear, mu / J * (shear**2 + (r / R) ** 2) + bulk
    true = np.stack([rr * c * c + tt * s * s - 2 * rt * c * s, (rr - tt) * c * s + rt * (c * c - s * s),
                     rr * s * s + tt * c * c + 2 * rt * c * s], axis=1)
    F = a.deformation_gradient.reshape(-1, 2, 2)
    det = np.linalg.det(F)[:, None, None]
    sigma = (lam * np.log(det) * np.eye(2) + mu * (F @ F.transpose(0, 2, 1) - np.eye(2))) / det
    for estimate, truth in ((a.estimate[:, :2], a.position_velocity[:, :2] - x),
                            (a.estimate[:, 2:], a.position_velocity[:, 2:] - v),
                            (a.estimate_stress[:, :3], sigma.reshape(-1, 4)[:, [0, 1, 3]] - true)):
        assert np.linalg.norm(estimate - truth) / np.linalg.norm(truth) < 0.03
    assert not solver.not_valid()


# ---- how it behaves ---------------------------------------------------------------------------------------------


def test_steps_of_its_own_longer_than_the_particles(simulate):
    """Interval 1 and 8: short steps of the particles, which it strides over, give the same estimate of x."""
    short = replace(VORTEX, cells=12, t_end=0.25, cfl=0.004)
    allocated = companion_vortex.allocate(short)["companion_counts"]
    assert allocated[companion.INTERVAL] > 4
    result = simulate(short)
    assert all(result.distance["companion"][name] < 0.03 for name in QUANTITIES)


def test_it_says_when_it_has_failed_itself():
    """As where a fast free vortex flies apart and turns its elements inside out: they are no numbers then."""
    solver = build(replace(VORTEX, cells=12))
    memory_parts(HOOKS, solver._arrays.memory)["companion_nodes"][:] = np.nan
    assert "failed" in solver.not_valid()["companion"]
