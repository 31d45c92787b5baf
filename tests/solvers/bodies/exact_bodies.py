"""Bodies with exact motions for tests: the axis-aligned square between rollers, the quarter of a ring; one period."""

from dataclasses import dataclass

import numpy as np

from solvers.bodies.body import Body
from solvers.bodies.patch import Patch
from solvers.problems.ring import C1, C2, C3

AMPLITUDE, RING_AMPLITUDE, E, DENSITY = 0.05, 0.1, 1e7, 1000.0
FREQUENCY = 100 * np.pi  # pi sqrt(E/rho), 1/s
PERIOD = 0.02  # s
LAME, SHEAR = E * 0.3 / (1.3 * 0.4), E / 2.6
SIGNS = np.array([1.0, -1.0])


def _force(own: str, other: str, sign: str, opposite: str) -> str:
    """b_i = -w^2 u_i - (1/rho) d/dX_i [lambda ln J / f_i + mu (f_i - 1/f_i)] of u_i = A sin 2 pi X_i sin w t."""
    swing = "sin(100*pi*t)"
    f, g = (f"(1{one}.1*pi*cos(2*pi*{axis})*{swing})" for axis, one in ((own, sign), (other, opposite)))
    inner = f"{LAME / DENSITY:.15g}*(1-log({f}*{g}))/{f}**2+{SHEAR / DENSITY:.15g}*(1+1/{f}**2)"
    return f"0{sign}.05*sin(2*pi*{own})*{swing}*(4*pi*pi*({inner})-1e4*pi**2)"


def square(method: str = "ugimp", cells: int = 8) -> Body:
    return Body(patches=(Patch(((0, 0), (1, 0), (1, 1), (0, 1)), ("roller",) * 4),), youngs_modulus=E,
                poissons_ratio=0.3, density=DENSITY, t_end=PERIOD, domain=((0, 0), (1, 1)), method=method,
                cells_per_metre=cells, velocity=("5*pi*sin(2*pi*X)", "-5*pi*sin(2*pi*Y)"),
                force=(_force("X", "Y", "+", "-"), _force("Y", "X", "-", "+")))


def square_motion(X, t):
    """u, v (P, 2) and F (P, 2, 2) of the square."""
    u = AMPLITUDE * SIGNS * np.sin(2 * np.pi * X)
    stretch = 1 + 2 * np.pi * AMPLITUDE * SIGNS * np.cos(2 * np.pi * X) * np.sin(FREQUENCY * t)
    F = np.zeros((len(X), 2, 2))
    F[:, 0, 0], F[:, 1, 1] = stretch.T
    return u * np.sin(FREQUENCY * t), FREQUENCY * u * np.cos(FREQUENCY * t), F


@dataclass(frozen=True)
class QuarterRing(Body):
    """The project's ring, at Poisson's ratio 0, whose force is too long for a formula."""

    def initial_velocity(self, X):
        return ring_motion(X, 0.0)[1]

    @property
    def has_force(self):
        return True

    def body_force(self, X, t):
        R = np.linalg.norm(X, axis=1)[:, None]
        swing = RING_AMPLITUDE * np.sin(FREQUENCY * t)
        w, w1, w2 = ((C3 * R + C2) * R + C1) * R, 3 * C3 * R**2 + 2 * C2 * R + C1, 6 * C3 * R + 2 * C2
        along, around = 1 + swing * w1, 1 + swing * w / R
        stress = (1 + along**-2) * swing * w2 + (along - 1 / along - around + 1 / around) / R
        return (-FREQUENCY**2 * swing * w - E / 2 / DENSITY * stress) * X / R


def quarter_ring() -> Body:
    return QuarterRing(patches=(Patch(((0.4, 0), (0.6, 0), (0, 0.6), (0, 0.4)), ("roller", "free", "roller", "free"),
                                      {"east": (0, 0), "west": (0, 0)}),), youngs_modulus=E, poissons_ratio=0.0,
                       density=DENSITY, t_end=PERIOD, domain=((0, 0), (1, 1)), cells_per_metre=20)


def ring_motion(X, t):
    """u and v (P, 2) of the ring."""
    R = np.linalg.norm(X, axis=1)[:, None]
    shape = RING_AMPLITUDE * ((C3 * R + C2) * R + C1) * X
    return shape * np.sin(FREQUENCY * t), FREQUENCY * shape * np.cos(FREQUENCY * t)
