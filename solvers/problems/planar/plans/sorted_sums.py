"""Another way to the nodes' sums on a GPU: particles are sorted by cell, and each node adds up those around it.

No two threads write to one place, so that nothing waits for anything, as atomic additions do, and the sums are the same
to the bit whenever they are made. What it costs is to sort, every step, and that what a particle gives is read once for
each of its nodes. Which is faster only a real GPU can tell: ``solvers.bench.gpu`` measures both.

An item is what has one cell: a particle, or one of the four corners of a domain of CPDI. A cell has the number of its
first node; of GIMP three nodes either way belong to it, of CPDI two.
"""

from typing import Any, NamedTuple

import numpy as np
import taichi as ti

from solvers.kernels.kinds import integers, octets, reals
from solvers.problems.planar.method import cpdi, phases
from solvers.problems.planar.method.body import WatchedBody
from solvers.problems.planar.method.kept import kept, kept_number
from solvers.problems.planar.method.margin import entry, slope_entry
from solvers.problems.planar.method.records import force_moment, force_record
from solvers.problems.planar.parts import PlanarParts
from solvers.problems.planar.plans.at_once import update_nodes
from solvers.solver.arrays import Watch

CHUNK = 64  # numbers that one thread adds up
CORNERS = 4
#: What is sorted: how many items a cell has and where they begin, both by cell; sums of chunks of cells, and of chunks
#: of those; a number for each item, within its cell, and the items in order; what each gives, in order.
SORTING = {"cell_counts": integers, "cell_begins": integers, "chunk_sums": integers, "chunk_begins": integers,
           "item_numbers": integers, "sorted_items": integers, "item_stencils": octets, "item_records": octets,
           "item_masses": reals}


class SortedSums(NamedTuple):
    """The type of the state with what is sorted, and the kernel that takes particles to nodes."""

    state: Any
    to_nodes: Any  # (step, state, on)


