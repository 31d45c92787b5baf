"""Richardson's estimate on a polar lattice between symmetry planes: the same scene on half the cells (see
``solvers.estimators.two_grid``).

Fields are compared in polar components on a common lattice of angles and radii, the second run's (but of four radii at
least, for cubics). Lattices go on beyond the symmetry planes as mirror images, in which the angular components are odd;
at the free surfaces fits are one-sided.

CPDI on a ring at A = 0.1, one period, 12 to 96 cells: indices of x .97-1.00 (distance .23 to .07), v .99-1.13 (.86 to
.13), sigma .98-1.14 (1.0 to .4), at 6-18 % of the running time. Nothing is said of a: its error is noise of a cell's
length, which each grid has in other places, so that no difference of the two tells where it is (distances of .5 to
1.3).
"""

import functools
from dataclasses import fields

import numpy as np
import taichi as ti

from solvers.estimators import two_grid
from solvers.kernels.kinds import octets, pairs, quads, real, reals
from solvers.kernels.packing import part
from solvers.problems.planar.method.body import PlanarBody, initial_body
from solvers.problems.planar.method.neo_hookean import cauchy_stress, cauchy_stress_of
from solvers.problems.planar.method.phases import nodes_to_particles, update_grid
from solvers.problems.planar.parts import Traits
from solvers.scene.estimator_hooks import EstimatorHooks
from solvers.scene.switches import switches

#: Stencils from the run's lattice down to the common one, from the second run's across to it, and up to the run's.
TABLES = tuple(f"{way}_{along}" for way in ("down", "across", "up") for along in ("radius", "angle"))
FEWEST_CELLS = 6
PARITY = (1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, 1.0)  # of the mirror image of u_R, u_t, v_R, v_t, s_RR, s_Rt, s_tt

MEMORY = {
    **{"coarse_" + name: kind for name, kind in PlanarBody.types().items()},
    **{f"two_grid_{name}_{member}": kind for name in TABLES for member, kind in two_grid.MEMBERS.items()},
    "two_grid_gain": real, "two_grid_interval": ti.i32,  # 1/(r^2 - 1); steps to one of the second run
    "two_grid_angles": ti.i32, "two_grid_coarse_angles": ti.i32, "two_grid_common_radii": ti.i32,  # of the lattices
    "two_grid_before": quads, "two_grid_before_a": pairs,  # F and a of the second run a step ago
    "two_grid_fields": octets,  # u, v and sigma of either run, in polar components
    "two_grid_band": octets,  # the same at the wanted radii, with images
    "two_grid_common": octets,  # the extrapolated ones on the common lattice
    "two_grid_largest": reals,  # the largest mean square of e_x that was reported
}


@ti.func
def after_step(body: ti.template(), step, traits: ti.template(), on: ti.template()):
    """One step of the second run, from ``coarse_dt`` ago until now; F and a before it are kept, for their rates."""
    coarse, bare = ti.static([part(body, "coarse_"), two_grid.bare(on)])
    for q in range(coarse.particles):
        body.two_grid_before[q] = coarse.deformation_gradient[q]
        body.two_grid_before_a[q] = coarse.acceleration[q]
    update_grid(coarse, step * body.dt - coarse.dt, traits, bare)
    nodes_to_particles(coarse, 0, 0, traits, bare)


