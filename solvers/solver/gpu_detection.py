"""Safe detection of GPUs.

A probe can crash its process (a driver without its device, a machine without a display), and Taichi falls back to the
CPU with no more than a warning. So a separate process probes, once for each kind of GPU, and computes a small sum to
check double precision and its atomic additions there; the result is cached.
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
SOFTWARE_DEVICES = ("llvmpipe", "lavapipe", "swiftshader")  # names of GPUs emulated on the CPU
TERMS = 1000  # of the sum
ROUNDING = 1e-12  # tolerance of the sum: TERMS roundings of numbers below 8, at most 9e-16 each


def resolve_arch(arch: str) -> str:
    """Returns where a run with a scene's ``arch`` takes place: "cpu", "cuda" or "vulkan". "gpu" is the first of these
    GPUs that exists, or else the CPU. Raises :class:`SceneError` for a GPU that is named and does not exist."""
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
    """Returns for "cuda" or "vulkan" the device's ``name``, if known, whether it is ``software`` on the CPU, and why it
    is ``missing``, or None."""
    try:
        return ask_fresh(f"{__name__}:probe_in_process", {"kind": kind}, patience=TIMEOUT)
    except ProcessDied as error:
        return {"name": "", "software": False, "missing": f"the process that looked for one {error}"}


@ti.kernel
def run_test_sum(terms: ti.i32, total: reals):
    """Adds the ``terms`` numbers 1, 1/2, 1/3, ... to ``total[0]``, in parallel."""
    for k in range(terms):
        ti.atomic_add(total[0], 1.0 / (k + 1))


def probe_in_process(question: dict, answer: Callable[[dict], None]) -> None:
    """Probes the device ``question["kind"]`` in its own process; calls ``answer`` with :func:`probe_device`'s dict."""
    kind, total = question["kind"], np.zeros(1)
    with _capture_stderr() as told:  # where Taichi's native code writes which device it uses
        ti.init(arch=getattr(ti, kind), default_fp=ti.f64, verbose=False, log_level=ti.TRACE)
        runs = runtime.running_arch()
        if runs == kind:
            run_test_sum(TERMS, total)
    names = re.findall(r"Vulkan Device \"(.+?)\" supports", told())
    name = names[-1] if names else ""
    wrong = abs(total[0] - np.sum(1 / np.arange(1, TERMS + 1))) > ROUNDING
    missing = "Taichi sees none" if runs != kind else "what there is adds wrongly" if wrong else None
    answer({"name": name, "software": any(word in name.lower() for word in SOFTWARE_DEVICES), "missing": missing})


@contextlib.contextmanager
def _capture_stderr() -> Iterator[Callable[[], str]]:
    """Captures standard error in the block, of native code too; yields a function () that returns it after it."""
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
