"""Where an estimator of the ring is known, before anything has run, not to hold.

What only a run can show is the business of the estimator's own ``verdict``. A scene is a ``RingScene``, whose file
imports this one.
"""

import math
from collections.abc import Callable
from typing import Any

from solvers.estimators.phase_lag import out_of_step
from solvers.problems.planar.validity import off_lattice, too_few_across, transport
from solvers.scene.registry import REMEDIES_REASON

FEWEST_CELLS = {"material": 12, "none": 48, "two-tone": 48}  # two move in waves across it; with 24 x is .7
COMPANION_LIMIT = 0.25  # amplitude: the index of the stress is 1.05 there (CPDI, 48 cells, one period), 5.7 at 0.3
RECOVERED_LIMIT = 0.2  # amplitude: good to 0.19 (stress index 1.08), 4 for the acceleration at 0.22, nothing at 0.25
MOST_GROWTH = 4.0  # two-grid, of a disturbance after the first period: measured at 7.7, .68 of the error of x
WIDTH = 0.2  # of the ring, in metres: the half wavelength of the longest wave across it


def two_grid(scene: Any) -> str | None:
    """Richardson's argument needs an error that falls like h^2; only CPDI's domains tile the lattice on all grids."""
    if scene.remedies:
        return REMEDIES_REASON
    needed = FEWEST_CELLS[scene.body_force]
    if scene.layout == "cartesian":
        return "the staircase of the cartesian layout is another one on each grid, so their errors are not comparable"
    if scene.method != "cpdi":
        return "the boxes of this method do not tile the ring, so its error does not fall with the cell size; use CPDI"
    if scene.cells < needed:
        return f"the second run has half the cells, and half of {scene.cells} is too few; give {needed} or more"
    if scene.amplitude >= 0.6 - 2 * 1.2 / (scene.cells // 2):  # radius 0.6; two rows of cells lie below zero
        return "so large a motion would leave the grid of the second run; give more cells or a smaller amplitude"
    if scene.ppc == 1:
        return ("one particle per cell is so coarse a rule of quadrature that its error, of a cell's length, drowns "
                "what the two grids have in common; give two or more")
    growth = scene.growth ** (scene.end_time / scene.period - 1)
    if growth > MOST_GROWTH:
        return (f"so large a motion is unstable: after the first period disturbances grow {growth:.2g}-fold or more, "
                "on each grid at another rate; end earlier or take a smaller amplitude")
    # The manufactured force moves the ring as a whole; the others send waves across it.
    return None if scene.body_force == "material" else out_of_step(scene, math.pi / WIDTH)


def companion(scene: Any) -> str | None:
    """Both solves must follow the same motion."""
    if scene.amplitude > COMPANION_LIMIT:
        return (f"at an amplitude above {COMPANION_LIMIT:g} the ring's motion is so unstable that a second solve of "
                "it leaves the first for reasons of its own")
    return None


def recovered(scene: Any) -> str | None:
    """The fits need a polar lattice with enough particles, and a motion that is not unstable."""
    if reason := off_lattice(scene):
        return reason
    if scene.amplitude > RECOVERED_LIMIT:
        return (f"at an amplitude above {RECOVERED_LIMIT:g} the compressed ring is so unstable that recovered's own "
                "equation of motion breaks down")
    return too_few_across(scene)


RULES: dict[str, Callable[[Any], str | None]] = {
    "companion": companion, "recovered": recovered, "transport": transport, "two-grid": two_grid}
