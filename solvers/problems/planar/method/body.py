"""State of a plane problem's kernels: numbers and arrays of the method itself, and of its diagnostics.

Nodes lie at (i - origin, j - origin) h and are stored row by row, entry j * row + i.
"""

from dataclasses import dataclass

import numpy as np

from solvers.kernels.dtypes import Blocks, Integer, Integers, Octets, Pairs, Quads, Real, Reals
from solvers.problems.planar.body_force import tabulate_body_force
from solvers.problems.planar.method.phases import TOTALS
from solvers.problems.planar.method.stored_weights import allocate_weights
from solvers.problems.planar.particle_layout import particle_layout
from solvers.problems.planar.scene import PlanarScene, motion_table
from solvers.scene.estimator_hooks import EstimatorHooks
from solvers.scene.kernel_options import KernelOptions
from solvers.scene.scene import Scene
from solvers.solver.separable_field_tables import (
    motion_mode_entries,
    pack_tables,
    pad_to_mode_pairs,
    vector_mode_entries,
)
from solvers.solver.state_arrays import DiagnosticsState, Members, initial_diagnostics, remedy_rates, zeros


@dataclass
class PlanarBody(Members):
    """State of a plane run in SI units: P particles in K orbits (``solvers.problems.planar.particle_layout``), N
    nodes, T slabs of particles with grids of their own. Arrays that only an inactive diagnostic would use have length
    one. Tables of the exact motion (``solvers.solver.separable_field_tables``) share one array: a kernel takes 64
    arguments at most.
    """

    particles: Integer
    nodes: Integer
    row: Integer  # nodes in a row
    active: Integer  # rows that can have mass in a sound run; others are neither cleared nor visited
    slabs: Integer
    orbits: Integer
    spacing: Real
    cells_per_length: Real
    origin: Real  # number of the node at x = 0, or between which two it lies
    dt: Real
    lame_modulus: Real  # lambda
    shear_modulus: Real  # mu
    density: Real
    half_width: Real  # of a particle's domain, in cells
    angular_frequency: Real
    farthest_move: Real  # how far a particle of a sound run may be from where it began, m
    material_position: Pairs  # X_p (P, 2)
    position_velocity: Quads  # x, y, v_x, v_y (P, 4)
    deformation_gradient: Quads  # F_xx, F_xy, F_yx, F_yy (P, 4)
    mass: Reals  # (P,)
    orbit: Integers  # number of each particle's (P,)
    direction: Pairs  # what the x axis at the orbit's point becomes at the particle (P, 2)
    orbit_point: Pairs  # material points that stand for the orbits (K, 2)
    orbit_force: Pairs  # body force per mass in this step, at these points (K, 2)
    exact: Quads  # of the exact solution at a sample, there, three rows each: (u, v), (a, 0, 0) of the step before, and
    # the Cauchy stress (xx, xy, yy, 0); then the polynomials by which nodes of circular bodies know u and a (3 K + M,)
    volumetric: Reals  # lambda ln J of each particle in this step (P,)
    table_sizes: Integers
    tables: Quads
    edges: Quads  # r1, r2 of the domain at the start (P, 4), for CPDI
    weights: Blocks  # laid out by ``solvers.problems.planar.method.stored_weights``: of GIMP outer weights and slopes,
    # each in x and y; of CPDI x, then y of the corners in cells, gradients of corners 1 and 2, first node of each one's
    # cell
    first_node: Integers  # GIMP: first node of the 3 x 3 stencil (P,)
    acceleration: Pairs  # a at the particle in the last step (P, 2), with the effect
    node_sums: Octets  # momentum, force, mass of each slab and three zeros: a whole vector register (T*N, 8)
    node_mass: Reals  # mass of all slabs in the last step (N,), for the truth and the estimators
    node_motion: Quads  # v after the step and a (N, 4)
    neighbours: Integers  # two next particles on the lattice, -1 for none (2P,), with the effect
    remedy_interval: Integer  # steps between two turns of the remedies
    remedy_rate: Real  # what a turn of the null-space filter takes out, and how far one of the coupling draws F
    particle_scratch: Quads  # of the remedies: a velocity and a displacement (P,)
    node_scratch: Quads  # of the remedies, as the particles'; and of the step's margin: gradient, its scaled size,
    # Gershgorin's sum (N,)
    node_remedy: Quads  # of the remedies: unseen velocity and sum of displacements (N,)
    totals: Reals  # so far, a slab at a time (3 T,): see ``solvers.problems.planar.method.phases.TOTALS``


