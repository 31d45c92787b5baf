"""Which GPU there is to run on, found out without risk.

Asking for one can take a process down (a driver without its device, a machine without a display), and Taichi falls back
to the processor with no more than a warning. So a process of its own asks, once for each kind of GPU, and shows by a
small sum that double precision and its atomic additions work there; whoever started it remembers the answer.
"""

import contextlib
import functools
import os
import re
import tempfile
from collections.abc import Callable, Iterator

import numpy as np
import taichi as ti

from solvers.kernels import runtime
from solvers.kernels.dtypes import reals
from solvers.scene.validation import SceneError
from solvers.workers.worker_process import ProcessDied, ask_fresh

CPU, GPU = "cpu", "gpu"
KINDS = ("cuda", "vulkan")  # in the order in which "gpu" takes them
TITLES = {"cuda": "CUDA", "vulkan": "Vulkan"}
TIMEOUT = 60.0  # seconds
SOFTWARE_DEVICES = ("llvmpipe", "lavapipe", "swiftshader")  # names of what only plays a GPU, on the processor
TERMS = 1000  # of the sum
ROUNDING = 1e-12  # that it may be off: TERMS roundings of numbers below 8, at most 9e-16 each


def resolve_arch(arch: str) -> str:
    """Where a run with this ``arch`` is: "cpu", "cuda" or "vulkan". ``gpu`` is the first of these GPUs that is there,
    or else the processor; one that is asked for by name and is not there is a :class:`SceneError`."""
    if arch == CPU:
        return CPU
    if arch == GPU:
        there = (kind for kind in KINDS if probe_device(kind)["missing"] is None and not probe_device(kind)["software"])
        return next(there, CPU)
    if missing := probe_device(arch)["missing"]:
        raise SceneError("arch", arch, f"no {TITLES[arch]} device was found that computes in double precision "
                         f"({missing}); give gpu, which takes what there is, or cpu")
    return arch


@functools.cache
def probe_device(kind: str) -> dict:
    """What there is of a kind: its ``name`` if it tells one, whether it is ``software`` on the processor, and None or
    why it is ``missing``."""
    try:
        return ask_fresh(f"{__name__}:probe_in_process", {"kind": kind}, patience=TIMEOUT)
    except ProcessDied as error:
        return {"name": "", "software": False, "missing": f"the process that looked for one {error}"}


@ti.kernel
def add_reciprocals(terms: ti.i32, total: reals):
    """Add 1, 1/2, 1/3, ... to the total, all at once."""
    for k in range(terms):
        ti.atomic_add(total[0], 1.0 / (k + 1))


def probe_in_process(question: dict, answer: Callable[[dict], None]) -> None:
    """What the process does that looks for a kind."""
    kind, total = question["kind"], np.zeros(1)
    with _capture_stderr() as told:  # where Taichi's own code writes which device it takes
        ti.init(arch=getattr(ti, kind), default_fp=ti.f64, verbose=False, log_level=ti.TRACE)
        runs = runtime.running_arch()
        if runs == kind:
            add_reciprocals(TERMS, total)
    names = re.findall(r"Vulkan Device \"(.+?)\" supports", told())
    name = names[-1] if names else ""
    wrong = abs(total[0] - np.sum(1 / np.arange(1, TERMS + 1))) > ROUNDING
    missing = "Taichi sees none" if runs != kind else "what there is adds wrongly" if wrong else None
    answer({"name": name, "software": any(word in name.lower() for word in SOFTWARE_DEVICES), "missing": missing})


@contextlib.contextmanager
def _capture_stderr() -> Iterator[Callable[[], str]]:
    """What is written to standard error meanwhile, by native code too."""
    with tempfile.TemporaryFile() as file:
        before = os.dup(2)
        os.dup2(file.fileno(), 2)
        text: list[str] = []
        try:
            yield lambda: text[0]
        finally:
            os.dup2(before, 2)
            os.close(before)
            file.seek(0)
            text.append(file.read().decode(errors="replace"))
