"""The margin of the ring's step: dt over the bound of ``solvers.step_bound``, from the weights of the last step."""

import taichi as ti

from solvers.ring import cpdi, gimp
from solvers.ring.layout import GHOSTS
from solvers.samples import column


@ti.func
def step_margin(ring: ti.template(), row, on: ti.template()):
    """Write dt over the bound. A node's record: grad S of the present particle, |grad S|/sqrt(m), Gershgorin's sum."""
    for node in range(ring.nodes):
        ring.node_bound[node] = ti.Vector([0.0, 0.0, 0.0, 0.0])
    for p in range(ring.particles):
        total = 0.0
        if ti.static(on.method == "cpdi"):
            g, places, cells = cpdi.corner_gradients(ring, p, on), ring.weights[p], ring.corner_nodes[p]
            for c in ti.static(range(4)):
                N = cpdi.hats(places, c)
                a, b = ti.static(2 * (c % 2), 1.0 if c < 2 else -1.0)
                for k in ti.static(range(4)):
                    node = cells[c] + (k // 2) * ring.row + k % 2
                    ring.node_bound[node] = ring.node_bound[node] + b * N[k] * ti.Vector([g[a], g[a + 1], 0.0, 0.0])
            for c in ti.static(range(4)):
                for k in ti.static(range(4)):
                    total += take_gradient(ring, cells[c] + (k // 2) * ring.row + k % 2)
            for c in ti.static(range(4)):
                for k in ti.static(range(4)):
                    add_circle(ring, cells[c] + (k // 2) * ring.row + k % 2, tangent(ring, p, on) * total)
        else:
            S, dS, R, dR = gimp.stencils_of(ring, p)
            first = ring.first_node[p]
            for j in ti.static(range(3)):
                for i in ti.static(range(3)):
                    node = first + j * ring.row + i
                    circle = ring.node_bound[node][3]
                    ring.node_bound[node] = ti.Vector([dS[i] * R[j], S[i] * dR[j], 0.0, circle])
            for j in ti.static(range(3)):
                for i in ti.static(range(3)):
                    total += take_gradient(ring, first + j * ring.row + i)
            for j in ti.static(range(3)):
                for i in ti.static(range(3)):
                    add_circle(ring, first + j * ring.row + i, tangent(ring, p, on) * total)
    largest = 0.0
    for node in range(ring.nodes):
        largest = ti.max(largest, ring.node_bound[node][3])
    if largest > 0:
        ring.samples[row, ti.static(column("margin"))] = 0.5 * ring.dt * ti.sqrt(largest)


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
