"""What a plane problem is made of, in one object: from it come its kernels and its solvers."""

from collections.abc import Callable
from typing import NamedTuple

from solvers.problems.planar.method.body import WatchedBody
from solvers.scene.estimator_hooks import EstimatorHooks


class Traits(NamedTuple):
    """A problem's own part of the phases. ``body`` is its state; a record of a node is (x, y, x, y) of two vectors."""

    forces: Callable  # (body, t, on): find the body force per mass at time t, wherever a particle needs it
    prepare: Callable  # (body, start, end): find what the stress of these particles needs, before it is asked for
    body_force_on: Callable  # (body, p): the force on particle p that was found, in N
    stress: Callable  # (body, p, on): J sigma as (xx, xy, yx, yy), or P where the weights stay those of rest
    #: (body, p, on): for the margin of the step, a stiffness in N m and a metric (xx, xy, yy) for the gradients of
    #: weights g and h at two nodes, which it binds with at most the stiffness times |g| |h|.
    tangent: Callable
    first: int  # the first row and column of nodes that are no ghosts
    fold: Callable  # (body, fold_pair): add what fell on ghosts to their mirror images
    pin: Callable  # (body, i, j, record): the record without what would move node (i, j) across a plane
    mirror: Callable  # (body, values): copy the records of nodes to their ghosts
    image: Callable  # (body, node): the node that a ghost is the mirror image of; any other is its own


class Measures(NamedTuple):
    """What a problem knows of itself, as functions for kernels; ``exact_at_step`` is handed on to those that follow
    it."""

    exact_at_step: Callable  # (body, step): what is known of the exact solution at the step, as numbers or in an array
    vector_errors: Callable  # (body, p, exact_at_step, on): errors of x and v as one vector of four, and of a
    stress_error: Callable  # (body, p, exact_at_step): error of the Cauchy stress, as xx, xy, yy
    node_acceleration_error: Callable  # (body, exact_at_step, on): mean squared error of the nodes' acceleration
    strain_energy: Callable  # (body, p): of a particle, in J
    look: Callable  # (body, row): for contradictions
    samplers: dict[str, Callable]  # what fills the columns of effects: see ``solvers.scene.effects.samplers``


class SnapshotMeasures(NamedTuple):
    """What a problem knows of itself, as functions of its arrays ``a``: what ``Measures`` are to kernels. Errors are
    computed minus exact, vectors are (x, y) and tensors (xx, xy, yy), each (P,)."""

    vector_errors: Callable  # (scene, a, time): of x and of v
    acceleration_error: Callable  # (scene, a, time): of the one that a step from that time on has used
    stress: Callable  # (a): Cauchy's
    stress_error: Callable  # (scene, a, time)
    component: Callable  # (a, quantity): what a plot shows of it (P,)
    exact_component: Callable  # (scene, a, quantity, time): the same of the exact solution (P,)
    body_force: Callable  # (a, some): on some particles (c,), in N (c, 2)


class PlanarParts(NamedTuple):
    """What the ring and the vortex have of their own."""

    hooks: dict[str, EstimatorHooks]  # what the solver calls of each estimator that it has, by name
    arrays: type[WatchedBody]
    body: Callable  # (scene, on, slabs): those of the arrays that the method needs, at the start
    farthest: Callable  # (scene): how far from the centre a particle of a sound run may be, m
    traits: Traits  # its part of the phases
    measures: Measures  # and of the samples
    snapshot: SnapshotMeasures  # and of snapshots
    has_escaped: Callable  # (body, p, step): whether a particle is where none of a sound run can be
