"""Where an estimator is known, before anything has run, not to hold: then it says so instead of a number.

Needs no kernels, so that the page and the command line can ask. What only a run can show is the business of the
estimator's own ``verdict``.
"""

from __future__ import annotations

from collections.abc import Callable

from solvers.scene import Scene

#: Two-grid: the error of a mapping or a force that is off by the displacement is a share of the motion, whatever the
#: grid; from this many h^2 (per unit length) on it outweighs the error that falls like h^2. Measured on the bar: with
#: uGIMP the index of x is .95 at 2, .85 at 40, .65 at 160; with the force at nodes .98 at 2, .80 at 6, .52 at 40.
MOST_MOTION = 5.0
FEWEST_ON_A_WAVE = 16  # cells; the second run has 8. With 12 the index of x is 1.2 and its distance 1.4
FEWEST_IN_RING = {"material": 12, "none": 48, "two-tone": 48}  # two move in waves across it; with 24 x is .7


def _bar_two_grid(scene: Scene) -> str | None:
    """Richardson's argument needs an error that falls like h^2 on both grids."""
    far = scene.motion_amplitude > MOST_MOTION * scene.spacing**2
    # The second tone has half the wavelength. Measured for far motion: index of x .42 with 40 cells, 1.06 with 80.
    needed = FEWEST_ON_A_WAVE * ((4 if far else 2) if scene.body_force == "two-tone" else 1)
    reach = scene.spacing / (2 * scene.particles_per_cell)  # from the outermost particle of a cell to the next cell
    if scene.cells < needed:
        return f"the second run has half the cells, and half of {scene.cells} is too few; give {needed} or more"
    if scene.body_force == "node" and far:
        return "the force at the nodes is off by the displacement, an error that both grids share and none shows"
    if scene.method == "mpm" and not (scene.linearity_preserving and scene.motion_amplitude < reach):
        return "with hat functions the error of particles that cross cells does not fall with the cell size"
    if scene.method in ("ugimp", "bspline") and not scene.linearity_preserving and far:
        return ("the domains do not follow the material, which leaves an error that does not fall with the cell size; "
                "switch linearity preservation on")
    return None


def _ring_two_grid(scene: Scene) -> str | None:
    """As for the bar; of the ring's domains only CPDI's tile the polar lattice, on grids of any size."""
    needed = FEWEST_IN_RING[scene.body_force]
    if scene.layout == "cartesian":
        return "the staircase of the cartesian layout is another one on each grid, so their errors are not comparable"
    if scene.method != "cpdi":
        return "the boxes of this method do not tile the ring, so its error does not fall with the cell size; use cpdi"
    if scene.cells < needed:
        return f"the second run has half the cells, and half of {scene.cells} is too few; give {needed} or more"
    if scene.amplitude >= 0.6 - 2 * 1.2 / (scene.cells // 2):  # radius 0.6; two rows of cells lie below zero
        return "so large a motion would leave the grid of the second run; give more cells or a smaller amplitude"
    return None


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
    ("ring", "companion"): _ring_companion, ("ring", "recovered"): _ring_recovered,
    ("bar", "two-grid"): _bar_two_grid, ("ring", "two-grid"): _ring_two_grid}


def not_valid(scene: Scene, estimator: str) -> str | None:
    """A sentence that begins with "not valid here: ", or None where the estimator may be used."""
    rule = RULES.get((scene.problem, estimator))
    reason = rule(scene) if rule else None
    return f"not valid here: {reason}" if reason else None
