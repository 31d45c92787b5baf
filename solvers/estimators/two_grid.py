"""Shared parts of the two-grid estimators: options of the second run, smoothing and interpolation between the lattices
of both runs, and checks of validity.

The same scene runs a second time on half as many cells, and every quantity q is extrapolated from the two (Richardson
1911): where the error is C h^2, q* = (r^2 q_h - q_rh)/(r^2 - 1) is free of it, and the run's error is q_h - q*, with r
the ratio of cells, 2 or slightly more. The runs are compared as smooth fields: at a cell's scale their errors have
their own patterns (the stress is a sawtooth, the null space of the particle-node map holds noise), unrelated, so
Richardson's argument cannot hold there; and none is needed, for what a run has and its smooth field lacks is error. So

    e = q_h - I q*,   q* = (r^2 S q_h - S q_rh)/(r^2 - 1),

S a fit of cubics over ``FIT_CELLS`` cells and I cubic interpolation. The time step is not refined with the grid. It
makes no first-order error but one: v belongs to a time dt/2 earlier than x (symplectic Euler is the leapfrog scheme
started at rest of the forces, a(0) = 0), which is known and taken into account for both runs.

Particles lie on lattices of lines that are evenly spaced in the material coordinate (the bar's X; the ring's angle and
radius; the square's X and Y), so every smoothing or interpolation is a product of 1-D stencils that never change. A
stencil is the value at one place of the polynomial that fits the nearest lattice points best (least squares; Savitzky &
Golay 1964): with as many points as coefficients it interpolates, with more it also smooths. What lies beyond the ends
of a line is the line again ("periodic"), its mirror image ("mirror") or nothing ("free"): then stencils are one-sided.

Cannot see: errors that both grids share (a misplaced force, a wrong material or time step), and errors longer than a
few cells that do not fall like h^2. Where they are known not to, it is not run (see each problem's ``LIMITS``), above
all where waves of the second run are out of step with the exact ones (``solvers.estimators.two_grid_phase_lag``).
"""

import math
from typing import NamedTuple

import numpy as np
import taichi as ti

from solvers.kernels.dtypes import integers, pairs, real, reals
from solvers.kernels.packing import prefix_view
from solvers.scene.kernel_options import KernelOptions
from solvers.scene.scene import Scene
from solvers.translatable_message import Message

FIT_CELLS = (4, 6)  # cells that a fit spans: of x, v and sigma; and of a, whose noise has longer waves
MOST_COURANT = 0.25  # steps of the coarse run, in multiples of the time a wave takes through a cell of the fine grid
MOST_STEPS = 10  # of the run to one of the coarse run
CRUSHED_JACOBIAN = 1e-3  # det F from which on a particle of the coarse run counts as crushed
LOST_DISPLACEMENT = 0.5  # of the amplitude: with such an error of x a run is lost
CUBIC_COEFFICIENTS = 4

TABLES = ("down", "over", "up")  # from the run's lattice to the common one, from the second run's, and to the run's
LATTICES = ("fine", "coarse", "common")  # of the run, of the second run, and the one on which they are compared
STENCILS = {"first": integers, "row": integers, "taps": ti.i32, "weights": pairs}


class ComponentWeightChoice(NamedTuple):
    """Choice of stencils for fields with several components per particle: for each component, which of the two weights
    (0 or 1) of a stencil's points it takes along the lattice's lines, and across them if there are several lines."""

    along: tuple[int, ...]
    across: tuple[int, ...] = ()


def memory_types(vectors: object) -> dict:
    """Returns Taichi types of two-grid's memory by name, for any problem; ``vectors`` is the type of fields' arrays."""
    return {
        **{f"two_grid_{table}_{way}_{member}": kind for table in TABLES for way in ("along", "across")
           for member, kind in STENCILS.items()},
        **{f"two_grid_{lattice}_{size}": ti.i32 for lattice in LATTICES for size in ("points", "lines")},
        "two_grid_gain": real, "two_grid_interval": ti.i32,  # 1/(r^2 - 1); steps to one of the second run
        "two_grid_fields": vectors,  # of either run; finally the errors of the run
        "two_grid_band": vectors,  # intermediate fields between two lattices, transferred along the lines only
        "two_grid_common": vectors,  # extrapolated fields on the common lattice
        "two_grid_largest": reals,  # the largest mean square of e_x that was reported
    }


