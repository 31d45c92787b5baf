"""Tables of ``solvers.motion.separable_field`` for kernels: several fields of time and place in one array of quads.

``sizes`` has five entries for each table (:data:`RANK` and the following). A series is (cos, sin, 0, 0) for each
function of time, harmonic by harmonic, the mean first; then come modes, and the functions' present values.
"""

import numpy as np
import taichi as ti

from solvers.kernels.elementary_functions import cos, sin
from solvers.motion.exact_solution import SECOND_FREQUENCY
from solvers.motion.separable_field import SeparableField

#: Indices in a table's sizes: numbers of functions of time and of harmonics; first entries of series, modes and values.
RANK, HARMONICS, SERIES, MODES, PRESENT = range(5)
SIZES_PER_TABLE = 5
FORCE, TONE, MOTION, GRID = range(4)  # tables of a body: its force, the force's second tone, its motion, nodes' a


def pack_tables(*tables: tuple[SeparableField | None, np.ndarray | None]) -> tuple[np.ndarray, np.ndarray]:
    """Returns sizes (5 n,) and entries (N, 4), for kernels, of n tables, each a field and its modes as one of the
    functions ``..._mode_entries`` returns them; a missing one has rank 0. The first entry is not used."""
    sizes, parts, entries = [], [np.zeros((1, 4))], 1
    for table, modes in tables:
        if table is None or modes is None:
            sizes += [0] * SIZES_PER_TABLE
            continue
        waves = np.zeros((1 + table.harmonics, table.rank, 4))
        waves[0, :, 0] = table.series[:, 0]
        waves[1:, :, 0], waves[1:, :, 1] = table.series[:, 1::2].T, table.series[:, 2::2].T
        at = entries + (1 + table.harmonics) * table.rank
        sizes += [table.rank, table.harmonics, entries, at, at + len(modes)]
        parts += [waves.reshape(-1, 4), modes, np.zeros((table.rank, 4))]
        entries = at + len(modes) + table.rank
    return np.array(sizes, np.int32), np.concatenate(parts)


def pad_to_mode_pairs(table: SeparableField | None) -> tuple[SeparableField | None, np.ndarray | None]:
    """Returns a field of vectors, padded to an even rank, and its modes (n, 4), two in each entry; None for None."""
    if table is None:
        return None, None
    modes, series = table.modes, table.series
    if table.rank % 2:
        series = np.vstack([series, np.zeros((1, series.shape[1]))])
        modes = np.concatenate([modes, np.zeros_like(modes[:, :1])], axis=1)
    return SeparableField(modes, series, table.angular_frequency), modes.reshape(-1, 4)


def vector_mode_entries(table: SeparableField | None) -> tuple[SeparableField | None, np.ndarray | None]:
    """Returns a field of vectors and its modes (n, 4), one in each entry: (x, y, 0, 0); None for None."""
    return table, None if table is None else np.pad(table.modes.reshape(-1, 2), ((0, 0), (0, 2)))


def motion_mode_entries(table: SeparableField | None) -> tuple[SeparableField | None, np.ndarray | None]:
    """Returns a field of u and Grad u (P, r, 6) and its modes (n, 4), two entries each: (u_x, u_y, 0, 0) and Grad u."""
    if table is None:
        return None, None
    return table, np.insert(table.modes.reshape(-1, 6), [2, 2], 0.0, axis=1).reshape(-1, 4)


@ti.func
def table_size(body: ti.template(), number: ti.template(), which: ti.template()):
    """Returns the size ``which``, such as :data:`RANK`, of table ``number``, such as ``MOTION``, of a body."""
    return body.table_sizes[ti.static(SIZES_PER_TABLE * number + which)]


