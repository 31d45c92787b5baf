"""The recovered estimator (``solvers.problems.planar.estimators.recovered``) on a body that is one rectangle.

Free sides are natural in its weak form. At a clamped side the reaction is unknown, so the error grid's functions vanish
there; the fits stay one-sided and are not told that the displacement is 0. It needs no second solution of its own order
of accuracy, and so knows nothing of the companions: where the two agree, neither is to blame.
"""

import math
from typing import Any

import numpy as np
import taichi as ti

from solvers.bodies.body import Body
from solvers.bodies.estimate import QUANTITIES
from solvers.bodies.force_series import body_force_at, compute_force_weights
from solvers.bodies.material_points import BodyState, MaterialPoints
from solvers.bodies.numerical_fracture import largest_gap
from solvers.bodies.rectangle import Rectangle, require_rectangle
from solvers.estimators import recovered_common
from solvers.estimators.lattice_line_operators import LatticeLine, Rows
from solvers.kernels.dtypes import pairs, quads
from solvers.kernels.launch import Launch
from solvers.motion.laws.elastic_material import NEO_HOOKEAN
from solvers.problems.planar.estimators import recovered
from solvers.problems.planar.estimators import recovered_operators as op
from solvers.problems.planar.estimators.recovered_tables import (
    SPARSE_WIDTH,
    cartesian_weights,
    lattice_arrays,
    project_component,
)
from solvers.scene.kernel_options import KernelOptions
from solvers.solver.error_series import finite_or_none
from solvers.solver.state_arrays import aligned_copy
from solvers.translatable_message import Message

#: What recovered reads of a body's own state.
SHARED = ("particles", "row", "spacing", "cells_per_length", "origin", "dt", "lame_modulus", "shear_modulus", "density",
          "position_velocity", "deformation_gradient", "weights", "first_node", "node_motion", "force_terms",
          "force_series", "force_weights", "force_numbers")
OWN = {"material_position": pairs, "direction": pairs, "estimate": quads, "estimate_stress": quads,
       "estimate_acceleration": pairs, **recovered.MEMORY}
BACKWARDS = np.array([1.0, 1.0, -1.0, -1.0])  # lines follow each other against xi: a quarter of a turn from eta
TINY = 1e-300  # m
WAVE_CFL = 0.601  # H c over the shortest side of an element at rest; material that is pressed has faster waves
FIT_DEGREE, PROJECTION_WIDTH, PROJECTION_DEGREE = 3, 4, 2
#: Cells by which neighbours part. On 240 beams of seeds 70301 and 70302 with one particle per cell: index of x from
#: 0.84 to 1.26 up to here; beyond, from 0.41 to 1.75. With 2 x 2 or 3 x 3 the largest of 100 was 0.05.
MOST_GAP = 0.25


@ti.func
def store_body_force(body: ti.template(), t, on: ti.template()):
    """Stores the body force at t s at the particles, twice side by side, in their block HALF_SLOPES."""
    compute_force_weights(body, t)
    for p in range(body.particles):
        b = body_force_at(body, p)
        body.recovered_particles[op.particle_index(body, op.HALF_SLOPES, p)] = ti.Vector([b[0], b[1], b[0], b[1]])


LATTICE = op.BOX._replace(planes=False, store_body_force=store_body_force)
State = ti.types.argpack(**{name: BodyState.types()[name] for name in SHARED}, **OWN)


@ti.kernel
def follow_step(step: ti.i32, state: State, on: ti.template()):
    """Advances the reference to the time of ``step`` steps of the run."""
    ti.loop_config(serialize=True)
    for _ in range(1):
        recovered.after_step(state, step, LATTICE, on)


@ti.kernel
def report_errors(step: ti.i32, state: State, on: ti.template()):
    """Writes the particles' errors after ``step`` steps to the ``estimate`` arrays."""
    ti.loop_config(serialize=True)
    for _ in range(1):
        recovered.report(state, 0, step, LATTICE, on)


def error_grid_lines(body: Body, shape: Rectangle, dt: float) -> list[LatticeLine]:
    """Returns the lines of particles and of the error grid along xi and eta, for steps of ``dt`` s: elements are a cell
    wide, or more if the reference could not follow with steps as short as the run's."""
    width = body.spacing * (SPARSE_WIDTH if body.ppc == 1 else 1.0)
    narrowest = body.wave_speed * dt / WAVE_CFL
    return [LatticeLine(int(points), max(1 + sum(clamped), min(round(length / width), int(length / narrowest))), length,
                        "free", clamped)
            for points, length, clamped in zip(body.lattice_counts[0], shape.lengths, shape.clamped, strict=True)]


