"""The companion on the vortex (see ``solvers.estimators.companion``): its space, and what it says of each particle.

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

from solvers.estimators import companion as shared
from solvers.kernels.elementary import log
from solvers.kernels.kinds import integers, octets, pairs, quads
from solvers.problems.planar.layout import particle_layout
from solvers.problems.planar.method.neo_hookean import cauchy_stress
from solvers.problems.vortex import exact
from solvers.problems.vortex.estimators import companion_mesh
from solvers.problems.vortex.method.material import force_at


@ti.func
def accelerate(vortex: ti.template(), t, on: ti.template()):
    """Accelerations of the nodes at the trial displacement and time t, where they are zero at first."""
    N, order = vortex.companion_counts[shared.NODES], vortex.companion_counts[shared.ORDER]
    stiffest = 1.0
    for e in range(vortex.companion_counts[shared.ACROSS]):
        stiffest = ti.max(stiffest, element_forces(vortex, e * order))
    vortex.companion_numbers[shared.STIFFEST] = stiffest
    for i in range(N):
        work = shared.WORK * N + i
        force = ti.Vector([0.0, 0.0])
        if ti.static(on.body_force != "none"):
            force = force_at(vortex, vortex.companion_radii[i], t, on)
        for c in ti.static(range(2)):
            a = vortex.companion_nodes[work][6 + c] * vortex.companion_nodes[work][2 + c]
            vortex.companion_nodes[work][2 + c] = a + force[c]


@ti.func
def element_forces(vortex: ti.template(), first):
    """Take the internal forces of the element from node ``first`` on from its nodes.

    Returns its stiffest tangent over lambda + 2 mu. Waves run along the radius, and the largest eigenvalue of their
    tangent is mu + (lambda + mu - lambda ln J) |F^-T e_R|^2, |F^-T e_R| = |F e_Theta|/J: 1 in any vortex with J = 1.
    """
    n = vortex.companion_counts[shared.ORDER] + 1
    trial = shared.WORK * vortex.companion_counts[shared.NODES] + first
    mu, lam = vortex.shear_modulus, vortex.lame_modulus
    stiffest = 1.0
    for k in range(n):
        slope = ti.Vector([0.0, 0.0])
        for i in range(n):
            d = vortex.companion_matrices[k * n + i][0]
            for c in ti.static(range(2)):
                slope[c] += d * vortex.companion_nodes[trial + i][c]
        R, w = vortex.companion_radii[first + k][0], vortex.companion_matrices[k * n][1]
        u = ti.Vector([vortex.companion_nodes[trial + k][0], vortex.companion_nodes[trial + k][1]])
        along, around = polar_gradient(slope, u, R)
        J = along[0] * around[1] - along[1] * around[0]
        volumetric = lam * ti.log(J)
        stiffest = ti.max(stiffest, (mu + (lam + mu - volumetric) * around.dot(around) / (J * J)) / (lam + 2 * mu))
        # F^-T e_R is F e_Theta turned by -90 degrees over J, F^-T e_Theta is F e_R turned by 90 degrees over J.
        back = (volumetric - mu) / J
        radial = w * R * ti.Vector([mu * along[0] + back * around[1], mu * along[1] - back * around[0]])  # P e_R
        hoop = w * ti.Vector([mu * around[0] - back * along[1], mu * around[1] + back * along[0]])  # P e_Theta
        vortex.companion_nodes[trial + k][2] = vortex.companion_nodes[trial + k][2] - hoop[1]
        vortex.companion_nodes[trial + k][3] = vortex.companion_nodes[trial + k][3] + hoop[0]
        for i in range(n):
            d = vortex.companion_matrices[k * n + i][0]
            for c in ti.static(range(2)):
                vortex.companion_nodes[trial + i][2 + c] = vortex.companion_nodes[trial + i][2 + c] - d * radial[c]
    return stiffest


@ti.func
def polar_gradient(slope, u, R):
    """F e_R and F e_Theta in the frame (e_R, e_Theta) of the particle at rest, from u' and u."""
    return ti.Vector([1 + slope[0], slope[1]]), ti.Vector([-u[1], R + u[0]]) / R


@ti.func
def report(vortex: ti.template(), base, step, on: ti.template()):
    """Every particle's error at ``step``: computed minus the companion's, at its material point; the companion is read
    once for all particles of a radius."""
    shared.read_nodes(vortex, step)
    report_at_once(vortex, base, step, on)


@ti.func
def report_at_once(vortex: ti.template(), base, step, on: ti.template()):
    """The same with nodes that are at ``step`` already, as on a GPU."""
    n = vortex.companion_counts[shared.ORDER] + 1
    for k in range(vortex.radius_count):
        now = shared.NOW * vortex.companion_counts[shared.NODES] + vortex.companion_first[k]
        circle = ti.Vector([0.0] * 8)  # u, v, a, u'
        for i in range(n):
            basis = vortex.companion_basis[k * n + i]
            for c in ti.static(range(6)):
                circle[c] += basis[0] * vortex.companion_nodes[now + i][c]
            for c in ti.static(range(2)):
                circle[6 + c] += basis[1] * vortex.companion_nodes[now + i][c]
        vortex.companion_circles[k] = circle
    squares = 0.0
    for p in range(vortex.particles):
        squares += particle_error(vortex, base, p, step, on)
    vortex.companion_numbers[shared.SQUARE] = squares / vortex.particles


