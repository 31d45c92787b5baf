"""Where an estimator of the vortex is known, before anything has run, not to hold.

What only a run can show is the business of the estimator's own ``verdict``. A scene is a ``VortexScene``, whose file
imports this one.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from solvers.problems.planar.validity import off_lattice, too_few_across, transport
from solvers.problems.vortex.exact import INNER, OUTER, shape

FEWEST_CELLS = 24  # on which a fit over four cells is as wide as the ring; with 12 the index of x is .7, that of a .5
LONGEST_STEP = 0.75  # of recovered, as the way of a wave over an element: from 0.8 on its method may be unstable
LOOKED_AT = 101  # circles, for the fastest wave


def crossing_rate(scene: Any) -> float:
    """How many radians a wave on the fastest circle runs while one runs a metre at rest.

    With F = [[1, 0], [g, 1]] the stiffest tangent along e_Theta, at rest, is mu + (lambda + mu) (1 + g^2), and there
    g/R = A |h'|. Where the shear is largest, circles are wider than the inner rim.
    """
    ratio = 1 / (1 - 2 * scene.poisson_ratio)  # (lambda + mu)/mu
    R = np.linspace(INNER, OUTER, LOOKED_AT)
    square = 1 / R**2 + ratio / (ratio + 1) * (scene.amplitude * shape(R)[1]) ** 2
    return float(np.sqrt(square.max()))


def recovered(scene: Any) -> str | None:
    """The fits need a polar lattice with enough particles, and its steps cannot be shorter than the run's."""
    if reason := off_lattice(scene) or too_few_across(scene):
        return reason
    if scene.cells < FEWEST_CELLS:
        return (f"recovered fits the particles over four cells, which is more than the whole width of the ring; give "
                f"{FEWEST_CELLS} cells or more")
    bearable = LONGEST_STEP / (INNER * crossing_rate(scene))  # elements are a cell wide at the inner rim
    if scene.courant_number > bearable:
        return (f"recovered has an equation of motion of its own, which such steps would make unstable in a material "
                f"sheared so much; give a cfl of {bearable:.2g} or less")
    return None


RULES: dict[str, Callable[[Any], str | None]] = {"recovered": recovered, "transport": transport}
