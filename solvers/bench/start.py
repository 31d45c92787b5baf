"""How long it takes from nothing to a solver that can step: imports, Taichi's start, compiling. Wall time.

Cold means that Taichi's cache of compiled kernels is empty, as after an installation; warm that a process has filled it
before. Run as a module, this is the process that is measured.
"""

from __future__ import annotations

import json
import tempfile
import time

CACHE = "TI_OFFLINE_CACHE_FILE_PATH"  # the variable by which Taichi is told where its cache is
MODULE = "solvers.bench.start"


def start_times() -> dict:
    """Seconds to import, to start Taichi and to compile each problem's default scene, cold and warm."""
    from solvers.bench.apart import ask
    with tempfile.TemporaryDirectory(prefix="mpm-lab-bench-", ignore_cleanup_errors=True) as cache:
        cold, warm = (ask(MODULE, {CACHE: cache}) for _ in range(2))
    return {"import": warm["import"], "taichi": warm["taichi"], "cold": cold["compile"], "warm": warm["compile"]}


def _measure() -> dict:
    clock = _Clock()
    from solvers import runtime
    from solvers.problems import PROBLEMS
    from solvers.run import build
    imported = clock.lap()
    runtime.start()
    started = clock.lap()
    compiled = {}
    for name, problem in PROBLEMS.items():
        solver = build(problem.scene())
        clock.lap()
        solver.compile()
        compiled[name] = clock.lap()
    return {"import": imported, "taichi": started, "compile": compiled}


class _Clock:
    def __init__(self) -> None:
        self._last = time.perf_counter()

    def lap(self) -> float:
        """Seconds since the last lap."""
        before, self._last = self._last, time.perf_counter()
        return self._last - before


if __name__ == "__main__":
    print(json.dumps(_measure()))
