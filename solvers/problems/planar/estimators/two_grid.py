"""Richardson's estimate between symmetry planes: the scene on half the cells (see ``solvers.estimators.two_grid``).

Fields are compared on the second run's lattice: of a square in x and y, of a ring in polar components (and on four
radii at least, for cubics). Lattices go on beyond the symmetry planes as mirror images, in which components across the
plane are odd; at free surfaces fits are one-sided.

CPDI on a ring at A = 0.1, one period, 12 to 96 cells: indices of x .97-1.00 (distance .23 to .07), v .99-1.13 (.86 to
.13), sigma .98-1.14 (1.0 to .4), at 6-18 % of the running time. a is not estimated: its error is noise of a cell's
length, at other places on each grid, so that the difference does not locate it (distances of .5 to 1.3).
"""

import functools
from dataclasses import fields

import numpy as np
import taichi as ti

from solvers.estimators import two_grid
from solvers.kernels.dtypes import octets, pairs, quads
from solvers.kernels.packing import prefix_view
from solvers.problems.planar.method.body import PlanarBody, initial_body
from solvers.problems.planar.method.material_laws import cauchy_stress, cauchy_stress_of
from solvers.problems.planar.method.phases import map_and_update_nodes, nodes_to_particles
from solvers.problems.planar.method.tensor_rotation import rotate_tensor, rotate_vector
from solvers.problems.planar.problem_kernel_functions import ProblemStepFunctions
from solvers.scene.estimator_hooks import EstimatorHooks
from solvers.scene.kernel_options import kernel_options_of

FEWEST_CELLS = 6
#: u, v and sigma, of which the second component is odd across the planes at the first and the last line, with the shear
#: stress; of a box the first is, and again the shear stress, at the ends of each line.
ACROSS = (0, 1, 0, 1, 0, 1, 0, 0)
POLAR, BOX = (two_grid.ComponentWeightChoice(along, ACROSS) for along in ((0,) * 8, (1, 0, 1, 0, 0, 1, 0, 0)))

MEMORY = {
    **{"coarse_" + name: kind for name, kind in PlanarBody.types().items()},
    **two_grid.memory_types(octets),
    "two_grid_before": quads, "two_grid_before_a": pairs,  # F and a of the second run a step ago
}


@ti.func
def after_step(body: ti.template(), step, traits: ti.template(), on: ti.template()):
    """Takes one step of the second run, to the run's ``step``; stores its F and a before that, for their rates."""
    coarse, bare = ti.static([prefix_view(body, "coarse_"), two_grid.coarse_run_options(on)])
    for q in range(coarse.particles):
        body.two_grid_before[q] = coarse.deformation_gradient[q]
        body.two_grid_before_a[q] = coarse.acceleration[q]
    map_and_update_nodes(coarse, step * body.dt - coarse.dt, traits, bare)
    nodes_to_particles(coarse, 0, 0, traits, bare)


@ti.func
def report(body: ti.template(), base, step, fields: ti.template(), on: ti.template()):
    """Writes the errors e = q_h - I q* of x, v and sigma after ``step`` steps, in Cartesian components and SI units, to
    the ``estimate`` arrays from entry ``base`` on. ``fields`` are :class:`two_grid.ComponentWeightChoice`."""
    own, coarse = ti.static([prefix_view(body, "two_grid_"), prefix_view(body, "coarse_")])
    two_grid.clear_common_lattice(own)
    store_run_fields(body, own, on)
    two_grid.transfer_fields(own, fields, "down", own.fields, "fine", own.common, "common", 1 + own.gain)
    store_coarse_fields(body, own, coarse, step, on)
    two_grid.transfer_fields(own, fields, "over", own.fields, "coarse", own.common, "common", -own.gain)
    store_run_fields(body, own, on)
    two_grid.transfer_fields(own, fields, "up", own.common, "common", own.fields, "fine", -1.0)
    square = 0.0
    for p in range(body.particles):
        e = own.fields[p]
        square += e[0] ** 2 + e[1] ** 2
        axis = body.direction[p]
        x, v, sigma = (rotate_vector(axis, e[0], e[1]), rotate_vector(axis, e[2], e[3]),
                       rotate_tensor(axis, e[4], e[5], e[6]))
        body.estimate[base + p] = ti.Vector([x[0], x[1], v[0], v[1]])
        body.estimate_stress[base + p] = ti.Vector([sigma[0], sigma[1], sigma[2], 0.0])
        body.estimate_acceleration[base + p] = ti.Vector([ti.math.nan] * 2)
    two_grid.store_largest_error(own, square / body.particles)


