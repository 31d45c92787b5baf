"""The paper's estimator in the plane: eqs 46-49, taken literally.

Per node, with D_x = -V dS/dx / V_i and the nodal stress f = sigma_xx in x, sigma_yy in y (over the nodal density, so
that its derivative is an acceleration),

    Ea_x = (sum D_x) f_x + (sum D_x (x_p - x_i) - 1) a_x     (46; in 47 the paper prints f_x where f_y is meant)
    Ev_p = dt sum S Ea                                       (48: not accumulated)
    Ex_p += dt Ev_p                                          (49)

a is the nodal acceleration's internal part, what the divergence of f stands for. Eq 46 measures how far the mapping is
from preserving constants and linear functions. At a free surface it is far by nature, for the weak form lets the
missing part be the traction; so the estimate does not fall with h and its index grows. Stress is not estimated.

Undeformed bodies have neither stress nor internal acceleration, so that Ea = 0 at first whatever a is. What a body with
a(0) != 0 misses because its velocity starts at t = 0 and not half a step before is no mapping defect, and not seen.
"""

import math

import numpy as np
import taichi as ti

from solvers.estimators.transport_validity import why_not_trusted
from solvers.kernels.dtypes import quads, real, reals
from solvers.problems.planar.method import cpdi, gimp
from solvers.problems.planar.method.stored_weights import stored_weight_entries
from solvers.problems.planar.problem_kernel_functions import ProblemStepFunctions
from solvers.scene.estimator_hooks import EstimatorHooks

MOST_INTERVAL = 20  # steps of the run between two of the estimator's

MEMORY = {
    "transport_dt": real,  # H = k dt
    "transport_squares": reals,  # sums over nodes and steps of m Ea^2 and m a^2, a by the stress alone
    "transport_stress": quads,  # sums of V S sigma_xx, V S sigma_yy, V S
    "transport_moments": quads,  # sums of D_x, D_y, D_x r_x, D_y r_y
    "transport_error": quads,  # nodal error of a, and two zeros
}


def hooks(traits: ProblemStepFunctions) -> EstimatorHooks:
    """Returns transport's hooks for the problem with the kernel functions ``traits``."""
    @ti.func
    def its_step(body: ti.template(), base, on: ti.template()):
        in_step(body, base, traits, on)

    return EstimatorHooks(memory=MEMORY, allocate=allocate, interval=interval, in_step=its_step, report=report,
                          verdict=verdict)


@ti.func
def in_step(body: ti.template(), base, traits: ti.template(), on: ti.template()):
    """Advances the estimates Ex by H = k dt and writes Ev and Ea, after the nodes of a step have moved."""
    sum_moments_at_nodes(body, traits, on)
    traits.fold(body, fold_pair)
    node_errors(body, traits)
    particle_errors(body, base, on)


