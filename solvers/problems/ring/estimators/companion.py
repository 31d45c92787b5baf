"""The companion on the ring (see ``solvers.estimators.companion``): its space, and what it says of each particle.

Elements are products of intervals in R and theta under the exact map X = R (cos theta, sin theta), so that nothing but
the polynomials is approximate; the unknowns are Cartesian displacements, and no radial symmetry is assumed. With
grad u = u_R e_R + u_theta/R e_theta, F = I + grad u and P = mu (F - F^-T),

    m_i a_i = m_i b_i - sum_q w_q R_q [P e_R . phi_i,R + P e_theta . phi_i,theta/R],  m_i = rho w_i R_i,

which leaves both rims free of traction; u_y = 0 on theta = 0 and u_x = 0 on theta = pi/2.
"""

import numpy as np
import taichi as ti

from solvers.estimators import companion as shared
from solvers.kernels import runtime
from solvers.kernels.kinds import integer_quads, pairs, quads
from solvers.problems.planar.estimators.companion import element_forces, line_node, reduce_to_line
from solvers.problems.ring import exact
from solvers.problems.ring.estimators import companion_mesh
from solvers.problems.ring.method.material import kirchhoff_stress, radial_force_at


@ti.func
def accelerate(ring: ti.template(), t, on: ti.template()):
    """Accelerations of the nodes at the trial displacement and time t, where they are zero at first."""
    row = ring.companion_counts[shared.ROW]
    stiffest = 1.0
    for across in range(ring.companion_counts[shared.ACROSS]):
        for around in range(ring.companion_counts[shared.AROUND]):
            corner = ring.companion_counts[shared.ORDER] * (across * row + around)
            stiffest = ti.max(stiffest, element_stresses(ring, corner))
            element_forces(ring, corner)
    ring.companion_numbers[shared.STIFFEST] = stiffest
    for k in range(ring.companion_counts[shared.RADII]):
        force = 0.0
        if ti.static(on.body_force != "none"):
            force = radial_force_at(ring, ring.companion_radii[k], t, on)
        for j in range(row):
            i = shared.WORK * ring.companion_counts[shared.NODES] + k * row + j
            for c in ti.static(range(2)):
                a = ring.companion_nodes[i][6 + c] * ring.companion_nodes[i][2 + c]
                ring.companion_nodes[i][2 + c] = a + force * ring.companion_directions[j][c]


