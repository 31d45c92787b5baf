"""The vortex's state: its body, and what watches it."""

from dataclasses import dataclass

import taichi as ti

from solvers.estimators.memory import packing
from solvers.problems.planar.estimators import transport
from solvers.problems.planar.state import WatchedBody, watched
from solvers.problems.vortex.estimators import companion, recovered
from solvers.problems.vortex.method.body import VortexBody, body, farthest
from solvers.problems.vortex.method.phases import TRAITS
from solvers.problems.vortex.scene import VortexScene
from solvers.scene import registry
from solvers.scene.switches import switches

#: What the solver calls of each estimator that the vortex has, by name.
HOOKS = registry.hooks_of("vortex", {
    "companion": companion.HOOKS, "recovered": recovered.HOOKS, "transport": transport.hooks(TRAITS)})


@dataclass
class WatchedVortex(WatchedBody, VortexBody):
    """A vortex and those who watch it."""


#: Numbers and arrays as one kernel argument: nothing of a scene is baked into compiled code but its switches.
VortexState = ti.types.argpack(**WatchedVortex.types(), **packing(HOOKS).types)


def allocate(scene: VortexScene, slabs: int) -> WatchedVortex:
    """The initial state."""
    on = switches(scene)
    own = body(scene, on, slabs)
    return WatchedVortex(**own, **watched(scene, on, own["particles"], farthest(scene), HOOKS))
