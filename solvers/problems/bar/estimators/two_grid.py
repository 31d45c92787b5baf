"""Richardson's estimate on the bar: a second bar with half the cells (see ``solvers.estimators.two_grid``).

Table 1 with the force at material points, 20 to 160 cells: in the small case indices are x .92-1.06, v .94-1.08,
sigma 1.03-1.04, a .92-.98, distances .05-.35; in the large one x .99-1.22, v .96-1.09, sigma .99-1.05, a .75-.93,
distances .4-1.4: the error there is waves of a few cells and their traces, different ones on each grid, so that its
size is right and not the places. Costs 10-30 % of the running time.
"""

from dataclasses import replace

import numpy as np
import taichi as ti

from solvers.estimators import two_grid
from solvers.kernels.kinds import quads, real, reals
from solvers.kernels.packing import part
from solvers.problems.bar.limits import noisy
from solvers.problems.bar.method.body import BarBody, body
from solvers.problems.bar.method.phases import nodes_to_particles, update_grid
from solvers.scene.estimator_hooks import EstimatorHooks
from solvers.scene.switches import switches

IMAGES = 4  # images of the common lattice's points beyond either end

TABLES = ("down", "across", "up")  # from the run's lattice to the common one, from the second run's, and back
MEMORY = {
    **{"coarse_" + name: kind for name, kind in BarBody.types().items()},
    **{f"two_grid_{name}_{member}": kind for name in TABLES for member, kind in two_grid.MEMBERS.items()},
    "two_grid_gain": real, "two_grid_interval": ti.i32,  # 1/(r^2 - 1); steps to one of the second run
    "two_grid_before": quads,  # F and a of the second bar a step ago, a two steps ago, and nothing
    "two_grid_fields": quads,  # u, v, sigma, a of either run, with images
    "two_grid_common": quads,  # the extrapolated ones on the second bar's lattice, with images
    "two_grid_noisy": ti.i32,  # whether nothing is said of a
    "two_grid_largest": reals,  # the largest mean square of e_x that was reported
}


@ti.func
def after_step(bar: ti.template(), base, step, on: ti.template()):
    """One step of the second bar, from ``coarse_dt`` ago until now; F and a before it are kept, for their rates."""
    coarse, bare = ti.static([part(bar, "coarse_"), two_grid.bare(on)])
    for q in range(coarse.particles):
        bar.two_grid_before[q] = ti.Vector([
            coarse.deformation_gradient[q], coarse.acceleration[q], bar.two_grid_before[q][1], 0.0])
    update_grid(coarse, step * bar.dt - coarse.dt, bare)
    nodes_to_particles(coarse, 0, bare)


@ti.func
def report(bar: ti.template(), base, step, on: ti.template()):
    """The run's fields less the extrapolated ones, q*, on the common lattice, which is the second bar's."""
    own, coarse = ti.static([part(bar, "two_grid_"), part(bar, "coarse_")])
    for q in range(bar.coarse_particles + 2 * IMAGES):
        own.common[q] = ti.Vector([0.0, 0.0, 0.0, 0.0])
    for p in range(bar.particles):
        own.fields[own.down_taps + p] = fields_of(bar, p, on)
    close(own.fields, bar.particles, own.down_taps)
    smooth(part(bar, "two_grid_down_"), own.fields, 1 + own.gain, own.common, bar.coarse_particles)
    coarse_fields(bar, own, coarse, step)
    close(own.fields, bar.coarse_particles, own.across_taps)
    smooth(part(bar, "two_grid_across_"), own.fields, -own.gain, own.common, bar.coarse_particles)
    close(own.common, bar.coarse_particles, IMAGES)
    subtract(bar, own, part(bar, "two_grid_up_"), base, step < 2 * own.interval, on)


@ti.func
def fields_of(bar: ti.template(), p, on: ti.template()):
    """u, v, sigma and a of a particle of the run."""
    a = 0.0
    if ti.static(on.acceleration):
        a = bar.acceleration[p]
    return ti.Vector([bar.position[p] - bar.material_position[p], bar.velocity[p],
                      bar.modulus * (bar.deformation_gradient[p] - 1), a])


