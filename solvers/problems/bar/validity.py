"""Where an estimator of the bar is known, before anything has run, not to hold.

What only a run can show is the business of the estimator's own ``verdict``.
"""

import math
from collections.abc import Callable
from typing import Any

from solvers.estimators.phase_lag import out_of_step
from solvers.scene.causes import NOTHING
from solvers.scene.registry import FROZEN_REASON, REMEDIES_REASON
from solvers.scene.remedies import COUPLED, FILTER, PIECES
from solvers.scene.scene import Scene

#: Two-grid: the error of a mapping or a force that is off by the displacement is a share of the motion, whatever the
#: grid; from this many h^2 (per unit length) on it outweighs the error that falls like h^2. Measured: with uGIMP the
#: index of x is .95 at 2, .85 at 40, .65 at 160; with the force at nodes .98 at 2, .80 at 6, .52 at 40.
MOST_MOTION = 5.0
MOST_MOTION_SPLINES = 30.0  # whose kinks are weaker; measured: good on 6 bars between, .73 at 150
#: The same of hat functions, whose error of quadrature grows with the motion as soon as particles stand unevenly:
#: x .9 to 1.1 on 6 of 7 bars below, .50 to .60 on 6 from .9 on.
MOST_MOTION_HATS = 0.5
FEWEST_ON_A_WAVE = 16  # cells; the second run has 8. With 12 the index of x is 1.2 and its distance 1.4
#: Two-grid: one or two particles are a coarse rule of quadrature, whose error depends on where in the cell they stand.
#: Particles that move a good part of a cell make it another one on each grid, and no power of h; measured, with one a
#: cell: .61-.70 of the error of sigma at .09 to .54 cells, .8 to .9 at .03 to .07. Farthest, in cells of the run:
FARTHEST_OF_FEW = {1: 1 / 16, 2: 1 / 4}
ENOUGH = 3  # particles in a cell
#: Two-grid: how far particles may move, in cells, until crossing from one cell to the next fills the acceleration with
#: noise. The force on a particle kinks there with hats (however wide a domain sees them) and is smooth with B-splines.
#: Measured distances of a: .3 below, .3-1.1 beyond.
QUIET = {"bspline": 1.0}
QUIET_HATS = 0.25
#: Two-grid: periods of such a motion. The noise stays in what the nodes do not see and grows with every period; after
#: 16 of them the distance of x is .64 with 80 cells and .79 with 160.
LONGEST_NOISE = 6
#: Two-grid: cells that particles may move until what the coupling of F does to a motion, and the second run does
#: without, outweighs the error; x .9 to 1.1 on 8 of 9 bars below, on 3 of 20 beyond.
MOST_COUPLED = 0.02


def two_grid(scene: Scene) -> str | None:
    """Richardson's argument needs an error that falls like h^2 on both grids."""
    if not scene.swings:
        return ("the error of a patch test is round-off, or what cells of unequal count leave, and neither falls with "
                "the cell size; take companion")
    reach = scene.spacing / (2 * scene.ppc)  # from the outermost particle of a cell to the next cell
    moved = scene.motion_amplitude / scene.spacing
    gentle = {FILTER} | ({COUPLED} if moved < MOST_COUPLED else set())  # only take noise away
    if others := [name for name in scene.remedies if name not in gentle]:
        return REMEDIES_REASON.format(names=" and ".join(others))
    motion = scene.motion_amplitude / scene.spacing**2
    far = motion > MOST_MOTION
    # The second tone has half the wavelength. Measured for far motion: index of x .42 with 40 cells, 1.06 with 80.
    needed = FEWEST_ON_A_WAVE * ((4 if far else 2) if scene.body_force == "two-tone" else 1)
    if scene.cells < needed:
        return f"the second run has half the cells, and half of {scene.cells} is too few; give {needed} or more"
    if scene.ppc < ENOUGH and moved > FARTHEST_OF_FEW[int(scene.ppc)]:
        return (f"with {scene.ppc} per cell, particles that move {moved:.2g} cells leave an error that is another one "
                f"on each grid; give {ENOUGH} or more")
    if noisy(scene) and scene.end_time > LONGEST_NOISE * scene.period:
        return ("particles that cross cells leave noise, another one on each grid, which grows with every period; end "
                f"within {LONGEST_NOISE} or take a smaller amplitude")
    if scene.body_force == "node" and far:
        return "the force at the nodes is off by the displacement, an error that both grids share and none shows"
    inside = scene.motion_amplitude < reach and (scene.linearity_preserving or motion < MOST_MOTION_HATS)
    if scene.method == "mpm" and not inside:
        return "with hat functions the error of particles that cross cells does not fall with the cell size"
    most = MOST_MOTION_SPLINES if scene.method == "bspline" else MOST_MOTION
    if scene.method in ("ugimp", "bspline") and not scene.linearity_preserving and motion > most:
        return ("the domains do not follow the material, which leaves an error that does not fall with the cell size; "
                "switch linearity preservation on")
    return out_of_step(scene, (4 if scene.body_force == "two-tone" else 2) * math.pi)


def recovered(scene: Scene) -> str | None:
    """Its tables repeat from cell to cell, and it fits what is smooth."""
    return None if scene.swings else ("recovered fits a smooth motion to whole numbers of particles per cell, and with "
                                      "these a patch test has no error but round-off; take companion")


def noisy(scene: Scene) -> bool:
    """Whether two-grid can say nothing of a: crossings fill it with noise, which each grid has in other places."""
    return scene.motion_amplitude > QUIET.get(scene.method, QUIET_HATS) * scene.spacing


def transport(scene: Scene) -> str | None:
    """Its defects are those of weights that follow the particles; of B-splines they are next to nothing.

    Measured with B-splines at 40 and 160 cells: indices .000-.006 for A = 2.5e-4, .005-.46 for .025, .08-.75 for .05.
    """
    if not scene.swings:
        return ("transport reads zero in a patch test that is passed, and thousands of times the error of x in one "
                "that is failed; take companion")
    if scene.frozen:
        return FROZEN_REASON
    if PIECES in scene.remedies:
        return ("the terms that transport carries are those of a particle's own weights, and forces of pieces have "
                "other ones; take recovered or companion")
    if scene.method == "bspline":
        return ("the terms that transport carries all but vanish for B-splines, so that it reads next to zero; take "
                "recovered or companion")
    return None


def of_whole_runs(rule: Callable[[Any], str | None]) -> Callable[[Any], str | None]:
    """The rule of an estimator that derives from the step what a run without one of its causes no longer has: of hats
    without crossings transport's index of x is 24. Recovered and companion, which look at the motion, go on."""
    def of_all(scene: Any) -> str | None:
        if scene.take_away != NOTHING and "budget" in scene.effects:
            return "a cause of error is taken out of the run, which only recovered and companion see; take one of them"
        return rule(scene)
    return of_all


RULES: dict[str, Callable[[Any], str | None]] = {
    "transport": of_whole_runs(transport), "two-grid": of_whole_runs(two_grid), "recovered": recovered}
