"""The ring's samples: sums over particles for the norms of the true and the estimated error, and the energy.

Errors are vectors (x, v, a) or tensors (sigma) at a fixed material point, computed minus exact; their sizes are
Euclidean and Frobenius norms. The acceleration is the one that the last step used, so it is compared at that step's
time. ``error_extra`` is the paper's "Err A": the error of the acceleration at the nodes that carry mass.
"""

import taichi as ti

from solvers.ring import soundness
from solvers.ring.exact import C1, C2, C3, INNER
from solvers.ring.layout import GHOSTS
from solvers.ring.material import kirchhoff_stress
from solvers.samples import BASE, EACH, column

NEWTON_STEPS = 8  # of the radius that has come to a node; the map is nearly linear and converges in four or five


@ti.func
def phase(ring: ti.template(), step):
    """T and T' of the exact solution at the step, and T at the step before, whose acceleration was used."""
    angle = ring.angular_frequency * ring.dt * step
    return (ring.amplitude * ti.sin(angle), ring.amplitude * ring.angular_frequency * ti.cos(angle),
            ring.amplitude * ti.sin(ti.max(0.0, angle - ring.angular_frequency * ring.dt)))  # at the start both a are 0


@ti.func
def vector_errors(ring: ti.template(), p, expansion, speed, before, on: ti.template()):
    """Errors of x and v as one vector of four, and of a, at particle p. ``expansion`` is T, ``speed`` T'."""
    w = ring.radii[ring.radius[p]][1]
    X, e, q = ring.material_position[p], ring.direction[p], ring.motion[p]
    motion = ti.Vector([q[0] - X[0] - expansion * w * e[0], q[1] - X[1] - expansion * w * e[1],
                        q[2] - speed * w * e[0], q[3] - speed * w * e[1]])
    a = ti.Vector([0.0, 0.0])
    if ti.static(on.acceleration):
        omega = ring.angular_frequency
        a = ring.acceleration[p] + omega * omega * before * w * e
    return motion, a


@ti.func
def stress_error(ring: ti.template(), p, expansion):
    """Error of the Cauchy stress, as xx, xy, yy."""
    known = ring.radii[ring.radius[p]]  # R, w, w', w''
    radial = 1 + expansion * known[2]
    hoop = 1 + expansion * known[1] / known[0]
    scale = ring.shear_modulus / (radial * hoop)
    along, across = scale * (radial * radial - 1), scale * (hoop * hoop - 1)
    c, s = ring.direction[p][0], ring.direction[p][1]
    F = ring.deformation_gradient[p]
    sigma = kirchhoff_stress(ring, p) / (F[0] * F[3] - F[1] * F[2])
    return sigma - ti.Vector([along * c * c + across * s * s, (along - across) * c * s, along * s * s + across * c * c])


@ti.func
def squared(tensor):
    """Squared Frobenius norm of a symmetric tensor given as xx, xy, yy."""
    return tensor[0] * tensor[0] + 2 * tensor[1] * tensor[1] + tensor[2] * tensor[2]


@ti.func
def node_acceleration_error(ring: ti.template(), before, on: ti.template()):
    """Mean squared error of the nodes' acceleration against the exact one at the place of the node."""
    total, count = 0.0, 0
    omega = ring.angular_frequency
    for j in range(GHOSTS, ring.active):
        for i in range(GHOSTS, ring.active):
            node = j * ring.row + i
            if ring.node_mass[node] > 0:
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
def sample(ring: ti.template(), row, step, looks, on: ti.template()):
    """Write one row of sums; with ``looks`` also contradictions, which are looked for more rarely."""
    crossings, work = 0.0, 0.0
    for slab in range(ring.slabs):
        crossings += ring.totals[2 * slab]
        work += ring.totals[2 * slab + 1]
    ring.samples[row, ti.static(column("step"))] = step
    ring.samples[row, ti.static(column("work"))] = work
    ring.samples[row, ti.static(column("crossings"))] = crossings
    if ti.static(on.truth):
        sample_truth(ring, row, step, on)
    if ti.static(len(on.estimators) > 0):
        sample_estimates(ring, row, step, on)
    for q in ti.static(range(column("apart"), column("margin") + 1)):
        ring.samples[row, q] = ti.math.nan
    if ti.static(on.soundness):
        if looks:
            soundness.look(ring, row)
    if ti.static(on.energy):
        sample_energy(ring, row)


