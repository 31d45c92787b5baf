"""Problem-specific parts of a plane problem's kernels, in one object from which kernels and solvers are made."""

from collections.abc import Callable
from typing import NamedTuple

from solvers.scene.estimator_hooks import EstimatorHooks


class ProblemStepFunctions(NamedTuple):
    """A problem's own functions for the kernels of a step. ``body`` is the state, ``on`` the compile-time options, p a
    particle; a node's record is a vector of four: v and a, or two others."""

    forces: Callable  # (body, t, on): computes the body force per mass at time t, wherever a particle needs it
    prepare: Callable  # (body, start, end, on): computes what the stress of these particles needs
    body_force_on: Callable  # (body, p): the computed force on particle p, in N
    stress: Callable  # (body, p, on): J sigma as (xx, xy, yx, yy), or P where the weights stay those of rest
    has_escaped: Callable  # (body, p, step): whether a particle is where none of a sound run can be
    first: int  # the first row and column of nodes that are no ghosts
    fold: Callable  # (body, fold_pair): adds what fell on ghosts to their mirror images
    pin: Callable  # (body, i, j, record): the record without what would move node (i, j) across a plane
    mirror: Callable  # (body, values): copies the records of nodes to their ghosts
    image: Callable  # (body, node): the node that a ghost is the mirror image of; any other is its own


class ProblemDiagnosticFunctions(NamedTuple):
    """A problem's own functions for the kernels that sample a run, beside the errors of particles."""

    node_acceleration_error: Callable  # (body, on): mean squared error of the nodes' acceleration
    strain_energy: Callable  # (body, p, on): of a particle, in J
    record_contradictions: Callable  # (body, row): writes its columns of sample ``row`` that show contradictions
    samplers: dict[str, Callable]  # what fills the columns of effects: see ``solvers.scene.effects.samplers``


class PlanarKernelFunctions(NamedTuple):
    """Parts from which the kernels of one plane problem are made."""

    hooks: dict[str, EstimatorHooks]  # hooks of each estimator, by name
    traits: ProblemStepFunctions  # its part of the phases
    measures: ProblemDiagnosticFunctions  # and of the samples
