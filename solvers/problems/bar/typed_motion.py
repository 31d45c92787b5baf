"""A typed motion of the bar as data: for kernels, and how large it is."""

import functools
from typing import Any, NamedTuple

import numpy as np

from solvers.motion.exact_solution import TIME, X_AXIS
from solvers.motion.line_solution import LineSolution
from solvers.motion.separable_field import SeparableField, separate
from solvers.motion.typed_motion import LineInputs

TYPED = "typed"  # what is compiled of such a motion, whatever the formula
PLACES, INSTANTS = 400, 128  # of the bar and of a period, at which its size is looked at
HALF_WRONG = 0.5  # of F - 1, as RMS: for that alone no place is called lost
TELLING = 0.03  # of the RMS of F - 1: a wave with less does not matter


def typed(scene: Any) -> LineSolution:
    """What follows from a typed displacement."""
    return LineInputs.solution(scene.displacement)


@functools.lru_cache(maxsize=2)
def motion_table(scene: Any) -> SeparableField:
    """u and F - 1 at the particles (P, r, 2), and as a last place their means."""
    X = (np.arange(scene.particles) + 0.5) / scene.particles

    def field(X: np.ndarray, t: np.ndarray) -> np.ndarray:
        return np.stack(typed(scene).derivatives(scene, X[:, 0], t, (), (X_AXIS,)), axis=1)

    motion = separate(field, X[:, None], scene.period)
    mean = motion.modes.mean(axis=0, keepdims=True)
    return SeparableField(np.concatenate([motion.modes, mean]), motion.series, motion.angular_frequency)


def force_table(scene: Any, X: np.ndarray) -> SeparableField:
    """The body force per mass at material points (K,), and 0 as a second component (K, r, 2)."""
    def field(X: np.ndarray, t: np.ndarray) -> np.ndarray:
        return np.stack([typed(scene).body_force(scene, X[:, 0], t), np.zeros(len(X))], axis=1)

    return separate(field, X[:, None], scene.period)


class TypedSizes(NamedTuple):
    """How large x, v, sigma and a become, and their RMS over the bar and a period; by how much, as RMS in m, neighbours
    move otherwise than the mean of their F says, and than one says that is half wrong; waves in a metre of the shortest
    that matters."""

    largest: dict[str, float]
    rms: dict[str, float]
    gap: float
    waves: int


def typed_sizes(scene: Any) -> TypedSizes:
    """Those of a typed motion."""
    X = np.tile(np.arange(PLACES) / PLACES, (INSTANTS, 1))
    t, dX = np.repeat(np.arange(INSTANTS) / INSTANTS * scene.period, PLACES), 1 / scene.particles
    u, strain, v, a = typed(scene).derivatives(scene, X, t, (), (X_AXIS,), (TIME,), (TIME, TIME))
    fields = {"x": u, "v": v, "sigma": scene.modulus * strain, "a": a}
    next_u, next_strain = typed(scene).derivatives(scene, (X + dX) % 1, t, (), (X_AXIS,))
    misses = next_u - u - 0.5 * dX * (strain + next_strain), HALF_WRONG * dX * strain
    power = (np.abs(np.fft.rfft(strain, axis=1)) ** 2).sum(axis=0)
    return TypedSizes({name: float(np.abs(one).max()) for name, one in fields.items()},
                      {name: float(np.sqrt((one**2).mean())) for name, one in fields.items()},
                      float(sum(np.sqrt((miss**2).mean(axis=1)) for miss in misses).max()),
                      int(np.flatnonzero(power >= TELLING**2 * power.sum())[-1]))
