"""The companion in the plane (see ``solvers.estimators.companion_solution``): its space, and its report per particle.

Elements are products of intervals in two coordinates xi and eta under a map X(xi, eta), a patch of the body. With
grad u = u_xi grad xi + u_eta grad eta, F = I + grad u and P(F),

    m_i a_i = m_i b_i - sum_q w_q j_q P [grad xi phi_i,xi + grad eta phi_i,eta],  m_i = rho w_i j_i,

j = det dX/d(xi, eta), which leaves sides that nothing holds free of traction. Mesh, map, force and material are
numbers and arrays, so that one compilation serves all bodies. Source: Patera, J. Comput. Phys. 54 (1984) 468-488.
"""

from typing import NamedTuple

import numpy as np
import taichi as ti

from solvers.estimators import companion_solution as shared
from solvers.kernels import runtime
from solvers.kernels.dtypes import integers, pairs, quads
from solvers.problems.planar.estimators.companion_patch import CompanionPatch
from solvers.problems.planar.method import material_laws
from solvers.problems.planar.method.material_laws import cauchy_stress_of, coefficients, piola, wave_stiffness
from solvers.problems.planar.particle_layout import particle_layout
from solvers.solver import separable_field_tables
from solvers.solver.separable_field_tables import compute_force_time_functions, pack_tables, pad_to_mode_pairs


@ti.func
def accelerate(body: ti.template(), t, on: ti.template()):
    """Writes the nodes' accelerations (m/s^2) at the trial displacement and t s to layer WORK, zero before."""
    row = body.companion_counts[shared.ROW]
    stiffest = 1.0
    for across in range(body.companion_counts[shared.ACROSS]):
        for along in range(body.companion_counts[shared.AROUND]):
            corner = body.companion_counts[shared.ORDER] * (across * row + along)
            stiffest = ti.max(stiffest, element_stresses(body, corner, on))
            element_forces(body, corner)
    body.companion_numbers[shared.STIFFEST] = stiffest
    compute_force_time_functions(body.companion_force, body.companion_force_sizes, body.angular_frequency * t, on)
    first = shared.WORK * body.companion_counts[shared.NODES]
    for node in range(body.companion_counts[shared.NODES]):
        force = separable_field_tables.body_force_at(body.companion_force, body.companion_force_sizes, node, on)
        work = first + node
        for c in ti.static(range(2)):
            per_mass = body.companion_nodes[work][6 + c]
            a = body.companion_nodes[work][2 + c] * per_mass
            body.companion_nodes[work][2 + c] = a + force[c] if per_mass > 0 else 0.0


@ti.func
def element_stresses(body: ti.template(), corner, on: ti.template()):
    """Stores w j P grad xi and w j P grad eta at the points of the element from node ``corner`` on; returns the
    stiffness of its stiffest waves, along a principal axis, over lambda + 2 mu, at least 1."""
    n, row = body.companion_counts[shared.ORDER] + 1, body.companion_counts[shared.ROW]
    trial = shared.WORK * body.companion_counts[shared.NODES] + corner
    for i in range(n):
        for j in range(n):
            node = trial + i * row + j
            body.companion_trial[i * n + j] = ti.Vector([body.companion_nodes[node][0], body.companion_nodes[node][1]])
    at_rest, stiffest = body.lame_modulus + 2 * body.shear_modulus, 1.0
    for i in range(n):
        for j in range(n):
            u_xi, u_eta = ti.Vector([0.0, 0.0]), ti.Vector([0.0, 0.0])
            for k in range(n):
                u_xi += body.companion_matrices[i * n + k][0] * body.companion_trial[k * n + j]
                u_eta += body.companion_matrices[j * n + k][1] * body.companion_trial[i * n + k]
            g = body.companion_geometry[corner + i * row + j]  # j grad xi, j grad eta, whose determinant is j
            per_j = 1 / (g[0] * g[3] - g[1] * g[2])
            xx, xy = 1 + per_j * (u_xi[0] * g[0] + u_eta[0] * g[2]), per_j * (u_xi[0] * g[1] + u_eta[0] * g[3])
            yx, yy = per_j * (u_xi[1] * g[0] + u_eta[1] * g[2]), 1 + per_j * (u_xi[1] * g[1] + u_eta[1] * g[3])
            F, w = ti.Vector([xx, xy, yx, yy]), body.companion_matrices[i * n + j][2]
            J, q, r, A, x = coefficients(body, F, on)
            # Of the principal stretches s, 1/s^2 are the roots of z^2 - (F:F/J^2) z + 1/J^2 = 0.
            per_J = 1 / J
            half = 0.5 * (xx * xx + xy * xy + yx * yx + yy * yy) * per_J * per_J
            root = ti.sqrt(ti.max(half * half - per_J * per_J, 0.0))
            for sign in ti.static((1, -1)):
                pressed = half + sign * root
                stiffest = ti.max(stiffest, wave_stiffness(q, r, A, x, 1 / pressed, pressed) / at_rest)
            P = piola(F, q, (r - q) * per_J)
            body.companion_stresses[i * n + j] = w * ti.Vector([P[0] * g[0] + P[1] * g[1], P[2] * g[0] + P[3] * g[1],
                                                                P[0] * g[2] + P[1] * g[3], P[2] * g[2] + P[3] * g[3]])
    return stiffest