@ti.func
def particle_error(vortex: ti.template(), base, p, step, on: ti.template()):
    """Errors of x and v, of the Cauchy stress and of a at a particle. Returns the square of that of x."""
    f, e = vortex.companion_circles[vortex.radius[p]], vortex.direction[p]
    X, q = vortex.material_position[p], vortex.position_velocity[p]
    u, v = turned(e, f[0], f[1]), turned(e, f[2], f[3])
    error = ti.Vector([q[0] - X[0] - u[0], q[1] - X[1] - u[1], q[2] - v[0], q[3] - v[1]])
    vortex.estimate[base + p] = error
    sigma, true = cauchy_stress(vortex, p), circle_stress(vortex, f, vortex.radii[vortex.radius[p]][0])
    c, s = e[0], e[1]
    mean, half, shear = 0.5 * (true[0] + true[2]), 0.5 * (true[0] - true[2]), true[1]
    along, across = half * (c * c - s * s) - 2 * shear * c * s, 2 * half * c * s + shear * (c * c - s * s)
    vortex.estimate_stress[base + p] = ti.Vector([sigma[0] - mean - along, sigma[1] - across,
                                                  sigma[2] - mean + along, 0.0])
    a = ti.Vector([ti.math.nan, ti.math.nan])
    if ti.static(on.acceleration):  # before the first step none has been computed, and so none can be wrong
        a = vortex.acceleration[p] - turned(e, f[4], f[5]) if step > 0 else ti.Vector([0.0, 0.0])
    vortex.estimate_acceleration[base + p] = a
    return error[0] * error[0] + error[1] * error[1]


@ti.func
def turned(e, along, around):
    """along e_R + around e_Theta."""
    return ti.Vector([along * e[0] - around * e[1], along * e[1] + around * e[0]])


@ti.func
def circle_stress(vortex: ti.template(), f, R):
    """sigma = lambda ln J/J I + mu/J (F F^T - I) of a circle (u, v, a, u'), as RR, Rt, tt of the frame at rest."""
    along, around = polar_gradient(ti.Vector([f[6], f[7]]), ti.Vector([f[0], f[1]]), R)
    per_J = 1 / (along[0] * around[1] - along[1] * around[0])
    mu, bulk = vortex.shear_modulus * per_J, -vortex.lame_modulus * log(per_J) * per_J
    return ti.Vector([mu * (along[0] * along[0] + around[0] * around[0] - 1) + bulk,
                      mu * (along[0] * along[1] + around[0] * around[1]),
                      mu * (along[1] * along[1] + around[1] * around[1] - 1) + bulk])


def allocate(scene) -> dict[str, np.ndarray]:
    """The companion at rest, moving with the initial velocity."""
    elements = companion_mesh.mesh()
    n, R, radii = elements.order + 1, elements.nodes, particle_layout(scene).radii
    lam, mu = exact.lame(scene)
    frequency = np.sqrt((lam + 2 * mu) / scene.density) * companion_mesh.unit_frequency(elements)
    inverse_mass = np.repeat(1 / (scene.density * companion_mesh.masses(elements))[:, None], 2, axis=1)
    element, *basis = elements.locate(radii)
    return {
        **shared.start((elements.order, elements.count, 1, len(R), len(R), len(R)), frequency, scene.time_step,
                       exact.velocity(scene, exact.on_axis(R), 0.0), inverse_mass),
        "companion_radii": np.stack([R, *exact.shape(R)], axis=1),
        "companion_matrices": np.stack([elements.derivative.ravel(), np.repeat(elements.weights, n)], axis=1),
        "companion_first": (element * elements.order).astype(np.int32),
        "companion_basis": np.stack(basis, axis=2).reshape(-1, 2), "companion_circles": np.zeros((len(radii), 8))}


def standalone(scene) -> companion_mesh.VortexCompanionBody:
    """The same solve by itself, on the same elements."""
    elements = companion_mesh.mesh()
    return companion_mesh.VortexCompanionBody(scene, elements.count, elements.order)


def verdict(scene, memory) -> str | None:
    """Why not to trust what was reported last."""
    elements = companion_mesh.mesh()
    u = memory["companion_nodes"].reshape(-1, len(elements.nodes), 8)[shared.NOW, :, :2]
    return shared.doubt(u[elements.of_node], (1,), memory["companion_numbers"][shared.SQUARE])


HOOKS = shared.hooks(
    accelerate, {
        # The layers of nodes are (4 N, 8), along e_R and e_Theta.
        "companion_radii": quads,  # R, h, h', h'' at the nodes
        "companion_matrices": pairs,  # d/dR in an element, row by row, and at each row's point the weight
        "companion_first": integers,  # first node of the element of each material radius of particles
        "companion_basis": pairs,  # the element's p + 1 polynomials there: value and slope
        "companion_circles": octets,  # u, v, a, u' at the particles' radii, for a report
    },
    allocate=allocate, report=report, verdict=verdict, standalone=standalone, report_at_once=report_at_once)
