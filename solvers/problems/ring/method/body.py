"""The ring's body: every number and array that the method itself needs.

Nodes lie at (-2h, -2h) + (i, j) h; the planes x = 0 and y = 0 run through the nodes with index 2, so that two rows of
ghosts lie beyond each.
"""

from dataclasses import dataclass

from solvers.kernels.kinds import Real, Reals
from solvers.problems.planar.layout import particle_layout
from solvers.problems.planar.method.body import PlanarBody, common
from solvers.problems.planar.scene import GHOSTS
from solvers.problems.ring import exact
from solvers.problems.ring.scene import RingScene
from solvers.scene.switches import Switches
from solvers.solver.arrays import zeros


@dataclass
class RingBody(PlanarBody):
    """What the ring has beside; K material radii."""

    radial_force: Reals  # body force per mass in this step (K,)
    farthest_move: Real  # how far a particle of a sound run may be from where it began, m


FARTHEST_MOVE = 20.0  # amplitudes


def farthest(scene: RingScene) -> float:
    """Distance from the centre beyond which a particle has left the ring: half as far again as it should go."""
    return exact.OUTER + 1.5 * scene.amplitude + scene.spacing


def body(scene: RingScene, on: Switches, slabs: int) -> dict:
    """The members of a :class:`RingBody` at the start: the scene's layout, F = I and the exact velocity."""
    layout = particle_layout(scene)
    active = min(scene.cells + 1, int(farthest(scene) / scene.spacing) + GHOSTS + 3)
    return {**common(scene, on, layout, slabs, float(GHOSTS), active, 0.5 * scene.modulus,
                     exact.velocity(scene, layout.position, 0.0), exact.shape(layout.radii)),
            "radial_force": zeros(len(layout.radii)), "farthest_move": FARTHEST_MOVE * scene.amplitude}
