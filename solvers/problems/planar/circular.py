"""CircularScene: a plane body whose circles stay circles, which ring and vortex are."""

import functools
from abc import abstractmethod
from types import ModuleType
from typing import ClassVar, Literal

import numpy as np

from solvers.problems.planar.circles import of_scene
from solvers.problems.planar.scene import PlanarScene
from solvers.scene.balance import Moments

CIRCLES, INSTANTS = 32, 32  # of the means over the ring and over a period


class CircularScene(PlanarScene):
    """Start, loads and material are the same all around: what is known of the motion without a run follows from one
    radius."""

    EXACT: ClassVar[ModuleType]  # the exact motion with the built-in force
    PLOTTED: ClassVar[Literal["radial", "angular"]]  # the component in which it moves

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

    def exact_along(self, quantity: str, R: np.ndarray, t: float) -> np.ndarray:
        """The plotted component (K,) of the exact solution at the radii R, as a method has it after the time t."""
        return self.EXACT.field(self, quantity, R, t)

    @functools.cached_property
    def _own_sizes(self) -> dict[str, float]:
        """RMS over the ring and over a period of x (its displacement), v, sigma and a in the exact motion, as vectors
        and Frobenius norms: errors may be as large."""
        edges, exact = np.linspace(self.INNER, self.OUTER, CIRCLES + 1), self.EXACT
        R = 0.5 * (edges[1:] + edges[:-1])
        X = np.stack([R, np.zeros_like(R)], axis=1)
        parts = {"x": (exact.displacement, (1, 1)), "v": (exact.velocity, (1, 1)), "sigma": (exact.stress, (1, 2, 1)),
                 "a": (exact.acceleration, (1, 1))}
        times = (np.arange(INSTANTS) + 0.5) / INSTANTS * self.period
        return {name: float(np.sqrt(np.mean([np.average(field(self, X, t) ** 2 @ np.array(weights), weights=R)
                                             for t in times]))) for name, (field, weights) in parts.items()}

    def rms_of(self, quantity: str) -> float:
        return self._own_sizes[quantity]

    def balanced_motion(self, times: np.ndarray) -> Moments:
        return of_scene(self).moments(times)
