"""The paper's estimator: transport the error with the method's own mappings.

Assumptions: the error is made where stress becomes acceleration (the quadratic Taylor term of the divergence
mapping, and for mappings that are not linearity preserving the constant and linear defects of eq 46), and is
carried on by eqs 12 and 20-28. It does not see interpolation errors of the velocity or errors in time, and it
drops second-order terms, so it is right in order and not in size: the paper's own indices run from 0.14 to 5.3
on the bar. Error means computed minus exact, at a fixed particle.
"""

import numpy as np
import taichi as ti

from solvers.estimators.transport_validity import why_not_trusted
from solvers.kernels.dtypes import octets, quads, real, reals
from solvers.problems.bar.method import periodic_nodes
from solvers.scene.estimator_hooks import EstimatorHooks

WAVE_CFL = 0.7  # H c/h where the bar is most stretched; the method itself is stable to 0.8 and more
MOST_INTERVAL = 10  # steps of the run between two of the estimator's


@ti.func
def in_step(bar: ti.template(), base, on: ti.template()):
    """Advances the estimated errors Ex, Ev, Esigma by H = k dt and reports Ea, between the node update and the particle
    update, in ``bar.estimate`` from entry ``base`` on. ``on``: compile-time options.

    The error varies over the time a wave takes through a cell, not over a step, so it is advanced every k steps
    (``interval``) with that step's own weights.

    With sigma_x = a_int m_i/V_i and sigma_xx from central differences of it, per node

        Ea_i = (V_i/m_i) [ sum D (Esigma + sigma EF/F) + q2 sigma_xx/2 + (q0 sigma_i + (q1 - 1) sigma_x) ],

    q_k = sum D (x_p - x_i)^k, where the last bracket vanishes for a linearity-preserving D (eqs 12, 46); then

        Ev += H sum S Ea_i;  Ex += H sum S Ev_i  (eqs 20-28, with the velocity that moves the particles: the
        grid's, or the particle's own where eq 24 is taken as printed);
        EF += H (L EF + F (sum dS Ev_i + v_xx/2 sum dS (x_i - x_p)^2));  Esigma = E EF.
    """
    sum_errors_at_nodes(bar, base, on)
    compute_nodal_stress_slopes(bar, on)
    compute_node_errors(bar, on)
    advance_particle_errors(bar, base, on)


@ti.func
def sum_errors_at_nodes(bar: ti.template(), base, on: ti.template()):
    """Computes sums over particles of S Ev, D* source, S source and D* r^2 in ``bar.transport_nodes``, from
    ``bar.estimate`` at ``base``; source = Esigma + sigma EF/F. ``on``: compile-time options.

    Also S r^2 for a mapping that preserves linearity, whose step has gathered its other moments; otherwise the moments
    D*, D* r, S sigma and S F V0, the last for V_i.
    """
    for i in range(bar.cells + periodic_nodes.GHOSTS):
        bar.transport_nodes[i] = ti.Vector([0.0] * 8)
    for p in range(bar.particles):
        S, dS = periodic_nodes.stencil_of(bar, p)
        i = bar.first_node[p]
        F = bar.deformation_gradient[p]
        error = bar.estimate[base + p]
        strain = F - bar.unstretched
        source = error[2] + strain * error[2] / F  # Esigma + sigma EF/F of eq 12: EF = Esigma/E, sigma = E strain
        r, volume, rest = periodic_nodes.offset_from_first_node(bar, p), F * bar.volume, 0.0
        if ti.static(not on.linearity_preserving):
            rest = 1.0
        by_weight = ti.Vector([error[1], 0.0, source, 0.0, 0.0, 0.0, rest * bar.modulus * strain, rest * volume])
        for k in ti.static(range(3)):
            r_k = r - k * bar.spacing
            by_gradient = ti.Vector([0.0, source, 0.0, r_k * r_k, rest, rest * r_k, 0.0, 0.0])
            sums = S[k] * by_weight - (volume * dS[k]) * by_gradient
            if ti.static(on.linearity_preserving):
                sums[4] = S[k] * r_k * r_k
            bar.transport_nodes[i + k] += sums
    periodic_nodes.add_periodic_images(bar.transport_nodes, bar.cells)


@ti.func
def current_node_volume(bar: ti.template(), i, on: ti.template()):
    """Returns V_i, node i's share of current volume, in m (per unit cross-section). ``on``: compile-time options."""
    volume = 0.0
    if ti.static(on.linearity_preserving):
        volume = bar.node_volume[i]
    else:
        volume = bar.transport_nodes[i][7]
    return volume


@ti.func
def compute_nodal_stress_slopes(bar: ti.template(), on: ti.template()):
    """Stores nodal d(sigma)/dx in Pa/m by the step's force in ``bar.transport_slope``. ``on``: compile-time options."""
    for i in range(1, bar.cells + 1):
        volume = ti.max(current_node_volume(bar, i, on), periodic_nodes.EMPTY * bar.spacing)
        bar.transport_slope[i] = periodic_nodes.node_internal_force(bar, i, on) / volume
    periodic_nodes.copy_to_periodic_images(bar.transport_slope, bar.cells)