@ti.func
def report(body: ti.template(), base, step, on: ti.template()):
    """Both runs' fields down to the common lattice, extrapolated, up to the run's particles again, and the run's less
    these."""
    own, coarse = ti.static([part(body, "two_grid_"), part(body, "coarse_")])
    for t in range(own.coarse_angles * own.common_radii):
        own.common[t] = ti.Vector([0.0] * 8)
    run_fields(body, own)
    smooth(own, part(body, "two_grid_down_radius_"), part(body, "two_grid_down_angle_"), own.angles,
           body.particles // own.angles, 1 + own.gain)
    coarse_fields(body, own, coarse, step)
    smooth(own, part(body, "two_grid_across_radius_"), part(body, "two_grid_across_angle_"), own.coarse_angles,
           body.coarse_particles // own.coarse_angles, -own.gain)
    across = body.particles // own.angles
    along_radius(own, part(body, "two_grid_up_radius_"), own.common, own.coarse_angles, own.common_radii, across,
                 two_grid.CUBIC)
    reflect(own, own.coarse_angles, across, two_grid.CUBIC)
    run_fields(body, own)
    subtract(body, own, part(body, "two_grid_up_angle_"), across, base)


@ti.func
def polar(direction, x, y):
    """Components along and across e_R."""
    return direction[0] * x + direction[1] * y, direction[0] * y - direction[1] * x


@ti.func
def record(displacement_x, displacement_y, v_x, v_y, direction, sigma):
    """u, v and the Cauchy stress, given as xx, xy, yy, in polar components."""
    u_R, u_t = polar(direction, displacement_x, displacement_y)
    v_R, v_t = polar(direction, v_x, v_y)
    c, s = direction[0], direction[1]
    turned = 2 * c * s * sigma[1]
    return ti.Vector([u_R, u_t, v_R, v_t, c * c * sigma[0] + s * s * sigma[2] + turned,
                      c * s * (sigma[2] - sigma[0]) + (c * c - s * s) * sigma[1],
                      s * s * sigma[0] + c * c * sigma[2] - turned, 0.0])


@ti.func
def run_fields(body: ti.template(), own: ti.template()):
    """Fields of the run, as they are."""
    for p in range(body.particles):
        q, X, e = body.position_velocity[p], body.material_position[p], body.direction[p]
        own.fields[p] = record(q[0] - X[0], q[1] - X[1], q[2], q[3], e, cauchy_stress(body, p))


@ti.func
def coarse_fields(body: ti.template(), own: ti.template(), coarse: ti.template(), step):
    """Fields of the second run, carried on from its last step to the present one, ``late`` seconds.

    v is early by r^2 dt/2 on purpose: see ``coarse_fields`` of the bar.
    """
    dt, H = body.dt, coarse.dt
    late = step % own.interval * dt
    early = 0.5 * dt * (1 + 1 / own.gain)
    for p in range(coarse.particles):
        q, X, e, F, a = coarse.position_velocity[p], coarse.material_position[p], coarse.direction[p], \
            coarse.deformation_gradient[p], coarse.acceleration[p]
        a_rate = (a - own.before_a[p]) / H
        now = a + (late + H) * a_rate
        G = F + (late / H) * (F - own.before[p])
        sigma = cauchy_stress_of(coarse, G)
        ahead, drift = late + 0.5 * H - early, 0.5 * late * (late + H)
        own.fields[p] = record(q[0] - X[0] + late * q[2] + drift * now[0], q[1] - X[1] + late * q[3] + drift * now[1],
                               q[2] + ahead * now[0], q[3] + ahead * now[1], e, sigma)


@ti.func
def smooth(own: ti.template(), by_radius: ti.template(), by_angle: ti.template(), angles, across, part):
    """Add a part of the smoothed fields, given on ``angles`` x ``across`` points, to the common lattice."""
    along_radius(own, by_radius, own.fields, angles, across, own.common_radii, by_angle.taps)
    reflect(own, angles, own.common_radii, by_angle.taps)
    for i in range(own.coarse_angles):
        for j in range(own.common_radii):
            at = i * own.common_radii + j
            own.common[at] = own.common[at] + part * angular_sum(own, by_angle, i, j, own.common_radii)


@ti.func
def along_radius(own: ti.template(), stencils: ti.template(), source: ti.template(), angles, across, width, images):
    """Bring a lattice of ``angles`` x ``across`` points into the band, to ``width`` points at each angle."""
    for i in range(angles):
        for j in range(width):
            first, start = i * across + stencils.first[j], stencils.row[j]
            total = ti.Vector([0.0] * 8)
            for k in range(stencils.taps):
                total += stencils.weights[start + k][0] * source[first + k]
            own.band[(images + i) * width + j] = total


@ti.func
def reflect(own: ti.template(), angles, width, images):
    """Mirror images beyond both planes, outwards, so that there may be more of them than angles."""
    sign = ti.Vector(PARITY)
    for k in range(images):
        for j in range(width):
            inner, outer = (images + k) * width + j, (images - 1 - k) * width + j
            own.band[outer] = sign * own.band[inner]
            inner, outer = (images + angles - 1 - k) * width + j, (images + angles + k) * width + j
            own.band[outer] = sign * own.band[inner]


@ti.func
def angular_sum(own: ti.template(), stencils: ti.template(), i, j, width):
    """Stencil i along the angle, at point j of the band; there are as many images as taps."""
    first, start = (stencils.first[i] + stencils.taps) * width + j, stencils.row[i]
    total = ti.Vector([0.0] * 8)
    for k in range(stencils.taps):
        total += stencils.weights[start + k][0] * own.band[first + k * width]
    return total


@ti.func
def subtract(body: ti.template(), own: ti.template(), stencils: ti.template(), across, base):
    """e = q_h - I q*, in Cartesian components."""
    square = 0.0
    for i in range(own.angles):
        for j in range(across):
            p = i * across + j
            e = own.fields[p] - angular_sum(own, stencils, i, j, across)
            square += e[0] ** 2 + e[1] ** 2
            c, s = body.direction[p][0], body.direction[p][1]
            body.estimate[base + p] = ti.Vector([c * e[0] - s * e[1], s * e[0] + c * e[1],
                                                 c * e[2] - s * e[3], s * e[2] + c * e[3]])
            turned = 2 * c * s * e[5]
            body.estimate_stress[base + p] = ti.Vector([
                c * c * e[4] + s * s * e[6] - turned, c * s * (e[4] - e[6]) + (c * c - s * s) * e[5],
                s * s * e[4] + c * c * e[6] + turned, 0.0])
            body.estimate_acceleration[base + p] = ti.Vector([ti.math.nan] * 2)
    if not square <= body.particles * own.largest[0]:  # what is no number replaces any
        own.largest[0] = square / body.particles


@functools.cache
def second_kind(kind: type) -> type:
    """The class of a problem's scenes on a grid so coarse that none would run it for its own sake."""
    return type("SecondScene", (kind,), {"FEWEST_CELLS": FEWEST_CELLS})


def coarse_scene(scene):
    """The scene of the second run."""
    own = {f.name: getattr(scene, f.name) for f in fields(scene)}
    return second_kind(type(scene))(**{
        **own, "cells": scene.cells // 2, "dt": two_grid.interval(scene) * scene.time_step, "cfl": None,
        "sample_every": None, "estimators": (), "effects": (), "plan": "serial", "threads": 1})


def all_stencils(scene, second):
    """The six tables, and the numbers of points (around, across) of the run's, the second's and the common lattice."""
    fine, coarse = (s.polar_counts(s.cells, s.ppc) for s in (scene, second))
    common = coarse[0], max(coarse[1], two_grid.CUBIC)
    windows, cubic = two_grid.windows(scene.ppc), (two_grid.CUBIC, two_grid.CUBIC)
    tables = {}
    for way, source, target, fit in (("down", fine, common, windows), ("across", coarse, common, windows),
                                     ("up", common, fine, cubic)):
        for along, k in (("radius", 1), ("angle", 0)):
            tables[f"{way}_{along}"] = two_grid.stencils(two_grid.centres(target[k], source[k]), source[k], fit,
                                                     closed=along == "radius")
    return tables, fine, coarse, common


def allocate(scene):
    """The second run at its start, the tables of stencils, and room for fields on all lattices."""
    second = coarse_scene(scene)
    members = initial_body(second, two_grid.bare(switches(second)), slabs=1)
    Q = members["particles"]
    tables, fine, coarse, common = all_stencils(scene, second)
    P, C = fine[0] * fine[1], common[0] * common[1]
    band = max((fine[0] + 2 * tables["down_angle"]["taps"]) * common[1],
               (coarse[0] + 2 * tables["across_angle"]["taps"]) * common[1],
               (common[0] + 2 * two_grid.CUBIC) * fine[1])
    return {
        **{"coarse_" + name: value for name, value in members.items()},
        **{f"two_grid_{name}_{member}": value for name, t in tables.items() for member, value in t.items()},
        "two_grid_gain": two_grid.gain(scene), "two_grid_interval": two_grid.interval(scene),
        "two_grid_angles": fine[0], "two_grid_coarse_angles": coarse[0], "two_grid_common_radii": common[1],
        "two_grid_before": members["deformation_gradient"], "two_grid_before_a": np.zeros((Q, 2)),
        "two_grid_fields": np.zeros((max(P, Q), 8)), "two_grid_band": np.zeros((band, 8)),
        "two_grid_common": np.zeros((C, 8)), "two_grid_largest": np.zeros(1)}


def verdict(scene, memory):
    """Whether the second run is sound, and near enough."""
    F, farthest = memory["coarse_deformation_gradient"].T, 1.5 * scene.amplitude + 2 * scene.spacing
    with np.errstate(invalid="ignore", over="ignore"):
        moved = memory["coarse_position_velocity"][:, :2] - memory["coarse_material_position"]
        determinant = F[0] * F[3] - F[1] * F[2]
        return two_grid.coarse_run_verdict(scene, determinant, moved, farthest, memory["two_grid_largest"])


def hooks(traits: Traits) -> EstimatorHooks:
    """The estimator of a problem with these traits."""
    @ti.func
    def its_step(body: ti.template(), base, step, on: ti.template()):
        after_step(body, step, traits, on)

    return EstimatorHooks(memory=MEMORY, allocate=allocate, interval=two_grid.interval, after_step=its_step,
                          report=report, verdict=verdict)
