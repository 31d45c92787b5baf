"""The ring's state: its body, and what watches it."""

from dataclasses import dataclass

import taichi as ti

from solvers.arrays import Watch, watch, zeros
from solvers.estimators import registry
from solvers.estimators.memory import packing
from solvers.kinds import Pairs, Quads
from solvers.ring.body import RingBody, body, farthest
from solvers.ring.scene import RingScene
from solvers.switches import switches

HOOKS = registry.hooks_of("ring")


@dataclass
class WatchedRing(Watch, RingBody):
    """A ring and those who watch it, with the estimates that are vectors and tensors."""

    estimate_acceleration: Pairs  # estimated error of a (E*P, 2)
    estimate_stress: Quads  # estimated error of sigma, as xx, xy, yy and nothing (E*P, 4)


#: Numbers and arrays as one kernel argument: nothing of a scene is baked into compiled code but its switches.
RingState = ti.types.argpack(**WatchedRing.types(), **packing(HOOKS).types)


def allocate(scene: RingScene, slabs: int) -> WatchedRing:
    """The initial state."""
    on = switches(scene)
    own = body(scene, on, slabs)
    P, estimated = own["particles"], bool(on.estimators)
    return WatchedRing(**own, **watch(scene, on, P, farthest(scene), HOOKS),
                       estimate_acceleration=zeros(len(on.estimators) * P, 2, when=estimated),
                       estimate_stress=zeros(len(on.estimators) * P, 4, when=estimated))
