"""The longest stable step of a plane body along the motion ahead, from its weights and its tangent stiffness, in numpy
(see ``solvers.scene.step_bound``).

Where weights stay those at rest gradients in space are F^-T times those at rest.
"""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from solvers.motion.laws.material_law import determinant, reference_stiffness_metric, stiffness_metric, stress_increment
from solvers.problems.planar.particle_layout import CORNERS, MOST_HALF_WIDTH, box_stretch, particle_layout
from solvers.scene import linear_stability
from solvers.scene.linear_stability import Fields, LinearisedConfigurations, longest_step_per_instant
from solvers.scene.scene import Scene
from solvers.scene.step_bound import StepBound, combine_instant_bounds, gershgorin_step_bound, motion_fractions, stencil

#: Largest numbers of particles in a quarter of the body: for every moment, and for a few.
MOST_PARTICLES, MOST_AT_FEW_MOMENTS = 500, 6000
IDENTITY = np.eye(2)
STRETCH_INSTANTS = 9  # of the motion, for the largest stretch
#: What becomes of v_x and v_y by quarters of a turn: a sign.
QUARTER_SIGNS = np.array([[1.0, -1.0, -1.0, 1.0], [1.0, 1.0, -1.0, -1.0]])


class Weights(NamedTuple):
    """Weights of P particles at M nodes: nodes' column i and row j, S and its x and y slopes in 1/m, (P, M)."""

    i: np.ndarray
    j: np.ndarray
    S: np.ndarray
    x: np.ndarray
    y: np.ndarray


class SymmetryNodeImages(NamedTuple):
    """Nodes that stand for others by symmetry: their numbers, the signs that v_x and v_y have at the others, and where
    x and y are exchanged (``turned``); arrays of equal shape."""

    number: np.ndarray
    sign_x: np.ndarray
    sign_y: np.ndarray
    turned: np.ndarray


def quarter_turn_images(i: np.ndarray, j: np.ndarray, cells: int) -> SymmetryNodeImages:
    """Returns the images of nodes (i, j), arrays of cells from the grid's middle, which quarter turns bring to the
    quarter i > 0, j >= 0. If ``cells``, the grid's along a side, is odd, i and j count from half a cell before it."""
    a, b = 2 * i - cells % 2, 2 * j - cells % 2
    turns = np.select([(a > 0) & (b >= 0), (a <= 0) & (b > 0), (a < 0) & (b <= 0)], [0, 1, 2], 3)
    crossed = turns % 2 == 1
    number = np.abs(np.where(crossed, b, a)) + 4 * cells * np.abs(np.where(crossed, a, b))
    return SymmetryNodeImages(number, QUARTER_SIGNS[0][turns], QUARTER_SIGNS[1][turns], crossed)


