"""The paper's "Err A": the error of the nodes' acceleration against that of the material at their places in the exact
motion, both at the last step's time."""

from collections.abc import Callable

import taichi as ti

from solvers.problems.planar.method.tensor_rotation import rotate_vector
from solvers.problems.planar.scene import PlanarScene
from solvers.solver.separable_field_tables import GRID, MODES, PRESENT, RANK, table_size

NEWTON_STEPS = 9  # of the radius that has come to a node; the map is nearly linear and converges in four or five
NEWTON_END = 1e-14  # m
MIN_RADIUS = 0.1  # of the inner radius: a node nearer to the centre, where no material comes, counts as there


def make_node_acceleration_error(ghosts: int) -> Callable:
    """Returns the Taichi function (body, on) of the nodes' mean squared acceleration error, m^2/s^4, of bodies whose
    grid table has the exact acceleration at each node; ``ghosts`` rows of nodes lie beyond planes at both ends."""
    @ti.func
    def node_acceleration_error(body: ti.template(), on: ti.template()):
        """Returns the mean squared error of the acceleration, m^2/s^4, over the nodes that carry mass."""
        total, count, rank, last = 0.0, 0, table_size(body, GRID, RANK), body.row - 1 - ghosts
        modes, out = table_size(body, GRID, MODES), table_size(body, GRID, PRESENT)
        for node in range(body.nodes):  # not one loop in another: Vulkan in software adds wrongly there
            i, j = node % body.row, node // body.row
            if i >= ghosts and j >= ghosts and i <= last and j <= last and body.node_mass[node] > 0:
                motion = body.node_motion[node]
                miss = ti.Vector([motion[2], motion[3]])
                for k in range(rank):
                    mode = body.tables[modes + node * rank + k]
                    miss = miss - body.tables[out + k][3] * ti.Vector([mode[0], mode[1]])
                total += miss[0] * miss[0] + miss[1] * miss[1]
                count += 1
        return total / ti.max(count, 1)

    return node_acceleration_error


def make_circular_acceleration_error(kind: type[PlanarScene], first: int) -> Callable:
    """Returns the Taichi function (body, on) of the nodes' mean squared acceleration error, m^2/s^4, of bodies between
    circles, whose exact motion is a polynomial of the radius; nodes before ``first`` in a row lie beyond a plane."""
    beyond, inner, outer = kind.BEYOND_RIMS, kind.INNER, kind.OUTER
    nearest, middle, half = MIN_RADIUS * inner, 0.5 * (outer + inner), 0.5 * (outer - inner)

    @ti.func
    def term_count(body: ti.template()):
        """Returns the number M of terms of the polynomials, which follow the samples in ``body.exact``."""
        entries = table_size(body, GRID, PRESENT) - table_size(body, GRID, MODES)
        return entries // ti.max(1, table_size(body, GRID, RANK))

    @ti.func
    def expansion(body: ti.template(), s):
        """Returns (u, a) at the radius s, -1 to 1 from rim to rim, as a vector of four, and its derivative by s:
        Clenshaw's recurrence for sum c_m T_m(s), and for its derivative."""
        b, older = ti.Vector([0.0] * 4), ti.Vector([0.0] * 4)
        d, older_d = ti.Vector([0.0] * 4), ti.Vector([0.0] * 4)
        start = 3 * body.orbits
        terms = start + term_count(body)
        for n in range(terms - start - 1):
            c = body.exact[terms - 1 - n]
            d, older_d = 2 * b + 2 * s * d - older_d, d
            b, older = c + 2 * s * b - older, b
        return body.exact[start] + s * b - older, b + s * d - older_d

    @ti.func
    def node_acceleration_error(body: ti.template(), on: ti.template()):
        """Returns the mean squared error of the acceleration, m^2/s^4, over the nodes that carry mass."""
        rank, modes = table_size(body, GRID, RANK), table_size(body, GRID, MODES)
        out = table_size(body, GRID, PRESENT)
        for m in range(term_count(body)):
            now = ti.Vector([0.0] * 4)
            for k in range(rank):
                T, c = body.tables[out + k], body.tables[modes + m * rank + k]
                now += ti.Vector([T[3] * c[0], T[3] * c[1], T[2] * c[0], T[2] * c[1]])
            body.exact[3 * body.orbits + m] = now
        total, count = 0.0, 0
        for node in range(body.nodes):  # not one loop in another: Vulkan in software adds wrongly there
            i, j = node % body.row, node // body.row
            if i >= first and j >= first and body.node_mass[node] > 0:
                x, y = (i - body.origin) * body.spacing, (j - body.origin) * body.spacing
                r = ti.max(ti.sqrt(x * x + y * y), nearest)
                e, R, step = ti.Vector([x, y]) / r, r, 1.0
                if ti.static(not beyond):
                    R = ti.min(ti.max(r, inner), outer)
                a = ti.Vector([0.0, 0.0])
                for _ in range(ti.static(NEWTON_STEPS if beyond and not on.frozen else 1)):
                    if ti.abs(step) > NEWTON_END:
                        value, slope = expansion(body, (R - middle) / half)
                        a = ti.Vector([value[2], value[3]])
                        if ti.static(not on.frozen):  # the material radius that has come here, and turned back from it
                            along, around = R + value[0], value[1]
                            size = ti.sqrt(along * along + around * around)
                            a = ti.Vector([a[0] * along + a[1] * around, a[1] * along - a[0] * around]) / size
                            rate = ((1 + slope[0] / half) * along + slope[1] / half * around) / size
                            step = (size - r) / rate
                            R -= step
                a = rotate_vector(e, a[0], a[1])
                motion = body.node_motion[node]
                miss_x, miss_y = motion[2] - a[0], motion[3] - a[1]
                total += miss_x * miss_x + miss_y * miss_y
                count += 1
        return total / ti.max(count, 1)

    return node_acceleration_error