class RecoveredEstimate:
    """Recovered's estimate of the errors of a run, which calls :meth:`follow` every ``interval`` steps. Raises
    SceneError for a body that is no rectangle."""

    def __init__(self, body: Body, run: MaterialPoints):
        self._run, self._rows, self._reach, self._gap = run, list[list[float]](), 0.0, 0.0
        shape, own = require_rectangle(body), run.state
        self._shape, self._counts, self._spacing = shape, body.lattice_counts[0], body.spacing
        lines = error_grid_lines(body, shape, own.dt)
        fit = max(recovered_common.NARROWEST_FIT, recovered_common.OTHER_FIT_CELLS * body.ppc + 1)
        maps = [[line.fit_operator(fit, FIT_DEGREE), line.interpolation_operator(),
                 line.projection_operator(PROJECTION_WIDTH, PROJECTION_DEGREE), line.smoothing_operator()]
                for line in lines]
        side = min(1 / line.elements_per_length for line in lines)
        self.interval = min(recovered_common.wave_travel_steps(body, WAVE_CFL * side), run.steps)
        numbers = recovered_common.initial_numbers(body, self.interval)
        numbers[recovered_common.H] = self.interval * own.dt
        nodes = np.zeros((op.NODE_BLOCKS, lines[0].node_count, lines[1].node_count, 4))
        v = body.initial_velocity(run.lattice.position).reshape(lines[0].points, lines[1].points, 2)
        for k in (0, 1):
            on_lines = project_component(maps[1][2], 0, v[:, :, k].T).T
            nodes[op.MOTION, :, :, 2 + k] = project_component(maps[0][2], 0, on_lines)
        across = [Rows(rows.first, rows.weights * BACKWARDS) for rows in map(cartesian_weights, maps[0])]
        P = len(run.lattice.position)
        arrays = {"material_position": own.position_velocity[:, :2], "direction": np.tile(shape.direction, (P, 1)),
                  "estimate": np.zeros((P, 4)), "estimate_stress": np.zeros((P, 4)),
                  "estimate_acceleration": np.zeros((P, 2)), "recovered_numbers": numbers,
                  "recovered_silent": 2 if body.ppc == 1 else 0, "recovered_nodes": nodes.reshape(-1, 4),
                  **lattice_arrays(*lines, [*across, *map(cartesian_weights, maps[1])])}
        self._memory = {name: aligned_copy(one) if isinstance(one, np.ndarray) else one for name, one in arrays.items()}
        state = State(**{name: getattr(own, name) for name in SHARED}, **self._memory)
        on = KernelOptions(body.method, False, "typed", "grid", (), (), (), "", NEO_HOOKEAN)
        self.follow, self._report = Launch(follow_step, state, on), Launch(report_errors, state, on)

    def add_sample(self) -> None:
        """Adds the errors at the run's sample to the summary."""
        run, memory = self._run, self._memory
        self._report(run.step)
        self._reach = max(self._reach, float(np.abs(run.displacement).max()))
        X, u, F = (one.reshape(*self._counts, *parts) for one, parts in (
            (run.lattice.position, (2,)), (run.displacement, (2,)), (run.state.deformation_gradient, (2, 2))))
        self._gap = max(self._gap, largest_gap(self._shape, X, u, F) / self._spacing)
        x, v = memory["estimate"][:, :2], memory["estimate"][:, 2:] + run.velocity_lead * run.state.acceleration
        sigma = memory["estimate_stress"][:, [0, 1, 1, 2]]  # xx, xy, yx, yy
        with np.errstate(all="ignore"):
            self._rows.append([math.sqrt(np.sum(one**2) / len(one)) for one in (x, v, sigma)])

    def to_dict(self) -> dict[str, Any]:
        """Returns a JSON object: by quantity the RMS over the particles at the last sample, the largest and the mean,
        in SI units, None for stresses with one particle per cell, because fits follow these; and under "not_valid" why
        not to believe them, as a sentence, or None."""
        rows = np.array(self._rows or [[math.nan] * len(QUANTITIES)])
        U = self._memory["recovered_nodes"].reshape(op.NODE_BLOCKS, -1, 4)[op.MOTION, :, :2]
        reason = recovered_common.why_not_trusted(self._memory, np.abs(U).max() / max(self._reach, TINY))
        if not reason and self._gap > MOST_GAP:
            reason = Message("not valid here: neighbouring particles have parted by {gap:.2g} cells more than they are "
                             "stretched (numerical fracture), and may by {most:.2g}; take two or more particles per "
                             "cell", self._gap, MOST_GAP)
        return {"not_valid": reason, **{
            name: {key: finite_or_none(math.nan if reason else value) for key, value in (
                ("final", rows[-1, k]), ("max", rows[:, k].max()), ("mean", rows[:, k].mean()))} | {"unit": unit}
            for k, (name, unit) in enumerate(QUANTITIES.items())}}
