"""Exact solution by a displacement along a line whose stress is linear in its stretch, P = E (F - 1): as
``solvers.motion.exact_solution`` in the plane, with the body force per mass b = u_tt - c^2 u_XX, c^2 = E/rho."""

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from solvers.motion.exact_solution import TIME, X_AXIS
from solvers.motion.jets import Jet, variables
from solvers.motion.separable_field import SeparableField, separate

PLACES, INSTANTS = 400, 128  # of the line and of a period, at which a motion is evaluated
HALF_ERROR = 0.5  # of F - 1, as RMS: for that alone no place is called lost
MIN_WAVE_SHARE = 0.03  # of the RMS of F - 1: a wave with less does not matter


class ExactSolution1D:
    """Motion along a line, from its ``displacement`` (scene, X, Y, t) -> (u,) in m of any kind of number. Methods take
    a scene with the ``wave_speed`` c in m/s, X in m, and t in s, one or one for each X; results have the shape of X."""

    def __init__(self, displacement: Callable[[Any, Any, Any, Any], tuple[Any, ...]]):
        self._displacement = displacement

    def displacement_derivatives(self, scene: Any, X: np.ndarray, t: Any, *axes: tuple[int, ...]) -> list[np.ndarray]:
        """Returns an array like ``X`` for each of ``axes``: () the displacement u in m, (X_AXIS,) F - 1, (TIME,) the
        velocity in m/s, (TIME, TIME) the acceleration in m/s^2."""
        t = np.reshape(t, X.shape) if np.ndim(t) else t
        (u,) = self._displacement(scene, *variables(X, None, t))
        u = u if isinstance(u, Jet) else Jet(u)
        found = [u.derivative(*one) if one else u.value for one in axes]
        return [np.array(np.broadcast_to(one, X.shape)) for one in found]

    def displacement(self, scene: Any, X: np.ndarray, t: Any) -> np.ndarray:
        """Returns the displacement in m at points ``X`` in m and time or times ``t`` in s, in the shape of X."""
        return self.displacement_derivatives(scene, X, t, ())[0]

    def velocity(self, scene: Any, X: np.ndarray, t: Any) -> np.ndarray:
        """Returns the velocity in m/s at points ``X`` in m and time or times ``t`` in s, in the shape of X."""
        return self.displacement_derivatives(scene, X, t, (TIME,))[0]

    def acceleration(self, scene: Any, X: np.ndarray, t: Any) -> np.ndarray:
        """Returns the acceleration in m/s^2 at points ``X`` in m and time or times ``t`` in s, shaped like X."""
        return self.displacement_derivatives(scene, X, t, (TIME, TIME))[0]

    def deformation_gradient(self, scene: Any, X: np.ndarray, t: Any) -> np.ndarray:
        """Returns F = 1 + du/dX at points ``X`` in m and time or times ``t`` in s, in the shape of X."""
        return 1 + self.displacement_derivatives(scene, X, t, (X_AXIS,))[0]

    def force_terms(self, scene: Any, X: np.ndarray, t: Any) -> np.ndarray:
        """Returns u_tt and -c^2 u_XX in m/s^2, in a last axis: for a free vibration their sum is only rounding."""
        a, bend = self.displacement_derivatives(scene, X, t, (TIME, TIME), (X_AXIS, X_AXIS))
        return np.stack([a, -scene.wave_speed**2 * bend], axis=-1)

    def body_force(self, scene: Any, X: np.ndarray, t: Any) -> np.ndarray:
        """Returns the force per mass in m/s^2, shaped like ``X`` in m, that the motion needs at ``t`` in s."""
        return self.force_terms(scene, X, t).sum(axis=-1)


@functools.lru_cache(maxsize=32)  # of many visitors
def motion_table(scene: Any) -> SeparableField:
    """Returns a scene's motion by formula over its period: u in m and F - 1 (2 components) at its P particles, and, as
    place P, their means over the particles."""
    X = (np.arange(scene.particles)[:, None] + 0.5) / scene.particles
    derivatives = functools.partial(scene.typed_solution.displacement_derivatives, scene)
    motion = separate(lambda X, t: np.stack(derivatives(X[:, 0], t, (), (X_AXIS,)), axis=1), X, scene.motion_period)
    mean = motion.modes.mean(axis=0, keepdims=True)
    return SeparableField(np.concatenate([motion.modes, mean]), motion.series, motion.angular_frequency)


def force_table(scene: Any, X: np.ndarray) -> SeparableField:
    """Returns the body force per mass of a motion by formula at points ``X`` (K,) in m: component 0, in m/s^2."""
    table = separate(lambda X, t: scene.typed_solution.force_terms(scene, X[:, 0], t), X[:, None], scene.motion_period)
    table.modes[:, :, 0] += table.modes[:, :, 1]
    return table


class MotionMagnitudes(NamedTuple):
    """Sizes of a motion in SI units: ``largest`` and ``rms`` (over line and period) values of x, v, sigma and a by key;
    the ``gap`` in m, the RMS mismatch between the motion of neighbours and their mean F, plus the effect of a mean F
    half wrong, largest over time; and the number of ``waves`` per metre of the shortest wave that matters."""

    largest: dict[str, float]
    rms: dict[str, float]
    gap: float
    waves: int


def motion_magnitudes(scene: Any) -> MotionMagnitudes:
    """Returns the sizes of the motion by formula of a bar's scene, from 400 places and 128 times of its period."""
    X = np.tile(np.arange(PLACES) / PLACES, (INSTANTS, 1))
    t, dX = np.repeat(np.arange(INSTANTS) / INSTANTS * scene.motion_period, PLACES), 1 / scene.particles
    derivatives = functools.partial(scene.typed_solution.displacement_derivatives, scene)
    u, strain, v, a = derivatives(X, t, (), (X_AXIS,), (TIME,), (TIME, TIME))
    next_u, next_strain = derivatives((X + dX) % 1, t, (), (X_AXIS,))
    fields = {"x": u, "v": v, "sigma": scene.modulus * strain, "a": a}
    misses = next_u - u - 0.5 * dX * (strain + next_strain), HALF_ERROR * dX * strain
    power = (np.abs(np.fft.rfft(strain, axis=1)) ** 2).sum(axis=0)
    return MotionMagnitudes({name: float(np.abs(one).max()) for name, one in fields.items()},
                            {name: float(np.sqrt((one**2).mean())) for name, one in fields.items()},
                            float(sum(np.sqrt((miss**2).mean(axis=1)) for miss in misses).max()),
                            int(np.flatnonzero(power >= MIN_WAVE_SHARE**2 * power.sum())[-1]))
