"""The companion on the bar (see ``solvers.estimators.companion_solution``): its space, and its report per particle.

Elements of the material coordinate X around the period, with P = E u_X:

    m_i a_i = m_i b_i - sum_q w_q P phi_i,X,  m_i = rho w_i.

The body force is that of the material points, b(X, t), wherever the method samples it: at nodes it is in the wrong
place, an error to be seen. The last node is the first's image. A bar that starts stretched counts X and u from there
(``solvers.problems.bar.patch_test_inputs``); its constant stress has no effect on the periodic bar and is left out.
"""

import functools

import numpy as np
import taichi as ti

from solvers.estimators import companion_solution as shared
from solvers.estimators.spectral_elements import Elements, highest_frequency
from solvers.kernels.dtypes import integers, pairs, quads, reals
from solvers.motion.exact_solution_1d import force_table
from solvers.problems.bar import exact_solution
from solvers.problems.bar.method.body_force import body_force_at, tabulated_force_amplitude
from solvers.solver.separable_field_tables import pack_tables, pad_to_mode_pairs

POLYNOMIALS = 4  # order p
PER_WAVE = 5  # elements of the shortest wave of a motion by formula that matters


@ti.func
def accelerate(bar: ti.template(), t, on: ti.template()):
    """Computes the nodes' accelerations in m/s^2, in ``bar.companion_nodes``, at their trial displacements and the time
    t in s; they must be zero before. ``on``: compile-time options."""
    N = bar.companion_counts[shared.NODES]
    for e in range(bar.companion_counts[shared.ACROSS]):
        element_forces(bar, shared.WORK * N + e * bar.companion_counts[shared.ORDER])
    whole = bar.companion_nodes[shared.WORK * N][2] + bar.companion_nodes[shared.WORK * N + N - 1][2]
    size = tabulated_force_amplitude(bar, bar.companion_force, bar.companion_force_sizes, t, on)
    for i in range(N):
        work = shared.WORK * N + i
        force = whole if i == 0 or i == N - 1 else bar.companion_nodes[work][2]
        bar.companion_nodes[work][2] = bar.companion_nodes[work][6] * force \
            + body_force_at(bar.companion_force, bar.companion_force_sizes, i, bar.companion_sine[i], size, on)


@ti.func
def element_forces(bar: ti.template(), first):
    """Subtracts an element's internal forces in N from its nodes, ``bar.companion_nodes`` from ``first`` on."""
    n = bar.companion_counts[shared.ORDER] + 1
    for q in range(n):
        stretch = 0.0
        for k in range(n):
            stretch += bar.companion_matrices[q * n + k][0] * bar.companion_nodes[first + k][0]
        weighted = bar.companion_matrices[q * n][1] * bar.modulus * stretch
        for k in range(n):
            bar.companion_nodes[first + k][2] -= bar.companion_matrices[q * n + k][0] * weighted


@ti.func
def report(bar: ti.template(), base, step, on: ti.template()):
    """Stores the particles' errors after ``step`` steps, computed minus the companion's, in ``bar.estimate`` from entry
    ``base`` on: x, v, sigma, a in SI. ``on``: compile-time options."""
    shared.interpolate_nodes_in_time(bar, step)
    evaluate_at_element_points(bar)
    n = bar.companion_counts[shared.ORDER] + 1
    squares = 0.0
    for p in range(bar.particles):
        f = ti.Vector([0.0, 0.0, 0.0, 0.0])
        first = bar.companion_element[p] * n
        for k in range(n):
            f += bar.companion_basis[p * n + k] * bar.companion_elements[first + k]
        a = ti.math.nan
        if ti.static(on.acceleration):  # before the first step none has been computed, and so none can be wrong
            a = bar.acceleration[p] - f[3] if step > 0 else 0.0
        x = bar.position[p] - bar.material_position[p] - f[0]
        squares += x * x
        bar.estimate[base + p] = ti.Vector([x, bar.velocity[p] - f[1],
                                            bar.modulus * (bar.deformation_gradient[p] - 1 - f[2]), a])
    bar.companion_numbers[shared.SQUARE] = squares / bar.particles


