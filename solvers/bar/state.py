"""The bar's memory: plain numpy arrays, handed to the kernels without a copy.

Numpy arrays, because a scene can then be rebuilt any number of times without growth (Taichi's own arrays keep
their memory for ever), and because the view and the tests read them as they are. An array that only a
switched-off effect would use has length one.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import NamedTuple

import numpy as np
import taichi as ti

from solvers.bar import exact
from solvers.bar.estimators import ESTIMATORS
from solvers.bar.members import MEMBERS
from solvers.bar.nodes import GHOSTS
from solvers.bar.scene import BarScene
from solvers.estimators.interface import allocate_memory, intervals, memory_types
from solvers.memory import align_fields
from solvers.samples import ROWS, column_count


class Switches(NamedTuple):
    """What is compiled in. Two scenes with equal switches share one compiled kernel."""

    method: str
    linearity_preserving: bool
    body_force: str
    velocity: str
    truth: bool
    crossings: bool
    energy: bool
    acceleration: bool
    estimators: tuple[str, ...]


def switches(scene: BarScene) -> Switches:
    return Switches(scene.method, scene.linearity_preserving, scene.body_force, scene.velocity,
                    scene.has("truth"), scene.has("crossings"), scene.has("energy"),
                    scene.has("acceleration"), scene.active_estimators)


@dataclass
class Arrays:
    """Every array of a run. P particles, N nodes; node arrays have ``GHOSTS`` more entries."""

    material_position: np.ndarray  # X_p (P,)
    position: np.ndarray  # x_p (P,), not wrapped: displacement is x - X
    velocity: np.ndarray  # v_p (P,)
    deformation_gradient: np.ndarray  # F_p (P,)
    sine: np.ndarray  # sin 2 pi X_p (P,)
    cosine: np.ndarray  # cos 2 pi X_p (P,)
    first_node: np.ndarray  # first node of a particle's stencil, in the padded node arrays (P,)
    weights: np.ndarray  # outer weights and outer gradients S_0, S_2, dS_0, dS_2 (P, 4)
    acceleration: np.ndarray  # a at the particle in the last step (P,), with the effect
    last_crossing: np.ndarray  # step of the particle's last cell change, -1 for never (P,)
    node_sine: np.ndarray  # sin 2 pi x_i (N+4,), for the body force at nodes
    node_sums: np.ndarray  # sum over particles of S, S v, D* sigma, S b^ (N+4, 4)
    node_moments: np.ndarray  # sum of D*, D* r, S r, S sigma (N+4, 4)
    node_volume: np.ndarray  # V_i = sum of S F V0 (N+4,)
    node_motion: np.ndarray  # v_i after the step and a_i (N+4, 2)
    estimate: np.ndarray  # estimated error of x, v, sigma, a (E*P, 4)
    estimate_intervals: np.ndarray  # steps between two steps of each estimator (E,)
    totals: np.ndarray  # grid crossings so far, work of the body force so far (2,)
    samples: np.ndarray  # one row a sample (ROWS, columns)
    verdict: np.ndarray  # 0 or the kind of failure, its step, its particle (3,)
    memory: dict  # what the estimators keep: numbers and arrays by name (see ``solvers.estimators.interface``)

    def __post_init__(self) -> None:
        align_fields(self)

    def members(self) -> dict:
        """Every array, and the estimators' numbers, by name."""
        own = {f.name: getattr(self, f.name) for f in fields(self) if f.name != "memory"}
        return {**own, **self.memory}


def allocate(scene: BarScene) -> Arrays:
    """The initial state: particles at (p + 1/2) h/ppc, F = 1, velocity A w sin 2 pi X."""
    P, nodes, on = scene.particles, scene.cells + GHOSTS, switches(scene)
    X = (np.arange(P) + 0.5) * (scene.spacing / scene.particles_per_cell)
    moments = on.linearity_preserving or "transport" in on.estimators
    material = on.body_force in ("material", "two-tone")

    def particles(width: int | None = None, *, when: bool = True, kind: type = np.float64) -> np.ndarray:
        return _zeros(P, width, when, kind)

    def at_nodes(width: int | None = None, *, when: bool = True) -> np.ndarray:
        return _zeros(nodes, width, when)

    arrays = Arrays(
        material_position=X, position=X.copy(), velocity=exact.velocity(scene, X, 0.0),
        deformation_gradient=np.ones(P),
        sine=np.sin(exact.WAVENUMBER * X) if on.truth or material else np.zeros(1),
        cosine=np.cos(exact.WAVENUMBER * X) if on.truth or on.body_force == "two-tone" else np.zeros(1),
        first_node=particles(kind=np.int32), weights=particles(4),
        acceleration=particles(when=on.acceleration),
        last_crossing=particles(when=on.crossings, kind=np.int32),
        node_sine=at_nodes(when=on.body_force == "node"), node_sums=at_nodes(4),
        node_moments=at_nodes(4, when=moments), node_volume=at_nodes(when=moments),
        node_motion=at_nodes(2),
        estimate=_zeros(len(on.estimators) * P, 4, bool(on.estimators)),
        estimate_intervals=intervals(ESTIMATORS, scene),
        totals=np.zeros(2), samples=np.zeros((ROWS, column_count(on.estimators))),
        verdict=np.zeros(3, np.int32),
        memory=allocate_memory(ESTIMATORS, scene))
    arrays.last_crossing[:] = -1
    if on.body_force == "node":
        arrays.node_sine[:] = np.sin(exact.WAVENUMBER * scene.spacing * (np.arange(nodes) - 1))
    return arrays


def _zeros(length: int, width: int | None, when: bool, kind: type = np.float64) -> np.ndarray:
    length = length if when else 1
    return np.zeros(length if width is None else (length, width), kind)


#: Numbers and arrays as one kernel argument: nothing of a scene is baked into compiled code but its switches.
BarState = ti.types.argpack(**MEMBERS, **memory_types(ESTIMATORS))


def farthest(scene: BarScene) -> float:
    """Displacement from which on a run counts as gone bad: half the bar, or twenty times what is exact."""
    return min(0.5, 20 * scene.motion_amplitude)


def numbers(scene: BarScene) -> dict[str, float]:
    """Every number that kernels need of a scene, by the name of its member."""
    w = scene.angular_frequency
    return {
        "particles": scene.particles, "cells": scene.cells, "sample_interval": scene.sample_interval,
        "spacing": scene.spacing, "cells_per_length": float(scene.cells), "dt": scene.time_step,
        "modulus": scene.modulus, "density": scene.density, "volume": scene.spacing / scene.particles_per_cell,
        "half_width": 0.5 / scene.particles_per_cell, "farthest": farthest(scene),
        "amplitude": scene.motion_amplitude, "angular_frequency": w, "force_scale": 3 * w * w * scene.amplitude}


def pack(scene: BarScene, arrays: Arrays):
    """The kernel's view of a scene and its arrays. The arrays must outlive it."""
    return BarState(**numbers(scene), **arrays.members())
