"""Phase lag of waves in two-grid's second run at the end, by linear theory.

A wave of wavenumber k passes four transfers in a step. Velocity to nodes and acceleration back, together the mass
matrix over the lumped one, let through 1 - (k h)^2 (1/6 + 1/(12 n^2)) of it with hats, of which n particles in a cell
take the values in the middle of their domains, and 1 - (k h)^2/4 with quadratic B-splines. Velocity gradient to
particles and stress to forces, together the stiffness, let through 1 - (k h)^2/12 and 1 - (k h)^2/4. So the wave swings
at 1 - s (k h)^2 times its frequency, s = 1/8 + 1/(24 n^2) and 1/4, and after the time t it is behind by s (k h)^2 k c
t: by phi in the second run, by phi/4 in the run. It is wrong by -phi cos + phi^2/2 sin then, and of the second term,
which falls like h^4, extrapolation makes an error of phi/2 times the one sought. That holds for errors too: they swing
as waves of their own, even where the motion is forced and keeps step. Source: derived for this program.
"""

import math
from collections.abc import Callable
from typing import Any

from solvers.scene.estimator_limits import Limit

#: Radians that a wave of the coarse run may be behind at the end: the estimate is off by .45 of itself then, and by
#: half of that in the mean. Measured on bars of one and two waves: distances of x up to .5 below, .2 to 1.5 beyond 1.2.
MOST_LAG = 0.9


def phase_lag(scene: Any, wavenumber: float | Callable[[Any], float]) -> float:
    """Returns the lag in radians of a wave in two-grid's second run behind the exact one when the scene ends;
    ``wavenumber`` is in rad/m, or a function of the scene."""
    slowing = 1 / 4 if scene.method == "bspline" else 1 / 8 + 1 / (24 * scene.ppc**2)
    k = wavenumber(scene) if callable(wavenumber) else wavenumber
    coarse = scene.spacing * scene.cells / (scene.cells // 2)
    return slowing * (k * coarse) ** 2 * k * scene.wave_speed * scene.end_time


def phase_lag_limit(wavenumber: float | Callable[[Any], float], **where: Any) -> Limit:
    """Returns two-grid's limit on :func:`phase_lag`; ``where`` are values of the scene's fields for which it holds."""
    return Limit("two-grid", lambda scene: phase_lag(scene, wavenumber), most=MOST_LAG, where=where, give={
        "cells": lambda scene, lag: 2 * math.ceil(scene.cells / 2 * math.sqrt(lag / MOST_LAG) + 1),
        "end_time": lambda scene, lag: scene.end_time * MOST_LAG / lag},
        why="by the end, waves on the second run's cells would be {value:.2g} radians behind, too far to extrapolate "
            "(at most {most:g}); give {cells} cells or {end_time:.3g} s")
