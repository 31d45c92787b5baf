"""Growth of small disturbances of the ring's exact motion, by theory, as ``assets/stability.md`` has it.

    uv run python -m tests.ring_growth

A disturbance moves a material point by a(R, t) cos(n theta) along the radius and by b(R, t) sin(n theta) around.
Linearised about the stretches p, q of the exact motion, the neo-Hookean stress P = mu (F - F^-T) of the ring (lambda =
0) gives M y'' = -K(t) y for the values of a and b at Gauss-Lobatto points. Growth is the largest modulus among the
eigenvalues of the map over one period (Floquet). Nothing is shared with the solver but the points.
"""

import math

import numpy as np

from solvers.estimators.spectral_elements import Elements
from solvers.study.markdown_tables import markdown_table
from tests.closed_forms import ring

AMPLITUDES = (0.11, 0.12, 0.13, 0.14, 0.15, 0.16, 0.18)
WAVES = (2, 4, 6)
ORDER, STEPS = 10, 600  # of the polynomials across the ring; Runge-Kutta steps of a period


def disturbance_growth(amplitude: float, waves: int) -> float:
    """Growth per period of a disturbance with so many waves around a full circle, for an amplitude in m; with E and
    density 1, so that w is pi and a period 2 s, for growth depends on neither."""
    points = Elements(ring.INNER, ring.OUTER, 1, ORDER)
    R, D, mu, w = points.node_coordinates, points.derivative, 0.5, math.pi
    weights, N = points.weights * R, ORDER + 1
    none, each = np.zeros((N, N)), np.diag(1 / R)
    radial, hoop = np.hstack([D, none]), np.hstack([each, waves * each])  # of dF, by the values (a, b)
    across, along = np.hstack([-waves * each, -each]), np.hstack([none, D])  # its shear, d(theta) and d(R)
    shape, slope, _ = ring.shape(R)

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        """The time derivative of values and velocities (4 N, 4 N)."""
        T = amplitude * math.sin(w * t)
        p, q = 1 + T * slope, 1 + T * shape / R
        parts = ((radial, radial, 1 + 1 / p**2), (hoop, hoop, 1 + 1 / q**2), (across, across, 1 + 0 * p),
                 (along, along, 1 + 0 * p), (across, along, 1 / (p * q)), (along, across, 1 / (p * q)))
        stiffness = mu * sum(one.T @ ((weights * size)[:, None] * other) for one, other, size in parts)
        return np.vstack([y[2 * N:], -stiffness @ y[:2 * N] / np.tile(weights, 2)[:, None]])

    y, H = np.eye(4 * N), 2 * math.pi / w / STEPS
    for n in range(STEPS):
        t = n * H
        k1 = rate(t, y)
        k2 = rate(t + H / 2, y + H / 2 * k1)
        k3 = rate(t + H / 2, y + H / 2 * k2)
        y = y + H / 6 * (k1 + 2 * k2 + 2 * k3 + rate(t + H, y + H * k3))
    return float(np.abs(np.linalg.eigvals(y)).max())


def growth_table() -> str:
    """Growth by waves around the circle and amplitude, in Markdown."""
    heads = ["n", f"A ≤ {AMPLITUDES[0]}", *(f"{A:g}" for A in AMPLITUDES[1:])]
    rows = [[str(n), *(f"{found:.2f}" if (found := disturbance_growth(A, n)) > 1.005 else "1" for A in AMPLITUDES)]
            for n in WAVES]
    return markdown_table(heads, rows)


if __name__ == "__main__":
    print(growth_table())