@ti.func
def element_forces(body: ti.template(), corner):
    """Subtracts the internal forces of the element from node ``corner`` on, of stored stresses, from its nodes."""
    n, row = body.companion_counts[shared.ORDER] + 1, body.companion_counts[shared.ROW]
    trial = shared.WORK * body.companion_counts[shared.NODES] + corner
    for i in range(n):
        for j in range(n):
            xi, eta = ti.Vector([0.0] * 4), ti.Vector([0.0] * 4)
            for k in range(n):
                xi += body.companion_matrices[k * n + i][0] * body.companion_stresses[k * n + j]
                eta += body.companion_matrices[k * n + j][1] * body.companion_stresses[i * n + k]
            node = trial + i * row + j
            for c in ti.static(range(2)):
                body.companion_nodes[node][2 + c] = body.companion_nodes[node][2 + c] - (xi[c] + eta[2 + c])


@ti.func
def report(body: ti.template(), base, step, on: ti.template()):
    """Writes every particle's error after ``step`` steps, computed minus the companion's, to the ``estimate`` arrays
    from ``base`` on. Of each xi the companion is first reduced to a line of nodes, then evaluated there at each eta."""
    shared.interpolate_nodes_in_time(body, step)
    squares = 0.0
    for k in range(body.companion_counts[shared.RADII]):
        interpolate_to_line(body, k)
        for place in range(body.companion_places[4 * k], body.companion_places[4 * k + 4]):
            squares += particle_error(body, base, place, step, on)
    body.companion_numbers[shared.SQUARE] = squares / body.particles


@ti.func
def report_at_once(body: ti.template(), base, step, on: ti.template()):
    """Writes every particle's error as :func:`report` on a GPU, from nodes at ``step``, each on a line of its own."""
    squares = 0.0
    for n in range(body.particles):
        squares += particle_error(body, base, body.companion_counts[shared.RADII] + 1 + n, step, on)
    body.companion_numbers[shared.SQUARE] = squares / body.particles


@ti.func
def interpolate_to_line(body: ti.template(), k):
    """Stores u, v, a and u_xi on the line of the particles' k-th xi, at the nodes' eta, behind the layers of nodes."""
    line = shared.LAYERS * body.companion_counts[shared.NODES]
    for j in range(body.companion_counts[shared.ROW]):
        total = line_node_values(body, k, j)
        body.companion_nodes[line + j] = total


@ti.func
def line_node_values(body: ti.template(), k, j):
    """Returns the companion's u, v, a and u_xi, (x, y) each, at node j of the line of the particles' k-th xi."""
    n, row = body.companion_counts[shared.ORDER] + 1, body.companion_counts[shared.ROW]
    start = shared.NOW * body.companion_counts[shared.NODES] + body.companion_places[4 * k + 1]
    total, slope = ti.Vector([0.0] * 8), ti.Vector([0.0, 0.0])
    for i in range(n):
        now, basis = body.companion_nodes[start + i * row + j], body.companion_basis[k * n + i]
        total += basis[0] * now
        slope += basis[1] * ti.Vector([now[0], now[1]])
    total[6], total[7] = slope[0], slope[1]
    return total


