"""Initial layout of the particles of a plane body: positions, volumes and domains."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from solvers.scene.scene import Scene

CORNERS = ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))  # of a CPDI domain, in its edges from its middle
STRETCHING_METHODS = ("cpgimp", "cpgimp-v")  # methods whose boxes follow the deformation
MOST_HALF_WIDTH = 0.5  # of a box, in cells: it meets at most two cells, so that three nodes suffice


@dataclass(frozen=True)
class ParticleLayout:
    """P particles at rest, in m. ``edges`` are the two edge vectors r1 and r2 of a domain, as (r1x, r1y, r2x, r2y).

    Particles that a symmetry of the motion maps onto each other form an orbit: the exact motion is evaluated once per
    orbit, at a representative material point, and rotated to each particle. In a body with rotational symmetry an orbit
    is a circle; on the square each particle is its own orbit.
    """

    position: np.ndarray  # (P, 2)
    volume: np.ndarray  # (P,), per unit thickness
    edges: np.ndarray  # (P, 4)
    orbits: np.ndarray  # the points that stand for them (K, 2); circles have theirs on the x axis
    orbit: np.ndarray  # number of each particle's orbit (P,) int32
    direction: np.ndarray  # what the x axis at the orbit's point becomes at the particle (P, 2): e_R on a circle
    neighbours: np.ndarray  # the next particles on the lattice in its two directions, -1 for none (P, 2)


def particle_layout(scene: Any) -> ParticleLayout:
    """Returns the scene's particles at rest: "polar" fills a ring exactly, "cartesian" has staircases at its rims."""
    if scene.layout == "box":
        return square_layout(scene.cells * scene.ppc, scene.SIDE)
    if scene.layout == "polar":
        return polar_layout(scene.INNER, scene.OUTER, scene.ANGLE, *scene.lattice_counts(scene.cells, scene.ppc))
    least = -scene.OUTER if scene.ANGLE >= 2 * np.pi else 0.0
    return cartesian_layout(scene.INNER, scene.OUTER, scene.spacing / scene.ppc, least)


def circle_counts(scene: Any) -> tuple[np.ndarray, np.ndarray]:
    """Returns the radii (K,), in m, of the scene's circles of particles, and the number of particles on each (K,)."""
    if scene.layout == "polar":
        around, across = scene.lattice_counts(scene.cells, scene.ppc)
        return polar_radii(scene.INNER, scene.OUTER, across), np.full(across, around)
    layout = particle_layout(scene)
    return layout.orbits[:, 0], np.bincount(layout.orbit)


def polar_radii(inner: float, outer: float, across: int) -> np.ndarray:
    """Returns the radii (across,) of circles of particles, evenly spaced between the rims ``inner`` and ``outer``."""
    return inner + (np.arange(across) + 0.5) * ((outer - inner) / across)


