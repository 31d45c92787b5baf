"""What kernels work on: numbers and arrays of a run, as one dataclass whose annotations are their Taichi types.

Numpy arrays, because a scene can then be rebuilt any number of times without growth (Taichi's own arrays keep their
memory for ever), and because the view and the tests read them as they are. They are placed so that compiled code may
move a whole vector at once.
"""

import functools
from dataclasses import dataclass, fields
from typing import Any, get_type_hints

import numpy as np

from solvers.estimators.estimator_memory import allocate_memory
from solvers.kernels.dtypes import Integer, Integers, Matrix, Quads, Real, Reals
from solvers.scene.estimator_hooks import NEVER, EstimatorHooks
from solvers.scene.kernel_options import KernelOptions
from solvers.scene.scene import Scene
from solvers.solver.samples import MAX_ROWS, column_names

ALIGNMENT = 64  # bytes: a cache line, and the widest vector, of eight numbers
REMEDY_TIME = 0.3  # tau c/h: how fast filter and coupling work, in the time that a wave takes through a cell
REMEDY_INTERVAL = 4  # steps between two turns of them: they work at a rate, so that seldom does as well as often


@dataclass
class Members:
    """Numbers and arrays by name; arrays are replaced by aligned copies when they come in."""

    def __post_init__(self) -> None:
        for field in fields(self):
            setattr(self, field.name, align(getattr(self, field.name)))

    @classmethod
    @functools.cache
    def types(cls) -> dict[str, object]:
        """The Taichi type of each member, in order."""
        hints = get_type_hints(cls, include_extras=True)
        return {f.name: hints[f.name].__metadata__[0] for f in fields(cls) if hasattr(hints[f.name], "__metadata__")}

    def members(self) -> dict[str, Any]:
        """Every number and array, by name."""
        return {name: getattr(self, name) for name in self.types()}


@dataclass
class Diagnostics(Members):
    """What watches a run, no part of the method: checks, samples, marks and estimates. P particles, E estimators."""

    sample_interval: Integer  # steps
    look_interval: Integer  # steps between two looks for contradictions, a multiple of that
    farthest: Real  # how far a particle may be in a run that is sound, m
    last_crossing: Integers  # step of the particle's last cell change, -1 for never (P,)
    estimate: Quads  # estimated errors (E*P, 4): of the bar x, v, sigma, a; in the plane x and v, vectors
    estimate_intervals: Integers  # steps between two steps of each estimator (E,)
    step_margin: Reals  # dt over its bound when it was last looked at (1,)
    samples: Matrix  # one row a sample (ROWS, columns)
    verdict: Integers  # 0 or the kind of failure, its step, its particle (3,)
    memory: dict  # what the estimators keep, numbers and arrays by name (see ``solvers.scene.estimator_hooks``)

    def members(self) -> dict[str, Any]:
        return {**super().members(), **self.memory}


def initial_diagnostics(scene: Scene, on: KernelOptions, particles: int, farthest: float,
                        hooks: dict[str, EstimatorHooks]) -> dict:
    """The members of a :class:`Diagnostics` at the start of a run of so many particles."""
    intervals = [hooks[name].interval(scene) for name in scene.active_estimators]
    return {"sample_interval": scene.sample_interval, "look_interval": scene.look_interval,
            "step_margin": np.full(1, np.nan), "farthest": farthest,
            "last_crossing": np.full(particles if on.crossings else 1, -1, np.int32),
            "estimate": zeros(len(on.estimators) * particles, 4, when=bool(on.estimators)),
            "estimate_intervals": np.array(intervals or [NEVER], np.int32), "memory": allocate_memory(hooks, scene),
            "samples": np.full((MAX_ROWS, len(column_names(on.estimators, on.effects))), np.nan),
            "verdict": np.zeros(3, np.int32)}


def remedy_rates(scene: Scene) -> dict[str, float]:
    """What a turn of the filter and of the coupling does: min(1, dt/tau), dt the time since the turn before."""
    rate = min(1.0, REMEDY_INTERVAL * scene.time_step * scene.wave_speed / (REMEDY_TIME * scene.spacing))
    return {"remedy_interval": REMEDY_INTERVAL, "remedy_rate": rate}


def zeros(length: int, width: int | None = None, *, when: bool = True, kind: type = np.float64) -> np.ndarray:
    """Zeros, of length one where nobody needs them."""
    length = length if when else 1
    return np.zeros(length if width is None else (length, width), kind)


def align(value: Any) -> Any:
    """A copy of an array, or of every array of a mapping, that starts at a multiple of ``ALIGNMENT``; numpy itself
    promises 16 bytes only. Anything else as it is."""
    if isinstance(value, dict):
        return {name: align(item) for name, item in value.items()}
    if not isinstance(value, np.ndarray):
        return value
    buffer = np.empty(value.nbytes + ALIGNMENT, np.uint8)
    start = -buffer.ctypes.data % ALIGNMENT
    copy = buffer[start:start + value.nbytes].view(value.dtype).reshape(value.shape)
    copy[...] = value
    return copy
