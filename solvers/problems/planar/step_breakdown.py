"""A step in the plane taken apart: read from the arrays that the step has left."""

import numpy as np

from solvers.problems.planar.layout import CORNERS, half_edges
from solvers.problems.planar.method.body import WatchedBody
from solvers.problems.planar.method.cpdi import NODES
from solvers.problems.planar.method.kept import by_particle
from solvers.problems.planar.scene import PlanarScene
from solvers.problems.planar.snapshot import body_force, cauchy_stress_of
from solvers.scene.scene import Scene
from solvers.solver.step_breakdown import Carried, Image, StepBreakdown, flipped, link


@np.errstate(all="ignore")  # a run gone bad holds anything
def carried(scene: PlanarScene, a: WatchedBody) -> Carried:
    """What the particles carry now, copied."""
    (xx, xy, yy), q = cauchy_stress_of(scene, a), a.position_velocity
    return Carried(q[:, :2].copy(), q[:, 2:].copy(), a.deformation_gradient.reshape(-1, 2, 2).copy(),
                   np.stack([xx, xy, xy, yy], axis=1).reshape(-1, 2, 2))


def breakdown(scene: PlanarScene, a: WatchedBody, particle: int, step: int, before: Carried,
              ghosts: int) -> StepBreakdown:
    """Of the step number ``step``, just taken, around a particle; ``before`` is what was carried then. The first
    ``ghosts`` rows of nodes either way lie beyond a symmetry plane."""
    edges, row = half_edges(scene, before.deformation_gradient, a.edges), a.row
    last = row - 1 - ghosts if scene.PLANES[1] else 2 * row  # the planes at the upper ends
    links = link(particle, nodes_of(scene, a), lambda some: weights_of(scene, a, edges, some),
                 lambda node: _images(node, row, ghosts, last))
    seen, k, ij = before.seen(links), links.members, np.stack([links.nodes % row, links.nodes // row], axis=1)
    signs = np.where((ij < ghosts) | (ij > last), -1.0, 1.0)  # a node beyond a plane has what its mirror image has
    home = np.abs(ij - ghosts) + ghosts
    home = np.where(home > last, 2 * last - home, home)
    sums, motion = a.node_sums[home[:, 1] * row + home[:, 0]], a.node_motion[links.nodes]
    body = links.weight.T @ (links.signs * body_force(a, k))
    F, place = seen.deformation_gradient, a.material_position if scene.frozen else before.position
    with np.errstate(all="ignore"):
        force_moment = np.linalg.det(F)[:, None, None] * seen.stress  # Kirchhoff's, or P = J sigma F^-T
        if scene.frozen:
            force_moment = force_moment @ np.linalg.inv(F).transpose(0, 2, 1)
    return StepBreakdown(
        step, (step - 1) * scene.time_step, scene.time_step, scene.spacing, links, seen,
        carried(scene, a).seen(links), a.mass[k], links.signs * place[k], flipped(edges[k], links.signs),
        (a.mass[k] / a.density)[:, None, None] * force_moment, (ij - a.origin) * scene.spacing, sums[:, 4].copy(),
        signs * sums[:, :2], signs * sums[:, 2:4] - body, body, motion[:, 2:].copy(), motion[:, :2].copy())


def _images(node: int, row: int, ghosts: int, last: int) -> list[Image]:
    """The mirror images of nodes in the rows next to a plane, on either side; the plane's own have none."""
    def along(index: int) -> list[int]:
        found = [index, 2 * ghosts - index] if index <= 2 * ghosts and index != ghosts else [index]
        return [*found, 2 * last - index] if index >= last - ghosts and index != last else found

    i, j = node % row, node // row
    return [Image(jj * row + ii, (1.0 if ii == i else -1.0, 1.0 if jj == j else -1.0), (0.0, 0.0))
            for jj in along(j) for ii in along(i)]


def nodes_of(scene: Scene, a: WatchedBody) -> np.ndarray:
    """The nodes (P, M) of each particle, some perhaps several times."""
    row = a.row
    if scene.method == "cpdi":
        first = by_particle(a.weights, scene.method, a.particles)[:, NODES:NODES + 4].astype(int)
        return (first[:, :, None] + np.array([0, 1, row, row + 1])).reshape(a.particles, 16)
    return a.first_node[:, None] + (row * np.arange(3)[:, None] + np.arange(3)).ravel()


def weights_of(scene: Scene, a: WatchedBody, edges: np.ndarray, some: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """S (c, M) and its gradient (c, M, 2) of ``some`` particles (c,), whose half edges are in ``edges`` (P, 2, 2)."""
    kept = by_particle(a.weights, scene.method, a.particles)[some]
    return _corner_weights(kept, edges[some]) if scene.method == "cpdi" else _stencil_weights(kept)


def _stencil_weights(kept: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    w = kept.reshape(-1, 4, 2)  # left, right and their slopes, each in x and y
    S = np.stack([w[:, 0], 1 - w[:, 0] - w[:, 1], w[:, 1]], axis=1)
    dS = np.stack([w[:, 2], -w[:, 2] - w[:, 3], w[:, 3]], axis=1)
    (x, y), (by_x, by_y) = np.moveaxis(S, 2, 0), np.moveaxis(dS, 2, 0)

    def product(along_y: np.ndarray, along_x: np.ndarray) -> np.ndarray:
        return np.einsum("pj,pi->pji", along_y, along_x).reshape(-1, 9)

    return product(y, x), np.stack([product(y, by_x), product(by_y, x)], axis=2)


def _corner_weights(kept: np.ndarray, edges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """S = 1/4 sum N(corner); the gradient takes N at opposite corners with opposite signs."""
    x, y = kept[:, :4], kept[:, 4:8]
    N = np.stack([(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y], axis=2)  # (c, corner, node)
    # A linear f has f(corner) = f(x) + c_1 f'r_1 + c_2 f'r_2, and so grad f = inverse of the edges, times sum c f.
    along = np.einsum("ce,pcn->pecn", np.array(CORNERS), N)
    slope = np.einsum("pde,pecn->pcnd", np.linalg.inv(2 * edges), along)
    return 0.25 * N.reshape(-1, 16), slope.reshape(-1, 16, 2)
