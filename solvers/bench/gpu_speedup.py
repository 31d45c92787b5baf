"""Gain by a GPU, if there is one: rates of its plan, those of a CPU's plans, and the limit by its memory.

Everything is measured in one fresh process, which restarts Taichi for each plan. A step moves at least what its phases
read and write of each particle, so that the memory's bandwidth, measured here by a copy, limits the rate; nodes, of
which there is one for several particles, are neglected."""

import os
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import taichi as ti

from solvers.bench.solver_benchmarks import bare_scene
from solvers.kernels import runtime
from solvers.kernels.dtypes import quads
from solvers.running.run import build
from solvers.scene.scene import MOST_PARTICLES, Scene
from solvers.solver import gpu_detection
from solvers.solver.base import Solver
from solvers.solver.error_series import finite_or_none
from solvers.workers.worker_process import ProcessDied, ask_fresh

#: Cells that make about 1e4, 1e5, 1e6 and 1e7 particles, of which a quick bench takes the first two.
CELLS: Mapping[str, Sequence[int]] = {"ring": (150, 474, 1500, 4743), "vortex": (66, 207, 654, 2067)}
METHODS = ("ugimp", "cpdi")
QUICK_SIZES = 2
SECONDS, TURNS = 0.2, 3  # of a stretch, at least, and stretches, of which the fastest counts
PATIENCE = 1200.0  # seconds, for all of it
COPIED_VECTORS = 20_000_000  # vectors of four numbers, to find the bandwidth

#: Bytes that a step moves of each particle: x and v, and F, each read three times and written once; mass, radius and
#: direction; the weights written once and read twice, with the first node or, for CPDI, gradients and first nodes of
#: four corners; and F and the corners' edges, read to find these.
BASE_BYTES = 32 * 4 + 32 * 3 + 8 + 4 + 16 + 64 * 3
EXTRA_BYTES = {"ugimp": 4 * 3, "cpdi": 64 * 3 + 32 + 32}


def measure_gpu(quick: bool) -> dict:
    """Returns the object of :func:`measure_device` for this machine's GPU, of small sizes only if ``quick``; without
    values, with the reason in ``missing``, where there is no GPU or the process fails."""
    where = gpu_detection.resolve_arch(gpu_detection.GPU)
    nothing = {"arch": None, "name": "", "bandwidth": None, "rows": []}
    if where == gpu_detection.CPU:
        return {**nothing, "missing": "no GPU was found"}
    try:
        return ask_fresh(f"{__name__}:measure_in_worker", {"sizes": QUICK_SIZES if quick else None}, patience=PATIENCE)
    except ProcessDied as error:
        return {**nothing, "missing": f"could not be measured: {error}"}


def measure_in_worker(question: dict, answer: Callable[[dict], None]) -> None:
    answer(measure_device(gpu_detection.resolve_arch(gpu_detection.GPU),
                          {name: cells[:question["sizes"]] for name, cells in CELLS.items()}))


def measure_device(where: str, sizes: Mapping[str, Sequence[int]], copied: int = COPIED_VECTORS) -> dict:
    """Returns name, bandwidth in GB/s and rates (``rows``) of the GPU ``where`` (name of Taichi's backend); ``sizes``
    maps problems to numbers of cells, ``copied`` is the number of vectors to copy for the bandwidth."""
    runtime.start(where)
    limit = measure_bandwidth(copied)
    rows = [measure_scene_rates(bare_scene(problem, n, method=method, arch=where), limit)
            for problem, cells in sizes.items() for method in METHODS for n in cells]
    return {"arch": where, "name": gpu_detection.probe_device(where)["name"], "missing": None,
            "bandwidth": 1e-9 * limit, "rows": rows}


def measure_scene_rates(scene: Scene, limit: float) -> dict:
    """Returns the rates of a GPU's scene, in million particle-steps per second, on that GPU and by the CPU's plans
    (None if unstable or too many particles), and the GPU's rate over its ``limit`` by bandwidth (bytes per second)."""
    rates = {"gpu": measure_particle_step_rate(build(scene))}
    everywhere: dict[str, Any] = {"plan": "parallel", "threads": os.cpu_count() or 1}
    for plan, inputs in {"serial": {}, "parallel": everywhere}.items():
        rates[plan] = measure_particle_step_rate(build(replace(scene, arch=gpu_detection.CPU, **inputs))) \
            if scene.particles <= MOST_PARTICLES else None
    share = None if rates["gpu"] is None else 1e6 * rates["gpu"] * (BASE_BYTES + EXTRA_BYTES[scene.method]) / limit
    return {"problem": scene.problem, "method": scene.method, "cells": scene.cells, "particles": scene.particles,
            "rates": rates, "share": share}


def measure_particle_step_rate(solver: Solver) -> float | None:
    """Returns a solver's rate in million particle-steps per second of wall time; None if its run becomes unstable."""
    solver.compile()
    steps, most = 1, solver.longest_advance
    while (took := _time_call(partial(solver.advance, steps))) < SECONDS and 2 * steps <= most:
        steps *= 2
    took = min(took, *(_time_call(partial(solver.advance, steps)) for _ in range(TURNS)))
    return finite_or_none(1e-6 * solver.scene.particles * steps / took) if solver.sound else None


def measure_bandwidth(vectors: int) -> float:
    """Returns the bytes per second that the GPU reads and writes in a copy of so many ``vectors`` of four doubles."""
    one, other = (ti.ndarray(quads.dtype, vectors) for _ in range(2))
    copy_vectors(one, other)
    took = [_time_call(lambda: (copy_vectors(one, other), ti.sync())) for _ in range(TURNS)]
    return 2 * 32 * vectors / float(np.min(took))


@ti.kernel
def copy_vectors(one: quads, other: quads):
    for k in range(one.shape[0]):
        other[k] = one[k]


def _time_call(work: Callable[[], object]) -> float:
    begun = time.perf_counter()
    work()
    return time.perf_counter() - begun
