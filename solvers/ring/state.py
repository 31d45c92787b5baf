"""The ring's memory: plain numpy arrays, handed to the kernels without a copy (see ``solvers.bar.state``).

Nodes lie at (-2h, -2h) + (i, j) h and are stored row by row, entry j * row + i; the planes x = 0 and y = 0 run through
the nodes with index 2, so that two rows of ghosts lie beyond each.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import NamedTuple

import numpy as np
import taichi as ti

from solvers.estimators.interface import allocate_memory, intervals, memory_types
from solvers.memory import align_fields
from solvers.ring import exact
from solvers.ring.estimators import ESTIMATORS
from solvers.ring.layout import GHOSTS, particle_layout
from solvers.ring.members import MEMBERS
from solvers.ring.scene import RingScene
from solvers.samples import ROWS, column_count


class Switches(NamedTuple):
    """What is compiled in. Two scenes with equal switches share one compiled kernel."""

    method: str
    body_force: bool
    two_tone: bool
    velocity: str
    truth: bool
    crossings: bool
    energy: bool
    acceleration: bool
    estimators: tuple[str, ...]


def switches(scene: RingScene) -> Switches:
    return Switches(scene.method, scene.body_force != "none",
                    scene.body_force == "two-tone", scene.velocity, scene.has("truth"),
                    scene.has("crossings"), scene.has("energy"), scene.has("acceleration"), scene.active_estimators)


@dataclass
class Arrays:
    """Every array of a run. P particles, K material radii, N nodes, T slabs of particles with grids of their own."""

    material_position: np.ndarray  # X_p (P, 2)
    motion: np.ndarray  # x, y, v_x, v_y (P, 4)
    deformation_gradient: np.ndarray  # F_xx, F_xy, F_yx, F_yy (P, 4)
    mass: np.ndarray  # (P,)
    direction: np.ndarray  # e_R at the material position (P, 2)
    radius: np.ndarray  # index of the material radius (P,)
    edges: np.ndarray  # r1, r2 of the domain at the start (P, 4), for CPDI
    weights: np.ndarray  # GIMP: outer weights and slopes, each in x and y; CPDI: x, then y of corners in cells (P, 8)
    first_node: np.ndarray  # GIMP: first node of the 3 x 3 stencil (P,)
    corner_nodes: np.ndarray  # CPDI: first node of each corner's cell (P, 4)
    acceleration: np.ndarray  # a at the particle in the last step (P, 2), with the effect
    last_crossing: np.ndarray  # step of the particle's last cell change, -1 for never (P,)
    radii: np.ndarray  # (K,)
    shape: np.ndarray  # w at the radii (K,)
    shape_slope: np.ndarray  # w' (K,)
    shape_curvature: np.ndarray  # w'' (K,)
    radial_force: np.ndarray  # body force per mass in this step (K,)
    node_sums: np.ndarray  # momentum, force, mass of each slab and three zeros: a whole vector register (T*N, 8)
    node_mass: np.ndarray  # mass of all slabs in the last step (N,)
    node_motion: np.ndarray  # v after the step and a (N, 4)
    estimate: np.ndarray  # estimated error of x and v, vectors (E*P, 4)
    estimate_acceleration: np.ndarray  # estimated error of a (E*P, 2)
    estimate_stress: np.ndarray  # estimated error of sigma, as xx, xy, yy and nothing (E*P, 4)
    estimate_intervals: np.ndarray  # steps between two steps of each estimator (E,)
    totals: np.ndarray  # grid crossings and work of the body force so far, a slab at a time (2 T,)
    samples: np.ndarray  # one row a sample (ROWS, columns)
    verdict: np.ndarray  # 0 or the kind of failure, its step, its particle (3,)
    memory: dict  # what the estimators keep: numbers and arrays by name (see ``solvers.estimators.interface``)

    def __post_init__(self) -> None:
        align_fields(self)

    def members(self) -> dict:
        """Every array, and the estimators' numbers, by name."""
        own = {f.name: getattr(self, f.name) for f in fields(self) if f.name != "memory"}
        return {**own, **self.memory}


def allocate(scene: RingScene, slabs: int) -> Arrays:
    """The initial state: the scene's layout, F = I and the exact velocity."""
    layout, on = particle_layout(scene), switches(scene)
    P, N = len(layout.volume), (scene.cells + 1) ** 2
    cpdi, E = on.method == "cpdi", len(on.estimators)
    X = layout.position
    w, slope, curvature = exact.shape(layout.radii)

    def zeros(length: int, width: int | None = None, when: bool = True, kind: type = np.float64) -> np.ndarray:
        length = length if when else 1
        return np.zeros(length if width is None else (length, width), kind)

    arrays = Arrays(
        material_position=X, motion=np.concatenate([X, exact.velocity(scene, X, 0.0)], axis=1),
        deformation_gradient=np.tile([1.0, 0.0, 0.0, 1.0], (P, 1)), mass=scene.density * layout.volume,
        direction=X / np.linalg.norm(X, axis=1)[:, None], radius=layout.radius,
        edges=layout.edges if cpdi else np.zeros((1, 4)), weights=zeros(P, 8),
        first_node=zeros(P, when=not cpdi, kind=np.int32), corner_nodes=zeros(P, 4, cpdi, np.int32),
        acceleration=zeros(P, 2, on.acceleration), last_crossing=zeros(P, when=on.crossings, kind=np.int32),
        radii=layout.radii, shape=w, shape_slope=slope, shape_curvature=curvature,
        radial_force=zeros(len(layout.radii)),
        node_sums=zeros(slabs * N, 8), node_mass=zeros(N), node_motion=zeros(N, 4),
        estimate=zeros(E * P, 4, E > 0), estimate_acceleration=zeros(E * P, 2, E > 0),
        estimate_stress=zeros(E * P, 4, E > 0), estimate_intervals=intervals(ESTIMATORS, scene),
        totals=zeros(2 * slabs), samples=zeros(ROWS, column_count(on.estimators)), verdict=np.zeros(3, np.int32),
        memory=allocate_memory(ESTIMATORS, scene))
    arrays.last_crossing[:] = -1
    return arrays


#: Numbers and arrays as one kernel argument: nothing of a scene is baked into compiled code but its switches.
RingState = ti.types.argpack(**MEMBERS, **memory_types(ESTIMATORS))


def farthest(scene: RingScene) -> float:
    """Distance from the centre beyond which a particle has left the ring: half as far again as it should go."""
    return exact.OUTER + 1.5 * scene.amplitude + scene.spacing


def numbers(scene: RingScene, arrays: Arrays, slabs: int) -> dict[str, float]:
    """Every number that kernels need of a scene, by the name of its member."""
    row = scene.cells + 1
    return {
        "particles": len(arrays.mass), "nodes": row * row, "row": row,
        # Rows in which a sound run can have mass; the others are neither cleared nor visited.
        "active": min(row, int(farthest(scene) / scene.spacing) + GHOSTS + 3), "slabs": slabs,
        "radius_count": len(arrays.radii), "sample_interval": scene.sample_interval,
        "spacing": scene.spacing, "cells_per_length": 1 / scene.spacing, "dt": scene.time_step,
        "shear_modulus": 0.5 * scene.modulus, "density": scene.density, "half_width": 0.5 / scene.particles_per_cell,
        "farthest": farthest(scene), "amplitude": scene.amplitude, "angular_frequency": scene.angular_frequency}


def pack(scene: RingScene, arrays: Arrays, slabs: int):
    """The kernel's view of a scene and its arrays. The arrays must outlive it."""
    return RingState(**numbers(scene, arrays, slabs), **arrays.members())
