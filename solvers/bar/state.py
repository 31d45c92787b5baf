"""The bar's state: its body, and what watches it."""

from dataclasses import dataclass

import taichi as ti

from solvers.arrays import Watch, watch
from solvers.bar.body import BarBody, body
from solvers.bar.scene import BarScene
from solvers.estimators import registry
from solvers.estimators.memory import packing
from solvers.switches import switches

HOOKS = registry.hooks_of("bar")


@dataclass
class WatchedBar(Watch, BarBody):
    """A bar and those who watch it."""


#: Numbers and arrays as one kernel argument: nothing of a scene is baked into compiled code but its switches.
BarState = ti.types.argpack(**WatchedBar.types(), **packing(HOOKS).types)


def allocate(scene: BarScene) -> WatchedBar:
    """The initial state."""
    on = switches(scene)
    return WatchedBar(**body(scene, on), **watch(scene, on, scene.particles, farthest(scene), HOOKS))


def farthest(scene: BarScene) -> float:
    """Displacement from which on a run counts as gone bad: half the bar, or twenty times what is exact."""
    return min(0.5, 20 * scene.motion_amplitude)
