"""Where an estimator is known, before anything has run, not to hold: then it says so instead of a number.

Needs no kernels, so that the page and the command line can ask. What only a run can show is the business of the
estimator's own ``verdict``.
"""

from __future__ import annotations

from collections.abc import Callable

from solvers.scene import Scene

COMPANION_LIMIT = 0.25  # amplitude: the index of the stress is 1.05 there (CPDI, 48 cells, one period), 5.7 at 0.3
RECOVERED_LIMIT = 0.2  # amplitude: good to 0.19 (stress index 1.08), 4 for the acceleration at 0.22, nothing at 0.25
FEWEST_ACROSS = 4  # particles, for a cubic


def _ring_companion(scene: Scene) -> str | None:
    if scene.amplitude > COMPANION_LIMIT:
        return (f"at an amplitude above {COMPANION_LIMIT:g} the ring's motion is so unstable that a second solve of "
                "it leaves the first for reasons of its own")
    return None


def _ring_recovered(scene: Scene) -> str | None:
    if scene.layout == "cartesian":
        return ("recovered fits the particles along the lines of a polar lattice, and could not see the error that a "
                "staircase for a boundary makes; take the polar layout")
    if scene.amplitude > RECOVERED_LIMIT:
        return (f"at an amplitude above {RECOVERED_LIMIT:g} the compressed ring is so unstable that recovered's own "
                "equation of motion breaks down")
    if round(scene.cells * scene.particles_per_cell / 6) < FEWEST_ACROSS:
        return ("recovered fits a cubic across the ring, which needs four particles there; take more cells or more "
                "particles per cell")
    return None


#: (problem, estimator) -> a rule that gives the reason, or nothing.
RULES: dict[tuple[str, str], Callable[[Scene], str | None]] = {
    ("ring", "companion"): _ring_companion, ("ring", "recovered"): _ring_recovered}


def not_valid(scene: Scene, estimator: str) -> str | None:
    """A sentence that begins with "not valid here: ", or None where the estimator may be used."""
    rule = RULES.get((scene.problem, estimator))
    reason = rule(scene) if rule else None
    return f"not valid here: {reason}" if reason else None
