"""A step of the ring taken apart: read from the arrays that the step has left."""

import numpy as np

from solvers.problems.planar.layout import half_edges
from solvers.problems.planar.step_breakdown import nodes_of, weights_of
from solvers.problems.ring.method.phases import GHOSTS
from solvers.problems.ring.scene import RingScene
from solvers.problems.ring.state import WatchedRing
from solvers.solver.step_breakdown import Carried, Image, StepBreakdown, flipped, link


def carried(a: WatchedRing) -> Carried:
    """What the particles carry now, copied."""
    F = a.deformation_gradient.copy()
    f = np.ascontiguousarray(F.T)  # component by component: numpy's products of many small matrices are slow
    with np.errstate(all="ignore"):  # a run gone bad holds anything
        xy = f[0] * f[2] + f[1] * f[3]
        stress = np.stack([f[0] * f[0] + f[1] * f[1] - 1, xy, xy, f[2] * f[2] + f[3] * f[3] - 1], axis=1)
        stress *= (a.shear_modulus / (f[0] * f[3] - f[1] * f[2]))[:, None]
    return Carried(a.motion[:, :2].copy(), a.motion[:, 2:].copy(), F.reshape(-1, 2, 2), stress.reshape(-1, 2, 2))


def breakdown(scene: RingScene, a: WatchedRing, particle: int, step: int, before: Carried) -> StepBreakdown:
    """Of the step number ``step``, just taken, around a particle; ``before`` is what was carried then."""
    edges, row = half_edges(scene, before.deformation_gradient, a.edges), a.row
    links = link(particle, nodes_of(scene, a), lambda some: weights_of(scene, a, edges, some),
                 lambda node: _images(node, row))
    seen, k, ij = before.seen(links), links.members, np.stack([links.nodes % row, links.nodes // row], axis=1)
    signs = np.where(ij < GHOSTS, -1.0, 1.0)  # a node beyond a plane has what its mirror image has
    home = np.abs(ij - GHOSTS) + GHOSTS
    sums = a.node_sums[home[:, 1] * row + home[:, 0]]
    force = links.signs * (a.mass * a.radial_force[a.radius])[k, None] * a.direction[k]
    body = links.weight.T @ force
    F, place = seen.deformation_gradient, a.material_position if scene.frozen else before.position
    with np.errstate(all="ignore"):
        J = np.linalg.det(F)[:, None, None]
        force_moment = J * seen.stress  # Kirchhoff's, or with frozen weights P = J sigma F^-T
        if scene.frozen:
            force_moment = force_moment @ np.linalg.inv(F).transpose(0, 2, 1)
    motion = a.node_motion[links.nodes]
    return StepBreakdown(
        step, (step - 1) * scene.time_step, scene.time_step, scene.spacing, links, seen, carried(a).seen(links),
        a.mass[k], links.signs * place[k], flipped(edges[k], links.signs),
        (a.mass[k] / a.density)[:, None, None] * force_moment, (ij - GHOSTS) * scene.spacing, sums[:, 4].copy(),
        signs * sums[:, :2], signs * sums[:, 2:4] - body, body, motion[:, 2:].copy(), motion[:, :2].copy())


def _images(node: int, row: int) -> list[Image]:
    """The mirror images of nodes in the two rows next to a plane, on either side; the plane's own have none."""
    def along(index: int) -> list[int]:
        return [index, 2 * GHOSTS - index] if index <= 2 * GHOSTS and index != GHOSTS else [index]

    i, j = node % row, node // row
    return [Image(jj * row + ii, (1.0 if ii == i else -1.0, 1.0 if jj == j else -1.0), (0.0, 0.0))
            for jj in along(j) for ii in along(i)]
