"""What FLIP does to the bar's velocity that no node sees: a prediction, without a run, of how long it takes to break.

A particle's velocity changes by the interpolated acceleration sum S_i a_i, which is a(x_p) + a_xx S2/2 with S2 = sum
S_i (x_i - x_p)^2. S2 depends on the particle's place in its cell and so on the motion itself: its product with a_xx
does not vanish over a period, and what it leaves adds up from period to period. The rate is known to about 6 %; that x
fails when v has drifted by about A w is the cruder part: at large amplitude other things come first.
"""

import numpy as np

from solvers.problems.bar.scene import BarScene
from solvers.scene.step_bound import stencil

INSTANTS = 2000  # of a period


def drift(scene: BarScene) -> float:
    """What the velocity drifts by in a period, as RMS over particles, in m/s."""
    X, k, w = (np.arange(scene.particles) + 0.5) / scene.particles, 2 * np.pi, scene.angular_frequency
    total, width = np.zeros_like(X), np.full_like(X, 0.5 / scene.ppc)
    for t in (np.arange(INSTANTS) + 0.5) * scene.period / INSTANTS:
        u = scene.motion_amplitude * np.sin(w * t)
        x, F, F_X = X + u * np.sin(k * X), 1 + k * u * np.cos(k * X), -k * k * u * np.sin(k * X)
        a_X, a_XX = -w * w * u * k * np.cos(k * X), w * w * u * k * k * np.sin(k * X)
        a_xx = (a_XX / F - a_X * F_X / F**2) / F
        half_width = np.minimum(width * F, 0.5) if scene.method == "cpgimp" else width
        first, S, _ = stencil(scene.method, x * scene.cells, half_width)
        apart = (first[:, None] + np.arange(3)) * scene.spacing - x[:, None]
        total += 0.5 * a_xx * (S * apart**2).sum(axis=1)
    return float(np.sqrt(np.mean((total * scene.period / INSTANTS) ** 2)))


def predicted_life(scene: BarScene) -> float | None:
    """Periods until the drift has reached A w; None where something mends it, or where something else comes first."""
    if scene.remedies or scene.linearity_preserving or scene.velocity != "grid" or scene.method == "mpm":
        return None
    return scene.size_of("v") / drift(scene)
