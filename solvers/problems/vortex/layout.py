"""Where the vortex's particles begin."""

import numpy as np

from solvers.problems.planar.layout import Layout, cartesian, polar
from solvers.problems.vortex.exact import INNER, OUTER
from solvers.problems.vortex.scene import VortexScene, polar_counts


def particle_layout(scene: VortexScene) -> Layout:
    """The scene's layout: "polar" lattices fill the ring exactly, "cartesian" ones leave staircases at its rims."""
    if scene.layout == "polar":
        return polar(INNER, OUTER, 2 * np.pi, *polar_counts(scene.cells, scene.ppc))
    return cartesian(INNER, OUTER, scene.spacing / scene.ppc, -OUTER)
