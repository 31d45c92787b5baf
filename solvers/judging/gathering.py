"""Named arrays of a file put together as the quantities that they are."""

from typing import Any

import numpy as np

from solvers.judging.columns import TENSORS, VECTORS, meaning
from solvers.judging.frames import FileError, Raw

MOST_ROWS = 20_000_000


def gathered(path: str, named: dict[str, np.ndarray], time: float | None, cells: int | None) -> Raw:
    """The table of named arrays (n, ...): components put together, the rest left out."""
    columns: dict[str, np.ndarray] = {}
    parts: dict[str, dict[tuple[int, ...], np.ndarray]] = {}
    for name, array in named.items():
        known = meaning(name)
        if known is None:
            continue
        key, component = known
        values = np.asarray(array, float)
        if name in VECTORS and values.ndim > 1:
            component = None  # a whole vector, called as its first component is
        if component is None and not (values.ndim == 1 and key in VECTORS + TENSORS):
            if key in columns:
                raise FileError(path, f"has {key} twice, the second time as {name}; give it once")
            columns[key] = _shaped(path, key, name, values)
        else:
            where = component or ((0,) if key in VECTORS else (0, 0))
            if where in parts.setdefault(key, {}):
                raise FileError(path, f"has the same component of {key} twice, the second time as {name}; give it once")
            parts[key][where] = values
    for key, pieces in parts.items():
        if key in columns:
            raise FileError(path, f"has {key} as a whole and in components; give one of the two")
        columns[key] = _joined(path, key, pieces)
    lengths = {key: len(array) for key, array in columns.items()}
    if len(set(lengths.values())) > 1:
        told = ", ".join(f"{key} has {n}" for key, n in lengths.items())
        raise FileError(path, f"has columns of several lengths ({told}); give a row for each particle in all of them")
    if not columns or not next(iter(lengths.values())):
        some = ", ".join(list(named)[:8]) or "nothing"
        raise FileError(path, f"holds no particles that are known by name, but {some}; give columns such as id, x, vx")
    if next(iter(lengths.values())) > MOST_ROWS:
        raise FileError(path, f"has {next(iter(lengths.values())):,} rows; give at most {MOST_ROWS:,}")
    return Raw(path, columns, tuple(named), time, cells)


def _shaped(path: str, key: str, name: str, values: np.ndarray) -> np.ndarray:
    """An array (n, ...) as (n,), (n, d) or (n, d, d)."""
    if key in ("t", "id"):
        if values.ndim != 1:
            raise FileError(path, f"has {name} of the shape {values.shape}; give one number for each particle")
        return values
    if key in VECTORS and values.ndim == 2 and values.shape[1] in (1, 2, 3):
        return values
    if key in TENSORS:
        if values.ndim == 3 and values.shape[1] == values.shape[2] and values.shape[1] in (1, 2, 3):
            return values
        size = {1: 1, 4: 2, 9: 3}.get(values.shape[1] if values.ndim == 2 else 0)
        if size:
            return values.reshape(-1, size, size)
        if values.ndim == 2 and values.shape[1] == 6 and key == "sigma":  # VTK's order: xx, yy, zz, xy, yz, xz
            return values[:, [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(-1, 3, 3)
    raise FileError(path, f"has {name} of the shape {values.shape}; give a row for each particle, with 1 to 3 numbers "
                          "of a vector, and 1, 4 or 9 of a tensor, row by row")


def _joined(path: str, key: str, pieces: dict[tuple[int, ...], np.ndarray]) -> np.ndarray:
    """Components (n,) as a vector (n, d) or a tensor (n, d, d); of a stress one of xy and yx is enough."""
    size = 1 + max(max(where) for where in pieces)
    n = len(next(iter(pieces.values())))
    out = np.full((n, size) if key in VECTORS else (n, size, size), np.nan)
    for where, values in pieces.items():
        if values.shape != (n,):
            raise FileError(path, f"has components of {key} of several lengths; give a number for each particle")
        out[_at(where)] = values
        if key == "sigma" and where[::-1] not in pieces:
            out[_at(where[::-1])] = values
    shape = out.shape[1:]
    missing = [w for w in np.ndindex(*shape) if w not in pieces and not (key == "sigma" and w[::-1] in pieces)]
    if size == 3:  # what concerns the third direction is not needed in the plane
        missing = [w for w in missing if 2 not in w]
        out = np.where(np.isnan(out), 0.0, out) if not missing and all(np.isfinite(v).all() for v in pieces.values()) \
            else out
    if missing:
        letters = "".join("xyz"[k] for k in missing[0])
        raise FileError(path, f"has some components of {key} but not {letters}; give all of them or none")
    return out


def _at(component: tuple[int, ...]) -> Any:
    """The index of a component in all rows."""
    return (slice(None), *component)
