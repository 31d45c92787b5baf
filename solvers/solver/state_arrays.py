"""State of kernels: numbers and arrays of a run, as a dataclass whose annotations are their Taichi types.

The arrays are numpy's, because a scene can then be rebuilt any number of times without leaking memory (Taichi never
frees its own arrays), and the view and the tests can read them directly. They are aligned for vector instructions.
"""

import functools
import math
from dataclasses import dataclass, fields
from typing import Any, get_type_hints

import numpy as np

from solvers.estimators.estimator_arrays import allocate_memory
from solvers.kernels.dtypes import Integer, Integers, Matrix, Quads, Real, Reals
from solvers.scene.estimator_hooks import NEVER, EstimatorHooks
from solvers.scene.kernel_options import KernelOptions
from solvers.scene.scene import Scene
from solvers.solver.samples import MAX_ROWS, column_names

ALIGNMENT = 64  # bytes: a cache line, and the widest vector, of eight numbers
REMEDY_TIME = 0.3  # tau c/h: time scale of filter and coupling, in the time in which a wave crosses a cell
SPARE_ROOM = 1.3  # length of a grown buffer over what it needs, so that slowly growing scenes rarely grow it again
MOST_SPARE_BYTES = 32 * 2**20  # that buffers may have beyond what their run needs
REMEDY_INTERVAL = 4  # steps between two applications; the effect per time does not depend on it


@dataclass
class Members:
    """Base of dataclasses of numbers and arrays for kernels."""

    @classmethod
    @functools.cache
    def types(cls) -> dict[str, object]:
        """Returns the Taichi type of each member by name, in order."""
        hints = get_type_hints(cls, include_extras=True)
        return {f.name: hints[f.name].__metadata__[0] for f in fields(cls) if hasattr(hints[f.name], "__metadata__")}

    def members(self) -> dict[str, Any]:
        """Returns every number and array, by name."""
        return {name: getattr(self, name) for name in self.types()}


@dataclass
class DiagnosticsState(Members):
    """State of a run beside the method: checks, samples, marks and estimates. P particles, E estimators."""

    sample_interval: Integer  # steps
    look_interval: Integer  # steps between two checks for contradictions, a multiple of that
    farthest: Real  # largest distance of a particle in a sound run, m
    last_crossing: Integers  # step of the particle's last cell change, -1 for never (P,)
    estimate: Quads  # estimated errors (E*P, 4): of the bar x, v, sigma, a; in the plane x and v, vectors
    estimate_intervals: Integers  # steps between two steps of each estimator (E,)
    step_margin: Reals  # dt over its bound at the last evaluation (1,)
    samples: Matrix  # one row per sample (ROWS, columns)
    verdict: Integers  # 0 or the kind of failure, its step, its particle (3,)
    memory: dict  # of the estimators, numbers and arrays by name (see ``solvers.scene.estimator_hooks``)

    def members(self) -> dict[str, Any]:
        return {**super().members(), **self.memory}


class StateBuffers:
    """Aligned ``arrays`` by name, in which the states of one run after another are stored. Kernels get them whole, and
    the numbers of a state say how much it uses. ``moved`` is whether the last :meth:`store` has replaced any."""

    def __init__(self) -> None:
        self.arrays: dict[str, np.ndarray] = {}
        self.moved = False
        self._used: dict[str, int] = {}  # length of the last array stored in each

    def store(self, members: dict[str, Any]) -> dict[str, Any]:
        """Returns the members of a state by name, with each array replaced by a view of the buffer to which it is
        copied; also those of its mapping ``memory``. A buffer that is too small is replaced by a larger one, and all
        buffers are if they are far too large."""
        flat = {**members, **members["memory"]}
        arrays = {name: value for name, value in flat.items() if isinstance(value, np.ndarray)}
        spare = sum(buffer.nbytes for buffer in self.arrays.values()) - sum(array.nbytes for array in arrays.values())
        if spare > MOST_SPARE_BYTES:
            self.arrays = {}
        self.moved = False
        views = {name: self._store_array(name, array) for name, array in arrays.items()}
        return {**members, **{name: views[name] for name in views if name in members},
                "memory": {name: views.get(name, value) for name, value in members["memory"].items()}}

    def _store_array(self, name: str, array: np.ndarray) -> np.ndarray:
        buffer = self.arrays.get(name)
        if buffer is None or len(buffer) < len(array) or buffer.shape[1:] != array.shape[1:]:
            length = len(array) if buffer is None else math.ceil(SPARE_ROOM * len(array))
            buffer = self.arrays[name] = aligned_copy(np.zeros((length, *array.shape[1:]), array.dtype))
            self._used[name], self.moved = 0, True
        buffer[:len(array)] = array
        buffer[len(array):self._used[name]] = 0
        self._used[name] = len(array)
        return buffer[:len(array)]


def initial_diagnostics(scene: Scene, on: KernelOptions, particles: int, farthest: float,
                        hooks: dict[str, EstimatorHooks]) -> dict:
    """Returns the members of a :class:`DiagnosticsState` by name, at the start of a run with ``particles`` particles;
    ``farthest`` is in m, ``hooks`` are of the problem's estimators. ``on``: compile-time options."""
    intervals = [hooks[name].interval(scene) if name in scene.active_estimators else NEVER for name in on.estimators]
    return {"sample_interval": scene.sample_interval, "look_interval": scene.look_interval,
            "step_margin": np.full(1, np.nan), "farthest": farthest,
            "last_crossing": np.full(particles if on.crossings else 1, -1, np.int32),
            "estimate": zeros(len(on.estimators) * particles, 4, when=bool(on.estimators)),
            "estimate_intervals": np.array(intervals or [NEVER], np.int32), "memory": allocate_memory(hooks, scene),
            "samples": np.full((MAX_ROWS, len(column_names(on.estimators, on.effects))), np.nan),
            "verdict": np.zeros(3, np.int32)}


def remedy_rates(scene: Scene) -> dict[str, float]:
    """Returns the members ``remedy_interval``, of filter and coupling in steps, and ``remedy_rate``, min(1, dt/tau)."""
    rate = min(1.0, REMEDY_INTERVAL * scene.time_step * scene.wave_speed / (REMEDY_TIME * scene.spacing))
    return {"remedy_interval": REMEDY_INTERVAL, "remedy_rate": rate}


def zeros(length: int, width: int | None = None, *, when: bool = True, kind: type = np.float64) -> np.ndarray:
    """Returns an array of zeros (length,) or (length, width) of this ``kind``; unless ``when``, which says that a
    kernel uses it, its length is one."""
    length = length if when else 1
    return np.zeros(length if width is None else (length, width), kind)


def aligned_copy(array: np.ndarray) -> np.ndarray:
    """Returns a copy of an array that starts at a multiple of ``ALIGNMENT``; numpy guarantees only 16 bytes."""
    buffer = np.empty(array.nbytes + ALIGNMENT, np.uint8)
    start = -buffer.ctypes.data % ALIGNMENT
    copy = buffer[start:start + array.nbytes].view(array.dtype).reshape(array.shape)
    copy[...] = array
    return copy
