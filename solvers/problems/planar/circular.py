"""CircularScene: a plane body whose circles stay circles, which ring and vortex are."""

import functools
from abc import abstractmethod
from types import ModuleType
from typing import ClassVar

import numpy as np

from solvers.problems.planar.circles import of_scene
from solvers.problems.planar.scene import PlanarScene
from solvers.problems.planar.sizes import own_sizes
from solvers.scene.balance import Moments


class CircularScene(PlanarScene):
    """Start, loads and material are the same all around: what is known of the motion without a run follows from one
    radius."""

    EXACT: ClassVar[ModuleType]  # the exact motion with the built-in force

    @property
    @abstractmethod
    def lame_moduli(self) -> tuple[float, float]:
        """lambda and mu in Pa."""

    @abstractmethod
    def circle_velocity(self, R: np.ndarray) -> np.ndarray:
        """The initial velocity (K,) at the radii R in m/s, complex: along e_R, and as imaginary part along e_Theta."""

    @abstractmethod
    def circle_force(self, R: np.ndarray, t: np.ndarray) -> np.ndarray:
        """The body force per mass (T, K) at the radii R and the times t (T, 1), in m/s^2: along e_R of the particle at
        rest, and as imaginary part, if any, along e_Theta."""

    @functools.cached_property
    def _own_sizes(self) -> dict[str, float]:
        return own_sizes(self, self.EXACT)

    def rms_of(self, quantity: str) -> float:
        return self._own_sizes[quantity]

    def balanced_motion(self, times: np.ndarray) -> Moments:
        return of_scene(self).moments(times)
