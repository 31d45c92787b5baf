"""Where estimators are known, before anything has run, not to hold in the plane, whatever the problem."""

from collections.abc import Callable, Mapping
from typing import Any

from solvers.scene.registry import FROZEN_REASON

FEWEST_ACROSS = 3  # particles, for a parabola; with two, x is 2 to 15 times the error


def transport(scene: Any) -> str | None:
    """Its defects are those of weights that follow the particles."""
    return FROZEN_REASON if scene.frozen else None


def off_lattice(scene: Any) -> str | None:
    """Why recovered cannot fit the particles along the lines of their lattice: it needs a polar one."""
    return ("recovered fits the particles along the lines of a polar lattice, and could not see the error that a "
            "staircase for a boundary makes; take the polar layout") if scene.layout == "cartesian" else None


def too_few_across(scene: Any) -> str | None:
    """Why recovered cannot fit them across the ring."""
    return (f"recovered fits a cubic across the ring, or a parabola, which needs {FEWEST_ACROSS} particles there; take "
            "more cells or more particles per cell") if round(scene.cells * scene.ppc / 6) < FEWEST_ACROSS else None


#: Where it is not that an estimator would be wrong: it cannot run.
NO_LATTICE: Mapping[str, Callable[[Any], str | None]] = {
    "recovered": lambda scene: off_lattice(scene) or too_few_across(scene)}