@ti.func
def compute_force_time_functions(tables: ti.template(), sizes: ti.template(), angle, on: ti.template()):
    """Stores in ``tables`` the functions of time of a body force and its second tone at an angle w t in rad. ``on``:
    compile-time options."""
    if ti.static(on.body_force != "none"):
        compute_paired_time_functions(tables, sizes, FORCE, angle, 1.0)
    if ti.static(on.body_force == "two-tone"):
        compute_paired_time_functions(tables, sizes, TONE, angle, sin(SECOND_FREQUENCY * angle))


@ti.func
def body_force_at(tables: ti.template(), sizes: ti.template(), place, on: ti.template()):
    """Returns the body force per mass (2,) in m/s^2 at the index ``place`` of ``tables``, for the functions of time
    stored last by :func:`compute_force_time_functions`. ``on``: compile-time options."""
    force = ti.Vector([0.0, 0.0])
    if ti.static(on.body_force != "none"):
        force = paired_field_at(tables, sizes, FORCE, place)
    if ti.static(on.body_force == "two-tone"):
        force += paired_field_at(tables, sizes, TONE, place)
    return force


@ti.func
def compute_paired_time_functions(tables: ti.template(), sizes: ti.template(), number: ti.template(), angle, scale):
    """Stores ``scale`` T_k at the first harmonic's angle w t in pair table ``number``, as (T_2k, T_2k, T_2k+1, T_2k+1).

    The functions are independent, harmonics by recurrence: on a GPU the outermost loop is spread over threads.
    """
    base = ti.static(SIZES_PER_TABLE * number)
    rank, at, out = sizes[base + RANK], sizes[base + SERIES], sizes[base + PRESENT]
    for k in range(rank // 2):
        a, b = tables[at + 2 * k][0], tables[at + 2 * k + 1][0]
        c1, s1 = cos(angle), sin(angle)
        c, s = c1, s1
        for n in range(1, sizes[base + HARMONICS] + 1):
            one, two = tables[at + n * rank + 2 * k], tables[at + n * rank + 2 * k + 1]
            a += one[0] * c + one[1] * s
            b += two[0] * c + two[1] * s
            c, s = c * c1 - s * s1, s * c1 + c * s1
        tables[out + k] = scale * ti.Vector([a, a, b, b])


@ti.func
def paired_field_at(tables: ti.template(), sizes: ti.template(), number: ti.template(), place):
    """Returns the vector (2,) of table ``number``, of pairs, at the index ``place``, for the functions of time stored
    last by :func:`compute_paired_time_functions`."""
    base = ti.static(SIZES_PER_TABLE * number)
    pairs, modes, now = sizes[base + RANK] // 2, sizes[base + MODES], sizes[base + PRESENT]
    total = ti.Vector([0.0, 0.0, 0.0, 0.0])
    for k in range(pairs):
        total += tables[now + k] * tables[modes + place * pairs + k]
    return ti.Vector([total[0] + total[2], total[1] + total[3]])


@ti.func
def compute_time_functions(tables: ti.template(), sizes: ti.template(), number, frequency, now, before):
    """Stores in table ``number`` (T_k, T_k' at the angle ``now`` in rad, T_k'' and T_k at ``before``), with harmonics
    of an angular ``frequency`` in 1/s: a method's acceleration is that of its last step."""
    base = SIZES_PER_TABLE * number
    rank, at, out = sizes[base + RANK], sizes[base + SERIES], sizes[base + PRESENT]
    for k in range(rank):
        mean = tables[at + k][0]
        found = ti.Vector([mean, 0.0, 0.0, mean])
        c1, s1, d1, e1 = cos(now), sin(now), cos(before), sin(before)
        c, s, d, e = c1, s1, d1, e1
        for n in range(1, sizes[base + HARMONICS] + 1):
            w, f = n * frequency, tables[at + n * rank + k]
            earlier = f[0] * d + f[1] * e
            found += ti.Vector([f[0] * c + f[1] * s, w * (f[1] * c - f[0] * s), -w * w * earlier, earlier])
            c, s = c * c1 - s * s1, s * c1 + c * s1
            d, e = d * d1 - e * e1, e * d1 + d * e1
        tables[out + k] = found
