"""Start of Taichi, in one place, so that every run is in double precision and reports its real architecture."""

import atexit
import contextlib
import io
import os
import weakref
from typing import Any, NoReturn

import taichi as ti

from solvers.kernels import taichi_front_end_patches

taichi_front_end_patches.speed_up_front_end()

PROCESSORS = ("x64", "arm64")  # as Taichi calls them

#: Objects with references to the running Taichi, whose ``free`` is called before it restarts, and at the end.
holders: weakref.WeakSet[Any] = weakref.WeakSet()

_started: tuple[str, int] | None = None
_options: dict = {}


def allow_forks() -> None:
    """Lets children forked from this process compile kernels; call before the first :func:`start`. Taichi's own threads
    are not forked, and the first compilation of a child would wait for them for ever."""
    _options["num_compile_threads"] = 0


def store_kernels_and_exit() -> NoReturn:
    """Writes compiled kernels to disk and ends the process with status 0. In a fork, Taichi's own exit would wait for
    threads that only the parent has."""
    _store_compiled_kernels()
    os._exit(0)


def start(arch: str = "cpu", threads: int = 1) -> str:
    """Starts Taichi for this process on ``arch``, "cpu", "cuda" or "vulkan", with so many CPU threads for a kernel, and
    returns the architecture that really runs ("x64", "cuda", ...). A call with other settings restarts Taichi, one with
    the same does nothing. All calls must come from one thread.

    Without a GPU Taichi takes the CPU with only a warning: ``solvers.solver.gpu_detection`` finds out beforehand, in
    its own process. ``fast_math`` stays off: it gains nothing in the bar and hides NaN from the stability check.

    On the CPU vectors stay whole: by default Taichi takes them apart into numbers, and LLVM rejoins only what it
    recognises, in the oldest processor's registers where it does not know the present one. Whole vectors make the ring
    1.5 times as fast. They are read and written at once, so arrays must be aligned (``solvers.solver.state_arrays``);
    and ``abs`` and casts of a whole vector abort the process while it compiles: take its entries.
    """
    global _started
    if _started != (arch, threads):
        _release_taichi_objects()
        with contextlib.redirect_stdout(io.StringIO()):  # it announces itself on standard output, which is ours
            ti.init(arch=getattr(ti, arch), default_fp=ti.f64, cpu_max_num_threads=threads,
                    fast_math=False, real_matrix_scalarize=arch != "cpu", log_level=ti.ERROR, verbose=False, **_options)
        _started = (arch, threads)
    return running_arch()


def running_arch() -> str:
    """Returns the architecture on which Taichi was started, by its name: "x64", "arm64", "cuda" or "vulkan"."""
    return ti.lang.impl.current_cfg().arch.name


def runs_on_cpu() -> bool:
    """Returns whether Taichi runs on CPUs, where arrays are numpy's own memory."""
    return running_arch() in PROCESSORS


@atexit.register  # later than Taichi's own end, and so run before it
def _store_kernels_and_release() -> None:
    """Writes compiled kernels to disk, as Taichi does when its program is destroyed: the time of that depends on the
    order in which Python frees classes and modules, and it may never happen."""
    _release_taichi_objects()
    _store_compiled_kernels()


def _store_compiled_kernels() -> None:
    if (program := ti.lang.impl.get_runtime().prog) is not None:
        program.finalize()


def _release_taichi_objects() -> None:
    """Frees all objects of the running Taichi before it ends, because later they would access freed memory."""
    for holder in list(holders):
        holder.free()
