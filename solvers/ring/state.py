"""The ring's state: its body, and what watches it."""

from dataclasses import dataclass

import taichi as ti

from solvers.estimators import registry
from solvers.estimators.memory import packing
from solvers.planar.state import WatchedBody, watched
from solvers.ring.body import RingBody, body, farthest
from solvers.ring.scene import RingScene
from solvers.switches import switches

HOOKS = registry.hooks_of("ring")


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