def sorting(arrays: WatchedBody, method: str) -> dict[str, np.ndarray]:
    """Room for what is sorted."""
    items, chunks = items_of(method) * arrays.particles, -(-arrays.nodes // CHUNK)
    lengths = {"cell_counts": arrays.nodes, "cell_begins": arrays.nodes, "chunk_sums": chunks,
               "chunk_begins": -(-chunks // CHUNK), "item_numbers": items, "sorted_items": items,
               "item_stencils": items, "item_records": items, "item_masses": items}
    return {name: np.zeros((n, 8) if SORTING[name] is octets else n, np.int32 if SORTING[name] is integers else float)
            for name, n in lengths.items()}


def items_of(method: str) -> int:
    """How many items a particle has."""
    return CORNERS if method == "cpdi" else 1


def sorted_sums(parts: PlanarParts) -> SortedSums:
    """For a problem: the first half of a step as ``plans.at_once`` has it, but for the sums."""
    TRAITS = parts.traits
    watching = {*Watch.types(), "estimate_acceleration", "estimate_stress"} - {"verdict"}
    needed = {name: kind for name, kind in parts.arrays.types().items() if name not in watching}
    State = ti.types.argpack(**needed, **SORTING)

    @ti.kernel
    def to_nodes(step: ti.i32, body: State, on: ti.template()):
        """The first half of the step after ``step`` steps: particles to nodes, and the nodes' new motion."""
        count = phases.moving(body)
        side = body.active * ti.min(count, 1)  # a run gone bad keeps its last nodes
        TRAITS.forces(body, step * body.dt, on)
        if ti.static(not on.frozen):
            phases.find_weights(body, 0, count, on)
        TRAITS.prepare(body, 0, count)
        sort(body, count * ti.static(items_of(on.method)), on)
        for at in range(count * ti.static(items_of(on.method))):
            give(body, at, TRAITS, on)
        for place in range(side * side):
            add_up(body, place % body.active, place // body.active, on)
        update_nodes(body, side, TRAITS, on)

    return SortedSums(State, to_nodes)


@ti.func
def cell_of(body: ti.template(), item, on: ti.template()):
    """The cell of an item, by the number of its first node."""
    cell = 0
    if ti.static(on.method == "cpdi"):
        cell = ti.cast(kept_number(body, item // CORNERS, cpdi.NODES + item % CORNERS, on), ti.i32)
    else:
        cell = body.first_node[item]
    return cell


@ti.func
def sort(body: ti.template(), items, on: ti.template()):
    """Put the items in the order of their cells, and within a cell in their own: by counting, where who comes first is
    by chance, then by exchanging the few of a cell."""
    for cell in range(body.nodes):
        body.cell_counts[cell] = 0
    for item in range(items):
        body.item_numbers[item] = ti.atomic_add(body.cell_counts[cell_of(body, item, on)], 1)
    find_begins(body)
    for item in range(items):
        body.sorted_items[body.cell_begins[cell_of(body, item, on)] + body.item_numbers[item]] = item
    for cell in range(body.nodes):
        begin = body.cell_begins[cell]
        for k in range(begin + 1, begin + body.cell_counts[cell]):
            item, free = body.sorted_items[k], k
            while free > begin and body.sorted_items[ti.max(free - 1, 0)] > item:
                body.sorted_items[free] = body.sorted_items[free - 1]
                free -= 1
            body.sorted_items[free] = item


@ti.func
def find_begins(body: ti.template()):
    """Where each cell's items begin: how many those before it have, added up by chunks, chunks of chunks, and one after
    another."""
    chunks = (body.nodes + CHUNK - 1) // CHUNK
    groups = (chunks + CHUNK - 1) // CHUNK
    for chunk in range(chunks):
        total = 0
        for cell in range(chunk * CHUNK, ti.min((chunk + 1) * CHUNK, body.nodes)):
            total += body.cell_counts[cell]
        body.chunk_sums[chunk] = total
    for group in range(groups):
        total = 0
        for chunk in range(group * CHUNK, ti.min((group + 1) * CHUNK, chunks)):
            total += body.chunk_sums[chunk]
        body.chunk_begins[group] = total
    for _ in range(1):
        begin = 0
        for group in range(groups):
            total = body.chunk_begins[group]
            body.chunk_begins[group] = begin
            begin += total
    for group in range(groups):
        begin = body.chunk_begins[group]
        for chunk in range(group * CHUNK, ti.min((group + 1) * CHUNK, chunks)):
            total = body.chunk_sums[chunk]
            body.chunk_sums[chunk] = begin
            begin += total
    for chunk in range(chunks):
        begin = body.chunk_sums[chunk]
        for cell in range(chunk * CHUNK, ti.min((chunk + 1) * CHUNK, body.nodes)):
            body.cell_begins[cell] = begin
            begin += body.cell_counts[cell]


@ti.func
def give(body: ti.template(), at, traits: ti.template(), on: ti.template()):
    """Write down in its place of the order what an item gives. A corner: its place in the cell, then momentum, force
    and mass; a particle: its stencils, then momentum, body force and V sigma, and its mass."""
    item = body.sorted_items[at]
    if ti.static(on.method == "cpdi"):
        p, c = item // CORNERS, item % CORNERS
        carried, tau = force_moment(body, p, traits, on)
        first = cpdi.GRADIENTS + c % 2 * 2
        sign = ti.select(c < 2, -1.0, 1.0)  # opposite corners have opposite gradients, and the force points against it
        g_x, g_y = sign * kept_number(body, p, first, on), sign * kept_number(body, p, first + 1, on)
        body.item_records[at] = 0.25 * carried + force_record(g_x * tau[0] + g_y * tau[1], g_x * tau[2] + g_y * tau[3])
        body.item_stencils[at] = ti.Vector([kept_number(body, p, c, on), kept_number(body, p, c + CORNERS, on),
                                            0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    else:
        carried, tau = force_moment(body, item, traits, on)
        w, = ti.static([kept(body, item, on)])
        body.item_records[at] = ti.Vector([carried[0], carried[1], carried[2], carried[3],
                                           tau[0], tau[1], tau[2], tau[3]])
        body.item_stencils[at] = ti.Vector([w[k] for k in range(8)])
        body.item_masses[at] = carried[4]


@ti.func
def add_up(body: ti.template(), i, j, on: ti.template()):
    """The sums of node (i, j), from the items of the cells that it belongs to."""
    reach = ti.static(2 if on.method == "cpdi" else 3)
    total = ti.Vector([0.0] * 8)
    for way in range(reach * reach):
        a, b = way % reach, way // reach  # the node's own place in the cell
        inside = ti.select(i >= a, 1, 0) * ti.select(j >= b, 1, 0)
        cell = inside * ((j - b) * body.row + i - a)
        begin = body.cell_begins[cell]
        for at in range(begin, begin + inside * body.cell_counts[cell]):
            total += given(body, at, a, b, on)
    body.node_sums[j * body.row + i] = total


@ti.func
def given(body: ti.template(), at, a, b, on: ti.template()):
    """What an item gives to the node at place (a, b) of its cell."""
    w, r = body.item_stencils[at], body.item_records[at]
    record = r
    if ti.static(on.method == "cpdi"):
        record = ti.select(a == 1, w[0], 1 - w[0]) * ti.select(b == 1, w[1], 1 - w[1]) * r
    else:
        S, dS = entry(a, w[0], w[2]), slope_entry(a, w[4], w[6])
        R, dR = entry(b, w[1], w[3]), slope_entry(b, w[5], w[7])
        weight = S * R
        record = ti.Vector([weight * r[0], weight * r[1], weight * r[2] - dS * R * r[4] - S * dR * r[5],
                            weight * r[3] - dS * R * r[6] - S * dR * r[7],
                            weight * body.item_masses[at], 0.0, 0.0, 0.0])
    return record
