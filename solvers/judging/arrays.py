"""Arrays with names as a table: those of one time, or of many times at once."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from solvers.judging.columns import gathered, meaning
from solvers.judging.frames import Raw
from solvers.judging.said import read_line
from solvers.outside.file_error import FileError
from solvers.outside.limits import LIMITS, Limits, check_name
from solvers.outside.quoting import quoted


def wanted(name: str) -> bool:
    """Whether an array of this name is looked at."""
    return bool(meaning(name)) or name in ("cells", "scene")


def from_arrays(path: str, arrays: Mapping[str, np.ndarray], limits: Limits = LIMITS) -> Raw:
    """The table of named arrays, as they stand in a .npz; ``path`` is what messages call it."""
    limits.check_columns(path, len(arrays))
    for name, array in arrays.items():
        check_name(path, name)
        if meaning(name) and array.dtype.kind not in "iuf":
            raise FileError(path, f"has no numbers in {quoted(name)}; give numbers, real and not objects or texts")
    scalars = {name: array.item() for name, array in arrays.items() if array.size == 1 and array.dtype.kind in "iuf"}
    cells = scalars.get("cells")
    times = next((arrays[name] for name in arrays if _key(name) == "t"), None)
    many = {name: array for name, array in arrays.items() if meaning(name) and array.ndim > 0}
    place = next((array for name, array in many.items() if _key(name) == "x"), None)
    # Positions of T times are (T, P) or (T, P, D), those of one table (n,) or (n, D).
    stacked = place is not None and (place.ndim == 3 or (place.ndim == 2 and place.shape[1] > 3))
    line = arrays["scene"].item() if "scene" in arrays and arrays["scene"].size == 1 else None
    if times is None or times.ndim == 0 or not stacked:
        time = None if times is None or times.ndim else float(times)
        return with_scene(gathered(path, many, time, whole(path, cells), limits), line)
    rows = _unstacked(path, many, times, limits)
    return with_scene(gathered(path, rows, None, whole(path, cells), limits), line)


def with_scene(raw: Raw, line: object) -> Raw:
    """The file with what it says of its scene."""
    said = read_line(raw.file, line, raw.cells)
    return raw if said is None else replace(raw, said=said, cells=said.inputs.get("cells", raw.cells), step=said.step)


def _unstacked(path: str, many: dict[str, np.ndarray], times: np.ndarray, limits: Limits) -> dict[str, np.ndarray]:
    """Arrays (T, P, ...) as rows, one for every time and particle; what is known once for all, ids and material
    positions, is repeated."""
    T = len(times)
    place = next(array for name, array in many.items() if _key(name) == "x")
    P = place.shape[1] if place.ndim > 1 else 0
    if len(place) != T or P == 0:
        raise FileError(path, f"has {T} times and positions of the shape {place.shape}; give positions of the shape "
                              "(times, particles, dimensions)")
    limits.check_times(path, T)
    limits.check_rows(path, T * P)
    limits.check_numbers(path, T * P, sum(_width(array, T, P) for array in many.values()))
    rows: dict[str, np.ndarray] = {}
    for name, array in many.items():
        if _key(name) == "t":
            rows[name] = np.repeat(array, P)
        elif array.shape[:2] == (T, P):
            rows[name] = array.reshape(T * P, *array.shape[2:])
        elif len(array) == P and _key(name) in ("id", "X", "mass", "volume"):
            rows[name] = np.tile(array, (T,) + (1,) * (array.ndim - 1))
        else:
            raise FileError(path, f"has {quoted(name)} of the shape {array.shape} beside {T} times of {P} particles; "
                                  f"give ({T}, {P}, ...)")
    return rows


def _key(name: str) -> str:
    return (meaning(name) or ("",))[0]


def _width(array: np.ndarray, T: int, P: int) -> int:
    """Numbers that an array of T times and P particles, or of P, has for each row."""
    return int(np.prod(array.shape[2 if array.shape[:2] == (T, P) else 1:], dtype=object))


def whole(path: str, value: float | None) -> int | None:
    if value is not None and not float(value).is_integer():
        raise FileError(path, f"says that it has {value} cells; give a whole number")
    return None if value is None else int(value)