@dataclass
class InstrumentedBody(DiagnosticsState, PlanarBody):
    """State of a plane run with its diagnostics, and with the estimates of E estimators for P particles."""

    estimate_acceleration: Pairs  # estimated error of a (E*P, 2)
    estimate_stress: Quads  # estimated error of sigma, as xx, xy, yy and nothing (E*P, 4)


def initial_body(scene: PlanarScene, on: KernelOptions, slabs: int) -> dict:
    """Returns the members of a :class:`PlanarBody` by name at the start: the particles' layout, F = I, and the exact
    velocity at the time to which the scene assigns initial ones; ``slabs`` is the number of grids."""
    layout, row, mended = particle_layout(scene), scene.row, on.filtered or on.coupled
    P, K, N, X = len(layout.volume), len(layout.orbits), row * row, layout.position
    lame_modulus, shear_modulus = scene.lame_moduli
    known = on.truth or bool(on.estimators) or on.soundness
    grid = scene.node_acceleration_field() if known and on.acceleration else None
    sizes, tables = pack_tables(*map(pad_to_mode_pairs, tabulate_body_force(scene, layout.orbits)[1:]),
                                motion_mode_entries(motion_table(scene) if known else None), vector_mode_entries(grid))
    v = scene.EXACT.velocity(scene, X, -scene.EARLIER * scene.time_step)
    return {"particles": P, "nodes": N, "row": row, "active": scene.active_rows, "slabs": slabs, "orbits": K,
            "spacing": scene.spacing, "cells_per_length": 1 / scene.spacing, "origin": scene.origin,
            "dt": scene.time_step, "lame_modulus": lame_modulus, "shear_modulus": shear_modulus,
            "density": scene.density, "half_width": 0.5 / scene.ppc, "angular_frequency": scene.angular_frequency,
            "farthest_move": scene.FARTHEST_MOVE * scene.amplitude, "material_position": X,
            "position_velocity": np.concatenate([X, v], axis=1),
            "deformation_gradient": np.tile([1.0, 0.0, 0.0, 1.0], (P, 1)), "mass": scene.density * layout.volume,
            "orbit": layout.orbit, "direction": layout.direction, "orbit_point": layout.orbits,
            "orbit_force": zeros(K, 2),
            "exact": zeros(3 * K + (len(grid.modes) if grid and scene.CIRCULAR else 0), 4, when=known),
            "volumetric": zeros(P), "table_sizes": sizes, "tables": tables,
            "edges": layout.edges if on.method == "cpdi" else zeros(1, 4), "weights": allocate_weights(on.method, P),
            "first_node": zeros(P, when=on.method != "cpdi", kind=np.int32),
            "acceleration": zeros(P, 2, when=on.acceleration), "node_sums": zeros(slabs * N, 8), "node_mass": zeros(N),
            "node_motion": zeros(N, 4), "totals": zeros(TOTALS * slabs),
            "neighbours": layout.neighbours.ravel().astype(np.int32) if on.soundness else zeros(1, kind=np.int32),
            **remedy_rates(scene), "particle_scratch": zeros(P, 4, when=mended),
            "node_scratch": zeros(N, 4, when=mended or on.margin), "node_remedy": zeros(N, 4, when=mended)}


def initial_instruments(scene: Scene, on: KernelOptions, particles: int, farthest: float,
                        hooks: dict[str, EstimatorHooks]) -> dict:
    """Returns the members of an :class:`InstrumentedBody` beyond a :class:`PlanarBody`'s, by name, at the start, for
    this number of ``particles``; ``farthest`` is their largest coordinate in a sound run, in m."""
    estimated, entries = bool(on.estimators), len(on.estimators) * particles
    return {**initial_diagnostics(scene, on, particles, farthest, hooks),
            "estimate_acceleration": zeros(entries, 2, when=estimated),
            "estimate_stress": zeros(entries, 4, when=estimated)}
