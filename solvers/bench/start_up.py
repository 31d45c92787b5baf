"""Wall time from nothing to a solver that can step: imports, Taichi's start, compilation, with an empty cache of
compiled kernels (cold, as after an installation) or a filled one (warm)."""

import subprocess
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from solvers.workers.worker_process import ProcessDied, ask_fresh

CACHE_VARIABLE = "TI_OFFLINE_CACHE_FILE_PATH"  # the variable for Taichi's cache folder
ROOT = Path(__file__).resolve().parents[2]  # where the packages lie, so that -m finds them
TURNS = 3
PATIENCE = 120.0  # seconds


def start_times(command: Sequence[str], problems: Sequence[str]) -> dict:
    """Returns seconds: of a command line, to import, to start Taichi, and by problem (name) to compile its default
    scene, cold and warm; all None, with the reason in ``failed``, where a process fails."""
    try:
        ready = min(time_command(command) for _ in range(TURNS))
        with tempfile.TemporaryDirectory(prefix="mpm-lab-bench-", ignore_cleanup_errors=True) as cache:
            question, environment = {"problems": list(problems)}, {CACHE_VARIABLE: cache}
            cold, warm = (ask_fresh(f"{__name__}:measure_own_start", question, environment) for _ in range(2))
    except ProcessDied as error:
        return dict.fromkeys(("command", "import", "taichi", "cold", "warm")) | {"failed": str(error)}
    return {"command": ready, "import": warm["import"], "taichi": warm["taichi"], "cold": cold["compile"],
            "warm": warm["compile"], "failed": None}


def time_command(command: Sequence[str]) -> float:
    """Returns the wall time of a command line in s; raises :class:`ProcessDied` if it fails."""
    begun = time.perf_counter()
    try:
        subprocess.run(command, cwd=ROOT, capture_output=True, stdin=subprocess.DEVNULL, timeout=PATIENCE, check=True)
    except (OSError, subprocess.SubprocessError) as error:
        raise ProcessDied(" ".join(str(error).split())) from None
    return time.perf_counter() - begun


def measure_own_start(question: dict, answer: Callable[[dict], None]) -> None:
    begun = time.perf_counter()
    from solvers.kernels import runtime
    from solvers.problems import PROBLEMS
    from solvers.running.run import build
    imported = time.perf_counter()
    runtime.start()
    started = time.perf_counter()
    compiled = {}
    for name in question["problems"]:
        solver = build(PROBLEMS[name].scene())
        built = time.process_time()  # of the processor: work only, whatever else the machine does
        solver.compile()
        compiled[name] = time.process_time() - built
    runtime.ti.reset()  # writes the cache, which a killed process would not do
    answer({"import": imported - begun, "taichi": started - imported, "compile": compiled})
