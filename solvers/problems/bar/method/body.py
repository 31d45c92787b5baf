"""State of the bar's kernels: all numbers and arrays of the method itself."""

from dataclasses import dataclass

import numpy as np

from solvers.kernels.dtypes import Integer, Integers, Pairs, Quads, Real, Reals
from solvers.motion.exact_solution_1d import force_table, motion_table
from solvers.problems.bar import exact_solution
from solvers.problems.bar.method.periodic_nodes import GHOSTS
from solvers.problems.bar.scene import BarScene
from solvers.scene.kernel_options import KernelOptions
from solvers.solver.separable_field_tables import pack_tables, pad_to_mode_pairs, vector_mode_entries
from solvers.solver.state_arrays import Members, remedy_rates, zeros


@dataclass
class BarBody(Members):
    """Numbers and arrays of the method on the bar, in SI: P particles, N nodes; node arrays have ``GHOSTS`` more
    entries. Arrays that only an inactive effect would use have length one."""

    particles: Integer
    cells: Integer
    spacing: Real
    cells_per_length: Real
    dt: Real
    modulus: Real  # E F at the start: stress is this times (deformation - unstretched)
    density: Real  # at the start
    volume: Real  # of a particle at the start
    unstretched: Real  # deformation at which there is no stress: 1, but where the bar starts stretched
    half_width: Real  # of a particle's domain, in cells
    amplitude: Real  # of the motion
    drift_velocity: Real  # at which the whole bar moves, in a patch test, m/s
    angular_frequency: Real  # of the motion, the first harmonic of one by formula
    force_scale: Real  # 3 w^2 A
    material_position: Reals  # X_p (P,)
    position: Reals  # x_p (P,), not wrapped: displacement is x - X
    velocity: Reals  # v_p (P,)
    deformation_gradient: Reals  # F_p since the start (P,)
    sine: Reals  # sin 2 pi X_p (P,)
    cosine: Reals  # cos 2 pi X_p (P,)
    first_node: Integers  # first node of a particle's stencil, in the padded node arrays (P,)
    weights: Quads  # outer weights and outer gradients S_0, S_2, dS_0, dS_2 (P, 4)
    acceleration: Reals  # a at the particle in the last step (P,), with the effect
    node_sine: Reals  # sin 2 pi x_i (N+4,), for the body force at nodes
    node_sums: Quads  # sum over particles of S, S v, D* sigma, S b^ (N+4, 4)
    node_moments: Quads  # sum of D*, D* r, S r, S sigma (N+4, 4)
    node_volume: Reals  # V_i = sum of S F V0 (N+4,)
    node_motion: Pairs  # v_i after the step and a_i (N+4, 2)
    node_stiffness: Reals  # Gershgorin's bound of each node, 1/s^2 (N+4,), for the step margin
    corners: Quads  # of each particle's piece, with pieces or a budget: ``stored_corner_stencil`` (P, 4)
    remedy_interval: Integer  # steps between two turns of the remedies
    remedy_rate: Real  # what a turn of the null-space filter takes out, and how far one of the coupling draws F
    particle_scratch: Reals  # of the remedies (P,)
    node_scratch: Reals  # of the remedies (N+4,)
    node_displacement: Reals  # x - X on the nodes, for the coupling of F (N+4,)
    totals: Reals  # grid crossings so far, work of the body force so far (2,)
    table_sizes: Integers  # of a typed motion: see ``solvers.solver.separable_field_tables``
    tables: Quads  # its body force at the particles; u and F - 1 there, and as a last place their means


def initial_body(scene: BarScene, on: KernelOptions) -> dict:
    """Returns the members of a :class:`BarBody` at the start, by name: particles at (p + 1/2) h/ppc, F = 1, and the
    exact velocity. F of a patch test is relative to its stretch (``solvers.problems.bar.patch_test_inputs``). ``on``:
    compile-time options."""
    P, nodes = scene.particles, scene.cells + GHOSTS
    X = (np.arange(P) + 0.5) * (scene.spacing / scene.ppc)
    by_formula, swings, stretch = bool(scene.motion_formula), not scene.is_patch, scene.initial_stretch
    w = 2 * np.pi / scene.motion_period if by_formula else scene.angular_frequency
    known = on.truth or on.soundness
    sizes, tables = pack_tables(pad_to_mode_pairs(force_table(scene, X) if by_formula else None),
                                pad_to_mode_pairs(None),
                                vector_mode_entries(motion_table(scene) if by_formula and known else None))
    material = on.body_force in ("material", "two-tone")
    at_nodes = np.sin(exact_solution.WAVENUMBER * scene.spacing * (np.arange(nodes) - 1))
    sine, cosine = np.sin(exact_solution.WAVENUMBER * X), np.cos(exact_solution.WAVENUMBER * X)
    v = exact_solution.velocity(scene, X, 0.0) - scene.velocity_lead * exact_solution.acceleration(scene, X, 0.0)
    return {"particles": P, "cells": scene.cells, "spacing": scene.spacing, "cells_per_length": float(scene.cells),
            "dt": scene.time_step, "modulus": scene.modulus * stretch, "density": scene.density / stretch,
            "volume": scene.spacing / scene.ppc, "unstretched": 1 / stretch, "half_width": 0.5 / scene.ppc,
            "amplitude": scene.motion_amplitude, "drift_velocity": 0.0 if swings else scene.initial_velocity,
            "angular_frequency": w, "force_scale": 3 * w * w * scene.amplitude, "material_position": X,
            "position": X, "velocity": v, "deformation_gradient": np.ones(P),
            "sine": sine if (on.truth and swings) or material or on.budget else zeros(1),
            "cosine": cosine if on.truth and swings else zeros(1),
            "first_node": zeros(P, kind=np.int32), "weights": zeros(P, 4),
            "acceleration": zeros(P, when=on.acceleration),
            "node_sine": at_nodes if on.body_force == "node" else zeros(1), "node_sums": zeros(nodes, 4),
            "node_moments": zeros(nodes, 4, when=on.linearity_preserving),
            "node_volume": zeros(nodes, when=on.linearity_preserving), "node_motion": zeros(nodes, 2),
            "totals": zeros(2), "table_sizes": sizes, "tables": tables,
            "node_stiffness": zeros(nodes, when=on.margin), "corners": zeros(P, 4, when=on.pieces or on.budget),
            **remedy_rates(scene), "particle_scratch": zeros(P, when=on.filtered or on.coupled),
            "node_scratch": zeros(nodes, when=on.filtered or on.coupled),
            "node_displacement": zeros(nodes, when=on.coupled)}
