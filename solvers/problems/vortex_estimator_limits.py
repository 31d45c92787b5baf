"""Where an estimator of the vortex is known not to hold: a row for each limit (see
``solvers.scene.estimator_limits``)."""

import math
from typing import Any

import numpy as np

from solvers.problems.planar.recovered_limits import POLAR, THREE_ACROSS
from solvers.scene.estimator_limits import Limit
from solvers.scene.estimator_registry import MOVING_WEIGHTS

FAR_ENOUGH = 3.0  # metres in a period
#: Radians from one cell to the next by which circles may turn against each other. Measured on 60 vortices of 16 to 80
#: cells: sigma .9 to 1.1 below, 1.2 to 3 beyond, and x up to 1.5.
MOST_TURN = 0.39


def swirl_slopes(scene: Any) -> tuple[np.ndarray, np.ndarray]:
    """Returns radii R (101,) across the vortex in m, and there h' in 1/m of h(R) = 1 - 32 (R-1)^2 + 256 (R-1)^4."""
    R = np.linspace(scene.INNER, scene.OUTER, 101)
    return R, (1024 * (R - 1) ** 2 - 64) * (R - 1)


def wave_angle_per_metre(scene: Any) -> float:
    """Returns the angle in radians that a wave runs along the fastest circle while a wave at rest runs a metre.

    With F = [[1, 0], [g, 1]] the stiffest tangent along e_Theta, at rest, is mu + (lambda + mu) (1 + g^2), and there
    g/R = A |h'|. Where the shear is largest, circles are wider than the inner rim.
    """
    ratio = 1 / (1 - 2 * scene.poisson_ratio)  # (lambda + mu)/mu
    R, slope = swirl_slopes(scene)
    return float(np.sqrt((1 / R**2 + ratio / (ratio + 1) * (scene.amplitude * slope) ** 2).max()))


def relative_turn(scene: Any) -> float:
    """Returns the largest angle in radians by which circles of material one cell apart turn against each other."""
    return float(scene.amplitude * scene.spacing * np.abs(swirl_slopes(scene)[1]).max())


LIMITS = (
    # Recovered: the fits need a polar lattice with enough particles, and its steps cannot be shorter than the run's.
    MOVING_WEIGHTS, POLAR, THREE_ACROSS,
    # On 24 cells along a side the ring is four cells wide, as a fit is. On fewer, errors are resolved only where waves
    # have spread them: measured, x and v .9 to 1.1 in 25 of 27 vortices in which a wave goes 3 m or more in a period,
    # in 4 of 28 others, where they are .6 to .9; with uneven particles, over which fits go farther, in 1 of 20 of all.
    Limit("recovered", "cells", least=24, where={"is_uneven": True}, why="particles that are one per cell or move with "
          "their own velocity stand unevenly, and recovered's fits over six cells are wider than the ring; give "
          "{least} cells or more"),
    Limit("recovered", lambda scene: scene.wave_speed * scene.period, least=FAR_ENOUGH, where={"is_coarse": True},
          give={"frequency": lambda scene, reach: reach * scene.frequency / FAR_ENOUGH},
          why="recovered's fits over four cells are wider than the ring, and waves, which go {value:.2g} m in a "
          "period, do not spread the error until they see it; give 24 cells or more, or a frequency of "
          "{frequency:.2g}/s or less"),
    Limit("recovered", relative_turn, most=MOST_TURN,
          give={"cells": lambda scene, turn: math.ceil(scene.cells * turn / MOST_TURN)},
          why="circles one cell apart turn by {value:.2g} radians against each other, and recovered's fits over four "
          "cells can follow {most:g}; give {cells} cells or a smaller amplitude"),
    # As a wave's way over an element, a cell wide at the inner rim. From 0.8 on it may be unstable, as the run shows.
    Limit("recovered", "courant_number", most=lambda scene: 0.9 / (scene.INNER * wave_angle_per_metre(scene)),
          why="recovered "
          "has its own equation of motion, which is unstable with such steps in such a shear; give a cfl of {most:.2g} "
          "or less"))
