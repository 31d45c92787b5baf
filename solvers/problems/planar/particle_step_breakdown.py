"""Breakdown of a step in the plane, from the arrays after the step."""

import numpy as np

from solvers.problems.planar.method.body import InstrumentedBody
from solvers.problems.planar.particle_layout import half_edges
from solvers.problems.planar.scene import GHOSTS, PlanarScene
from solvers.problems.planar.snapshot_errors import body_force, cauchy_stress_of
from solvers.problems.planar.step_weights import MirroredNodeGrid, particle_node_numbers, shape_function_values
from solvers.solver import particle_step_breakdown
from solvers.solver.particle_step_breakdown import ParticleState, ParticleStepBreakdown, PeriodicOrMirrorNode


@np.errstate(all="ignore")  # for unstable runs
def particle_state(scene: PlanarScene, a: InstrumentedBody) -> ParticleState:
    """Returns a copy of the particles' x, v, F and Cauchy stress in the arrays ``a``, in SI units."""
    (xx, xy, yy), q = cauchy_stress_of(scene, a), a.position_velocity
    return ParticleState(q[:, :2].copy(), q[:, 2:].copy(), a.deformation_gradient.reshape(-1, 2, 2).copy(),
                         np.stack([xx, xy, xy, yy], axis=1).reshape(-1, 2, 2))


def breakdown(scene: PlanarScene, a: InstrumentedBody, particle: int, step: int,
              before: ParticleState) -> ParticleStepBreakdown:
    """Returns the breakdown of the last step, number ``step``, around ``particle``, an index, from the arrays ``a``
    after and the state ``before`` it."""
    ghosts = GHOSTS if scene.PLANES[0] else 0  # rows of nodes beyond a symmetry plane
    edges, row = half_edges(scene, before.deformation_gradient, a.edges), a.row
    grid = MirroredNodeGrid(row, ghosts, scene.PLANES[1])
    links = particle_step_breakdown.find_links(particle, particle_node_numbers(scene, a),
                                               lambda some: shape_function_values(scene, a, edges, some),
                                               lambda node: _images(node, row, ghosts, grid.last))
    seen, k, ij = before.mirror(links), links.members, np.stack([links.nodes % row, links.nodes // row], axis=1)
    home, signs = grid.resolve_images(links.nodes)  # a node beyond a plane has what its mirror image has
    sums, motion = a.node_sums[home], a.node_motion[links.nodes]
    body = links.weight.T @ (links.signs * body_force(a, k))
    F, place = seen.deformation_gradient, a.material_position if scene.frozen else before.position
    with np.errstate(all="ignore"):
        force_moment = np.linalg.det(F)[:, None, None] * seen.stress  # Kirchhoff's, or P = J sigma F^-T
        if scene.frozen:
            force_moment = force_moment @ np.linalg.inv(F).transpose(0, 2, 1)
    return ParticleStepBreakdown(
        step, (step - 1) * scene.time_step, scene.time_step, scene.spacing, links, seen,
        particle_state(scene, a).mirror(links), a.mass[k], links.signs * place[k],
        particle_step_breakdown.mirror_tensors(edges[k], links.signs),
        (a.mass[k] / a.density)[:, None, None] * force_moment, (ij - a.origin) * scene.spacing, sums[:, 4].copy(),
        signs * sums[:, :2], signs * sums[:, 2:4] - body, body, motion[:, 2:].copy(), motion[:, :2].copy())


def _images(node: int, row: int, ghosts: int, last: int) -> list[PeriodicOrMirrorNode]:
    """Returns ``node`` and its mirror images across planes at most ``ghosts`` rows away, each with its signs; ``row``
    is the number of nodes in a row, ``last`` the row of the upper plane."""
    def along(index: int) -> list[int]:
        found = [index, 2 * ghosts - index] if index <= 2 * ghosts and index != ghosts else [index]
        return [*found, 2 * last - index] if index >= last - ghosts and index != last else found

    i, j = node % row, node // row
    return [PeriodicOrMirrorNode(jj * row + ii, (1.0 if ii == i else -1.0, 1.0 if jj == j else -1.0), (0.0, 0.0))
            for jj in along(j) for ii in along(i)]