@ti.func
def evaluate_at_element_points(bar: ti.template()):
    """Computes u, v, u_X and a at each element's points in ``bar.companion_elements``; u_X jumps between elements."""
    n, N = bar.companion_counts[shared.ORDER] + 1, bar.companion_counts[shared.NODES]
    for e in range(bar.companion_counts[shared.ACROSS]):
        first = shared.NOW * N + e * (n - 1)
        for i in range(n):
            stretch = 0.0
            for k in range(n):
                stretch += bar.companion_matrices[i * n + k][0] * bar.companion_nodes[first + k][0]
            bar.companion_elements[e * n + i] = ti.Vector([
                bar.companion_nodes[first + i][0], bar.companion_nodes[first + i][2], stretch,
                bar.companion_nodes[first + i][4]])


def mesh(scene) -> Elements:
    """Returns the companion's elements along the bar: of three cells on coarse bars and up to 16 on fine ones, where it
    gains by its order, and enough of them for the waves of a motion by formula."""
    count = max(3, min(1 + scene.cells // 3, 6 + scene.cells // 16))
    return Elements(0.0, 1.0, max(count, PER_WAVE * scene.highest_harmonic) if scene.motion_formula else count,
                    POLYNOMIALS)


def allocate(scene) -> dict[str, np.ndarray]:
    """Returns the companion's arrays by name, for a bar at its start: undeformed, with the initial velocity."""
    elements = mesh(scene)
    n, X = elements.order + 1, elements.node_coordinates
    inverse_mass = np.zeros((len(X), 2))
    inverse_mass[:, 0] = 1 / (scene.density / scene.initial_stretch * nodal_masses(elements))
    velocity = np.stack([exact_solution.velocity(scene, X, 0.0), np.zeros(len(X))], axis=1)
    frequency = scene.wave_speed * scene.initial_stretch * highest_unit_frequency(elements)  # of the bar as it starts
    element, basis, _ = elements.evaluate_basis((np.arange(scene.particles) + 0.5) * (scene.spacing / scene.ppc))
    sizes, force = pack_tables(pad_to_mode_pairs(force_table(scene, X) if scene.motion_formula else None))
    start = shared.initial_companion_arrays((elements.order, elements.count, 1, len(X), len(X), 1), frequency,
                                            scene.time_step, velocity, inverse_mass)
    return {**start, "companion_sine": np.sin(exact_solution.WAVENUMBER * X),
            "companion_element": element, "companion_basis": basis.ravel(),
            "companion_matrices": np.stack([elements.derivative.ravel(), np.repeat(elements.weights, n)], axis=1),
            "companion_elements": np.zeros((elements.count * n, 4)),
            "companion_force_sizes": sizes, "companion_force": force}


def nodal_masses(elements: Elements) -> np.ndarray:
    """Returns the masses of nodes (n,) for a density of 1; the first and the last node are one, of the sum of both."""
    m = elements.assembled_weights
    m[0] = m[-1] = m[0] + m[-1]
    return m


@functools.cache
def highest_unit_frequency(elements: Elements) -> float:
    """Returns the highest angular frequency of the elements for a wave speed of 1 m/s, in 1/s."""
    stiffness = elements.derivative.T @ (elements.weights[:, None] * elements.derivative)
    inverse_mass = 1 / nodal_masses(elements)

    def accelerations(u: np.ndarray) -> np.ndarray:
        pull = np.bincount(elements.node_of_point.ravel(), (u[elements.node_of_point] @ stiffness).ravel())
        pull[0] = pull[-1] = pull[0] + pull[-1]
        return inverse_mass * pull

    return highest_frequency(accelerations, inverse_mass)


def verdict(scene, memory) -> str | None:
    """Returns a sentence why the companion's last report is not to be trusted, or None; ``memory`` has its arrays."""
    elements = mesh(scene)
    u = memory["companion_nodes"].reshape(-1, len(elements.node_coordinates), 8)[shared.NOW, :, :2]
    return shared.why_not_trusted(u[elements.node_of_point], (1,), memory["companion_numbers"][shared.SQUARE])


HOOKS = shared.hooks(
    accelerate, {
        # The layers of nodes are (4 N, 8); the bar is the first of two components.
        "companion_sine": reals,  # sin 2 pi X of the nodes
        "companion_matrices": pairs,  # d/dX in an element, row by row, and at each row's point the weight
        "companion_element": integers,  # the particle's element
        "companion_basis": reals,  # the element's p + 1 polynomials at the particle
        "companion_force": quads, "companion_force_sizes": integers,  # a table of force at the nodes
        "companion_elements": quads,  # u, v, u_X, a at the points of each element, for a report
    }, allocate=allocate, report=report, verdict=verdict)
