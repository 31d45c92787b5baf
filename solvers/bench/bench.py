"""All measurements of the bench, one after another, as one object."""

from __future__ import annotations

import os
import platform
import sys
import time
from collections.abc import Callable, Sequence

from solvers import runtime
from solvers.bench import apart, measure
from solvers.bench.example import example
from solvers.bench.start import start_times
from solvers.problems import PROBLEMS

SCHEMA = "mpm-lab/bench/1"
COMMAND_TURNS = 3


def bench(quick: bool, command: Sequence[str], on_progress: Callable[[float], None]) -> dict:
    """Measure everything. ``command`` is what a person starts, and ends at once; ``on_progress`` gets 0 to 1."""
    begun = time.perf_counter()
    effort = measure.QUICK if quick else measure.FULL
    parts = {"start": [lambda: _start(command)], "example": [example]}
    rates = [lambda p=problem, m=method: measure.rates(p, m, effort)
             for problem in PROBLEMS for method in PROBLEMS[problem].scene.choices("method")]
    parts |= {"rates": rates}
    for name, what in (("estimators", measure.estimator_prices), ("effects", measure.effect_prices),
                       ("off", measure.off)):
        parts[name] = [lambda p=problem, w=what: w(p, effort) for problem in PROBLEMS]
    total, done, found = sum(len(tasks) for tasks in parts.values()), 0, {}
    for name, tasks in parts.items():
        for task in tasks:
            on_progress(done / total)
            found.setdefault(name, []).append(task())
            done += 1
    on_progress(1.0)
    flat = {name: [row for rows in found[name] for row in rows] for name in ("rates", "estimators", "effects")}
    return {"schema": SCHEMA, "quick": quick, "machine": _machine(), "precision": "double", "threads": 1,
            "arch": runtime.running_arch(), "unit": "million particle-steps per second of processor time",
            **flat, "off": found["off"], "start": found["start"][0], "example": found["example"][0],
            "seconds": time.perf_counter() - begun}


def _start(command: Sequence[str]) -> dict:
    """Start-up times; null with a reason where a process fails."""
    try:
        ready = min(apart.seconds(command) for _ in range(COMMAND_TURNS))
        return {"command": ready, **start_times(), "failed": None}
    except apart.Failed as error:
        return dict.fromkeys(("command", "import", "taichi", "cold", "warm")) | {"failed": str(error)}


def _machine() -> dict:
    """What the numbers belong to."""
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else None
    return {"system": platform.system(), "processor": platform.machine(), "cores": os.cpu_count(), "load": load,
            "python": ".".join(map(str, sys.version_info[:3])), "taichi": ".".join(map(str, runtime.ti.__version__))}