@ti.func
def fields_in_local_axes(u_x, u_y, v_x, v_y, direction, sigma):
    """Returns u, v and Cauchy stress ``sigma`` (xx, xy, yy) in components along and across the unit vector
    ``direction``, as a vector of eight with a last 0."""
    back = ti.Vector([direction[0], -direction[1]])
    u, v = rotate_vector(back, u_x, u_y), rotate_vector(back, v_x, v_y)
    local = rotate_tensor(back, sigma[0], sigma[1], sigma[2])
    return ti.Vector([u[0], u[1], v[0], v[1], local[0], local[1], local[2], 0.0])


@ti.func
def store_run_fields(body: ti.template(), own: ti.template(), on: ti.template()):
    """Stores the run's fields (:func:`fields_in_local_axes`) in ``two_grid_fields``."""
    for p in range(body.particles):
        q, X, e = body.position_velocity[p], body.material_position[p], body.direction[p]
        own.fields[p] = fields_in_local_axes(q[0] - X[0], q[1] - X[1], q[2], q[3], e, cauchy_stress(body, p, on))


@ti.func
def store_coarse_fields(body: ti.template(), own: ti.template(), coarse: ti.template(), step, on: ti.template()):
    """Stores the second run's fields (:func:`fields_in_local_axes`) in ``two_grid_fields``, extrapolated by ``late``
    seconds from its last step to ``step``. v is early by r^2 dt/2 on purpose: see ``store_coarse_fields`` of the bar.
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
        sigma = cauchy_stress_of(coarse, G, on)
        ahead, drift = late + 0.5 * H - early, 0.5 * late * (late + H)
        own.fields[p] = fields_in_local_axes(q[0] - X[0] + late * q[2] + drift * now[0],
                                             q[1] - X[1] + late * q[3] + drift * now[1], q[2] + ahead * now[0],
                                             q[3] + ahead * now[1], e, sigma)


@functools.cache
def coarse_scene_class(kind: type) -> type:
    """Returns a subclass of the scene class ``kind`` that allows grids too coarse for a run of their own."""
    return type("SecondScene", (kind,), {"FEWEST_CELLS": FEWEST_CELLS})


def coarse_scene(scene):
    """Returns the scene of two-grid's second run, with half the cells and steps of a multiple, from the run's."""
    own = {f.name: getattr(scene, f.name) for f in fields(scene)}
    return coarse_scene_class(type(scene))(**{
        **own, "cells": scene.cells // 2, "dt": two_grid.steps_per_coarse_step(scene) * scene.time_step, "cfl": None,
        "sample_every": None, "estimators": (), "effects": (), "plan": "serial", "threads": 1})


def allocate(scene):
    """Returns two-grid's memory by name for a scene: the second run at its start, and the tables of the comparison."""
    second, box = coarse_scene(scene), scene.layout == "box"
    members = initial_body(second, two_grid.coarse_run_options(kernel_options_of(second)), slabs=1)
    fine, coarse = (one.lattice_counts(one.cells, one.ppc)[::-1] for one in (scene, second))
    common = max(coarse[0], two_grid.CUBIC_COEFFICIENTS), coarse[1]
    return {**{"coarse_" + name: value for name, value in members.items()},
            **two_grid.allocate(scene, BOX if box else POLAR, fine, coarse, common,
                                ("mirror" if box else "free", "mirror")),
            "two_grid_before": members["deformation_gradient"], "two_grid_before_a": np.zeros((second.particles, 2))}


def verdict(scene, memory):
    """Returns why two-grid's second run cannot be used, as a sentence, or None; ``memory`` are arrays by name."""
    F, farthest = memory["coarse_deformation_gradient"].T, 1.5 * scene.motion_amplitude + 2 * scene.spacing
    with np.errstate(invalid="ignore", over="ignore"):
        moved = memory["coarse_position_velocity"][:, :2] - memory["coarse_material_position"]
        determinant = F[0] * F[3] - F[1] * F[2]
        return two_grid.coarse_run_verdict(scene, determinant, moved, farthest, memory["two_grid_largest"])


def hooks(traits: ProblemStepFunctions, fields: two_grid.ComponentWeightChoice) -> EstimatorHooks:
    """Returns two-grid's hooks for the problem with the kernel functions ``traits``; ``fields`` are those compared."""
    @ti.func
    def its_step(body: ti.template(), base, step, on: ti.template()):
        after_step(body, step, traits, on)

    @ti.func
    def its_report(body: ti.template(), base, step, on: ti.template()):
        report(body, base, step, fields, on)

    return EstimatorHooks(memory=MEMORY, allocate=allocate, interval=two_grid.steps_per_coarse_step,
                          after_step=its_step, report=its_report, verdict=verdict)