@ti.func
def particle_error(body: ti.template(), base, row, step, on: ti.template()):
    """Writes the estimated errors (:func:`store_errors`) of the particle in ``row`` of ``companion_places``: (p, first
    node of its line, first of its polynomials, number of its xi). Returns the square of that of x, in m^2."""
    place = ti.Vector([body.companion_places[4 * row + k] for k in range(4)])
    p = place[0]
    f = ti.Vector([0.0] * 8)  # u, v, a, u_xi
    u_eta = ti.Vector([0.0, 0.0])
    for j in range(body.companion_counts[shared.ORDER] + 1):
        basis, value = body.companion_basis[place[2] + j], ti.Vector([0.0] * 8)
        if ti.static(runtime.runs_on_cpu()):
            value = body.companion_nodes[place[1] + j]
        else:  # particles of many xi are at work, and there is room for one line
            value = line_node_values(body, place[3], place[1] + j - shared.LAYERS * body.companion_counts[shared.NODES])
        f += basis[0] * value
        u_eta += basis[1] * ti.Vector([value[0], value[1]])
    g = body.companion_slopes[p]  # grad xi, grad eta
    xx, xy = 1 + f[6] * g[0] + u_eta[0] * g[2], f[6] * g[1] + u_eta[0] * g[3]
    yx, yy = f[7] * g[0] + u_eta[1] * g[2], 1 + f[7] * g[1] + u_eta[1] * g[3]
    sigma = cauchy_stress_of(body, ti.Vector([xx, xy, yx, yy]), on)
    return store_errors(body, base, p, step, ti.Vector([f[0], f[1], f[2], f[3]]), ti.Vector([f[4], f[5]]), sigma, on)


@ti.func
def store_errors(body: ti.template(), base, p, step, motion, acceleration, sigma, on: ti.template()):
    """Writes the errors of particle p against the companion's ``motion`` (u, v), a and Cauchy stress ``sigma`` (xx, xy,
    yy), SI units, to the ``estimate`` arrays at ``base + p``; returns the square of that of x, in m^2."""
    q, X = body.position_velocity[p], body.material_position[p]
    error = ti.Vector([q[0] - X[0] - motion[0], q[1] - X[1] - motion[1], q[2] - motion[2], q[3] - motion[3]])
    body.estimate[base + p] = error
    miss = material_laws.cauchy_stress(body, p, on) - sigma
    body.estimate_stress[base + p] = ti.Vector([miss[0], miss[1], miss[2], 0.0])
    a = ti.Vector([ti.math.nan, ti.math.nan])
    if ti.static(on.acceleration):  # before the first step none has been computed, and so none can be wrong
        a = body.acceleration[p] - acceleration if step > 0 else ti.Vector([0.0, 0.0])
    body.estimate_acceleration[base + p] = a
    return error[0] * error[0] + error[1] * error[1]


class ParticleBasis(NamedTuple):
    """Tables with which kernels evaluate the companion at P particles, sorted by xi.

    ``basis`` (n, 2) are values and derivatives of the p + 1 polynomials at each different xi (``columns`` of them),
    then at each eta. ``places`` (rows, 4) begin with a row for each xi and one more: the row of its first particle, its
    element's first node, 0, 0; then have a row per particle: its number, its element's first node on a line of nodes,
    its basis' first row, its xi's number. ``coordinate_gradients`` (P, 4) are grad xi and grad eta in 1/m.
    """

    basis: np.ndarray
    places: np.ndarray
    coordinate_gradients: np.ndarray
    columns: int


