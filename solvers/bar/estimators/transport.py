"""The paper's estimator: transport the error with the method's own mappings.

Assumptions: the error is made where stress becomes acceleration (the quadratic Taylor term of the divergence
mapping, and for mappings that are not linearity preserving the constant and linear defects of eq 46), and is
carried on by eqs 12 and 20-28. It does not see interpolation errors of the velocity or errors in time, and it
drops second-order terms, so it is right in order and not in size: the paper's own indices run from 0.14 to 5.3
on the bar. Error means computed minus exact, at a fixed particle.
"""

import numpy as np
import taichi as ti

from solvers.bar import nodes
from solvers.estimators.interface import EstimatorHooks
from solvers.estimators.transport import doubt
from solvers.kinds import quads, real, reals


@ti.func
def in_step(bar: ti.template(), base, on: ti.template()):
    """Advance Ex, Ev, Esigma by H = k dt and report Ea, between the node update and the particle update.

    The error varies over the time a wave takes through a cell, not over a step, so it is advanced every
    k = clamp(h/(2 c dt), 1, 10) steps with that step's own weights.

    With sigma_x = a_int m_i/V_i and sigma_xx from central differences of it, per node

        Ea_i = (V_i/m_i) [ sum D (Esigma + sigma EF/F) + q2 sigma_xx/2 + (q0 sigma_i + (q1 - 1) sigma_x) ],

    q_k = sum D (x_p - x_i)^k, where the last bracket vanishes for a linearity-preserving D (eqs 12, 46); then

        Ev += H sum S Ea_i;  Ex += H sum S Ev_i  (eqs 20-28, with the velocity that moves the particles: the
        grid's, or the particle's own where eq 24 is taken as printed);
        EF += H (L EF + F (sum dS Ev_i + v_xx/2 sum dS (x_i - x_p)^2));  Esigma = E EF.
    """
    if ti.static(not on.linearity_preserving):  # else the step has gathered them
        nodes.gather_moments(bar)
    gather_errors(bar, base)
    stress_slopes(bar, on)
    node_errors(bar, on)
    particle_errors(bar, base, on)


@ti.func
def gather_errors(bar: ti.template(), base):
    """Nodal sums of S Ev, D* source, S source, D* r^2 and S r^2; source = Esigma + sigma EF/F."""
    for i in range(bar.cells + nodes.GHOSTS):
        bar.transport_nodes[i] = ti.Vector([0.0, 0.0, 0.0, 0.0])
        bar.transport_spread[i] = 0.0
    for p in range(bar.particles):
        S, dS = nodes.stencil_of(bar, p)
        i = bar.first_node[p]
        F = bar.deformation_gradient[p]
        error = bar.estimate[base + p]
        source = error[2] + (F - 1) * error[2] / F  # Esigma + sigma EF/F of eq 12: EF = Esigma/E, sigma = E(F - 1)
        r = nodes.offset(bar, p)
        for k in ti.static(range(3)):
            D = -dS[k] * F * bar.volume
            square = (r - k * bar.spacing) ** 2
            bar.transport_nodes[i + k] += ti.Vector([S[k] * error[1], D * source, S[k] * source, D * square])
            bar.transport_spread[i + k] += S[k] * square
    nodes.fold(bar.transport_nodes, bar.cells)
    nodes.fold(bar.transport_spread, bar.cells)


@ti.func
def stress_slopes(bar: ti.template(), on: ti.template()):
    """sigma_x at the nodes, from the force that the step used."""
    for i in range(1, bar.cells + 1):
        bar.transport_slope[i] = nodes.node_force(bar, i, on) / ti.max(bar.node_volume[i], nodes.EMPTY * bar.spacing)
    nodes.spread(bar.transport_slope, bar.cells)