def half_edges(scene: Scene, F: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Returns half the edge vectors (P, 2, 2) in m, one per row, of the particles' domains in the scene's method at
    deformation gradients ``F`` (P, 2, 2); ``edges`` (P, 4) in m are those at rest. Zeros for methods without domains.
    """
    if scene.method == "cpdi":
        rest = 0.5 * edges.reshape(-1, 2, 2)
        return rest if scene.frozen else np.einsum("pij,pej->pei", F, rest)
    at_rest = 0.5 / scene.ppc
    width = np.full((len(F), 2), 0.0 if scene.method == "mpm" else at_rest)
    if scene.method in STRETCHING_METHODS and not scene.frozen:
        width = np.clip(at_rest * box_stretch(scene.method, F), 1e-6, MOST_HALF_WIDTH)
    return scene.spacing * width[:, :, None] * np.eye(2)


def box_stretch(method: str, F: np.ndarray) -> np.ndarray:
    """Returns the widths of particles' boxes in x and y (P, 2) over those at rest, for F (P, 2, 2): |F_xx| and |F_yy|;
    for the method "cpgimp-v" V_xx and V_yy of the spatial stretch V = sqrt(F F^T), which no rotation changes."""
    if method != "cpgimp-v":
        return np.abs(F[:, [0, 1], [0, 1]])
    with np.errstate(all="ignore"):  # for unstable runs
        b = F @ F.transpose(0, 2, 1)
        J = np.sqrt(np.linalg.det(b))  # sqrt(b) = (b + J I)/sqrt(tr b + 2 J), by Cayley and Hamilton
        return (b[:, [0, 1], [0, 1]] + J[:, None]) / np.sqrt(b[:, 0, 0] + b[:, 1, 1] + 2 * J)[:, None]


def polar_layout(inner: float, outer: float, angle: float, around: int, across: int) -> ParticleLayout:
    """Returns ``around`` x ``across`` particles that exactly fill the region between the radii ``inner`` and ``outer``
    (m), from the x axis to ``angle`` (rad). In a full turn the last row neighbours the first."""
    d_angle, d_radius = angle / around, (outer - inner) / across
    radii = polar_radii(inner, outer, across)
    theta, radius = (g.ravel() for g in np.meshgrid((np.arange(around) + 0.5) * d_angle, np.arange(across),
                                                    indexing="ij"))
    R, c, s = radii[radius], np.cos(theta), np.sin(theta)
    edges = np.stack([R * d_angle * s, -R * d_angle * c, d_radius * c, d_radius * s], axis=1)
    e = np.stack([c, s], axis=1)
    return ParticleLayout(R[:, None] * e, R * d_radius * d_angle, edges, points_on_x_axis(radii),
                          radius.astype(np.int32), e,
                          lattice_neighbours(np.arange(around * across).reshape(around, across), angle >= 2 * np.pi))


def square_layout(across: int, side: float) -> ParticleLayout:
    """Returns ``across`` x ``across`` particles that tile a square, ``side`` m wide, with a corner at the origin."""
    width = side / across
    line = (np.arange(across) + 0.5) * width
    y, x = (g.ravel() for g in np.meshgrid(line, line, indexing="ij"))
    P, position = across * across, np.stack([x, y], axis=1)
    number = np.arange(P, dtype=np.int32)
    return ParticleLayout(position, np.full(P, width**2), np.tile([width, 0.0, 0.0, width], (P, 1)), position, number,
                          np.tile([1.0, 0.0], (P, 1)), lattice_neighbours(number.reshape(across, across)))


def cartesian_layout(inner: float, outer: float, side: float, least: float) -> ParticleLayout:
    """Returns particles ``side`` m apart whose centres lie between the radii ``inner`` and ``outer`` (m), with both
    coordinates above ``least`` (m): a staircase at the rims."""
    line = (np.arange(int(np.floor(least / side)), int(np.ceil(outer / side))) + 0.5) * side
    y, x = (g.ravel() for g in np.meshgrid(line, line, indexing="ij"))
    R = np.hypot(x, y)
    kept = (R >= inner) & (R <= outer)
    x, y = x[kept], y[kept]
    radii, radius = np.unique(R[kept].round(12), return_inverse=True)
    edges, position = np.tile([side, 0.0, 0.0, side], (len(x), 1)), np.stack([x, y], axis=1)
    number = np.where(kept, np.cumsum(kept) - 1, -1).reshape(len(line), len(line))
    return ParticleLayout(position, np.full(len(x), side**2), edges, points_on_x_axis(radii), radius.astype(np.int32),
                          position / R[kept][:, None], lattice_neighbours(number))


def points_on_x_axis(radii: np.ndarray) -> np.ndarray:
    """Returns points (K, 2) on the x axis at these ``radii`` (K,): e_R and e_Theta are the axes there."""
    return np.stack([radii, np.zeros_like(radii)], axis=1)


def lattice_neighbours(number: np.ndarray, closed: bool = False) -> np.ndarray:
    """Returns each particle's next one (P, 2) along columns and along rows of a lattice, -1 for none. ``number`` has
    the lattice's particles, -1 for a gap. If ``closed``, the first row follows the last."""
    wide = np.pad(number, ((0, 1), (0, 1)), constant_values=-1)
    if closed:
        wide[-1, :-1] = number[0]
    return np.stack([wide[1:, :-1], wide[:-1, 1:]], axis=2)[number >= 0]
