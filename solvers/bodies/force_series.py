"""Body force of a body in kernels: between two samples a polynomial in time at every point, of the typed formulas.

b(X, t) = sum_k c_k(X) T_k(s), s from -1 to 1 over the interval, with Chebyshev polynomials T_k and coefficients from
numpy at the start of each interval; gravity alone is one term. State members: ``force_series`` (N K, 2), coefficients
of a point side by side, ``force_weights`` (K,), ``force_numbers``: start of the interval and 2 over its length.
"""

from typing import Any

import numpy as np
import taichi as ti

from solvers.bodies.body import Body
from solvers.scene.validation import SceneError

TERMS = 8  # of a formula's series: with 30 intervals, ten periods in the run are resolved to 1e-6
TOLERANCE = 1e-4  # of the largest force: by how much the last two terms may stand out


@ti.func
def compute_force_weights(body: ti.template(), t):
    """Writes T_k to ``force_weights`` for the time t in s."""
    s = (t - body.force_numbers[0]) * body.force_numbers[1] - 1
    before, now = s, 1.0  # T_-1 = T_1 and T_0
    for k in range(body.force_terms):
        body.force_weights[k] = now
        before, now = now, 2 * s * now - before


@ti.func
def body_force_at(body: ti.template(), point):
    """Returns the body force per mass (2,) in m/s^2 at a point's index, for the weights stored last."""
    force = body.force_series[point * body.force_terms]
    for k in range(1, body.force_terms):
        force += body.force_weights[k] * body.force_series[point * body.force_terms + k]
    return force


def force_terms(body: Body) -> int:
    """Returns the number of terms of the series of a body's force."""
    return TERMS if body.has_force else 1


def force_coefficients(body: Body, X: np.ndarray, start: float, end: float) -> np.ndarray:
    """Returns the coefficients (N K, 2) in m/s^2 at material points X (N, 2) in m for the times in s from ``start`` to
    ``end``. Raises SceneError for a force that changes too fast with time."""
    K = force_terms(body)
    angles = np.pi * (np.arange(K) + 0.5) / K
    at_times = np.stack([body.body_force(X, start + 0.5 * (end - start) * (1 + np.cos(angle))) for angle in angles])
    scale = np.full(K, 2 / K)
    scale[0] = 1 / K
    series = np.einsum("ks,snc->nkc", scale[:, None] * np.cos(np.outer(np.arange(K), angles)), at_times)
    if K > 1 and np.abs(series[:, -2:]).max() > TOLERANCE * max(np.abs(at_times).max(), 1e-300):
        raise SceneError("force", ", ".join(body.force), "changes too fast with t; give a slower one or a shorter "
                         "t_end")
    return np.ascontiguousarray(series.reshape(-1, 2))


def set_force(state: Any, body: Body, X: np.ndarray, start: float, end: float) -> None:
    """Writes to the arrays of a ``state`` the force at its points X (N, 2) in m between two times in s."""
    if body.has_force or not start:  # gravity stays
        state.force_series[:] = force_coefficients(body, X, start, end)
    state.force_numbers[:] = start, 2 / (end - start)