@ti.func
def coarse_fields(bar: ti.template(), own: ti.template(), coarse: ti.template(), step):
    """The same of the second bar, carried on from its last step to the present one, ``late`` seconds.

    Its v belongs to half a step before, the run's to dt/2 before now, and the extrapolated one shall belong to now: the
    v taken here is early by r^2 dt/2 on purpose, which cancels what (r^2 S v_h) lacks. Its a belongs to a step before,
    and follows a parabola, as soon as there are three: along a line it was off by more than its error on a free bar.
    """
    dt, H = bar.dt, coarse.dt
    late = step % own.interval * dt
    early = 0.5 * dt * (1 + 1 / own.gain)
    ghosts = own.across_taps
    for q in range(coarse.particles):
        before = own.before[q]
        a, F = coarse.acceleration[q], coarse.deformation_gradient[q]
        a_rate, F_rate = (a - before[1]) / H, (F - before[0]) / H
        now = a + (late + H) * a_rate
        bend = ti.select(step >= 3 * own.interval, (a - 2 * before[1] + before[2]) / (H * H), 0.0)
        ahead = late + H - dt
        v = coarse.velocity[q]
        u = coarse.position[q] - coarse.material_position[q] + late * (v + 0.5 * (late + H) * now)
        own.fields[ghosts + q] = ti.Vector([u, v + (late + 0.5 * H - early) * now,
                                            coarse.modulus * (F + late * F_rate - 1),
                                            a + ahead * (a_rate + 0.5 * (ahead + H) * bend)])


@ti.func
def close(fields: ti.template(), count, ghosts):
    """Copy periodic images to both ends, outwards, so that a lattice may be shorter than its images."""
    for k in range(ghosts):
        fields[ghosts + count + k] = fields[ghosts + k]
        fields[ghosts - 1 - k] = fields[ghosts - 1 - k + count]


@ti.func
def smooth(stencils: ti.template(), fields: ti.template(), part, common: ti.template(), count):
    """Add a part of the smoothed fields to the common lattice."""
    taps = stencils.taps
    for t in range(count):
        first, row = stencils.first[t] + taps, stencils.row[t]
        total = ti.Vector([0.0, 0.0, 0.0, 0.0])
        for k in range(taps):
            w = stencils.weights[row + k]
            total += ti.Vector([w[0], w[0], w[0], w[1]]) * fields[first + k]
        common[IMAGES + t] = common[IMAGES + t] + part * total


@ti.func
def subtract(bar: ti.template(), own: ti.template(), stencils: ti.template(), base, early, on: ti.template()):
    """e = q_h - I q*; nothing yet of a, if it is so ``early`` that the second bar has had only that of the start."""
    square = 0.0
    for p in range(bar.particles):
        first, row = stencils.first[p] + IMAGES, stencils.row[p]
        e = fields_of(bar, p, on)
        for k in ti.static(range(two_grid.CUBIC)):
            e = e - stencils.weights[row + k][0] * own.common[first + k]  # -= of a whole vector aborts the compiler
        square += e[0] ** 2
        if own.noisy or ti.static(not on.acceleration):
            e[3] = ti.math.nan
        elif early:
            e[3] = 0.0
        bar.estimate[base + p] = e
    if not square <= bar.particles * own.largest[0]:  # what is no number replaces any
        own.largest[0] = square / bar.particles


def coarse_scene(scene):
    """The scene of the second run."""
    return replace(scene, cells=scene.cells // 2, dt=two_grid.interval(scene) * scene.time_step, cfl=None,
                   sample_every=None, estimators=(), effects=())


def allocate(scene):
    """The second bar at its start, the tables of stencils, and room for fields on both lattices."""
    second = coarse_scene(scene)
    P, Q = scene.particles, second.particles
    members = body(second, two_grid.bare(switches(second)))
    windows = two_grid.windows(scene.ppc)
    tables = {"down": two_grid.stencils(two_grid.centres(Q, P), P, windows, closed=False),
              "across": two_grid.stencils(two_grid.centres(Q, Q), Q, windows, closed=False),
              "up": two_grid.stencils(two_grid.centres(P, Q), Q, (two_grid.CUBIC, two_grid.CUBIC), closed=False)}
    return {
        **{"coarse_" + name: value for name, value in members.items()},
        **{f"two_grid_{name}_{member}": value for name, t in tables.items() for member, value in t.items()},
        "two_grid_gain": two_grid.gain(scene), "two_grid_interval": two_grid.interval(scene),
        "two_grid_before": np.tile([1.0, 0.0, 0.0, 0.0], (Q, 1)),
        "two_grid_fields": np.zeros((P + 2 * max(windows), 4)), "two_grid_common": np.zeros((Q + 2 * IMAGES, 4)),
        "two_grid_noisy": noisy(scene), "two_grid_largest": np.zeros(1)}


def verdict(scene, memory):
    """Whether the second bar is sound, and near enough."""
    moved = memory["coarse_position"] - memory["coarse_material_position"]
    return two_grid.coarse_run_verdict(scene, memory["coarse_deformation_gradient"], moved,
                                       min(0.5, 20 * scene.motion_amplitude), memory["two_grid_largest"])


HOOKS = EstimatorHooks(memory=MEMORY, allocate=allocate, interval=two_grid.interval, after_step=after_step,
                     report=report, verdict=verdict)
