"""Where an estimator of the bar is known, before anything has run, not to hold.

What only a run can show is the business of the estimator's own ``verdict``.
"""

from collections.abc import Callable

from solvers.estimators.validity import FROZEN_REASON, REMEDIES_REASON
from solvers.scene import Scene

#: Two-grid: the error of a mapping or a force that is off by the displacement is a share of the motion, whatever the
#: grid; from this many h^2 (per unit length) on it outweighs the error that falls like h^2. Measured: with uGIMP the
#: index of x is .95 at 2, .85 at 40, .65 at 160; with the force at nodes .98 at 2, .80 at 6, .52 at 40.
MOST_MOTION = 5.0
FEWEST_ON_A_WAVE = 16  # cells; the second run has 8. With 12 the index of x is 1.2 and its distance 1.4


def two_grid(scene: Scene) -> str | None:
    """Richardson's argument needs an error that falls like h^2 on both grids."""
    if scene.remedies:
        return REMEDIES_REASON
    far = scene.motion_amplitude > MOST_MOTION * scene.spacing**2
    # The second tone has half the wavelength. Measured for far motion: index of x .42 with 40 cells, 1.06 with 80.
    needed = FEWEST_ON_A_WAVE * ((4 if far else 2) if scene.body_force == "two-tone" else 1)
    reach = scene.spacing / (2 * scene.ppc)  # from the outermost particle of a cell to the next cell
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


def transport(scene: Scene) -> str | None:
    """Its defects are those of weights that follow the particles; of B-splines they are next to nothing.

    Measured with B-splines at 40 and 160 cells: indices .000-.006 for A = 2.5e-4, .005-.46 for .025, .08-.75 for .05.
    """
    if scene.frozen:
        return FROZEN_REASON
    if scene.method == "bspline":
        return ("the terms that transport carries all but vanish for B-splines, so that it reads next to zero; take "
                "recovered or companion")
    return None


RULES: dict[str, Callable[[Scene], str | None]] = {"transport": transport, "two-grid": two_grid}
