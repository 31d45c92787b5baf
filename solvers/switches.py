"""Switches: what of a scene is compiled into its kernels."""

from typing import NamedTuple

from solvers.effects import EFFECTS
from solvers.remedies import CENTRED, COUPLED, FILTER, FROZEN
from solvers.scene import Scene


class Switches(NamedTuple):
    """What is compiled in; kernels take it as ``on``. Two scenes with equal switches share one compiled kernel. Each
    effect is an attribute too: ``on.truth`` says whether "truth" is one of ``effects``."""

    method: str
    linearity_preserving: bool
    body_force: str
    velocity: str
    effects: tuple[str, ...]
    estimators: tuple[str, ...]
    remedies: tuple[str, ...]

    def __getattr__(self, name: str) -> bool:
        if name not in EFFECTS:
            raise AttributeError(f"no effect is called {name}")
        return name in self.effects

    @property
    def filtered(self) -> bool:
        return FILTER in self.remedies

    @property
    def coupled(self) -> bool:
        return COUPLED in self.remedies

    @property
    def centred(self) -> bool:
        return CENTRED in self.remedies

    @property
    def frozen(self) -> bool:
        return FROZEN in self.remedies


def switches(scene: Scene) -> Switches:
    """The switches of a scene."""
    return Switches(scene.method, scene.linearity_preserving, scene.body_force, scene.velocity,
                    tuple(effect for effect in EFFECTS if scene.has(effect)), scene.active_estimators, scene.remedies)