@ti.func
def sample_truth(ring: ti.template(), row, step, on: ti.template()):
    """Sums of squares of the true errors of x, v, sigma and, with the effect, a at particles and nodes."""
    expansion, speed, before = phase(ring, step)
    squares = ti.Vector([0.0, 0.0, 0.0, 0.0])
    for p in range(ring.particles):
        motion, a = vector_errors(ring, p, expansion, speed, before, on)
        squares += squared_parts(motion, stress_error(ring, p, expansion), a)
    for q in ti.static(range(3)):
        ring.samples[row, ti.static(column("error_x")) + q] = squares[q]
    if ti.static(on.acceleration):
        # Before the first step no acceleration has been computed, and so none can be wrong.
        nodes = node_acceleration_error(ring, before, on)
        ring.samples[row, ti.static(column("error_a"))] = squares[3] if step > 0 else 0.0
        ring.samples[row, ti.static(column("error_extra"))] = nodes * ring.particles if step > 0 else 0.0


@ti.func
def sample_estimates(ring: ti.template(), row, step, on: ti.template()):
    """Sums of squares of each estimate and of its distance from the truth."""
    expansion, speed, before = phase(ring, step)
    for e in range(ti.static(len(on.estimators))):
        squares, missed = ti.Vector([0.0, 0.0, 0.0, 0.0]), ti.Vector([0.0, 0.0, 0.0, 0.0])
        for p in range(ring.particles):
            motion, stress = ring.estimate[e * ring.particles + p], ring.estimate_stress[e * ring.particles + p]
            sigma = ti.Vector([stress[0], stress[1], stress[2]])
            a = ring.estimate_acceleration[e * ring.particles + p]
            squares += squared_parts(motion, sigma, a)
            if ti.static(on.truth):
                true_motion, true_a = vector_errors(ring, p, expansion, speed, before, on)
                missed += squared_parts(motion - true_motion, sigma - stress_error(ring, p, expansion), a - true_a)
        at = ti.static(len(BASE)) + ti.static(len(EACH)) * e
        for q in ti.static(range(4)):
            ring.samples[row, at + q] = squares[q]
            if ti.static(on.truth and (q < 3 or on.acceleration)):
                ring.samples[row, at + 4 + q] = missed[q]


@ti.func
def squared_parts(motion, sigma, a):
    """Squared sizes of x, v, sigma and a."""
    return ti.Vector([motion[0] * motion[0] + motion[1] * motion[1], motion[2] * motion[2] + motion[3] * motion[3],
                      squared(sigma), a[0] * a[0] + a[1] * a[1]])


@ti.func
def sample_energy(ring: ti.template(), row):
    """Kinetic energy, and strain energy mu/2 (F:F - 2 - 2 ln J) per reference volume."""
    kinetic, strain = 0.0, 0.0
    for p in range(ring.particles):
        q, F, mass = ring.motion[p], ring.deformation_gradient[p], ring.mass[p]
        kinetic += 0.5 * mass * (q[2] * q[2] + q[3] * q[3])
        J = ti.max(F[0] * F[3] - F[1] * F[2], 1e-300)
        strain += 0.5 * ring.shear_modulus * mass / ring.density \
            * (F[0] * F[0] + F[1] * F[1] + F[2] * F[2] + F[3] * F[3] - 2 - 2 * ti.log(J))
    ring.samples[row, ti.static(column("kinetic"))] = kinetic
    ring.samples[row, ti.static(column("strain"))] = strain
