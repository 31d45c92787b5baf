"""What the ring's kernels know a ring by: the type of every number and array (see ``solvers.ring.state``)."""

from __future__ import annotations

import taichi as ti

from solvers.kinds import integer_quads, integers, octets, pairs, quads, real, reals, table

MEMBERS = dict(
    particles=ti.i32, nodes=ti.i32, row=ti.i32, active=ti.i32, slabs=ti.i32, radius_count=ti.i32,
    sample_interval=ti.i32, spacing=real, cells_per_length=real, dt=real, shear_modulus=real, density=real,
    half_width=real, farthest=real, amplitude=real, angular_frequency=real,
    material_position=pairs, motion=quads, deformation_gradient=quads, mass=reals, direction=pairs, radius=integers,
    edges=quads, weights=octets, first_node=integers, corner_nodes=integer_quads, acceleration=pairs,
    last_crossing=integers, radii=reals, shape=reals, shape_slope=reals, shape_curvature=reals, radial_force=reals,
    node_sums=octets, node_mass=reals, node_motion=quads, estimate=quads, estimate_acceleration=pairs,
    estimate_stress=quads, estimate_intervals=integers, totals=reals, samples=table, verdict=integers)
