"""What a plane problem is made of, in one object: from it come its kernels and its solvers."""

from collections.abc import Callable
from typing import NamedTuple

from solvers.problems.planar.errors import SnapshotMeasures
from solvers.problems.planar.method.samples import Measures
from solvers.problems.planar.method.traits import Traits
from solvers.problems.planar.state import WatchedBody
from solvers.scene.estimator_hooks import EstimatorHooks


class PlanarParts(NamedTuple):
    """What the ring and the vortex have of their own."""

    hooks: dict[str, EstimatorHooks]  # what the solver calls of each estimator that it has, by name
    arrays: type[WatchedBody]
    body: Callable  # (scene, on, slabs): those of the arrays that the method needs, at the start
    farthest: Callable  # (scene): how far from the centre a particle of a sound run may be, m
    traits: Traits  # its part of the phases
    measures: Measures  # and of the samples
    snapshot: SnapshotMeasures  # and of snapshots
    has_escaped: Callable  # (body, p): whether a particle is where none of a sound run can be