@ti.func
def compute_node_errors(bar: ti.template(), on: ti.template()):
    """Stores the errors Ea_i of acceleration, and of velocity after the step, Ev_i = sum S Ev/sum S + dt Ea_i, at nodes
    in ``bar.transport_errors``, in SI, and adds to ``bar.transport_squares``. ``on``: compile-time options."""
    for i in range(1, bar.cells + 1):
        weight = bar.node_sums[i][0]
        Ea, Ev = 0.0, 0.0
        left, right = bar.node_motion[i - 1][0], bar.node_motion[i + 1][0]
        v_xx = (left - 2 * bar.node_motion[i][0] + right) / bar.spacing**2
        if weight > periodic_nodes.EMPTY:
            sums = bar.transport_nodes[i]
            sigma_x = bar.transport_slope[i]
            sigma_xx = (bar.transport_slope[i + 1] - bar.transport_slope[i - 1]) / (2 * bar.spacing)
            mean, scale, spread = 0.0, 1.0, 0.0
            moments = ti.Vector([sums[4], sums[5], 0.0, sums[6]])
            if ti.static(on.linearity_preserving):
                mean, scale = periodic_nodes.divergence_mapping_factors(bar, i, on)
                moments, spread = bar.node_moments[i], sums[4]
            constant = (moments[0] - mean * weight) * moments[3] / weight  # (sum D) f_i of eq 46
            first = (moments[1] - mean * moments[2]) * scale
            linear = (first - current_node_volume(bar, i, on)) * sigma_x  # (sum D r - 1) a_i
            quadratic = (sums[3] - mean * spread) * 0.5 * sigma_xx  # C h^k of eq 12
            fed_back = sums[1] - mean * sums[2]  # sum D (Esigma F + sigma EF) V0 of eq 12
            mass = bar.density * bar.volume * weight
            Ea = ((fed_back + quadratic + constant) * scale + linear) / mass  # eq 12
            Ev = sums[0] / weight + bar.transport_dt * Ea  # eq 21 at the node
            internal = current_node_volume(bar, i, on) * sigma_x / mass
            bar.transport_squares[0] += mass * Ea**2
            bar.transport_squares[1] += mass * internal**2
        bar.transport_errors[i] = ti.Vector([Ev, Ea, v_xx, bar.node_motion[i][0]])
    periodic_nodes.copy_to_periodic_images(bar.transport_errors, bar.cells)


@ti.func
def advance_particle_errors(bar: ti.template(), base, on: ti.template()):
    """Advances Ex, Ev, Esigma in ``bar.estimate`` from ``base`` on with the step's weights, and stores Ea with them.
    ``on``: compile-time options."""
    for p in range(bar.particles):
        S, dS = periodic_nodes.stencil_of(bar, p)
        i = bar.first_node[p]
        F = bar.deformation_gradient[p]
        r = periodic_nodes.offset_from_first_node(bar, p)
        at_particle, slope = ti.Vector([0.0] * 4), ti.Vector([0.0] * 4)  # Ev, Ea, v_xx and v of the nodes
        second = 0.0
        for k in ti.static(range(3)):
            node = bar.transport_errors[i + k]
            at_particle += S[k] * node
            slope += dS[k] * node
            second += dS[k] * (r - k * bar.spacing) ** 2
        error = bar.estimate[base + p]
        Ev = error[1] + bar.transport_dt * at_particle[1]  # eqs 21, 22: Ev += dt sum S Ea_i
        moving = at_particle[0]
        if ti.static(on.velocity == "particle"):
            moving = Ev
        EF = error[2] / bar.modulus
        EF += bar.transport_dt * (slope[3] * EF + F * (slope[0] + 0.5 * at_particle[2] * second))
        Ex = error[0] + bar.transport_dt * moving  # eqs 25, 27: Ex += dt Ev, in steps of H
        bar.estimate[base + p] = ti.Vector([Ex, Ev, bar.modulus * EF, at_particle[1]])


def interval(scene):
    """Returns the run's steps per step of the estimator: as many as keep the feedback stable, which is a wave like the
    motion's own and no faster than c in the most stretched cell; only numbers that divide the sample interval, or the
    steps of a shorter run."""
    fastest = scene.courant_number * (1 + scene.size_of("sigma") / scene.modulus)
    most = max(1, min(MOST_INTERVAL, int(WAVE_CFL / fastest)))
    return max(k for k in range(1, most + 1) if min(scene.sample_interval, scene.steps) % k == 0)


def allocate(scene):
    """Returns the estimator's nodal arrays at the start, by name, with entries for the periodic images."""
    N = scene.cells + periodic_nodes.GHOSTS
    return {"transport_dt": interval(scene) * scene.time_step, "transport_squares": np.zeros(2),
            "transport_nodes": np.zeros((N, 8)), "transport_slope": np.zeros(N), "transport_errors": np.zeros((N, 4))}


def verdict(scene, memory):
    """Returns a sentence why the estimate is not to be trusted, or None; ``memory`` has the estimator's arrays."""
    return why_not_trusted(memory["transport_squares"])


HOOKS = EstimatorHooks(memory={
    "transport_dt": real,  # H = k dt
    "transport_squares": reals,  # sums over nodes and steps of m Ea^2 and m a^2, a by the stress alone
    # Sums of S Ev, D* source, S source, D* r^2, and D*, D* r, S sigma, S F V0; or S r^2 and nothing.
    "transport_nodes": octets,
    "transport_slope": reals,  # d(sigma)/dx as the step saw it
    "transport_errors": quads,  # nodal errors of v and a, v_xx, v
}, allocate=allocate, interval=interval, in_step=in_step, verdict=verdict)
