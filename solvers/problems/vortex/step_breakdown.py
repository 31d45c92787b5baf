"""A step of the vortex taken apart: read from the arrays that the step has left."""

import numpy as np

from solvers.problems.planar.layout import half_edges
from solvers.problems.planar.step_breakdown import nodes_of, weights_of
from solvers.problems.vortex.errors import stress
from solvers.problems.vortex.scene import VortexScene
from solvers.problems.vortex.state import WatchedVortex
from solvers.solver.step_breakdown import Carried, Image, StepBreakdown, link


def carried(a: WatchedVortex) -> Carried:
    """What the particles carry now, copied."""
    with np.errstate(all="ignore"):  # a run gone bad holds anything
        xx, xy, yy = stress(a)
    sigma = np.stack([xx, xy, xy, yy], axis=1).reshape(-1, 2, 2)
    return Carried(a.motion[:, :2].copy(), a.motion[:, 2:].copy(), a.deformation_gradient.reshape(-1, 2, 2).copy(),
                   sigma)


def breakdown(scene: VortexScene, a: WatchedVortex, particle: int, step: int, before: Carried) -> StepBreakdown:
    """Of the step number ``step``, just taken, around a particle; ``before`` is what was carried then."""
    edges = half_edges(scene, before.deformation_gradient, a.edges)
    links = link(particle, nodes_of(scene, a), lambda some: weights_of(scene, a, edges, some),
                 lambda node: [Image(node, (1.0, 1.0), (0.0, 0.0))])
    k, seen = links.members, before.seen(links)
    sums, motion = a.node_sums[links.nodes], a.node_motion[links.nodes]
    f, e = a.polar_force[a.radius[k]], a.direction[k]
    force = f[:, :1] * e + f[:, 1:] * np.stack([-e[:, 1], e[:, 0]], axis=1)
    body = links.weight.T @ (a.mass[k][:, None] * force)
    F, place = seen.deformation_gradient, a.material_position if scene.frozen else before.position
    with np.errstate(all="ignore"):
        force_moment = np.linalg.det(F)[:, None, None] * seen.stress  # Kirchhoff's, or P = J sigma F^-T
        if scene.frozen:
            force_moment = force_moment @ np.linalg.inv(F).transpose(0, 2, 1)
    ij = np.stack([links.nodes % a.row, links.nodes // a.row], axis=1)
    return StepBreakdown(
        step, (step - 1) * scene.time_step, scene.time_step, scene.spacing, links, seen, carried(a).seen(links),
        a.mass[k], place[k], edges[k], (a.mass[k] / a.density)[:, None, None] * force_moment,
        (ij - a.origin) * scene.spacing, sums[:, 4].copy(), sums[:, :2].copy(), sums[:, 2:4] - body, body,
        motion[:, 2:].copy(), motion[:, :2].copy())
