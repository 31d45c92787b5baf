"""Compile-time options: the properties of a scene that are compiled into its kernels."""

from functools import lru_cache
from typing import NamedTuple

from solvers.scene.effects import ALL
from solvers.scene.scene import Scene
from solvers.scene.stabilisations import SWITCHES


class KernelOptions(NamedTuple):
    """Compile-time options of kernels, passed as ``on``, as in the scene. Scenes with equal options share one compiled
    kernel. Each effect and remedy is an attribute too: ``on.truth`` is whether "truth" is one of ``effects``,
    ``on.frozen`` whether frozen weights are one of ``remedies``."""

    method: str
    linearity_preserving: bool
    body_force: str
    velocity: str
    effects: tuple[str, ...]
    estimators: tuple[str, ...]
    remedies: tuple[str, ...]
    motion: str  # of a problem that has several, "" of the others
    law: str = ""  # of a problem whose material has one

    def __getattr__(self, name: str) -> bool:
        if name in SWITCHES:
            return SWITCHES[name] in self.remedies
        if name not in ALL:
            raise AttributeError(f"no effect or remedy is called {name}")
        return name in self.effects


def kernel_options_of(scene: Scene) -> KernelOptions:
    """Returns the compile-time options of a scene."""
    return KernelOptions(scene.method, scene.linearity_preserving, scene.body_force, scene.velocity,
                         scene.active_effects, scene.active_estimators, scene.remedies,
                         getattr(scene, "compiled_motion", ""), getattr(scene, "law", ""))


def method_options(on: KernelOptions) -> KernelOptions:
    """Returns the options ``on`` without effects and estimators, so that kernels compute the method alone."""
    return on._replace(effects=(), estimators=())


@lru_cache(maxsize=256)  # used repeatedly while a visitor waits for the compiler
def kernel_key(scene: Scene) -> tuple:
    """Returns the key of a scene's compiled code: scenes with equal keys run the same kernels on the same processor."""
    plan = getattr(scene, "plan", None)  # of a problem that has several
    return scene.problem, scene.arch, scene.threads, plan, kernel_options_of(scene)