class MotionSamples:
    """Samples of the exact motion on a scene's cells, at ``parts`` (n,) of the way, 0 to 1, from one extreme to the
    other: the weights ``weights``, F (n, P, 2, 2), and the longest stable steps ``limits`` (n,) in s.

    Between symmetry planes all of the body is looked at. Where there is no plane, lattice, grid and motion look the
    same after a quarter of a turn, and a quarter of the particles is enough, if a node has one number with the three
    where it then comes to lie, and velocities are turned with it.
    """

    def __init__(self, scene: Any, parts: np.ndarray):
        self.scene, layout = scene, particle_layout(scene)
        self._low, self._high = scene.PLANES
        kept = np.full(len(layout.volume), True) if self._low else (layout.position > 0).all(axis=1)  # none on an axis
        self._volume, self._X = layout.volume[kept], layout.position[kept]
        F = [self._gradient_at(part) for part in parts]
        middle = 0.0 if self._low else 0.5 * (scene.cells % 2) * scene.spacing  # from there or the planes nodes count
        places = [self._X if scene.frozen else scene.EXACT.position(scene, self._X,
                                                                    self._time_at(part)) for part in parts]
        self.weights = [particle_weights(scene, x + middle, one, layout.edges[kept]) for x,
                        one in zip(places, F, strict=True)]
        self.F = np.stack(F)
        self.limits = longest_step_per_instant(self._configurations())

    def stretch(self) -> float:
        """Returns the largest stretch of any line of material in the motion, over its length at rest."""
        return max(float(np.linalg.norm(self._gradient_at(part), 2, axis=(1, 2)).max())
                   for part in np.linspace(0, 1, STRETCH_INSTANTS))

    def gershgorin_bound(self, moment: int) -> float:
        """Returns Gershgorin's bound of the stable step, in s, at the sample with index ``moment``."""
        one, F = self.weights[moment], np.moveaxis(self.F[moment].reshape(-1, 4), -1, 0)[..., None]
        number = self._images(one.i, one.j).number
        mass = np.bincount(number.ravel(), (self.scene.density * self._volume[:, None] * one.S).ravel())
        J, bound = determinant(F), reference_stiffness_metric if self.scene.frozen else stiffness_metric
        xx, xy, yy = bound(F, J, *self.scene.material.coefficients(F, J))
        lengths = np.sqrt(np.maximum(xx * one.x * one.x + 2 * xy * one.x * one.y + yy * one.y * one.y, 0.0))
        return gershgorin_step_bound(number, lengths, self._volume, mass)

    def _time_at(self, part: float) -> float:
        """Returns the time in s at this part, 0 to 1, of the way between the extremes of the motion."""
        start, end = self.scene.EXTREMES
        return self.scene.period * (start + (end - start) * part)

    def _gradient_at(self, part: float) -> np.ndarray:
        """Returns F (P, 2, 2) of the particles at this part, 0 to 1, of the way between the extremes of the motion."""
        return self.scene.EXACT.deformation_gradient(self.scene, self._X, self._time_at(part))

    def _images(self, i: np.ndarray, j: np.ndarray) -> SymmetryNodeImages:
        """Returns the images by symmetry of the nodes in columns i and rows j, (P, M) each."""
        n, high = self.scene.cells, self._high
        if not self._low:
            return quarter_turn_images(i, j, n)
        inside = [np.where(high & (k > n), 2 * n - k, np.abs(k)) for k in (i, j)]
        sign_x, sign_y = (np.where((k < 0) | high & (k > n), -1.0, 1.0) for k in (i, j))
        return SymmetryNodeImages(inside[0] + 2 * n * inside[1], sign_x, sign_y, np.zeros(i.shape, bool))

    def _configurations(self) -> LinearisedConfigurations:
        """Returns the samples as linear systems, whose unknowns are v_x and v_y of all nodes with particles nearby."""
        scene, V, F = self.scene, self._volume, self.F
        wide = max(one.S.shape[1] for one in self.weights)
        i, j, S, x, y = (np.stack([_pad(part, wide) for part in parts]) for parts in zip(*self.weights, strict=True))
        images, n = self._images(i, j), scene.cells
        numbers, node = np.unique(images.number, return_inverse=True)
        node, N = node.reshape(i.shape), len(numbers)
        links = linear_stability.ParticleNodeUnknowns([node + N * images.turned, node + N * ~images.turned],
                                                      [images.sign_x, images.sign_y])
        held = np.concatenate([self._low & ((k == 0) | self._high & (k == n))  # which hold still in x, and in y
                               for k in (numbers % (2 * n), numbers // (2 * n))])
        if scene.frozen:
            back = np.linalg.inv(F)
            x, y = (x * back[..., 0, k, None] + y * back[..., 1, k, None] for k in (0, 1))
        b, F = F @ F.swapaxes(-1, -2), np.moveaxis(F.reshape(*F.shape[:2], 4), -1, 0)
        tangent = (b[..., 0, 0], b[..., 0, 1], b[..., 1, 1]), *scene.material.coefficients(F, determinant(F))

        def stress(L: Fields) -> Fields:
            return [V * part for part in stress_increment(L, *tangent)]

        return LinearisedConfigurations(2 * N, links, S, links, [x, y], scene.density * V, stress, np.flatnonzero(held))


def critical_time_step(scene: Any) -> StepBound:
    """Returns the bound of a scene's stable time step.

    All moments are evaluated on so few cells that it is quick: on a finer grid particles meet nodes in the same ways,
    and the bound shrinks with the cells. But which node at a rim is emptiest, and how empty it is, depends on the cells
    themselves. So the hardest moment, and another where weights move, are evaluated again on the scene's own cells, and
    if they give a lower bound there, it scales all moments.
    """
    parts = motion_fractions(scene)
    few = MotionSamples(coarsen(scene, MOST_PARTICLES), parts)
    hardest = int(np.argmin(few.limits))
    whole, share = coarsen(scene, MOST_AT_FEW_MOMENTS), 1.0
    by_circles = few.gershgorin_bound(hardest)
    if whole.cells > few.scene.cells:
        again = MotionSamples(whole, parts[sorted({hardest, hardest if scene.frozen else len(parts) // 2})])
        larger, least = few.scene.spacing / whole.spacing, int(np.argmin(again.limits))
        share = larger * float(again.limits[least] / few.limits[hardest])
        if share < 1:
            by_circles = larger * again.gershgorin_bound(least)
    finer, first = few.scene.spacing / scene.spacing, few.weights[0]
    crossed = any(np.any(one.i[:, 0] != first.i[:, 0]) or np.any(one.j[:, 0] != first.j[:, 0]) for one in few.weights)
    seconds = (scene.EXTREMES[1] - scene.EXTREMES[0]) * scene.period
    return combine_instant_bounds(few.scene, min(1.0, share) * few.limits, seconds * finer, few.stretch(), by_circles,
                                  crossed).scaled_by_cell_size(1 / finer)


def coarsen(scene: Any, most: int) -> Any:
    """Returns the scene with so few cells that a quarter of its body has at most ``most`` particles, if possible."""
    while scene.particles * 0.5 * np.pi / scene.ANGLE > most and scene.cells > scene.FEWEST_CELLS:
        scene = replace(scene, cells=max(scene.cells // 2, scene.FEWEST_CELLS))
    return scene


def _pad(part: np.ndarray, wide: int) -> np.ndarray:
    """Returns nodes or weights, ``part`` (P, M), padded to (P, wide): the last node is repeated, with zero weights."""
    more = wide - part.shape[1]
    last = part[:, -1:] if part.dtype.kind == "i" else np.zeros((len(part), 1))
    return np.hstack([part, np.repeat(last, more, axis=1)]) if more else part


def particle_weights(scene: Scene, x: np.ndarray, F: np.ndarray, edges: np.ndarray) -> Weights:
    """Returns the weights of particles at ``x`` (P, 2) in m, with F (P, 2, 2) and ``edges`` (P, 4) at rest in m."""
    if scene.frozen:
        F = np.tile(IDENTITY, (len(x), 1, 1))
    return cpdi_weights(scene, x, F.reshape(-1, 4), edges) if scene.method == "cpdi" \
        else gimp_weights(scene, x, box_stretch(scene.method, F))


def gimp_weights(scene: Scene, x: np.ndarray, stretch: np.ndarray) -> Weights:
    """Returns hat or GIMP weights at M = 9 nodes of particles at ``x`` (P, 2) in m, whose boxes are ``stretch`` (P, 2)
    times as wide as at rest, except with uGIMP."""
    axes = []
    for axis in range(2):
        half_width = np.full(len(x), 0.5 / scene.ppc)
        if scene.method not in ("mpm", "ugimp"):
            half_width = np.clip(half_width * stretch[:, axis], 1e-6, MOST_HALF_WIDTH)
        first, S, dS = stencil(scene.method, x[:, axis] / scene.spacing, half_width)
        axes.append((first[:, None] + np.arange(3), S, dS / scene.spacing))
    (i, S, dS), (j, R, dR) = axes
    pairs = [a[:, :, None] * b[:, None, :] for a, b in ((S, R), (dS, R), (S, dR))]
    P, square = len(x), np.zeros((1, 3, 3), int)
    return Weights(*(part.reshape(P, 9) for part in (i[:, :, None] + square, j[:, None, :] + square, *pairs)))


def cpdi_weights(scene: Scene, x: np.ndarray, F: np.ndarray, edges: np.ndarray) -> Weights:
    """Returns CPDI's weights of particles at ``x`` (P, 2) in m, with F (P, 4) and ``edges`` (P, 4) of the domains at
    rest in m: corners of a domain may share nodes, where gradients add up."""
    first = np.stack([F[:, 0] * edges[:, 0] + F[:, 1] * edges[:, 1], F[:, 2] * edges[:, 0] + F[:, 3] * edges[:, 1]], 1)
    second = np.stack([F[:, 0] * edges[:, 2] + F[:, 1] * edges[:, 3], F[:, 2] * edges[:, 2] + F[:, 3] * edges[:, 3]], 1)
    area = (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])[:, None]
    places = np.stack([x + a * first + b * second for a, b in CORNERS], axis=1) / scene.spacing  # (P, 4, 2)
    cells = np.floor(places).astype(int)
    start = cells.min(axis=1)
    P, W = len(x), int((cells.max(axis=1) - start).max()) + 2
    S, gradients = np.zeros((P, W, W)), np.zeros((P, W, W, 2))
    for c, (a, b) in enumerate(CORNERS):  # grad of the corner's value: a normal to the opposite diagonal
        normal = np.stack([a * second[:, 1] - b * first[:, 1], b * first[:, 0] - a * second[:, 0]], axis=1) / area
        place, offset = places[:, c] - cells[:, c], cells[:, c] - start
        for i in range(2):
            for j in range(2):
                N = (place[:, 0] if i else 1 - place[:, 0]) * (place[:, 1] if j else 1 - place[:, 1])
                at = (np.arange(P), offset[:, 0] + i, offset[:, 1] + j)
                S[at] += 0.25 * N
                gradients[at] += N[:, None] * normal
    lines, square = start[:, :, None] + np.arange(W), np.zeros((1, W, W), int)
    return Weights(*(part.reshape(P, -1) for part in (lines[:, 0, :, None] + square, lines[:, 1, None, :] + square, S,
                                                      gradients[..., 0], gradients[..., 1])))
