"""Steps of a plane body with all particles at once, for a GPU, and the other kernels of such a run.

They call the same phases as the plans of a CPU, from the kernel itself: there, Taichi makes every loop, in functions
too, a launch with one thread per iteration. So nothing here may call them under an ``if``, which would run on a single
thread; the host decides what is launched (``solvers.problems.planar.plans.gpu_plan``).
"""

from typing import Any, NamedTuple

import taichi as ti

from solvers.estimators import estimator_loop
from solvers.problems.planar.method import phases, stabilisations, stability_margin
from solvers.problems.planar.method.error_and_energy_sums import sample_sums
from solvers.problems.planar.method.motion_contradictions import SAME
from solvers.problems.planar.problem_kernel_functions import PlanarKernelFunctions
from solvers.solver.base import CRUSHED, ESCAPED, INVERTED
from solvers.solver.serial_stepping import MIN_JACOBIAN, NAN_JACOBIAN


class GpuKernels(NamedTuple):
    """Kernels of a problem's runs on a GPU; ``line`` is a row of samples, ``on`` are compile-time options."""

    to_nodes: Any  # (step, state, on)
    to_particles: Any  # (step, state, on)
    begin_remedies: Any  # (state, on)
    sharpen: Any  # (pass number, state, on)
    end_remedies: Any  # (state, on)
    check: Any  # (step, state, on)
    sample: Any  # (step, line, state, on)
    contradictions: Any  # (line, state, on)
    report: Any  # (step, state, on)
    freeze: Any  # (state, on)
    compute_step_margin: Any  # (state, on)


@ti.func
def update_nodes(body: ti.template(), side, traits: ti.template(), on: ti.template()):
    """Sets v and a of the nodes, ``side`` in each direction, from their sums of momentum, force and mass."""
    traits.fold(body, phases.fold_ghost_sums)
    least = phases.EMPTY * body.density * body.spacing * body.spacing
    for place in range(side * side):
        i, j = place % body.active, place // body.active
        if i >= traits.first and j >= traits.first:
            phases.update_node(body, i, j, least, traits, on)
    traits.mirror(body, body.node_motion)


@ti.func
def check_particles_in_parallel(body: ti.template(), step, has_escaped: ti.template()):
    """Writes to ``verdict`` why the run is unstable after ``step`` steps, if it is, from all particles in parallel: as
    ``solvers.solver.serial_stepping.check_particles``, except that it picks the last of several NaN."""
    flattest, rank = MIN_JACOBIAN, body.particles
    for p in range(phases.active_particle_count(body)):
        J = jacobian_without_nan(body, p)
        if J < MIN_JACOBIAN:
            ti.atomic_min(flattest, J)
    for p in range(phases.active_particle_count(body)):
        if flattest < MIN_JACOBIAN:
            if jacobian_without_nan(body, p) <= flattest + SAME * ti.abs(flattest):
                ti.atomic_min(rank, p if flattest > NAN_JACOBIAN else body.particles - 1 - p)
        elif has_escaped(body, p, step):
            ti.atomic_min(rank, p)
    if rank < body.particles:
        body.verdict[0] = ESCAPED if flattest == MIN_JACOBIAN else (CRUSHED if flattest > 0 else INVERTED)
        body.verdict[1] = step
        body.verdict[2] = rank if flattest > NAN_JACOBIAN else body.particles - 1 - rank


@ti.func
def jacobian_without_nan(body: ti.template(), p):
    """Returns det F of particle p, or ``NAN_JACOBIAN`` for NaN."""
    J = phases.jacobian(body, p)
    return NAN_JACOBIAN if ti.math.isnan(J) else J


def make_gpu_kernels(State: Any, parts: PlanarKernelFunctions) -> GpuKernels:
    """Returns the kernels of the problem with these ``parts``, whose state has the Taichi type ``State``."""
    HOOKS, TRAITS, MEASURES = parts.hooks, parts.traits, parts.measures

    @ti.kernel
    def to_nodes(step: ti.i32, body: State, on: ti.template()):
        """Runs the first half of the step after ``step`` steps: particles to nodes, and the nodes' new motion."""
        count = phases.active_particle_count(body)
        side = body.active * ti.min(count, 1)  # an unstable run keeps its last nodes
        for place in range(side * side):
            body.node_sums[place // body.active * body.row + place % body.active] = ti.Vector([0.0] * 8)
        TRAITS.forces(body, step * body.dt, on)
        for p in range(count):
            phases.map_to_nodes(body, p, p + 1, 0, TRAITS, on)
        update_nodes(body, side, TRAITS, on)

    @ti.kernel
    def to_particles(step: ti.i32, body: State, on: ti.template()):
        """Runs the second half of step number ``step`` (from 1): nodes to particles."""
        phases.nodes_to_particles(body, 0, step, TRAITS, on)

    @ti.kernel
    def begin_remedies(body: State, on: ti.template()):
        stabilisations.begin_remedies(body, on)

    @ti.kernel
    def sharpen(pass_number: ti.i32, body: State, on: ti.template()):
        stabilisations.sharpen(body, pass_number, TRAITS, on)

    @ti.kernel
    def end_remedies(body: State, on: ti.template()):
        stabilisations.end_remedies(body, on)

    @ti.kernel
    def check(step: ti.i32, body: State, on: ti.template()):
        """Stops a run that is unstable after ``step`` steps, by its ``verdict``."""
        check_particles_in_parallel(body, step, TRAITS.has_escaped)

    @ti.kernel
    def sample(step: ti.i32, line: ti.i32, body: State, on: ti.template()):
        """Samples the state after ``step`` steps into row ``line``, without contradictions."""
        sample_sums(body, line, step, MEASURES, on)

    @ti.kernel
    def contradictions(line: ti.i32, body: State, on: ti.template()):
        """Samples contradictions into row ``line``."""
        MEASURES.record_contradictions(body, line)

    @ti.kernel
    def report(step: ti.i32, body: State, on: ti.template()):
        """Writes the companion's estimates after ``step`` steps, to which its nodes have been advanced."""
        estimator_loop.report_at_once(body, step, HOOKS, on)

    @ti.kernel
    def freeze(body: State, on: ti.template()):
        """Stores all particles' weights, once, for a run with frozen weights."""
        phases.find_weights(body, 0, body.particles, on)

    @ti.kernel
    def compute_step_margin(body: State, on: ti.template()):
        stability_margin.store_step_margin(body, TRAITS, on)

    return GpuKernels(to_nodes, to_particles, begin_remedies, sharpen, end_remedies, check, sample, contradictions,
                      report, freeze, compute_step_margin)
