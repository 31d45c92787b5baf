"""A yardstick that is not ours: the example mpm99 that ships with Taichi, run without its window.

It is another method (MLS-MPM with quadratic B-splines and plasticity, three materials) in single precision, so its rate
says how fast a well-known Taichi code runs on this machine and not which code is better. It is run as it stands; only
the start of Taichi is replaced, for one thread of the processor instead of a GPU.
"""

import runpy
import time
from collections.abc import Callable
from pathlib import Path

from solvers.kernels import runtime
from solvers.workers.processes import ProcessDied, ask_fresh

NAME = "mpm99"
METHOD = "MLS-MPM, quadratic B-splines, plasticity"
WORK = f"{__name__}:measure"
SECONDS = 0.1  # of a stretch at least: it launches kernels for every step
TURNS = 5


def example() -> dict:
    """The example's rate, or why there is none."""
    row = {"name": NAME, "method": METHOD, "precision": "single", "particles": None, "rate": None, "missing": None}
    if find() is None:
        return {**row, "missing": "the installed Taichi comes without this example"}
    try:
        return {**row, **ask_fresh(WORK)}
    except ProcessDied as error:
        return {**row, "missing": f"the example could not be run: {error}"}


def find() -> Path | None:
    """Where the installed Taichi has the example, if it has it."""
    path = Path(runtime.ti.__file__).parent / "examples" / "simulation" / f"{NAME}.py"
    return path if path.is_file() else None


def measure(question: dict, answer: Callable[[dict], None]) -> None:
    ti = runtime.ti
    start = ti.init
    ti.init = lambda **_: start(arch=ti.cpu, cpu_max_num_threads=1, verbose=False, log_level=ti.ERROR)
    names = runpy.run_path(str(find()))  # under another name than __main__: nothing runs yet
    names["initialize"]()
    steps = 1
    while (best := _seconds(names["substep"], steps)) < SECONDS:
        steps *= 2
    best = min(best, *(_seconds(names["substep"], steps) for _ in range(TURNS)))
    particles = names["n_particles"]
    answer({"particles": particles, "rate": 1e-6 * particles * steps / best})


def _seconds(substep: Callable[[], None], steps: int) -> float:
    """The processor's time for some steps, of the whole process: parallel loops have a thread of their own."""
    begun = time.process_time()
    for _ in range(steps):
        substep()
    return time.process_time() - begun
