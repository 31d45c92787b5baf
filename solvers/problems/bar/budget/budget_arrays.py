"""Memory of a run's budget: errors by cause, corners of pieces, sums at the nodes."""

from typing import Any

import numpy as np
import taichi as ti

from solvers.kernels.dtypes import quads, reals
from solvers.kernels.packing import ArrayPacking, PackedAttributesView
from solvers.kernels.scalar_hoisting import mark_untranslated_by_taichi
from solvers.motion.exact_solution_1d import motion_table
from solvers.problems.bar import exact_solution
from solvers.problems.bar.estimators.companion import mesh
from solvers.problems.bar.method.periodic_nodes import GHOSTS
from solvers.problems.bar.scene import BarScene
from solvers.scene.error_causes import CAUSES
from solvers.scene.kernel_options import KernelOptions
from solvers.scene.typed_motion_scene import TYPED
from solvers.solver.state_arrays import zeros

#: Layers of ``budget_nodes``, each of all nodes: of the reference its v + dt a, a, b and the method's force of its
#: stress; of pieces their force, their length (by linearity preservation's measure) and sum S P; and, a lane a cause,
#: velocity and force of the errors, with linearity preservation their sum S P too.
REFERENCE, PIECES, VELOCITY, FORCE, STRESS = range(5)
NO_CAUSE_REMOVED = -1
#: What it keeps; P particles, and arrays of length one where the effect is off. One array for each type holds them all,
#: so that a run without a budget has few more arguments to launch.
MEMBERS = {
    "taken_away": ti.i32,  # lane of the cause whose sources are taken out of the run, or KEEPS_ALL
    "cause_errors": quads,  # errors of x, then of v, then of F, a lane a cause (3 P, 4); with some remedies P more
    "budget_nodes": quads,  # layers as above (5 (N+4), 4)
    "reference_motion": quads,  # the companion's, as the step begins: v + dt a and a (P, 4); where it is the reference
    "reference_slopes": quads,  # F, the slope of v + dt a along X, and u (P, 4)
    "reference_elements": quads,  # u, v, a and u_X at the points of its elements (n, 4)
    "reference_rates": reals,  # and the slope of v + dt a (n,)
    "removed": quads,  # what the step's end takes from x, v and F of a run without a cause (P, 4)
}
BUDGET = ArrayPacking(MEMBERS, "budget_")


def stores_reference(on: KernelOptions) -> bool:
    """Returns whether the budget's reference is stored from step to step: for the companion, or a typed motion. ``on``:
    compile-time options."""
    return not on.truth or on.motion == TYPED


@mark_untranslated_by_taichi
def state_with_budget_arrays(state: Any) -> PackedAttributesView:
    """Returns a view of the bar's state, for kernels, with the budget's arrays (``MEMBERS``) as attributes too."""
    return PackedAttributesView(state, BUDGET, MEMBERS)


def initial_budget_arrays(scene: BarScene, on: KernelOptions) -> dict:
    """Returns the budget's initial arrays, packed one per type (``BUDGET``), by name. ``on``: compile-time options."""
    P, nodes = scene.particles, scene.cells + GHOSTS
    taken = on.budget and scene.take_away in CAUSES
    layers = 4 if on.filtered or on.coupled else 3  # those remedies need room to work
    causes = zeros(layers * P, 4, when=on.budget)
    if on.budget and scene.motion_formula:
        causes[P:2 * P, list(CAUSES).index("time_step")] = -scene.velocity_lead * motion_table(scene)(0.0, 2)[:P, 0]
    return BUDGET.pack({"taken_away": list(CAUSES).index(scene.take_away) if taken else NO_CAUSE_REMOVED,
                        "cause_errors": causes, "budget_nodes": zeros(5 * nodes, 4, when=on.budget),
                        **_initial_reference(scene, on), "removed": zeros(P, 4, when=taken)})


def _initial_reference(scene: BarScene, on: KernelOptions) -> dict:
    """Returns the budget's reference at the start by member: the run's own initial data, zeros where none is stored.
    ``on``: compile-time options."""
    P, elements = scene.particles, mesh(scene)
    used = on.budget and stores_reference(on)
    points = elements.count * (elements.order + 1)
    motion, slopes = zeros(P, 4, when=used), zeros(P, 4, when=used)
    if used:
        X = (np.arange(P) + 0.5) * (scene.spacing / scene.ppc)
        motion[:, 0] = exact_solution.velocity(scene, X, 0.0)
        slopes[:, 0] = 1.0
        if scene.motion_formula:
            rate, bend = (motion_table(scene)(0.0, derivative)[:P] for derivative in (1, 2))
            (motion[:, 0], slopes[:, 1]), motion[:, 1] = (rate + scene.time_step * bend).T, bend[:, 0]
        elif not scene.is_patch:
            slopes[:, 1] = scene.motion_amplitude * scene.angular_frequency * exact_solution.WAVENUMBER \
                * np.cos(exact_solution.WAVENUMBER * X)
    return {"reference_motion": motion, "reference_slopes": slopes,
            "reference_elements": zeros(points, 4, when=used), "reference_rates": zeros(points, when=used)}
