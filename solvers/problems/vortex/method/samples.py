"""What the vortex knows of itself, for the samples: its exact solution at particles and nodes, energy and spin.

The exact solution depends on R alone but for a rotation, so it is found once a circle at each sample: ``turns`` has
cos and sin of alpha, alpha_t and R alpha_R at the time of the step, and cos, sin, alpha_t and alpha_tt at that of the
step before, whose acceleration was used. See ``solvers.problems.vortex.exact``.
"""

import taichi as ti

from solvers.kernels.elementary import cos, sin
from solvers.problems.planar.method.neo_hookean import cauchy_stress, strain_energy
from solvers.problems.planar.method.phases import TOTALS
from solvers.problems.planar.method.soundness import contradictions
from solvers.problems.planar.parts import Measures
from solvers.problems.vortex.exact import BEND, INNER, MIDDLE, OUTER, RISE
from solvers.scene.effects import samplers
from solvers.solver.samples import column


@ti.func
def exact_at_step(vortex: ti.template(), step):
    """Fill ``turns`` for the step; returns A, w and the angle w t of the step before."""
    A, w = vortex.amplitude, vortex.angular_frequency
    now = w * vortex.dt * step
    before = ti.max(0.0, now - w * vortex.dt)
    for k in range(vortex.radius_count):
        R, h, slope = vortex.radii[k][0], vortex.radii[k][1], vortex.radii[k][2]
        alpha, earlier = A * sin(now) * h, A * sin(before) * h
        vortex.turns[k] = ti.Vector([
            cos(alpha), sin(alpha), A * w * cos(now) * h, A * sin(now) * R * slope,
            cos(earlier), sin(earlier), A * w * cos(before) * h, -A * w * w * sin(before) * h])
    return ti.Vector([A, w, before])


@ti.func
def vector_errors(vortex: ti.template(), p, now, on: ti.template()):
    """Errors of x and v as one vector of four, and of a, at particle p: x = Q X, v = alpha_t e_z x x, and
    a = alpha_tt e_z x x - alpha_t^2 x."""
    f, X, q = vortex.turns[vortex.radius[p]], vortex.material_position[p], vortex.position_velocity[p]
    x, y = f[0] * X[0] - f[1] * X[1], f[1] * X[0] + f[0] * X[1]
    motion = ti.Vector([q[0] - x, q[1] - y, q[2] + f[2] * y, q[3] - f[2] * x])
    a = ti.Vector([0.0, 0.0])
    if ti.static(on.acceleration):
        x, y = f[4] * X[0] - f[5] * X[1], f[5] * X[0] + f[4] * X[1]
        rate = f[6] * f[6]
        a = vortex.acceleration[p] + ti.Vector([f[7] * y + rate * x, rate * y - f[7] * x])
    return motion, a


@ti.func
def stress_error(vortex: ti.template(), p, now):
    """Error of the Cauchy stress, as xx, xy, yy: the exact one is mu g and mu g^2 in the turned frame, g the shear."""
    f, e = vortex.turns[vortex.radius[p]], vortex.direction[p]
    c, s = f[0] * e[0] - f[1] * e[1], f[1] * e[0] + f[0] * e[1]  # e_r at the present angle
    shear = vortex.shear_modulus * f[3]
    hoop = shear * f[3]
    return cauchy_stress(vortex, p) - ti.Vector([hoop * s * s - 2 * shear * c * s,
                                                 shear * (c * c - s * s) - hoop * c * s,
                                                 hoop * c * c + 2 * shear * c * s])


@ti.func
def node_acceleration_error(vortex: ti.template(), now, on: ti.template()):
    """Mean squared error of the nodes' acceleration against the exact one at the place of the node, or of the rim
    nearest to it: circles keep their radius, so R = r."""
    total, count = 0.0, 0
    A, w, angle = now[0], now[1], now[2]
    for node in range(vortex.nodes):
        if vortex.node_mass[node] > 0:
            x = (node % vortex.row - vortex.origin) * vortex.spacing
            y = (node // vortex.row - vortex.origin) * vortex.spacing
            square = (ti.min(ti.max(ti.sqrt(x * x + y * y), INNER), OUTER) - MIDDLE) ** 2
            h = 1 + (BEND + RISE * square) * square
            if ti.static(on.frozen):  # the node stands for where it is at rest
                c, s = cos(A * sin(angle) * h), sin(A * sin(angle) * h)
                x, y = c * x - s * y, s * x + c * y
            rate, gain = A * w * cos(angle) * h, -A * w * w * sin(angle) * h
            motion = vortex.node_motion[node]
            miss_x, miss_y = motion[2] + rate * rate * x + gain * y, motion[3] + rate * rate * y - gain * x
            total += miss_x * miss_x + miss_y * miss_y
            count += 1
    return total / ti.max(count, 1)


@ti.func
def sample_angular_momentum(vortex: ti.template(), row, step, on: ti.template()):
    """Angular momentum, the exact one of the particles, and the impulse of the body force's torque so far.

    Velocities belong to half a step before, and so does the exact angular momentum here: sum m R^2 alpha_t.
    """
    momentum, expected, torque = 0.0, 0.0, 0.0
    angle = vortex.angular_frequency * vortex.dt * (step - 0.5)
    rate = vortex.amplitude * vortex.angular_frequency * cos(angle)
    for p in range(vortex.particles):
        q, known = vortex.position_velocity[p], vortex.radii[vortex.radius[p]]
        momentum += vortex.mass[p] * (q[0] * q[3] - q[1] * q[2])
        expected += vortex.mass[p] * known[0] * known[0] * known[1] * rate
    for slab in range(vortex.slabs):
        torque += vortex.totals[ti.static(TOTALS) * slab + 2]
    vortex.samples[row, ti.static(column("spin/momentum", on))] = momentum
    vortex.samples[row, ti.static(column("spin/torque", on))] = torque
    if ti.static(on.truth):
        vortex.samples[row, ti.static(column("spin/exact_momentum", on))] = expected


MEASURES = Measures(exact_at_step, vector_errors, stress_error, node_acceleration_error, strain_energy,
                    contradictions(INNER, OUTER, turns=True), samplers("vortex", {"spin": sample_angular_momentum}))
