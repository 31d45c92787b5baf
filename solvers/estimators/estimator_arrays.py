"""Memory of a run's estimators: the types of their numbers and arrays, and their values at the start."""

import functools
from collections.abc import Mapping
from typing import Any

import numpy as np

from solvers.kernels.packing import ArrayPacking
from solvers.scene.estimator_hooks import EstimatorHooks
from solvers.scene.scene import Scene


def packing(estimators: Mapping[str, EstimatorHooks]) -> ArrayPacking:
    """Returns the layout of all estimators' memory in a state's arrays; ``estimators`` are the hooks by name."""
    return _packing_of(tuple(item for estimator in estimators.values() for item in estimator.memory.items()))


@functools.cache
def _packing_of(members: tuple[tuple[str, Any], ...]) -> ArrayPacking:
    return ArrayPacking(dict(members))


def allocate_memory(estimators: Mapping[str, EstimatorHooks], scene: Scene) -> dict:
    """Returns packed initial arrays by name: an active estimator's own values, for others the smallest valid ones."""
    values: dict[str, object] = {}
    for name, estimator in estimators.items():
        blank = {member: _blank(kind) for member, kind in estimator.memory.items()}
        own = estimator.allocate(scene) if name in scene.active_estimators else {}
        if own and own.keys() != blank.keys():
            raise TypeError(f"estimator {name} allocates {sorted(own.keys() ^ blank.keys())} against its own list")
        values.update(own or blank)
    return packing(estimators).pack(values)


def unpack_arrays(estimators: Mapping[str, EstimatorHooks], memory: Mapping) -> dict[str, np.ndarray]:
    """Returns all estimators' arrays by name from the packed arrays by name, ``memory``."""
    return packing(estimators).unpack(memory)


@functools.cache  # its arrays are copied where they are used
def _blank(kind: Any) -> float | int | np.ndarray:
    """Returns zero for a number's Taichi type, or zeros of length one for an array's."""
    if not hasattr(kind, "ndim"):
        return 0
    element = kind.dtype
    shape = (1,) * kind.ndim + tuple(element.get_shape() if hasattr(element, "get_shape") else ())
    integer = getattr(element, "dtype", element).to_string() == "i32"
    return np.zeros(shape, np.int32 if integer else np.float64)
