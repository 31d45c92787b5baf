"""The body of a plane problem: every number and array that the method itself needs, and what is watched of it.

Nodes lie at (i - origin, j - origin) h and are stored row by row, entry j * row + i.
"""

from dataclasses import dataclass

import numpy as np

from solvers.kernels.kinds import Blocks, Integer, Integers, Octets, Pairs, Quads, Real, Reals
from solvers.problems.planar.layout import Layout
from solvers.problems.planar.method.kept import room
from solvers.problems.planar.method.phases import TOTALS
from solvers.problems.planar.scene import PlanarScene
from solvers.scene.estimator_hooks import EstimatorHooks
from solvers.scene.scene import Scene
from solvers.scene.switches import Switches
from solvers.solver.arrays import Members, Watch, remedy_rates, watch, zeros


@dataclass
class PlanarBody(Members):
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
    origin: Real  # number of the node at x = 0, or between which two it lies
    dt: Real
    shear_modulus: Real
    density: Real
    half_width: Real  # of a particle's domain, in cells
    amplitude: Real
    angular_frequency: Real
    material_position: Pairs  # X_p (P, 2)
    position_velocity: Quads  # x, y, v_x, v_y (P, 4)
    deformation_gradient: Quads  # F_xx, F_xy, F_yx, F_yy (P, 4)
    mass: Reals  # (P,)
    direction: Pairs  # e_R at the material position (P, 2)
    radius: Integers  # index of the material radius (P,)
    edges: Quads  # r1, r2 of the domain at the start (P, 4), for CPDI
    weights: Blocks  # as ``solvers.problems.planar.method.kept`` lays them out, of GIMP outer weights and slopes, each
    # in x and y; of CPDI x, then y of the corners in cells, gradients of corners 1 and 2, first node of each one's cell
    first_node: Integers  # GIMP: first node of the 3 x 3 stencil (P,)
    acceleration: Pairs  # a at the particle in the last step (P, 2), with the effect
    radii: Quads  # R and the exact solution's function of it with two derivatives, at the material radii (K, 4)
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
    totals: Reals  # so far, a slab at a time (3 T,): see ``solvers.problems.planar.method.phases.TOTALS``


@dataclass
class WatchedBody(Watch, PlanarBody):
    """A body and those who watch it, with the estimates that are vectors and tensors."""

    estimate_acceleration: Pairs  # estimated error of a (E*P, 2)
    estimate_stress: Quads  # estimated error of sigma, as xx, xy, yy and nothing (E*P, 4)


def common(scene: PlanarScene, on: Switches, layout: Layout, slabs: int, origin: float, active: int,
           shear_modulus: float, velocity: np.ndarray, shape: tuple[np.ndarray, ...]) -> dict:
    """The members of a :class:`PlanarBody` at the start: the layout with F = I and a ``velocity`` (P, 2).

    ``shape`` are the exact solution's function of R and two derivatives (K,) at the layout's radii.
    """
    row, cpdi, mended = scene.row, on.method == "cpdi", on.filtered or on.coupled
    P, K, N, X = len(layout.volume), len(layout.radii), row * row, layout.position
    return {
        "particles": P, "nodes": N, "row": row, "active": active, "slabs": slabs, "radius_count": K,
        "spacing": scene.spacing, "cells_per_length": 1 / scene.spacing, "origin": origin, "dt": scene.time_step,
        "shear_modulus": shear_modulus, "density": scene.density, "half_width": 0.5 / scene.ppc,
        "amplitude": scene.amplitude, "angular_frequency": scene.angular_frequency, "material_position": X,
        "position_velocity": np.concatenate([X, velocity], axis=1),
        "deformation_gradient": np.tile([1.0, 0.0, 0.0, 1.0], (P, 1)),
        "mass": scene.density * layout.volume, "direction": X / np.linalg.norm(X, axis=1)[:, None],
        "radius": layout.radius, "edges": layout.edges if cpdi else zeros(1, 4), "weights": room(on.method, P),
        "first_node": zeros(P, when=not cpdi, kind=np.int32),
        "acceleration": zeros(P, 2, when=on.acceleration),
        "radii": np.stack([layout.radii, *shape], axis=1), "node_sums": zeros(slabs * N, 8), "node_mass": zeros(N),
        "node_motion": zeros(N, 4), "totals": zeros(TOTALS * slabs),
        "neighbours": layout.neighbours.ravel().astype(np.int32) if on.soundness else zeros(1, kind=np.int32),
        "circles": zeros(K, 4, when=on.soundness), "node_bound": zeros(N, 4, when=on.margin), **remedy_rates(scene),
        "particle_scratch": zeros(P, 4, when=mended), "node_scratch": zeros(N, 4, when=mended),
        "node_remedy": zeros(N, 4, when=mended)}


def watched(scene: Scene, on: Switches, particles: int, farthest: float, hooks: dict[str, EstimatorHooks]) -> dict:
    """The members of a :class:`WatchedBody` that are not of the body, at the start."""
    estimated, entries = bool(on.estimators), len(on.estimators) * particles
    return {**watch(scene, on, particles, farthest, hooks),
            "estimate_acceleration": zeros(entries, 2, when=estimated),
            "estimate_stress": zeros(entries, 4, when=estimated)}
