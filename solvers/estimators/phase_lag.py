"""How far waves of two-grid's second run are behind the exact ones at the end, by linear theory.

Every transfer between particles and grid weakens a wave of wavenumber k a little, by the Fourier transform of the shape
function, 1 - s (k h)^2: s = 1/12 of a hat, 1/8 of a quadratic B-spline, 1/12 + 1/(24 n^2) of a hat seen by the domain
of one of n particles in a cell. Four transfers (stress to forces, acceleration to particles, velocity to nodes, its
gradient to particles) make up the stiffness, so that a wave swings at (1 - 2 s (k h)^2) times its frequency, and after
the time t it is behind by 2 s (k h)^2 k c t: by phi in the second run, by phi/4 in the run. A wave that is behind by
phi is wrong by -phi cos + phi^2/2 sin, and of the second term, which falls like h^4, extrapolation makes an error of
phi/2 times the one sought. That holds for errors too: they swing as waves of their own, even where the motion is forced
and keeps step.
Source: derived for this program.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from solvers.scene import Scene

#: Radians that a wave of the coarse run may be behind at the end: the estimate is off by .6 of itself then, and by half
#: of that in the mean. Measured on bars of one and two waves: distances of x up to .5 below, of .2 to 1.5 from 1.5 on.
MOST_PHASE = 1.2


def phase_lag(scene: Scene, wavenumber: float) -> float:
    """Radians by which a wave, in 1/m, of the second run is behind the exact one at the end, by linear theory."""
    weakening = {"mpm": 1 / 12, "bspline": 1 / 8}.get(scene.method, 1 / 12 + 1 / (24 * scene.ppc**2))
    coarse = scene.spacing * scene.cells / (scene.cells // 2)
    return 2 * weakening * (wavenumber * coarse) ** 2 * wavenumber * scene.wave_speed * scene.end_time


def out_of_step(scene: Scene, wavenumber: float) -> str | None:
    """A sentence where waves of the second run end too far behind; the lag falls with the square of the cells."""
    lag = phase_lag(scene, wavenumber)
    if lag <= MOST_PHASE:
        return None
    cells = 2 * math.ceil(scene.cells / 2 * math.sqrt(lag / MOST_PHASE) + 1)
    return (f"by the end, waves on the second run's cells would be {lag:.2g} radians behind, too far to extrapolate "
            f"(at most {MOST_PHASE:g}); give {cells} cells or {scene.end_time * MOST_PHASE / lag:.3g} s")
