"""The ring's state: its body, and what watches it."""

from dataclasses import dataclass

import taichi as ti

from solvers.estimators.memory import packing
from solvers.problems.planar.estimators import transport
from solvers.problems.planar.state import WatchedBody, watched
from solvers.problems.ring.estimators import companion, recovered, two_grid
from solvers.problems.ring.method.body import RingBody, body, farthest
from solvers.problems.ring.method.phases import TRAITS
from solvers.problems.ring.scene import RingScene
from solvers.scene import registry
from solvers.scene.switches import switches

#: What the solver calls of each estimator that the ring has, by name.
HOOKS = registry.hooks_of("ring", {
    "companion": companion.HOOKS, "recovered": recovered.HOOKS, "transport": transport.hooks(TRAITS),
    "two-grid": two_grid.HOOKS})


@dataclass
class WatchedRing(WatchedBody, RingBody):
    """A ring and those who watch it."""


#: Numbers and arrays as one kernel argument: nothing of a scene is baked into compiled code but its switches.
RingState = ti.types.argpack(**WatchedRing.types(), **packing(HOOKS).types)


def allocate(scene: RingScene, slabs: int) -> WatchedRing:
    """The initial state."""
    on = switches(scene)
    own = body(scene, on, slabs)
    return WatchedRing(**own, **watched(scene, on, own["particles"], farthest(scene), HOOKS))
