"""Breakdown of one step around one particle: all quantities between it and its nodes, in physical units."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class PeriodicOrMirrorNode:
    """A node summed with another: its number, and how its positions are seen there, ``signs`` x + ``shift`` in m.

    The bar's period has images one length away, the ring's symmetry planes have mirror images; a node is its own, too.
    """

    node: int
    signs: tuple[float, ...]
    shift: tuple[float, ...]


@dataclass(frozen=True)
class ParticleNodeLinks:
    """Links of the n nodes of one particle with k ``members``: numbers of particles that reach them, itself first, each
    as seen from it (``signs`` and ``shift`` (k, D) as in :class:`PeriodicOrMirrorNode`). ``nodes`` (n,) index the
    solver's arrays, ``weight`` (k, n) is S and ``slope`` (k, n, D) its gradient in 1/m; 0 without a link."""

    members: np.ndarray
    signs: np.ndarray
    shift: np.ndarray
    nodes: np.ndarray
    weight: np.ndarray
    slope: np.ndarray


def find_links(particle: int, nodes: np.ndarray, weights: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]],
               images: Callable[[int], Iterable[PeriodicOrMirrorNode]]) -> ParticleNodeLinks:
    """Returns the links of the particle with this number. ``nodes`` (P, M) are those of each particle, possibly
    repeated; ``weights`` returns S (c, M) and its gradient (c, M, D) in 1/m for particles (c,), and ``images`` for a
    node all that are summed with it."""
    S, dS = weights(np.array([particle]))
    own = np.unique(nodes[particle][(S[0] != 0) | (dS[0] != 0).any(axis=1)])
    n, D = len(own), dS.shape[2]
    found = {(particle, (1.0,) * D, (0.0,) * D): (np.zeros(n), np.zeros((n, D)))}
    summed = [(column, image) for column, node in enumerate(own) for image in images(int(node))]
    wanted = np.zeros(nodes.max() + 1, bool)  # a table: looking numbers up in a list takes ten times as long
    wanted[[image.node for _, image in summed if image.node < len(wanted)]] = True
    near = np.flatnonzero(wanted[nodes].any(axis=1))
    S, dS = weights(near)
    for column, image in summed:
        for row, place in zip(*np.nonzero(nodes[near] == image.node), strict=True):
            if S[row, place] != 0 or dS[row, place].any():
                member = (int(near[row]), image.signs, image.shift)
                weight, slope = found.setdefault(member, (np.zeros(n), np.zeros((n, D))))
                weight[column] += S[row, place]
                slope[column] += np.array(image.signs) * dS[row, place]
    members, signs, shift = (np.array(part) for part in zip(*found, strict=True))
    return ParticleNodeLinks(members, signs, shift, own,
                             *(np.array(part) for part in zip(*found.values(), strict=True)))


@dataclass(frozen=True)
class ParticleState:
    """State of k particles: x in m, v in m/s (k, D), F and Cauchy stress in Pa (k, D, D)."""

    position: np.ndarray
    velocity: np.ndarray
    deformation_gradient: np.ndarray
    stress: np.ndarray

    def mirror(self, links: ParticleNodeLinks) -> "ParticleState":
        """Returns the state of the k members of the links, each as seen from the particle that the links are about."""
        p, signs = links.members, links.signs
        return ParticleState(signs * self.position[p] + links.shift, signs * self.velocity[p],
                             mirror_tensors(self.deformation_gradient[p], signs), mirror_tensors(self.stress[p], signs))


def mirror_tensors(tensors: np.ndarray, signs: np.ndarray) -> np.ndarray:
    """Returns tensors (k, D, D) mirrored along the directions whose ``signs`` (k, D) are -1."""
    return signs[:, :, None] * tensors * signs[:, None, :]


@dataclass(frozen=True)
class ParticleStepBreakdown:
    """Step number ``step``, from ``time`` on in s, around the first of k members, with their states ``before`` and
    ``after``; n nodes, D directions.

    ``place`` (k, D) is where weights see the particles: at x, or at X with frozen weights. ``edges`` (k, D, D) has
    their domains' half edge vectors as the method sees them, in m, 0 for hat functions. ``tension`` (k, D, D) is what
    multiplies the slopes, V sigma, or V0 P with frozen weights, in N m. Of the nodes (n, D): place in m, ``momentum``
    in N s, forces in N, ``acceleration`` and ``velocity`` after the step; ``node_mass`` (n,) in kg; of the bar all for
    a cross-section of 1 m2, of the ring for a thickness of 1 m. At a symmetry plane the solver sums one side.
    """

    step: int
    time: float
    time_step: float
    spacing: float
    links: ParticleNodeLinks
    before: ParticleState
    after: ParticleState
    mass: np.ndarray
    place: np.ndarray
    edges: np.ndarray
    tension: np.ndarray
    nodes: np.ndarray
    node_mass: np.ndarray
    momentum: np.ndarray
    internal_force: np.ndarray
    body_force: np.ndarray
    acceleration: np.ndarray
    velocity: np.ndarray

    @property
    def particle(self) -> int:
        """Number of the particle that the breakdown is about."""
        return int(self.links.members[0])

    @property
    def before_velocity(self) -> np.ndarray:
        """Velocity of the nodes (n, D) in m/s before their acceleration: 0 where there is no mass."""
        mass = self.node_mass[:, None]
        return np.divide(self.momentum, mass, out=np.zeros_like(self.momentum), where=mass > 0)

    @property
    def velocity_change_by_remedies(self) -> np.ndarray:
        """Velocity (D,) in m/s that the particle has gained in the step beside what the nodes gave it."""
        gained = self.time_step * self.links.weight[0] @ self.acceleration
        return self.after.velocity[0] - self.before.velocity[0] - gained
