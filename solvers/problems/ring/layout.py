"""Where the ring's particles begin."""

import numpy as np

from solvers.problems.planar.layout import Layout, cartesian, polar
from solvers.problems.ring.exact import INNER, OUTER
from solvers.problems.ring.scene import RingScene, polar_counts

GHOSTS = 2  # rows of nodes beyond each symmetry plane


def particle_layout(scene: RingScene) -> Layout:
    """The scene's layout: "polar" lattices fill the ring exactly, "cartesian" ones leave a staircase at its rim."""
    if scene.layout == "polar":
        return polar(INNER, OUTER, 0.5 * np.pi, *polar_counts(scene.cells, scene.ppc))
    return cartesian(INNER, OUTER, scene.spacing / scene.ppc, 0.0)