def allocate(scene: Scene, fields: ComponentWeightChoice, fine: tuple[int, int], coarse: tuple[int, int],
             common: tuple[int, int], ends: tuple[str, str]) -> dict:
    """Returns the initial values of :func:`memory_types` by name. The lattices ``fine`` (of the run), ``coarse`` (of
    the second run) and ``common`` are (points on a line, lines); ``ends`` is what continues a line beyond its ends, and
    the lattice beyond its first and last lines: "periodic", "mirror" or "free"."""
    smooth, cubic = (FIT_CELLS[0] * scene.ppc, FIT_CELLS[1] * scene.ppc), (CUBIC_COEFFICIENTS, CUBIC_COEFFICIENTS)
    values: dict = {}
    for table, source, target, fit in zip(TABLES, (fine, coarse, common), (common, common, fine),
                                          (smooth, smooth, cubic), strict=True):
        for k, way in enumerate(("along", "across")):
            values |= {f"two_grid_{table}_{way}_{member}": value for member, value in stencils(
                target_point_positions(target[k], source[k]), source[k], fit, ends[k]).items()}
    for lattice, (points, lines) in zip(LATTICES, (fine, coarse, common), strict=True):
        values |= {f"two_grid_{lattice}_points": points, f"two_grid_{lattice}_lines": lines}
    width, most = len(fields.along), max(math.prod(fine), math.prod(coarse))
    band = max(fine[1] * common[0], coarse[1] * common[0], common[1] * fine[0])
    return {**values, "two_grid_gain": extrapolation_factor(scene), "two_grid_interval": steps_per_coarse_step(scene),
            "two_grid_fields": np.zeros((most, width)), "two_grid_band": np.zeros((band, width)),
            "two_grid_common": np.zeros((math.prod(common), width)), "two_grid_largest": np.zeros(1)}


@ti.func
def clear_common_lattice(own: ti.template()):
    """Sets the fields on the common lattice to zero; ``own`` is the estimator's memory, without ``two_grid_``."""
    for t in range(own.common_points * own.common_lines):
        own.common[t] = own.common[t] * 0.0


@ti.func
def store_largest_error(own: ti.template(), square):
    """Stores the mean square of e_x, ``square`` in m^2, in the memory ``own`` if it is the largest so far, or NaN."""
    if not square <= own.largest[0]:
        own.largest[0] = square


@ti.func
def transfer_fields(own: ti.template(), fields: ti.template(), table: ti.template(), source: ti.template(),
                    at: ti.template(), into: ti.template(), to: ti.template(), share):
    """Adds to the fields ``into`` on the lattice ``to`` the ``share`` (a factor) of the fields ``source`` on the
    lattice ``at``, smoothed or interpolated by the stencils ``table``: names of ``LATTICES`` and ``TABLES``."""
    from_lattice, to_lattice = ti.static([prefix_view(own, at + "_"), prefix_view(own, to + "_")])
    along, across = ti.static([prefix_view(own, table + "_along_"), prefix_view(own, table + "_across_")])
    points, lines, wanted = from_lattice.points, from_lattice.lines, to_lattice.points
    for i in range(lines):
        for j in range(wanted):
            total = stencil_sum(along, fields.along, j, source, i * points, 1, points)
            if ti.static(len(fields.across) > 0):
                own.band[i * wanted + j] = total
            else:
                into[j] = into[j] + share * total
    if ti.static(len(fields.across) > 0):
        for i in range(to_lattice.lines):
            for j in range(wanted):
                into[i * wanted + j] = into[i * wanted + j] \
                    + share * stencil_sum(across, fields.across, i, own.band, j, wanted, lines)


@ti.func
def stencil_sum(table: ti.template(), picks: ti.template(), t, source: ti.template(), start, stride, count):
    """Returns the sum of stencil number ``t`` of a ``table`` over ``source``, whose ``count`` entries from ``start`` on
    lie ``stride`` apart and repeat periodically; ``picks`` is the weight (0 or 1) that each component takes."""
    row, entry = table.row[t], table.first[t]
    total = source[start] * 0.0
    for k in range(table.taps):
        w = table.weights[row + k]
        total += ti.Vector([w[pick] for pick in ti.static(picks)]) * source[start + stride * entry]
        entry = ti.select(entry + 1 == count, 0, entry + 1)
    return total


def steps_per_coarse_step(scene: Scene) -> int:
    """Returns the steps of the run per step of the coarse run: 2, for equal Courant numbers, to ``MOST_STEPS``.

    More where steps are so short that they could be longer without harm; preferably so many that the coarse run has
    just arrived whenever a sample is taken.
    """
    most = max(2, min(MOST_STEPS, int(MOST_COURANT / scene.courant_number)))
    return max((k for k in range(2, most + 1) if scene.sample_interval % k == 0), default=most)


