"""What particles may be given as: files, mappings from names to arrays, or what was read of either."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from solvers.judging.columns import from_arrays
from solvers.judging.frames import Raw
from solvers.judging.reading import read
from solvers.outside.file_error import FileError
from solvers.outside.limits import LIMITS, Limits
from solvers.scene.rules import SceneError

Particles = str | os.PathLike | Mapping[str, Any] | Raw


def listed(files: Particles | Sequence[Particles]) -> list[Particles]:
    """One or several, as a list; :class:`SceneError` for none."""
    sources = [files] if isinstance(files, (str, os.PathLike, Mapping, Raw)) else list(files)
    if not sources:
        raise SceneError("files", "none", "give one or several files of particles, or their arrays")
    return sources


def read_all(files: Particles | Sequence[Particles]) -> list[Raw]:
    """What the files hold, all of them together within the limits."""
    left, found = LIMITS, list[Raw]()
    for k, source in enumerate(listed(files)):
        found.append(_raw(source, k, left))
        left = left.less(found[-1].columns)
    return found


def _raw(source: Particles, k: int, limits: Limits) -> Raw:
    """What number ``k`` of the files holds."""
    if isinstance(source, Mapping):
        name = f"arrays {k + 1}"
        try:
            return from_arrays(name, {key: np.asarray(array) for key, array in source.items()}, limits)
        except ValueError as error:
            raise error if isinstance(error, FileError) else FileError(name, f"are no arrays: {error}") from None
    return source if isinstance(source, Raw) else read(os.fspath(source), limits)
