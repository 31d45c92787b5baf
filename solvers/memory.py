"""Arrays placed so that compiled code may move a whole vector at once."""

from __future__ import annotations

from dataclasses import fields

import numpy as np

ALIGNMENT = 64  # bytes: a cache line, and the widest vector, of eight numbers


def aligned(array: np.ndarray) -> np.ndarray:
    """A copy that starts at a multiple of ``ALIGNMENT``; numpy itself promises 16 bytes only."""
    buffer = np.empty(array.nbytes + ALIGNMENT, np.uint8)
    start = -buffer.ctypes.data % ALIGNMENT
    copy = buffer[start:start + array.nbytes].view(array.dtype).reshape(array.shape)
    copy[...] = array
    return copy


def align_fields(arrays: object) -> None:
    """Replace every array of a dataclass, in a dictionary too, by an aligned copy."""
    for field in fields(arrays):
        setattr(arrays, field.name, _aligned(getattr(arrays, field.name)))


def _aligned(value: object) -> object:
    if isinstance(value, dict):
        return {name: _aligned(item) for name, item in value.items()}
    return aligned(value) if isinstance(value, np.ndarray) else value
