"""What the budget of a run keeps: errors by cause, corners of pieces, sums at the nodes."""

from dataclasses import dataclass

import numpy as np

from solvers.kernels.kinds import Integer, Integers, Quads
from solvers.problems.bar.method.nodes import GHOSTS
from solvers.problems.bar.scene import BarScene
from solvers.scene.causes import CAUSES
from solvers.scene.switches import Switches
from solvers.solver.arrays import Members, zeros

#: Layers of ``budget_nodes``, each of all nodes: of the reference its v + dt a, a, b and the method's force of its
#: stress; of pieces their force, their length (by linearity preservation's measure) and sum S P; and, a lane a cause,
#: velocity and force of the errors, with linearity preservation their sum S P too.
REFERENCE, PIECES, VELOCITY, FORCE, STRESS = range(5)
KEEPS_ALL = -1


@dataclass
class BarBudget(Members):
    """P particles; arrays of length one where the effect is off."""

    taken_away: Integer  # lane of the cause whose sources are taken out of the run, or KEEPS_ALL
    cause_errors: Quads  # errors of x, then of v, then of F, a lane a cause (3 P, 4); with some remedies P more
    corner_node: Integers  # first node of each particle's left corner (P,)
    corner_weights: Quads  # and the base functions there, in three entries (P, 4)
    budget_nodes: Quads  # layers as above (5 (N+4), 4)
    removed: Quads  # what the step's end takes from x, v and F of a run without a cause (P, 4)


def budget(scene: BarScene, on: Switches) -> dict:
    """The members of a :class:`BarBudget` at the start."""
    P, nodes = scene.particles, scene.cells + GHOSTS
    taken = on.budget and scene.take_away in CAUSES
    layers = 4 if on.filtered or on.coupled else 3  # those remedies need room to work
    return {
        "taken_away": list(CAUSES).index(scene.take_away) if taken else KEEPS_ALL,
        "cause_errors": zeros(layers * P, 4, when=on.budget), "corner_node": zeros(P, when=on.budget, kind=np.int32),
        "corner_weights": zeros(P, 4, when=on.budget), "budget_nodes": zeros(5 * nodes, 4, when=on.budget),
        "removed": zeros(P, 4, when=taken)}
