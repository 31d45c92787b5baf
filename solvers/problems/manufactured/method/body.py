"""The body of a manufactured problem: beside what every plane body has, its exact fields as tables, and no formula."""

from dataclasses import dataclass

import numpy as np

from solvers.kernels.kinds import Integers, Pairs, Quads, Real, Reals
from solvers.problems.manufactured.scene import ManufacturedScene, motion_table
from solvers.problems.planar.layout import particle_layout
from solvers.problems.planar.method.body import PlanarBody, common
from solvers.problems.planar.method.field_tables import of_motions, of_pairs, of_vectors, pack
from solvers.scene.switches import Switches
from solvers.solver.arrays import zeros

FORCE, MOTION, GRID = range(3)  # tables: body force, motion, and acceleration at nodes


@dataclass
class ManufacturedBody(PlanarBody):
    """What a manufactured problem has beside. All tables lie in one array, for a kernel takes 64 arguments at most."""

    lame_modulus: Real  # lambda
    volumetric: Reals  # lambda ln J of each particle in this step (P,)
    particle_force: Pairs  # body force per mass in this step (P, 2)
    table_sizes: Integers  # see ``solvers.problems.planar.method.field_tables``
    tables: Quads


def farthest(scene: ManufacturedScene) -> float:
    """The largest coordinate that a particle of a sound run may have, in m."""
    return scene.farthest


def body(scene: ManufacturedScene, on: Switches, slabs: int) -> dict:
    """The members of a :class:`ManufacturedBody` at the start: the layout, F = I, and the exact velocity of half a step
    before, for symplectic Euler is the leapfrog scheme, whose velocities belong to the middle of the steps."""
    layout, exact = particle_layout(scene), scene.EXACT
    lame_modulus, shear_modulus = scene.lame_moduli
    known = on.truth or bool(on.estimators) or on.soundness
    nothing = (np.zeros(len(layout.radii)),) * 3
    sizes, tables = pack(of_pairs(scene.force_table() if on.body_force != "none" else None),
                         of_motions(motion_table(scene) if known else None),
                         of_vectors(scene.grid_table() if known and on.acceleration else None))
    return {**common(scene, on, layout, slabs, scene.origin, scene.row, shear_modulus,
                     exact.velocity(scene, layout.position, -0.5 * scene.time_step), nothing),
            "lame_modulus": lame_modulus, "volumetric": zeros(len(layout.volume)),
            "particle_force": zeros(len(layout.volume), 2),
            "table_sizes": sizes, "tables": tables}
