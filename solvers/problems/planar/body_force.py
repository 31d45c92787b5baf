"""The body force of a plane problem: the built-in one, for which its displacement is the solution, and a second tone of
another frequency, for which no solution is known, so that there is no true error."""

from typing import Any, NamedTuple

import numpy as np

from solvers.motion.exact_solution import SECOND_FREQUENCY
from solvers.motion.separable_field import SeparableField, separate

SECOND_RATIO = 0.5  # of the second tone, in w^2 times its shape


class TabulatedBodyForce(NamedTuple):
    """Body force per mass at K points (``points``) as data; ``second_tone`` is the factor of sin(1.7 wt)."""

    points: int
    built_in: SeparableField | None = None
    second_tone: SeparableField | None = None

    def __call__(self, t: float) -> np.ndarray:
        """Returns the body force per mass (K, 2) in m/s^2 at the time t in s."""
        force = self.built_in(t) if self.built_in else np.zeros((self.points, 2))
        if self.second_tone:
            force += np.sin(SECOND_FREQUENCY * self.second_tone.angular_frequency * t) * self.second_tone(t)
        return force


def body_force_at(scene: Any, X: np.ndarray, t: Any) -> np.ndarray:
    """Returns the scene's body force per mass (P, 2), m/s^2, at material points X (P, 2) and a time or times (P,)."""
    if scene.body_force == "none":
        return np.zeros_like(X)
    force = scene.EXACT.body_force(scene, X, t)
    if scene.body_force == "two-tone":
        tone = np.sin(SECOND_FREQUENCY * scene.angular_frequency * t)[..., None]
        force = force + _second_tone_amplitude(scene, X, t) * tone
    return force


def tabulate_body_force(scene: Any, points: np.ndarray) -> TabulatedBodyForce:
    """Returns the scene's body force per mass at material ``points`` (K, 2), m, as data: a function of the time."""
    if scene.body_force == "none":
        return TabulatedBodyForce(len(points))
    first = separate(lambda X, t: scene.EXACT.body_force(scene, X, t), points, scene.period)
    second = separate(lambda X, t: _second_tone_amplitude(scene, X, t), points, scene.period) \
        if scene.body_force == "two-tone" else None
    return TabulatedBodyForce(len(points), first, second)


def _second_tone_amplitude(scene: Any, X: np.ndarray, t: Any) -> np.ndarray:
    """Returns the amplitude (P, 2), m/s^2, of the force's second tone at X (P, 2) and t; its shape is the scene's."""
    return SECOND_RATIO * scene.angular_frequency**2 * scene.second_tone_shape(X, t)