@ti.func
def node_errors(bar: ti.template(), on: ti.template()):
    """Ea_i and the nodal velocity error after the step, Ev_i = sum S Ev/sum S + dt Ea_i."""
    for i in range(1, bar.cells + 1):
        weight = bar.node_sums[i][0]
        Ea, Ev = 0.0, 0.0
        left, right = bar.node_motion[i - 1][0], bar.node_motion[i + 1][0]
        v_xx = (left - 2 * bar.node_motion[i][0] + right) / bar.spacing**2
        if weight > nodes.EMPTY:
            moments, errors = bar.node_moments[i], bar.transport_nodes[i]
            mean, scale = nodes.divergence_form(bar, i, on)
            sigma_x = bar.transport_slope[i]
            sigma_xx = (bar.transport_slope[i + 1] - bar.transport_slope[i - 1]) / (2 * bar.spacing)
            constant = (moments[0] - mean * weight) * moments[3] / weight  # (sum D) f_i of eq 46
            linear = ((moments[1] - mean * moments[2]) * scale - bar.node_volume[i]) * sigma_x  # (sum D r - 1) a_i
            quadratic = (errors[3] - mean * bar.transport_spread[i]) * 0.5 * sigma_xx  # C h^k of eq 12
            fed_back = errors[1] - mean * errors[2]  # sum D (Esigma F + sigma EF) V0 of eq 12
            mass = bar.density * bar.volume * weight
            Ea = ((fed_back + quadratic + constant) * scale + linear) / mass  # eq 12
            Ev = errors[0] / weight + bar.transport_dt * Ea  # eq 21 at the node
        bar.transport_errors[i] = ti.Vector([Ev, Ea, v_xx, 0.0])
    nodes.spread(bar.transport_errors, bar.cells)


@ti.func
def particle_errors(bar: ti.template(), base, on: ti.template()):
    """Carry Ev, Ex and Esigma on with the step's own weights, and leave Ea for the report."""
    for p in range(bar.particles):
        S, dS = nodes.stencil_of(bar, p)
        i = bar.first_node[p]
        F = bar.deformation_gradient[p]
        r = nodes.offset(bar, p)
        at_particle = ti.Vector([0.0, 0.0, 0.0, 0.0])  # Ev, Ea, v_xx of the nodes, interpolated
        L, error_slope, second = 0.0, 0.0, 0.0
        for k in ti.static(range(3)):
            node = bar.transport_errors[i + k]
            at_particle += S[k] * node
            error_slope += dS[k] * node[0]
            L += dS[k] * bar.node_motion[i + k][0]
            second += dS[k] * (r - k * bar.spacing) ** 2
        error = bar.estimate[base + p]
        Ev = error[1] + bar.transport_dt * at_particle[1]  # eqs 21, 22: Ev += dt sum S Ea_i
        moving = at_particle[0]
        if ti.static(on.velocity == "particle"):
            moving = Ev
        EF = error[2] / bar.modulus
        EF += bar.transport_dt * (L * EF + F * (error_slope + 0.5 * at_particle[2] * second))
        Ex = error[0] + bar.transport_dt * moving  # eqs 25, 27: Ex += dt Ev, in steps of H
        bar.estimate[base + p] = ti.Vector([Ex, Ev, bar.modulus * EF, at_particle[1]])


def allocate(scene):
    """Nodal arrays, with the periodic images."""
    N = scene.cells + nodes.GHOSTS
    return {"transport_dt": scene.estimate_interval * scene.time_step, "transport_nodes": np.zeros((N, 4)),
            "transport_spread": np.zeros(N), "transport_slope": np.zeros(N), "transport_errors": np.zeros((N, 4))}


def verdict(scene, memory):
    a = memory["transport_errors"][:, 1]
    return doubt(np.abs(a).max(), memory["transport_nodes"].any(), scene.size_of("a"))


HOOKS = EstimatorHooks(
    memory={
        "transport_dt": real,  # H = k dt
        "transport_nodes": quads,  # sums of S Ev, D* source, S source, D* r^2
        "transport_spread": reals,  # sum of S r^2
        "transport_slope": reals,  # d(sigma)/dx as the step saw it
        "transport_errors": quads,  # nodal errors of v and a, and v_xx
    },
    allocate=allocate, interval=lambda scene: scene.estimate_interval, in_step=in_step, verdict=verdict)
