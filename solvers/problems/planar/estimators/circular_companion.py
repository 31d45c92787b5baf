"""The companion of a body whose motion is the same all around (see ``solvers.estimators.companion_solution``).

Body force and initial velocity are the same at every angle of the ring, seen from that angle, and so are its shape and
its material. Turn a solution by any angle, and it solves the same problem; but a smooth solution is the only one; so it
is its own image under every rotation,

    x(R, Theta, t) = p(R, t) e_R(Theta) + q(R, t) e_Theta(Theta),

and two functions of the radius tell all: p = r cos alpha and q = r sin alpha, where r(R, t) is the radius to which a
circle has gone and alpha(R, t) by how much it has turned. Neither is taken from the exact solution: circles may widen,
J may change, and lambda matters. In p and q, other than in r and alpha, masses are constant and nothing depends on
velocities. With the columns of F in the frame (e_R, e_Theta) of the particle at rest,

    F e_R = (p', q'),  F e_Theta = (-q, p)/R,  P = mu (F - F^-T) + lambda ln J F^-T,
    m_i p_i'' = m_i b_R - sum_k w_k R_k P_RR phi_i' - w_i P_tt,  m_i = rho w_i R_i,
    m_i q_i'' = m_i b_t - sum_k w_k R_k P_tR phi_i' + w_i P_Rt,

the second index that of the column; both rims are free of traction. The unknowns kept are u = (p - R, q).

It sees every error of the particles, those that depend on the angle too (the grid has no rotational symmetry, nor has a
Cartesian layout), for they are errors against a solution that does not. It cannot see that a real ring, kicked, might
leave this motion if that were unstable: nothing here depends on the angle. Nor, as everywhere, an error in b, in the
initial velocity or in the law of the material.
"""

import numpy as np
import taichi as ti

from solvers.estimators import companion_solution as shared
from solvers.kernels.dtypes import integers, octets, pairs, quads, reals
from solvers.problems.planar.estimators.companion import store_errors
from solvers.problems.planar.method.material_laws import cauchy_stress_of, coefficients, piola, wave_stiffness
from solvers.problems.planar.method.tensor_rotation import rotate_tensor, rotate_vector
from solvers.problems.planar.particle_layout import particle_layout
from solvers.solver import separable_field_tables
from solvers.solver.separable_field_tables import compute_force_time_functions, pack_tables, pad_to_mode_pairs


@ti.func
def accelerate(body: ti.template(), t, on: ti.template()):
    """Writes the nodes' accelerations (m/s^2) at the trial displacement and t s to layer WORK, zero before."""
    N, order = body.companion_counts[shared.NODES], body.companion_counts[shared.ORDER]
    stiffest = 1.0
    for e in range(body.companion_counts[shared.ACROSS]):
        stiffest = ti.max(stiffest, element_forces(body, e * order, on))
    body.companion_numbers[shared.STIFFEST] = stiffest
    compute_force_time_functions(body.companion_force, body.companion_force_sizes, body.angular_frequency * t, on)
    for i in range(N):
        work = shared.WORK * N + i
        force = separable_field_tables.body_force_at(body.companion_force, body.companion_force_sizes, i, on)
        for c in ti.static(range(2)):
            a = body.companion_nodes[work][6 + c] * body.companion_nodes[work][2 + c]
            body.companion_nodes[work][2 + c] = a + force[c]


@ti.func
def element_forces(body: ti.template(), first, on: ti.template()):
    """Subtracts the internal forces of the element from node ``first`` on from its nodes; returns the stiffness of its
    stiffest waves, along the radius, over lambda + 2 mu, at least 1. |F^-T e_R| = |F e_Theta|/J."""
    n = body.companion_counts[shared.ORDER] + 1
    trial = shared.WORK * body.companion_counts[shared.NODES] + first
    at_rest, stiffest = body.lame_modulus + 2 * body.shear_modulus, 1.0
    for k in range(n):
        slope = ti.Vector([0.0, 0.0])
        for i in range(n):
            d = body.companion_matrices[k * n + i][0]
            for c in ti.static(range(2)):
                slope[c] += d * body.companion_nodes[trial + i][c]
        R, w = body.companion_radii[first + k], body.companion_matrices[k * n][1]
        u = ti.Vector([body.companion_nodes[trial + k][0], body.companion_nodes[trial + k][1]])
        along, around = polar_gradient(slope, u, R)
        F = ti.Vector([along[0], around[0], along[1], around[1]])
        J, q, r, A, x = coefficients(body, F, on)
        stiffness = wave_stiffness(q, r, A, x, along.dot(along), around.dot(around) / (J * J))
        stiffest = ti.max(stiffest, stiffness / at_rest)
        P = piola(F, q, (r - q) / J)
        radial, hoop = w * R * ti.Vector([P[0], P[2]]), w * ti.Vector([P[1], P[3]])  # P e_R, P e_Theta
        body.companion_nodes[trial + k][2] = body.companion_nodes[trial + k][2] - hoop[1]
        body.companion_nodes[trial + k][3] = body.companion_nodes[trial + k][3] + hoop[0]
        for i in range(n):
            d = body.companion_matrices[k * n + i][0]
            for c in ti.static(range(2)):
                body.companion_nodes[trial + i][2 + c] = body.companion_nodes[trial + i][2 + c] - d * radial[c]
    return stiffest


