"""All measurements of the bench, one after another, as one object."""

import os
import platform
import sys
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from solvers.bench import solver_benchmarks
from solvers.bench.cpp_reference import measure_ratios
from solvers.bench.gpu_speedup import measure_gpu
from solvers.bench.start_up import start_times
from solvers.kernels import runtime
from solvers.problems import PROBLEMS

SCHEMA = "mpm-lab/bench/1"
CPP_PROBLEMS = ("bar", "ring")  # problems whose step there is in C++; that of the ring takes longest to compile


def run_benchmarks(quick: bool, command: Sequence[str], on_progress: Callable[[float], None]) -> dict:
    """Returns the object of ``mpm-lab bench --json``, of fewer measurements if ``quick``. ``command`` is a command line
    that exits at once, to time the start; ``on_progress`` receives the part done, from 0 to 1."""
    begun, effort = time.perf_counter(), solver_benchmarks.QUICK if quick else solver_benchmarks.FULL
    tasks: list[tuple[str, Callable[[], Any]]] = [
        ("start", partial(start_times, command, tuple(PROBLEMS))), ("gpu", partial(measure_gpu, quick)),
        *(("rates", partial(solver_benchmarks.measure_rates, name, method, effort))
          for name, problem in PROBLEMS.items() for method in problem.scene.choices("method")),
        *(("estimators", partial(solver_benchmarks.estimator_prices, name, effort)) for name in PROBLEMS),
        *(("effects", partial(solver_benchmarks.effect_prices, name, effort)) for name in PROBLEMS),
        *(("off", partial(solver_benchmarks.measure_inactive_overhead, name, effort)) for name in PROBLEMS),
        *(("limit", partial(measure_ratios, name, quick)) for name in (CPP_PROBLEMS[:1] if quick else CPP_PROBLEMS))]
    found: dict[str, list] = {name: [] for name, _ in tasks}
    for done, (name, task) in enumerate(tasks):
        on_progress(done / len(tasks))
        found[name].append(task())
    on_progress(1.0)
    flat = {name: [row for rows in found[name] for row in rows] for name in ("rates", "estimators", "effects")}
    return {"schema": SCHEMA, "quick": quick, "machine": machine_info(), "precision": "double", "threads": 1,
            "arch": runtime.running_arch(), "unit": "million particle-steps per second of processor time",
            **flat, "off": found["off"], "limit": found["limit"], "start": found["start"][0],
            "gpu": found["gpu"][0], "seconds": time.perf_counter() - begun}


def machine_info() -> dict[str, Any]:
    """Returns system, processor, cores, last minute's mean load (None if unknown), versions of Python and Taichi."""
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else None
    return {"system": platform.system(), "processor": platform.machine(), "cores": os.cpu_count(), "load": load,
            "python": ".".join(map(str, sys.version_info[:3])), "taichi": ".".join(map(str, runtime.ti.__version__))}