def particle_basis(patch: CompanionPatch, X: np.ndarray) -> ParticleBasis:
    """Returns the tables to evaluate the companion on ``patch`` at particles with material points X (P, 2) in m."""
    first, second = patch.lines
    (across, column), (along, line) = (np.unique(one.round(12), return_inverse=True)
                                       for one in patch.map.coordinates(X))
    (at_xi, *xi_basis), (at_eta, *eta_basis) = first.evaluate_basis(across), second.evaluate_basis(along)
    K, order, row = len(across), np.argsort(column, kind="stable"), len(second.node_coordinates)
    places = np.zeros((K + 1 + len(order), 4), np.int32)
    places[:K + 1, 0] = K + 1 + np.searchsorted(column[order], np.arange(K + 1))
    places[:K, 1] = at_xi * first.order * row
    places[K + 1:, 0] = order
    places[K + 1:, 1] = shared.LAYERS * len(patch.places) + at_eta[line[order]] * second.order
    places[K + 1:, 2] = (K + line[order]) * (first.order + 1)
    places[K + 1:, 3] = column[order]
    basis = np.concatenate([np.stack(one, axis=2).reshape(-1, 2) for one in (xi_basis, eta_basis)])
    return ParticleBasis(basis, places, patch.coordinate_gradients(X), K)


def allocate(scene) -> dict[str, np.ndarray]:
    """Returns the companion's arrays by name for a scene, undeformed and with the initial velocity."""
    patch = scene.companion_body(fine=None)
    (first, second), seen = patch.lines, particle_basis(patch, particle_layout(scene).position)
    n = first.order + 1
    matrices = np.stack([first.derivative, second.derivative, np.outer(first.weights, second.weights),
                         np.zeros((n, n))], axis=-1)
    sizes, force = pack_tables(*map(pad_to_mode_pairs, patch.force[1:]))
    row = len(second.node_coordinates)
    return {**shared.initial_companion_arrays((first.order, first.count, second.count, row, len(patch.places),
                                               seen.columns), patch.frequency_at_rest, scene.time_step, patch.velocity,
                                              patch.inverse_mass, row), "companion_geometry": patch.geometry,
            "companion_slopes": seen.coordinate_gradients, "companion_matrices": matrices.reshape(-1, 4),
            "companion_trial": np.zeros((n * n, 2)), "companion_stresses": np.zeros((n * n, 4)),
            "companion_basis": seen.basis, "companion_places": seen.places.ravel(), "companion_force": force,
            "companion_force_sizes": sizes}


def verdict(scene, memory) -> str | None:
    """Returns why not to trust the companion's last report, as a sentence, or None; ``memory`` are arrays by name."""
    counts = memory["companion_counts"]
    order, shape = counts[shared.ORDER], (counts[shared.NODES] // counts[shared.ROW], counts[shared.ROW])
    u = memory["companion_nodes"][shared.NOW * counts[shared.NODES]:, :2][:counts[shared.NODES]].reshape(*shape, 2)
    of_xi, of_eta = (np.arange(counts[one])[:, None] * order + np.arange(order + 1)
                     for one in (shared.ACROSS, shared.AROUND))
    return shared.why_not_trusted(u[of_xi[:, None, :, None], of_eta[None, :, None, :]], (2, 3),
                                  memory["companion_numbers"][shared.SQUARE])


MEMORY = {
    # Behind the layers of nodes is one line of u, v, a, u_xi for a report: (4 N + row, 8).
    "companion_geometry": quads,  # j grad xi and j grad eta at the nodes
    "companion_slopes": quads,  # grad xi and grad eta at the particles
    "companion_matrices": quads,  # d/dxi and d/deta in an element, row by row, and the weights of its points
    "companion_trial": pairs,  # u at the points of the element at work
    "companion_stresses": quads,  # w j P grad xi and w j P grad eta at the points of the element at work
    "companion_basis": pairs,  # see ParticleBasis
    "companion_places": integers,  # rows of four, see ParticleBasis
    "companion_force": quads, "companion_force_sizes": integers,  # the table of the body force at the nodes
}


HOOKS = shared.hooks(accelerate, MEMORY, allocate=allocate, report=report, verdict=verdict,
                     standalone=lambda scene: scene.companion_body(fine=None), report_at_once=report_at_once)
