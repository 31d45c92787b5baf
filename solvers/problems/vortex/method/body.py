"""The vortex's body: every number and array that the method itself needs.

Nodes lie at (-1.5, -1.5) m + (i, j) h. Nothing is fixed: both rims are free.
"""

from dataclasses import dataclass

from solvers.kernels.kinds import Octets, Pairs, Real, Reals
from solvers.problems.planar.layout import particle_layout
from solvers.problems.planar.method.body import PlanarBody, common
from solvers.problems.vortex import exact
from solvers.problems.vortex.scene import SIDE, VortexScene
from solvers.scene.switches import Switches
from solvers.solver.arrays import zeros


@dataclass
class VortexBody(PlanarBody):
    """What the vortex has beside; K material radii."""

    lame_modulus: Real  # lambda
    volumetric: Reals  # lambda ln J of each particle in this step (P,)
    polar_force: Pairs  # body force per mass in this step along e_R and e_Theta of the particle at rest (K, 2)
    turns: Octets  # of the exact solution at a sample, with the truth: see the problem's ``samples`` (K,)


def farthest(scene: VortexScene) -> float:
    """How far from the centre in x or y a particle may be, in metres: half a cell from the grid's edge."""
    return 0.5 * (SIDE - scene.spacing)


def body(scene: VortexScene, on: Switches, slabs: int) -> dict:
    """The members of a :class:`VortexBody` at the start: the scene's layout, F = I and the exact velocity.

    The velocity is that of half a step before: symplectic Euler is the leapfrog scheme, whose velocities belong to the
    middle of the steps, and a(0) is not zero here. Begun with v(0) its positions are only first-order in the step.
    """
    layout = particle_layout(scene)
    lame_modulus, shear_modulus = exact.lame(scene)
    known = on.truth or bool(on.estimators)
    return {**common(scene, on, layout, slabs, 0.5 * scene.cells, scene.cells + 1, shear_modulus,
                     exact.velocity(scene, layout.position, -0.5 * scene.time_step), exact.shape(layout.radii)),
            "lame_modulus": lame_modulus, "volumetric": zeros(len(layout.volume)),
            "polar_force": zeros(len(layout.radii), 2), "turns": zeros(len(layout.radii), 8, when=known)}
