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
from solvers.scene.remedies import FILTER

FEWEST_CELLS = {"material": 12, "none": 48, "two-tone": 48}  # two move in waves across it; with 24 x is .7
COMPANION_LIMIT = 0.25  # amplitude: the index of the stress is 1.05 there (CPDI, 48 cells, one period), 5.7 at 0.3
RECOVERED_LIMIT = 0.22  # amplitude: x, v and sigma good in 8 of 10 rings of .2 to .22, 4 for a; nothing at 0.25
RECOVERED_TIME = 0.6  # periods until which both are good beyond: in the second half of one the ring is compressed
COMPRESSED = 0.2  # amplitude from which on two-grid's x may be .4 to .7 once the ring has been compressed
FEWEST_FILTERED = 15  # cells of a run with the filter; with 12 and 13 v is 1.2 and 1.5
FEWEST_WITH_GAPS, MOST_WITH_GAPS = 15, 8  # cells of a cpGIMP ring for two-grid, the second for each particle in a cell
MOST_GROWTH = 4.0  # two-grid, of a disturbance after the first period: measured at 7.7, .68 of the error of x
WIDTH = 0.2  # of the ring, in metres: the half wavelength of the longest wave across it


def two_grid(scene: Any) -> str | None:
    """Richardson's argument needs an error that falls like h^2; only CPDI's domains tile the lattice on all grids."""
    if others := [name for name in scene.remedies if name != FILTER]:  # which only takes noise away
        return REMEDIES_REASON.format(names=" and ".join(others))
    needed = max(FEWEST_CELLS[scene.body_force], FEWEST_FILTERED if scene.remedies else 0)
    if scene.layout == "cartesian":
        return "the staircase of the cartesian layout is another one on each grid, so their errors are not comparable"
    # What the boxes of cpGIMP leave open is less, the more particles there are: x .9 to 1.0 on 12 of 12 rings on which
    # that is less than the error of the cells, on 7 of 50 others.
    gaps_are_small = scene.method == "cpgimp" and scene.ppc >= 3 \
        and FEWEST_WITH_GAPS <= scene.cells <= MOST_WITH_GAPS * scene.ppc
    if scene.method != "cpdi" and not gaps_are_small:
        return "the boxes of this method do not tile the ring, so its error does not fall with the cell size; use CPDI"
    if scene.cells < needed:
        return f"the second run has half the cells, and half of {scene.cells} is too few; give {needed} or more"
    if scene.amplitude >= 0.6 - 2 * 1.2 / (scene.cells // 2):  # radius 0.6; two rows of cells lie below zero
        return "so large a motion would leave the grid of the second run; give more cells or a smaller amplitude"
    if scene.ppc == 1:
        return ("one particle per cell is so coarse a rule of quadrature that its error, of a cell's length, drowns "
                "what the two grids have in common; give two or more")
    if scene.amplitude > COMPRESSED and scene.end_time > RECOVERED_TIME * scene.period:
        return (f"at an amplitude above {COMPRESSED:g} the compressed ring is so unstable that the two runs part; end "
                f"within {RECOVERED_TIME:g} periods or take a smaller one")
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
    if scene.amplitude > RECOVERED_LIMIT and scene.end_time > RECOVERED_TIME * scene.period:
        return (f"at an amplitude above {RECOVERED_LIMIT:g} the compressed ring is so unstable that recovered's own "
                f"equation of motion breaks down after {RECOVERED_TIME:g} periods; end earlier or take a smaller one")
    if scene.ppc == 1 and scene.velocity == "particle":
        return ("single particles per cell that move with their own velocity stand so unevenly that recovered's fits "
                "follow them; give two or more per cell, or the velocity grid")
    return too_few_across(scene)


RULES: dict[str, Callable[[Any], str | None]] = {
    "companion": companion, "recovered": recovered, "transport": transport, "two-grid": two_grid}
