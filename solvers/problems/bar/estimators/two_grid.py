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
from solvers.kernels.dtypes import quads
from solvers.kernels.packing import prefix_view
from solvers.problems.bar.estimator_limits import is_too_noisy_for_two_grid
from solvers.problems.bar.method.body import BarBody, initial_body
from solvers.problems.bar.method.phases import nodes_to_particles, update_grid
from solvers.scene.estimator_hooks import EstimatorHooks
from solvers.scene.kernel_options import kernel_options_of

FIELDS = two_grid.ComponentWeightChoice(along=(0, 0, 0, 1))  # u, v, sigma; and a, whose fits go over more cells
MEMORY = {
    **{"coarse_" + name: kind for name, kind in BarBody.types().items()},
    **two_grid.memory_types(quads),
    "two_grid_before": quads,  # F and a of the second bar a step ago, a two steps ago, and nothing
    "two_grid_noisy": ti.i32,  # whether a is not estimated
}


@ti.func
def after_step(bar: ti.template(), base, step, on: ti.template()):
    """Takes one step of the second bar, ``coarse_dt`` in s long and ending at the run's ``step``; stores its F and a
    before the step, for their rates. ``on``: compile-time options."""
    coarse, bare = ti.static([prefix_view(bar, "coarse_"), two_grid.coarse_run_options(on)])
    for q in range(coarse.particles):
        bar.two_grid_before[q] = ti.Vector([
            coarse.deformation_gradient[q], coarse.acceleration[q], bar.two_grid_before[q][1], 0.0])
    update_grid(coarse, step * bar.dt - coarse.dt, bare)
    nodes_to_particles(coarse, 0, bare)


@ti.func
def report(bar: ti.template(), base, step, on: ti.template()):
    """Stores e = q_h - I q* of all particles after ``step`` steps (x, v, sigma, a in SI) in ``bar.estimate`` from
    ``base`` on; 0 for a as long as the second bar has only that of the start. ``on``: compile-time options."""
    own, coarse = ti.static([prefix_view(bar, "two_grid_"), prefix_view(bar, "coarse_")])
    two_grid.clear_common_lattice(own)
    store_run_fields(bar, own, on)
    two_grid.transfer_fields(own, FIELDS, "down", own.fields, "fine", own.common, "common", 1 + own.gain)
    store_coarse_fields(bar, own, coarse, step)
    two_grid.transfer_fields(own, FIELDS, "over", own.fields, "coarse", own.common, "common", -own.gain)
    store_run_fields(bar, own, on)
    two_grid.transfer_fields(own, FIELDS, "up", own.common, "common", own.fields, "fine", -1.0)
    square = 0.0
    for p in range(bar.particles):
        e = own.fields[p]
        square += e[0] ** 2
        if own.noisy or ti.static(not on.acceleration):
            e[3] = ti.math.nan
        elif step < 2 * own.interval:
            e[3] = 0.0
        bar.estimate[base + p] = e
    two_grid.store_largest_error(own, square / bar.particles)


@ti.func
def store_run_fields(bar: ti.template(), own: ti.template(), on: ti.template()):
    """Stores u, v, sigma, a of the run's particles in SI in the estimator's ``own.fields``. ``on``: kernel options."""
    for p in range(bar.particles):
        a = 0.0
        if ti.static(on.acceleration):
            a = bar.acceleration[p]
        own.fields[p] = ti.Vector([bar.position[p] - bar.material_position[p], bar.velocity[p],
                                   bar.modulus * (bar.deformation_gradient[p] - 1), a])


@ti.func
def store_coarse_fields(bar: ti.template(), own: ti.template(), coarse: ti.template(), step):
    """Stores u, v, sigma and a of the second bar, ``coarse``, in ``own.fields``, extrapolated by ``late`` seconds from
    its last step to the run's ``step``.

    Its v belongs to half a step before, the run's to dt/2 before now, and the extrapolated one shall belong to now: the
    v taken here is early by r^2 dt/2 on purpose, which cancels what (r^2 S v_h) lacks. Its a belongs to a step before,
    and follows a parabola, as soon as there are three: along a line it was off by more than its error on a free bar.
    """
    dt, H = bar.dt, coarse.dt
    late = step % own.interval * dt
    early = 0.5 * dt * (1 + 1 / own.gain)
    for q in range(coarse.particles):
        before = own.before[q]
        a, F = coarse.acceleration[q], coarse.deformation_gradient[q]
        a_rate, F_rate = (a - before[1]) / H, (F - before[0]) / H
        now = a + (late + H) * a_rate
        bend = ti.select(step >= 3 * own.interval, (a - 2 * before[1] + before[2]) / (H * H), 0.0)
        ahead = late + H - dt
        v = coarse.velocity[q]
        u = coarse.position[q] - coarse.material_position[q] + late * (v + 0.5 * (late + H) * now)
        own.fields[q] = ti.Vector([u, v + (late + 0.5 * H - early) * now, coarse.modulus * (F + late * F_rate - 1),
                                   a + ahead * (a_rate + 0.5 * (ahead + H) * bend)])


def coarse_scene(scene):
    """Returns the scene of the second bar: half the cells, a longer step, no estimators or effects."""
    return replace(scene, cells=scene.cells // 2, dt=two_grid.steps_per_coarse_step(scene) * scene.time_step, cfl=None,
                   sample_every=None, estimators=(), effects=())


def allocate(scene):
    """Returns the estimator's arrays by name: the second bar at its start, and the tables of the comparison."""
    second = coarse_scene(scene)
    fine, coarse = (scene.particles, 1), (second.particles, 1)
    members = initial_body(second, two_grid.coarse_run_options(kernel_options_of(second)))
    return {**{"coarse_" + name: value for name, value in members.items()},
            **two_grid.allocate(scene, FIELDS, fine, coarse, coarse, ("periodic", "free")),
            "two_grid_before": np.tile([1.0, 0.0, 0.0, 0.0], (second.particles, 1)),
            "two_grid_noisy": is_too_noisy_for_two_grid(scene)}


def verdict(scene, memory):
    """Returns a sentence why the second bar cannot be used, or None; ``memory`` has the estimator's arrays by name."""
    moved = memory["coarse_position"] - memory["coarse_material_position"]
    return two_grid.coarse_run_verdict(scene, memory["coarse_deformation_gradient"], moved,
                                       min(0.5, 20 * scene.motion_amplitude), memory["two_grid_largest"])


HOOKS = EstimatorHooks(memory=MEMORY, allocate=allocate, interval=two_grid.steps_per_coarse_step, after_step=after_step,
                       report=report, verdict=verdict)