@ti.func
def polar_gradient(slope, u, R):
    """Returns F e_R and F e_Theta in the frame (e_R, e_Theta) of the point at rest, from u' (``slope``), u and R."""
    return ti.Vector([1 + slope[0], slope[1]]), ti.Vector([-u[1], R + u[0]]) / R


@ti.func
def report(body: ti.template(), base, step, on: ti.template()):
    """Writes every particle's error after ``step`` steps, computed minus the companion's, to the ``estimate`` arrays
    from entry ``base`` on; the companion is evaluated once for all particles of a radius."""
    shared.interpolate_nodes_in_time(body, step)
    report_at_once(body, base, step, on)


@ti.func
def report_at_once(body: ti.template(), base, step, on: ti.template()):
    """Writes every particle's error as :func:`report`, from nodes that are at ``step`` already, as on a GPU."""
    n = body.companion_counts[shared.ORDER] + 1
    for k in range(body.orbits):
        now = shared.NOW * body.companion_counts[shared.NODES] + body.companion_first[k]
        circle = ti.Vector([0.0] * 8)  # u, v, a, u'
        for i in range(n):
            basis = body.companion_basis[k * n + i]
            for c in ti.static(range(6)):
                circle[c] += basis[0] * body.companion_nodes[now + i][c]
            for c in ti.static(range(2)):
                circle[6 + c] += basis[1] * body.companion_nodes[now + i][c]
        body.companion_circles[k] = circle
        slope, u = ti.Vector([circle[6], circle[7]]), ti.Vector([circle[0], circle[1]])
        along, around = polar_gradient(slope, u, body.orbit_point[k][0])
        sigma = cauchy_stress_of(body, ti.Vector([along[0], around[0], along[1], around[1]]), on)
        body.companion_circle_stress[k] = ti.Vector([sigma[0], sigma[1], sigma[2], 0.0])
    squares = 0.0
    for p in range(body.particles):
        squares += particle_error(body, base, p, step, on)
    body.companion_numbers[shared.SQUARE] = squares / body.particles


@ti.func
def particle_error(body: ti.template(), base, p, step, on: ti.template()):
    """Writes the estimated errors of particle p (:func:`store_errors`); returns the square of that of x, in m^2."""
    f, e, true = body.companion_circles[body.orbit[p]], body.direction[p], body.companion_circle_stress[body.orbit[p]]
    u, v, sigma = (rotate_vector(e, f[0], f[1]), rotate_vector(e, f[2], f[3]),
                   rotate_tensor(e, true[0], true[1], true[2]))
    return store_errors(body, base, p, step, ti.Vector([u[0], u[1], v[0], v[1]]), rotate_vector(e, f[4], f[5]), sigma,
                        on)


def allocate(scene) -> dict[str, np.ndarray]:
    """Returns the companion's arrays by name for a scene, undeformed and with the initial velocity."""
    solved = scene.companion_body(fine=None)
    elements, layout = solved.elements, particle_layout(scene)
    n, R = elements.order + 1, elements.node_coordinates
    element, *basis = elements.evaluate_basis(layout.orbits[:, 0])
    sizes, force = pack_tables(*map(pad_to_mode_pairs, solved.force[1:]))
    start = shared.initial_companion_arrays((elements.order, elements.count, 1, len(R), len(R), len(R)),
                                            solved.frequency_at_rest, scene.time_step, solved.velocity,
                                            solved.inverse_mass)
    return {**start, "companion_radii": R, "companion_first": (element * elements.order).astype(np.int32),
            "companion_matrices": np.stack([elements.derivative.ravel(), np.repeat(elements.weights, n)], axis=1),
            "companion_basis": np.stack(basis, axis=2).reshape(-1, 2),
            "companion_circles": np.zeros((len(layout.orbits), 8)), "companion_force_sizes": sizes,
            "companion_circle_stress": np.zeros((len(layout.orbits), 4)), "companion_force": force}


def verdict(scene, memory) -> str | None:
    """Returns why not to trust the companion's last report, as a sentence, or None; ``memory`` are arrays by name."""
    counts = memory["companion_counts"]
    order = counts[shared.ORDER]
    u = memory["companion_nodes"].reshape(-1, counts[shared.NODES], 8)[shared.NOW, :, :2]
    of_node = np.arange(counts[shared.ACROSS])[:, None] * order + np.arange(order + 1)
    return shared.why_not_trusted(u[of_node], (1,), memory["companion_numbers"][shared.SQUARE])


HOOKS = shared.hooks(
    accelerate, {
        # The layers of nodes are (4 N, 8), along e_R and e_Theta.
        "companion_radii": reals,  # of the nodes
        "companion_matrices": pairs,  # d/dR in an element, row by row, and at each row's point the weight
        "companion_first": integers,  # first node of the element of each circle of particles
        "companion_basis": pairs,  # the element's p + 1 polynomials there: value and slope
        "companion_circles": octets,  # u, v, a, u' at the particles' radii, for a report
        "companion_circle_stress": quads,  # the Cauchy stress there, as RR, R Theta, Theta Theta and nothing
        "companion_force": quads, "companion_force_sizes": integers,  # the tables of the body force at the nodes
    }, allocate=allocate, report=report, verdict=verdict, report_at_once=report_at_once,
    standalone=lambda scene: scene.companion_body(fine=None))
