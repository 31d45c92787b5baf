"""What the bar's kernels know a bar by: the type of every number and array (see ``solvers.bar.state``)."""

from __future__ import annotations

import taichi as ti

from solvers.kinds import integers, pairs, quads, real, reals, table

MEMBERS = dict(
    particles=ti.i32, cells=ti.i32, sample_interval=ti.i32, spacing=real, cells_per_length=real, dt=real,
    modulus=real, density=real, volume=real, half_width=real, farthest=real, amplitude=real,
    angular_frequency=real, force_scale=real,
    material_position=reals, position=reals, velocity=reals, deformation_gradient=reals, sine=reals,
    cosine=reals, first_node=integers, weights=quads, acceleration=reals, last_crossing=integers,
    node_sine=reals, node_sums=quads, node_moments=quads, node_volume=reals, node_motion=pairs,
    estimate=quads, estimate_intervals=integers, totals=reals, samples=table, verdict=integers)
