"""The ring's body: every number and array that the method itself needs.

Nodes lie at (-2h, -2h) + (i, j) h and are stored row by row, entry j * row + i; the planes x = 0 and y = 0 run through
the nodes with index 2, so that two rows of ghosts lie beyond each.
"""

from dataclasses import dataclass

import numpy as np

from solvers.arrays import Members, zeros
from solvers.kinds import Integer, IntegerQuads, Integers, Octets, Pairs, Quads, Real, Reals
from solvers.remedies import remedy_rates
from solvers.ring import exact
from solvers.ring.layout import GHOSTS, particle_layout
from solvers.ring.scene import RingScene
from solvers.switches import Switches


@dataclass
class RingBody(Members):
    """P particles, K material radii, N nodes, T slabs of particles with grids of their own. What only an effect that
    is off would use has length one."""

    particles: Integer
    nodes: Integer
    row: Integer  # nodes in a row
    active: Integer  # rows in which a sound run can have mass; the others are neither cleared nor visited
    slabs: Integer
    radius_count: Integer
    spacing: Real
    cells_per_length: Real
    dt: Real
    shear_modulus: Real
    density: Real
    half_width: Real  # of a particle's domain, in cells
    amplitude: Real
    angular_frequency: Real
    material_position: Pairs  # X_p (P, 2)
    motion: Quads  # x, y, v_x, v_y (P, 4)
    deformation_gradient: Quads  # F_xx, F_xy, F_yx, F_yy (P, 4)
    mass: Reals  # (P,)
    direction: Pairs  # e_R at the material position (P, 2)
    radius: Integers  # index of the material radius (P,)
    edges: Quads  # r1, r2 of the domain at the start (P, 4), for CPDI
    weights: Octets  # GIMP: outer weights and slopes, each in x and y; CPDI: x, then y of corners in cells (P, 8)
    first_node: Integers  # GIMP: first node of the 3 x 3 stencil (P,)
    corner_nodes: IntegerQuads  # CPDI: first node of each corner's cell (P, 4)
    acceleration: Pairs  # a at the particle in the last step (P, 2), with the effect
    radii: Quads  # R, w, w', w'' of the exact solution at the material radii (K, 4)
    radial_force: Reals  # body force per mass in this step (K,)
    farthest_move: Real  # how far a particle of a sound run may be from where it began, m
    node_sums: Octets  # momentum, force, mass of each slab and three zeros: a whole vector register (T*N, 8)
    node_mass: Reals  # mass of all slabs in the last step (N,), for the truth and the estimators
    node_motion: Quads  # v after the step and a (N, 4)
    neighbours: Integers  # two next particles on the lattice, -1 for none (2P,), with the effect
    circles: Quads  # sums over the particles of a material radius (K,), with the effect
    node_bound: Quads  # of the step's margin: gradient, its scaled size, Gershgorin's sum (N,), with the effect
    remedy_interval: Integer  # steps between two turns of the remedies
    remedy_rate: Real  # what a turn of the null-space filter takes out, and how far one of the coupling draws F
    particle_scratch: Quads  # of the remedies: a velocity and a displacement (P,)
    node_scratch: Quads  # of the remedies, as the particles' (N,)
    node_remedy: Quads  # of the remedies: unseen velocity and sum of displacements (N,)
    totals: Reals  # grid crossings and work of the body force so far, a slab at a time (2 T,)


FARTHEST_MOVE = 20.0  # amplitudes


def farthest(scene: RingScene) -> float:
    """Distance from the centre beyond which a particle has left the ring: half as far again as it should go."""
    return exact.OUTER + 1.5 * scene.amplitude + scene.spacing


def body(scene: RingScene, on: Switches, slabs: int) -> dict:
    """The members of a :class:`RingBody` at the start: the scene's layout, F = I and the exact velocity."""
    layout, row, cpdi = particle_layout(scene), scene.cells + 1, on.method == "cpdi"
    mended = on.filtered or on.coupled
    P, N, X = len(layout.volume), row * row, layout.position
    return {
        "particles": P, "farthest_move": FARTHEST_MOVE * scene.amplitude, "nodes": N, "row": row,
        "active": min(row, int(farthest(scene) / scene.spacing) + GHOSTS + 3),
        "slabs": slabs, "radius_count": len(layout.radii), "spacing": scene.spacing,
        "cells_per_length": 1 / scene.spacing, "dt": scene.time_step, "shear_modulus": 0.5 * scene.modulus,
        "density": scene.density, "half_width": 0.5 / scene.ppc, "amplitude": scene.amplitude,
        "angular_frequency": scene.angular_frequency,
        "material_position": X, "motion": np.concatenate([X, exact.velocity(scene, X, 0.0)], axis=1),
        "deformation_gradient": np.tile([1.0, 0.0, 0.0, 1.0], (P, 1)), "mass": scene.density * layout.volume,
        "direction": X / np.linalg.norm(X, axis=1)[:, None], "radius": layout.radius,
        "edges": layout.edges if cpdi else zeros(1, 4), "weights": zeros(P, 8),
        "first_node": zeros(P, when=not cpdi, kind=np.int32),
        "corner_nodes": zeros(P, 4, when=cpdi, kind=np.int32), "acceleration": zeros(P, 2, when=on.acceleration),
        "radii": np.stack([layout.radii, *exact.shape(layout.radii)], axis=1), "radial_force": zeros(len(layout.radii)),
        "node_sums": zeros(slabs * N, 8), "node_mass": zeros(N), "node_motion": zeros(N, 4), "totals": zeros(2 * slabs),
        "neighbours": layout.neighbours.ravel().astype(np.int32) if on.soundness else zeros(1, kind=np.int32),
        "circles": zeros(len(layout.radii), 4, when=on.soundness), "node_bound": zeros(N, 4, when=on.margin),
        **remedy_rates(scene), "particle_scratch": zeros(P, 4, when=mended), "node_scratch": zeros(N, 4, when=mended),
        "node_remedy": zeros(N, 4, when=mended)}
