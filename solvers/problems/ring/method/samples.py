"""What the ring knows of itself, for the samples: its exact solution at particles and nodes, and its strain energy."""

import taichi as ti

from solvers.kernels.elementary import cos, log, sin
from solvers.problems.planar.method.soundness import contradictions
from solvers.problems.planar.parts import Measures
from solvers.problems.planar.scene import GHOSTS
from solvers.problems.ring.exact import C1, C2, C3, INNER, OUTER
from solvers.problems.ring.method.material import kirchhoff_stress
from solvers.scene.effects import samplers

NEWTON_STEPS = 8  # of the radius that has come to a node; the map is nearly linear and converges in four or five


@ti.func
def exact_at_step(ring: ti.template(), step):
    """T and T' of the exact solution at the step, and T at the step before, whose acceleration was used."""
    angle = ring.angular_frequency * ring.dt * step
    before = ti.max(0.0, angle - ring.angular_frequency * ring.dt)  # at the start both a are 0
    return ti.Vector([ring.amplitude * sin(angle), ring.amplitude * ring.angular_frequency * cos(angle),
                      ring.amplitude * sin(before)])


@ti.func
def vector_errors(ring: ti.template(), p, now, on: ti.template()):
    """Errors of x and v as one vector of four, and of a, at particle p; ``now`` is the :func:`exact_at_step`."""
    expansion, speed, before = now[0], now[1], now[2]
    w = ring.radii[ring.radius[p]][1]
    X, e, q = ring.material_position[p], ring.direction[p], ring.position_velocity[p]
    motion = ti.Vector([q[0] - X[0] - expansion * w * e[0], q[1] - X[1] - expansion * w * e[1],
                        q[2] - speed * w * e[0], q[3] - speed * w * e[1]])
    a = ti.Vector([0.0, 0.0])
    if ti.static(on.acceleration):
        omega = ring.angular_frequency
        a = ring.acceleration[p] + omega * omega * before * w * e
    return motion, a


@ti.func
def stress_error(ring: ti.template(), p, now):
    """Error of the Cauchy stress, as xx, xy, yy."""
    known, expansion = ring.radii[ring.radius[p]], now[0]  # R, w, w', w''
    radial = 1 + expansion * known[2]
    hoop = 1 + expansion * known[1] / known[0]
    scale = ring.shear_modulus / (radial * hoop)
    along, across = scale * (radial * radial - 1), scale * (hoop * hoop - 1)
    c, s = ring.direction[p][0], ring.direction[p][1]
    F = ring.deformation_gradient[p]
    sigma = kirchhoff_stress(ring, p) / (F[0] * F[3] - F[1] * F[2])
    return sigma - ti.Vector([along * c * c + across * s * s, (along - across) * c * s, along * s * s + across * c * c])


@ti.func
def node_acceleration_error(ring: ti.template(), now, on: ti.template()):
    """Mean squared error of the nodes' acceleration against the exact one at the place of the node."""
    total, count = 0.0, 0
    omega, before = ring.angular_frequency, now[2]
    for node in range(ring.nodes):  # not one loop in another: Vulkan in software adds wrongly there
        i, j = node % ring.row, node // ring.row
        if i >= GHOSTS and j >= GHOSTS and ring.node_mass[node] > 0:
            x, y = (i - GHOSTS) * ring.spacing, (j - GHOSTS) * ring.spacing
            r = ti.max(ti.sqrt(x * x + y * y), 0.1 * INNER)
            R = r  # the material radius that has come here: R + T w(R) = r
            for _ in range(ti.static(0 if on.frozen else NEWTON_STEPS)):
                w = ((C3 * R + C2) * R + C1) * R
                slope = (3 * C3 * R + 2 * C2) * R + C1
                R -= (R + before * w - r) / (1 + before * slope)
            a = -omega * omega * before * ((C3 * R + C2) * R + C1) * R
            motion = ring.node_motion[node]
            across_x = motion[2] - a * x / r if i > GHOSTS else 0.0
            across_y = motion[3] - a * y / r if j > GHOSTS else 0.0
            total += across_x * across_x + across_y * across_y
            count += 1
    return total / ti.max(count, 1)


@ti.func
def strain_energy(ring: ti.template(), p):
    """mu/2 (F:F - 2 - 2 ln J) per reference volume."""
    F, mass = ring.deformation_gradient[p], ring.mass[p]
    J = ti.max(F[0] * F[3] - F[1] * F[2], 1e-300)
    return 0.5 * ring.shear_modulus * mass / ring.density \
        * (F[0] * F[0] + F[1] * F[1] + F[2] * F[2] + F[3] * F[3] - 2 - 2 * log(J))


MEASURES = Measures(exact_at_step, vector_errors, stress_error, node_acceleration_error, strain_energy,
                    contradictions(INNER, OUTER, turns=False), samplers("ring", {}))