@ti.func
def sum_moments_at_nodes(body: ti.template(), traits: ti.template(), on: ti.template()):
    """Sums V S (sigma_xx, sigma_yy, 1), V (-S_x, -S_y, -S_x r_x, -S_y r_y) and S times the body force at the nodes, in
    ``transport_stress``, ``transport_moments`` and ``transport_error``."""
    for j in range(body.active):
        for node in range(j * body.row, j * body.row + body.active):
            body.transport_stress[node], body.transport_moments[node] = ti.Vector([0.0] * 4), ti.Vector([0.0] * 4)
            body.transport_error[node] = ti.Vector([0.0] * 4)
    for p in range(body.particles):
        F = body.deformation_gradient[p]
        tau = traits.stress(body, p, on)
        rest = body.mass[p] / body.density
        volume = rest * (F[0] * F[3] - F[1] * F[2])
        stress = rest * ti.Vector([tau[0], tau[3], 0.0, 0.0])  # V sigma = V0 J sigma
        stress[2] = volume
        force = ti.Vector([0.0, 0.0])
        if ti.static(on.body_force != "none"):
            force = traits.body_force_on(body, p)
        if ti.static(on.method == "cpdi"):
            w, = ti.static([stored_weight_entries(body, p, on)])
            cells, g = cpdi.corner_cell_nodes(w), cpdi.stored_gradients(body, p, w, on)
            for c in ti.static(range(4)):
                N = cpdi.corner_hats(w, c)
                a, sign = ti.static(2 * (c % 2), 1.0 if c < 2 else -1.0)
                for k in ti.static(range(4)):
                    node = cells[c] + (k // 2) * body.row + k % 2
                    add_contribution(body, p, node, 0.25 * N[k], sign * g[a] * N[k], sign * g[a + 1] * N[k], volume,
                                     stress, force)
        else:
            S, dS, R, dR = gimp.stored_stencils(body, p, on)
            for j in ti.static(range(3)):
                for i in ti.static(range(3)):
                    node = body.first_node[p] + j * body.row + i
                    add_contribution(body, p, node, S[i] * R[j], dS[i] * R[j], S[i] * dR[j], volume, stress, force)


@ti.func
def add_contribution(body: ti.template(), p, node, S, S_x, S_y, volume, stress, force):
    """Adds particle p's part at a node to the sums of :func:`sum_moments_at_nodes`: its weight S and slopes S_x, S_y
    there, ``volume`` V, ``stress`` (V sigma_xx, V sigma_yy, V, 0) and body force; r = x_p - x_i."""
    r_x = body.position_velocity[p][0] - (node % body.row - body.origin) * body.spacing
    r_y = body.position_velocity[p][1] - (node // body.row - body.origin) * body.spacing
    body.transport_stress[node] = body.transport_stress[node] + S * stress
    body.transport_moments[node] = body.transport_moments[node] - volume * ti.Vector([S_x, S_y, S_x * r_x, S_y * r_y])
    body.transport_error[node] = body.transport_error[node] + S * ti.Vector([force[0], force[1], 0.0, 0.0])


@ti.func
def fold_pair(body: ti.template(), ghost, image, in_x, in_y):
    """Adds the sums of node ``ghost`` to its mirror ``image``; D and force take the signs ``in_x`` and ``in_y``."""
    moments, force = body.transport_moments[ghost], body.transport_error[ghost]
    body.transport_stress[image] = body.transport_stress[image] + body.transport_stress[ghost]
    body.transport_moments[image] = body.transport_moments[image] \
        + ti.Vector([in_x * moments[0], in_y * moments[1], moments[2], moments[3]])
    body.transport_error[image] = body.transport_error[image] + ti.Vector([in_x * force[0], in_y * force[1], 0.0, 0.0])


@ti.func
def node_errors(body: ti.template(), traits: ti.template()):
    """Writes Ea (m/s^2) to ``transport_error`` and adds to ``transport_squares``. The internal part of a is a minus the
    nodal mean of the body force."""
    for j in range(traits.first, body.active):
        for i in range(traits.first, body.active):
            node = j * body.row + i
            sums, moments, mass = body.transport_stress[node], body.transport_moments[node], body.node_mass[node]
            error = ti.Vector([0.0, 0.0, 0.0, 0.0])
            if mass > 0 and sums[2] > 0:
                motion, force = body.node_motion[node], body.transport_error[node]
                a = ti.Vector([motion[2] - force[0] / mass, motion[3] - force[1] / mass])
                # f over the nodal density: (sum V S sigma / V_i)/(m_i/V_i) = sum V S sigma / m_i.
                error[0] = moments[0] / sums[2] * sums[0] / mass + (moments[2] / sums[2] - 1) * a[0]  # eq 46
                error[1] = moments[1] / sums[2] * sums[1] / mass + (moments[3] / sums[2] - 1) * a[1]  # eq 47
                error = traits.pin(body, i, j, error)
                body.transport_squares[0] += mass * (error[0] ** 2 + error[1] ** 2)
                body.transport_squares[1] += mass * a.norm_sqr()
            body.transport_error[node] = error
    traits.mirror(body, body.transport_error)


@ti.func
def particle_errors(body: ti.template(), base, on: ti.template()):
    """Writes Ea and Ev of the particles to the estimate arrays from entry ``base`` on, and advances Ex there by H."""
    for p in range(body.particles):
        Ea = interpolate(body, p, on)
        Ev = body.dt * Ea  # eq 48
        before = body.estimate[base + p]
        half = 0.5 * body.transport_dt  # eq 49 in steps of H, by the trapezoidal rule
        body.estimate[base + p] = ti.Vector([before[0] + half * (before[2] + Ev[0]),
                                             before[1] + half * (before[3] + Ev[1]), Ev[0], Ev[1]])
        body.estimate_acceleration[base + p] = Ea


@ti.func
def interpolate(body: ti.template(), p, on: ti.template()):
    """Returns the nodal error of a (x, y), m/s^2, interpolated to particle p with the step's own weights."""
    total = ti.Vector([0.0, 0.0])
    if ti.static(on.method == "cpdi"):
        w, = ti.static([stored_weight_entries(body, p, on)])
        cells = cpdi.corner_cell_nodes(w)
        for c in ti.static(range(4)):
            N = cpdi.corner_hats(w, c)
            for k in ti.static(range(4)):
                error = body.transport_error[cells[c] + (k // 2) * body.row + k % 2]
                total += 0.25 * N[k] * ti.Vector([error[0], error[1]])
    else:
        S, _, R, _ = gimp.stored_stencils(body, p, on)
        for j in ti.static(range(3)):
            for i in ti.static(range(3)):
                error = body.transport_error[body.first_node[p] + j * body.row + i]
                total += S[i] * R[j] * ti.Vector([error[0], error[1]])
    return total


@ti.func
def report(body: ti.template(), base, step, on: ti.template()):
    """Sets the particles' estimated error of the stress to NaN, as unknown; other errors are always up to date."""
    for p in range(body.particles):
        body.estimate_stress[base + p] = ti.Vector([ti.math.nan] * 4)


def interval(scene):
    """Returns the run's steps per step of transport, at most ``MOST_INTERVAL``; samples come after whole ones, also the
    only one of a run that is shorter than the sample interval."""
    between = min(scene.sample_interval, scene.steps)
    return between // math.ceil(between / MOST_INTERVAL)


def verdict(scene, memory):
    """Returns why not to trust transport's estimate, as a sentence, or None; ``memory`` are its arrays by name."""
    return why_not_trusted(memory["transport_squares"])


def allocate(scene):
    """Returns transport's memory by name for a scene: its step in s, and nodal arrays of zeros."""
    nodes = scene.row**2
    return {"transport_dt": interval(scene) * scene.time_step, "transport_squares": np.zeros(2),
            "transport_stress": np.zeros((nodes, 4)),
            "transport_moments": np.zeros((nodes, 4)), "transport_error": np.zeros((nodes, 4))}
