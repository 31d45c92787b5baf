"""What an error estimator is to a solver: its memory, its moments in a step, and its report.

An estimator of a problem is one :class:`EstimatorHooks`, called ``HOOKS``, at the end of its file. Several can run in
one scene; number e reports the estimated errors of particle p in entry ``e * particles + p`` of the state's
``estimate`` arrays. It may
use whatever the method itself computes, the body force and the initial state; never the exact solution.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from solvers.estimators.packing import Packing
from solvers.scene import Scene

NEVER = 2**31 - 1  # an interval that no step is a multiple of: the estimator is left out, to time the others


@dataclass(frozen=True)
class EstimatorHooks:
    """The hooks of one estimator for one problem.

    ``memory`` names its numbers and arrays, each with the estimator's name in front, and gives their Taichi types;
    ``allocate(scene)`` gives their values. ``interval(scene)`` is the number of steps between two of its own. The
    others are Taichi functions, or None:

    * ``in_step(state, base, on)``: in every step that is a multiple of the interval, between the update of the nodes
      and that of the particles, when the step's weights and the nodes' new motion are known;
    * ``after_step(state, base, step, on)``: at the end of these steps; ``step`` is the number of steps taken;
    * ``report(state, base, step, on)``: fill entries ``base`` to ``base + particles`` of the estimate arrays for the
      state after ``step`` steps, whether or not that is a multiple of the interval. The acceleration is the one that
      the last step used, which belongs to the time one step earlier. Called only when somebody looks.

    ``verdict(scene, memory)`` may find, from the arrays of a run, that the estimate cannot be trusted: one sentence
    that begins with "not valid here: ". What is known beforehand is said by the problem's ``validity``.
    """

    memory: Mapping[str, object]
    allocate: Callable[[Scene], dict]
    interval: Callable[[Scene], int]
    in_step: Callable | None = None
    after_step: Callable | None = None
    report: Callable | None = None
    verdict: Callable[[Scene, Mapping], str | None] = field(default=lambda scene, memory: None)


def members(estimators: Mapping[str, EstimatorHooks]) -> dict[str, object]:
    """The memory of all estimators, by name, with types."""
    return {name: kind for estimator in estimators.values() for name, kind in estimator.memory.items()}


def memory_types(estimators: Mapping[str, EstimatorHooks]) -> dict[str, object]:
    """The types of the members of the state that hold all estimators' memory (see ``solvers.estimators.packing``)."""
    return Packing(members(estimators)).types


def allocate_memory(estimators: Mapping[str, EstimatorHooks], scene: Scene) -> dict:
    """What these hold: the active estimators' own values, and for the others the least that a kernel accepts."""
    values = {}
    for name, estimator in estimators.items():
        blank = {member: _blank(kind) for member, kind in estimator.memory.items()}
        own = estimator.allocate(scene) if name in scene.active_estimators else {}
        if own and own.keys() != blank.keys():
            raise TypeError(f"estimator {name} allocates {sorted(own.keys() ^ blank.keys())} against its own list")
        values.update(own or blank)
    return Packing(members(estimators)).values(values)


def memory_parts(estimators: Mapping[str, EstimatorHooks], memory: Mapping) -> dict[str, np.ndarray]:
    """All estimators' arrays by name, out of what holds them."""
    return Packing(members(estimators)).parts(memory)


def intervals(estimators: Mapping[str, EstimatorHooks], scene: Scene) -> np.ndarray:
    """Steps between two steps of each active estimator; one entry at least."""
    return np.array([estimators[name].interval(scene) for name in scene.active_estimators] or [NEVER], np.int32)


def _blank(kind: object) -> float | int | np.ndarray:
    """Zero, or an array of length one, of a Taichi type."""
    if not hasattr(kind, "ndim"):
        return 0
    element = kind.dtype
    shape = (1,) * kind.ndim + tuple(element.get_shape() if hasattr(element, "get_shape") else ())
    integer = getattr(element, "dtype", element).to_string() == "i32"
    return np.zeros(shape, np.int32 if integer else np.float64)
