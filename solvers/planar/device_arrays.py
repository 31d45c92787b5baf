"""Arrays on a GPU. With Vulkan, Taichi 1.7.4 keeps the memory of those that are let go of, so they are used again."""

from collections import defaultdict
from typing import Any

import numpy as np
import taichi as ti

from solvers import runtime


class Spare:
    """Arrays that nobody uses any more, by type and shape."""

    def __init__(self) -> None:
        self._arrays: dict[tuple, list[ti.Ndarray]] = defaultdict(list)
        runtime.holders.add(self)

    def take(self, kind: Any, shape: tuple[int, ...]) -> ti.Ndarray:
        """One with entries of a kernel's type, which may hold anything."""
        kept = self._arrays[_key(kind, shape)]
        return kept.pop() if kept else ti.ndarray(kind.dtype, shape)

    def give(self, kind: Any, array: ti.Ndarray) -> None:
        """Take one back."""
        if runtime.running_arch() == "vulkan":
            self._arrays[_key(kind, array.shape)].append(array)

    def forget(self) -> None:
        """Keep none: Taichi is about to end."""
        self._arrays.clear()


SPARE = Spare()


class DeviceArrays:
    """Copies on the GPU of arrays by name, which have the types of a kernel's argument."""

    def __init__(self, arrays: dict[str, np.ndarray], types: dict[str, Any]):
        self._arrays, self._types = arrays, types
        self.copies = {name: SPARE.take(types[name], array.shape[:types[name].ndim]) for name, array in arrays.items()}
        runtime.holders.add(self)
        self.push(*arrays)

    def __del__(self) -> None:
        for name, copy in self.copies.items():
            SPARE.give(self._types[name], copy)

    def fetch(self, *names: str) -> None:
        """Bring the arrays up to date."""
        for name in names:
            self._arrays[name][...] = self.copies[name].to_numpy()

    def push(self, *names: str) -> None:
        """Bring the copies up to date."""
        for name in names:
            self.copies[name].from_numpy(self._arrays[name])

    def forget(self) -> None:
        """Keep none: Taichi is about to end."""
        self.copies = {}


def _key(kind: Any, shape: tuple[int, ...]) -> tuple:
    return str(kind.dtype), kind.ndim, shape
