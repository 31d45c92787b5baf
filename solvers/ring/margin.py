"""The margin of the ring's step: dt over the bound of ``solvers.step_bound``, from the weights of the last step."""

import taichi as ti

from solvers.ring import cpdi, gimp
from solvers.ring.layout import GHOSTS


@ti.func
def step_margin(ring: ti.template(), on: ti.template()):
    """Write dt over the bound; NaN before the first step.

    A node's record: grad S of the present particle (two numbers), |grad S|/sqrt(m), Gershgorin's sum.
    """
    for node in range(ring.nodes):
        ring.node_bound[node] = ti.Vector([0.0, 0.0, 0.0, 0.0])
    for p in range(ring.particles):
        total = 0.0
        if ti.static(on.method == "cpdi"):
            # Loops that are not unrolled: this runs seldom, and would take longer to compile.
            g, places, cells = cpdi.corner_gradients(ring, p, on), ring.weights[p], ring.corner_nodes[p]
            for corner in range(16):
                c, k = corner // 4, corner % 4
                x, y = places[c], places[c + 4]
                N = (x if k % 2 == 1 else 1 - x) * (y if k // 2 == 1 else 1 - y) * (1.0 if c < 2 else -1.0)
                node = cells[c] + (k // 2) * ring.row + k % 2
                record, a = ring.node_bound[node], 2 * (c % 2)
                ring.node_bound[node] = record + N * ti.Vector([g[a], g[a + 1], 0.0, 0.0])
            for corner in range(16):
                k = corner % 4
                total += take_gradient(ring, cells[corner // 4] + (k // 2) * ring.row + k % 2)
            stiffness = tangent(ring, p, on) * total
            for corner in range(16):
                k = corner % 4
                add_circle(ring, cells[corner // 4] + (k // 2) * ring.row + k % 2, stiffness)
        else:
            S, dS, R, dR = gimp.stencils_of(ring, p)
            first = ring.first_node[p]
            for j in ti.static(range(3)):
                for i in ti.static(range(3)):
                    node = first + j * ring.row + i
                    circle = ring.node_bound[node][3]
                    ring.node_bound[node] = ti.Vector([dS[i] * R[j], S[i] * dR[j], 0.0, circle])
            for place in range(9):
                total += take_gradient(ring, first + (place // 3) * ring.row + place % 3)
            stiffness = tangent(ring, p, on) * total
            for place in range(9):
                add_circle(ring, first + (place // 3) * ring.row + place % 3, stiffness)
    largest = 0.0
    for node in range(ring.nodes):
        largest = ti.max(largest, ring.node_bound[node][3])
    ring.step_margin[0] = 0.5 * ring.dt * ti.sqrt(largest) if largest > 0 else ti.math.nan


@ti.func
def tangent(ring: ti.template(), p, on: ti.template()):
    """k V: mu V0 (1 + the largest eigenvalue of F F^T); for frozen weights the largest of its inverse."""
    F = ring.deformation_gradient[p]
    xx, yy, xy = F[0] * F[0] + F[1] * F[1], F[2] * F[2] + F[3] * F[3], F[0] * F[2] + F[1] * F[3]
    root = ti.sqrt((xx - yy) ** 2 + 4 * xy * xy)
    largest = 0.5 * (xx + yy + root)
    if ti.static(on.frozen):
        J = F[0] * F[3] - F[1] * F[2]
        largest = largest / (J * J)
    return ring.shear_modulus * ring.mass[p] / ring.density * (1 + largest)


@ti.func
def image(ring: ti.template(), node):
    """The node that a ghost is the mirror image of; any other is its own."""
    i, j = node % ring.row, node // ring.row
    i, j = ti.select(i < GHOSTS, 2 * GHOSTS - i, i), ti.select(j < GHOSTS, 2 * GHOSTS - j, j)
    return j * ring.row + i


@ti.func
def take_gradient(ring: ti.template(), node):
    """|grad S|/sqrt(m) of the present particle at a node, kept there; the gradient goes, lest it be taken twice."""
    record = ring.node_bound[node]
    size, mass = ti.sqrt(record[0] * record[0] + record[1] * record[1]), ring.node_mass[image(ring, node)]
    scaled = 0.0
    if size > 0 and mass > 0:
        scaled = size / ti.sqrt(mass)
        ring.node_bound[node] = ti.Vector([0.0, 0.0, scaled, record[3]])
    return scaled


@ti.func
def add_circle(ring: ti.template(), node, stiffness):
    """Add the present particle's part to the sum of a node, once."""
    scaled = ring.node_bound[node][2]
    ring.node_bound[node][2] = 0.0
    ring.node_bound[image(ring, node)][3] += stiffness * scaled