def extrapolation_factor(scene: Scene) -> float:
    """Returns 1/(r^2 - 1), r the ratio of the second run's cells to the scene's: about 1/3."""
    return 1 / ((scene.cells / (scene.cells // 2)) ** 2 - 1)


def coarse_run_options(on: KernelOptions) -> KernelOptions:
    """Returns the second run's compile-time options from the run's: the bare method, and only the acceleration."""
    return on._replace(effects=("acceleration",), estimators=())


def coarse_run_verdict(scene: Scene, determinant: np.ndarray, displacement: np.ndarray, farthest: float,
                       largest: np.ndarray) -> str | None:
    """Returns why the coarse run cannot be used, as a sentence, or None. Some particle may be inverted or crushed (its
    ``determinant`` of F), or ``farthest`` m or more from its start (``displacement``), or the run lost: its error is
    r^2 times e_x while extrapolation is possible; ``largest`` (1,) is the largest mean square of e_x in m^2."""
    with np.errstate(invalid="ignore", over="ignore"):
        sound = np.all(determinant > CRUSHED_JACOBIAN) and np.all(np.abs(displacement) < farthest)  # False for NaN
        share = (1 + 1 / extrapolation_factor(scene)) * float(np.sqrt(largest[0])) / scene.motion_amplitude
    if not sound:
        return Message("not valid here: the second run, with half the cells, went unstable")
    if not share <= LOST_DISPLACEMENT:
        return Message("not valid here: the second run, with half the cells, seems to be {share:.2g} of the amplitude "
                       "off, too far to extrapolate; take more cells or end earlier", share)
    return None


def stencils(places: np.ndarray, count: int, windows: tuple[int, int], ends: str) -> dict:
    """Returns stencils at ``places`` (T,), in spacings from the first of ``count`` lattice points: the four members
    that ``STENCILS`` names. ``ends`` is "periodic", "mirror" or "free".

    ``windows`` are the numbers of points in fits of two kinds, with weights side by side, the shorter's padded with
    zeros; between mirrors all fits are of the first, and the weights those of components that are even and odd. Stencil
    t begins at point ``first[t]`` and its weights at ``weights[row[t]]``; equal ones are kept once, so any bar needs
    one row or a few. Stencils near free ends are one-sided, with the lower degree that fewer points than four allow.
    """
    taps = min(max(windows), count) if ends == "free" else windows[0] if ends == "mirror" else max(windows)
    first = _first_points(places, taps, count, ends)
    beyond = (taps > count) | (ends == "mirror") & ((first < 0) | (first + taps > count))
    offset, width = places - first, min(taps, count)
    start = np.where(beyond, np.clip(first, 0, count - width), first % count)
    _, where, rows = np.unique(np.stack([offset.round(9), np.where(beyond, places, -1.0)]), axis=1, return_index=True,
                               return_inverse=True)
    weights = np.zeros((len(where), width, 2))
    for row, t in enumerate(where):
        turns, index = np.divmod(first[t] + np.arange(taps), count)
        index, mirrored = np.where((ends == "mirror") & (turns % 2 == 1), count - 1 - index, index), 1 - 2 * (turns % 2)
        for kind, window in enumerate(windows):
            points = min(window, taps)
            begin = int(_first_points(places[t:t + 1], points, count, ends)[0] - first[t])
            powers = np.vander(np.arange(points) + begin - offset[t], min(CUBIC_COEFFICIENTS, points), increasing=True)
            fit = np.zeros(taps)
            fit[begin:begin + points] = np.linalg.pinv(powers)[0]
            if ends == "mirror" and kind:
                fit *= mirrored
            np.add.at(weights[row, :, kind], index - start[t] if beyond[t] else np.arange(taps), fit)
    return {"first": start.astype(np.int32), "row": (rows.ravel() * width).astype(np.int32), "taps": width,
            "weights": weights.reshape(-1, 2)}


def _first_points(places: np.ndarray, points: int, count: int, ends: str) -> np.ndarray:
    """Returns the index of the first of the ``points`` nearest lattice points, of ``count``, to each place (T,)."""
    first = np.round(places - 0.5 * (points - 1) + 1e-9).astype(int)
    return np.clip(first, 0, count - points) if ends == "free" else first


def target_point_positions(targets: int, count: int) -> np.ndarray:
    """Returns where even points (targets,) lie, in spacings of ``count`` over the same length, from their first."""
    return (np.arange(targets) + 0.5) * (count / targets) - 0.5