@ti.func
def element_stresses(ring: ti.template(), corner):
    """Keep w R P e_R and w P e_theta at the points of the element from node ``corner`` on.

    Returns its stiffest tangent over 2 mu: the largest eigenvalue of dP/dF is mu (1 + 1/s^2), s the least stretch.
    """
    n, row = ring.companion_counts[shared.ORDER] + 1, ring.companion_counts[shared.ROW]
    trial = shared.WORK * ring.companion_counts[shared.NODES] + corner
    for i in range(n):
        for j in range(n):
            node = trial + i * row + j
            ring.companion_trial[i * n + j] = ti.Vector([ring.companion_nodes[node][0], ring.companion_nodes[node][1]])
    stiffest = 1.0
    for i in range(n):
        R = ring.companion_radii[corner // row + i][0]
        for j in range(n):
            u_R, u_t = ti.Vector([0.0, 0.0]), ti.Vector([0.0, 0.0])
            for k in range(n):
                u_R += ring.companion_matrices[i * n + k][0] * ring.companion_trial[k * n + j]
                u_t += ring.companion_matrices[j * n + k][1] * ring.companion_trial[i * n + k]
            e = ring.companion_directions[corner % row + j]
            f_R = e + u_R  # F e_R
            f_t = ti.Vector([-e[1], e[0]]) + u_t / R  # F e_theta
            per_J = 1 / (f_R[0] * f_t[1] - f_R[1] * f_t[0])
            # 1/s^2 is the larger root of z^2 - (F:F/J^2) z + 1/J^2 = 0.
            half = 0.5 * (f_R.dot(f_R) + f_t.dot(f_t)) * per_J * per_J
            stiffest = ti.max(stiffest, 0.5 * (1 + half + ti.sqrt(ti.max(half * half - per_J * per_J, 0.0))))
            # F^-T e_R is F e_theta turned by -90 degrees over J, F^-T e_theta is F e_R turned by 90 degrees over J.
            w = ring.shear_modulus * ring.companion_matrices[i * n + j][2]
            ring.companion_stresses[i * n + j] = w * ti.Vector([
                R * (f_R[0] - f_t[1] * per_J), R * (f_R[1] + f_t[0] * per_J),
                f_t[0] + f_R[1] * per_J, f_t[1] - f_R[0] * per_J])
    return stiffest


@ti.func
def report(ring: ti.template(), base, step, on: ti.template()):
    """Every particle's error at ``step``: computed minus the companion's, at its material point. Along each radius of
    particles that is first reduced to one arc of nodes, then read there at each particle's angle."""
    shared.read_nodes(ring, step)
    squares = 0.0
    for k in range(ring.radius_count):
        reduce_to_line(ring, k)
        for place in range(ring.companion_places[k][0], ring.companion_places[k + 1][0]):
            squares += particle_error(ring, base, ring.companion_places[place], step, on)
    ring.companion_numbers[shared.SQUARE] = squares / ring.particles


@ti.func
def report_at_once(ring: ti.template(), base, step, on: ti.template()):
    """The same on a GPU, whose nodes are at ``step`` already; each particle reads its own part of its arc."""
    squares = 0.0
    for n in range(ring.particles):
        squares += particle_error(ring, base, ring.companion_places[ring.radius_count + 1 + n], step, on)
    ring.companion_numbers[shared.SQUARE] = squares / ring.particles


@ti.func
def particle_error(ring: ti.template(), base, place, step, on: ti.template()):
    """Errors of x and v, of the Cauchy stress and of a at a particle, whose ``place`` is (p, first node of its arc,
    first of its polynomials). Returns the square of that of x."""
    p = place[0]
    f = ti.Vector([0.0] * 8)  # u, v, a, u_R
    turn = ti.Vector([0.0, 0.0])  # u_theta/R
    for j in range(ring.companion_counts[shared.ORDER] + 1):
        arc, basis = place[1] + j, ring.companion_basis[place[2] + j]
        if ti.static(runtime.on_processor()):
            value = ring.companion_nodes[arc]
            f += basis[0] * value
            turn += basis[1] * ti.Vector([value[0], value[1]])
        else:  # particles of many radii are at work, and there is room for one arc
            value = line_node(ring, ring.radius[p], arc - shared.LAYERS * ring.companion_counts[shared.NODES])
            f += basis[0] * value
            turn += basis[1] * ti.Vector([value[0], value[1]])
    turn /= ring.radii[ring.radius[p]][0]
    e, X, q = ring.direction[p], ring.material_position[p], ring.position_velocity[p]
    xx, xy = 1 + f[6] * e[0] - turn[0] * e[1], f[6] * e[1] + turn[0] * e[0]  # F = I + u_R e_R + u_theta/R e_theta
    yx, yy = f[7] * e[0] - turn[1] * e[1], 1 + f[7] * e[1] + turn[1] * e[0]
    per = ring.shear_modulus / (xx * yy - xy * yx)
    F = ring.deformation_gradient[p]
    sigma = kirchhoff_stress(ring, p) / (F[0] * F[3] - F[1] * F[2])
    error = ti.Vector([q[0] - X[0] - f[0], q[1] - X[1] - f[1], q[2] - f[2], q[3] - f[3]])
    ring.estimate[base + p] = error
    ring.estimate_stress[base + p] = ti.Vector([sigma[0] - per * (xx * xx + xy * xy - 1),
                                                sigma[1] - per * (xx * yx + xy * yy),
                                                sigma[2] - per * (yx * yx + yy * yy - 1), 0.0])
    a = ti.Vector([ti.math.nan, ti.math.nan])
    if ti.static(on.acceleration):  # before the first step none has been computed, and so none can be wrong
        a = ring.acceleration[p] - ti.Vector([f[4], f[5]]) if step > 0 else ti.Vector([0.0, 0.0])
    ring.estimate_acceleration[base + p] = a
    return error[0] * error[0] + error[1] * error[1]


def allocate(scene) -> dict[str, np.ndarray]:
    """The companion at rest, moving with the initial velocity."""
    radial, angular = companion_mesh.mesh(scene.cells)
    n, R, e = radial.order + 1, radial.nodes, companion_mesh.directions(angular)
    X = (R[:, None, None] * e).reshape(-1, 2)
    masses = np.outer(radial.assembled_weights * R, angular.assembled_weights)  # w_i R_i, for a density of 1
    inverse_mass = companion_mesh.free(radial, angular) / (scene.density * masses[..., None])
    frequency = scene.wave_speed * companion_mesh.unit_frequency(radial, angular)
    basis, places = companion_mesh.read_particles(scene, radial, angular)
    weights = np.outer(radial.weights, angular.weights)
    matrices = np.stack([radial.derivative, angular.derivative, weights, np.zeros((n, n))], axis=-1)
    return {
        **shared.start((radial.order, radial.count, angular.count, len(e), len(X), len(R)), frequency, scene.time_step,
                       exact.velocity(scene, X, 0.0), inverse_mass.reshape(-1, 2), len(e)),
        "companion_radii": np.stack([R, *exact.shape(R)], axis=1), "companion_directions": e,
        "companion_matrices": matrices.reshape(-1, 4), "companion_trial": np.zeros((n * n, 2)),
        "companion_stresses": np.zeros((n * n, 4)),
        "companion_basis": basis, "companion_places": places}


def standalone(scene) -> companion_mesh.RingCompanionBody:
    """The same solve by itself, on the same elements."""
    radial, angular = companion_mesh.mesh(scene.cells)
    return companion_mesh.RingCompanionBody(scene, radial.count, angular.count, radial.order)


def verdict(scene, memory) -> str | None:
    """Why not to trust what was reported last.

    Force and initial velocity are radial, and so is the exact motion; what the companion moves around the ring is
    error, and grows beyond bounds where the radial motion is unstable: from rounding, within 20 periods at A = 0.19.
    """
    radial, angular = companion_mesh.mesh(scene.cells)
    count = len(radial.nodes) * len(angular.nodes)
    u = memory["companion_nodes"][shared.NOW * count:(shared.NOW + 1) * count, :2]
    u = u.reshape(len(radial.nodes), len(angular.nodes), 2)
    elements = u[radial.of_node[:, None, :, None], angular.of_node[None, :, None, :]]
    around = u @ np.array([[0.0, 1.0], [-1.0, 0.0]]) * companion_mesh.directions(angular)
    known = float(np.sqrt(np.mean(np.sum(around, axis=-1) ** 2)))
    return shared.doubt(elements, (2, 3), memory["companion_numbers"][shared.SQUARE], known)


HOOKS = shared.hooks(
    accelerate, {
        # Behind the layers of nodes is one arc of u, v, a, u_R for a report: (4 N + row, 8).
        "companion_radii": quads,  # R, w, w', w'' at the radii of nodes
        "companion_directions": pairs,  # e_R at the angles of nodes
        "companion_matrices": quads,  # d/dR and d/dtheta in an element, row by row, and the weights of its points
        "companion_trial": pairs,  # u at the points of the element at work
        "companion_stresses": quads,  # w R P e_R and w P e_theta at the points of the element at work
        "companion_basis": pairs,  # see read_particles
        "companion_places": integer_quads,
    },
    allocate=allocate, report=report, verdict=verdict, standalone=standalone, report_at_once=report_at_once)
