"""A step in the plane with nothing optional in it: see :mod:`solvers.problems.bar.baseline`."""

import functools
from typing import Any

import taichi as ti

from solvers.problems.planar.method import phases
from solvers.problems.planar.method.body import WatchedBody
from solvers.problems.planar.solver import PlanarSolver
from solvers.scene.scene import Scene
from solvers.scene.switches import bare
from solvers.solver.arrays import part_of, part_types
from solvers.solver.base import SOUND
from solvers.solver.loop import CHECK_EVERY, check

MEMBERS = ("particles", "nodes", "row", "active", "slabs", "orbits", "spacing", "origin", "cells_per_length", "dt",
           "lame_modulus", "shear_modulus", "density", "farthest", "farthest_move", "angular_frequency",
           "material_position", "position_velocity", "deformation_gradient", "mass", "direction", "orbit",
           "orbit_force", "volumetric", "table_sizes", "tables", "edges", "weights", "node_sums", "node_motion",
           "totals", "verdict")


@functools.cache
def baseline(Own: type[PlanarSolver]) -> type[PlanarSolver]:
    """The problem's own solver with the baseline step; its rows of samples hold nothing."""
    TRAITS = Own.PARTS.traits
    State = part_types(WatchedBody, MEMBERS)

    @ti.kernel
    def advance(start: ti.i32, steps: ti.i32, body: State, on: ti.template()):
        ti.loop_config(serialize=True)
        for k in range(steps):
            if body.verdict[0] == SOUND:
                step = start + k
                phases.update_grid(body, step * body.dt, TRAITS, on)
                phases.nodes_to_particles(body, 0, step + 1, TRAITS, on)
                if (step + 1) % CHECK_EVERY == 0:
                    check(body, step + 1, phases.flatness, TRAITS.has_escaped)

    class Baseline(Own):
        def __init__(self, scene: Scene):
            super().__init__(scene)
            self._baseline: Any = part_of(self._pack, State)

        def _run(self, steps: int) -> None:
            advance(self.step, steps, self._baseline, bare(self._switches))

    return Baseline
