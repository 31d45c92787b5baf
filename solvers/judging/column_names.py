"""Assembly of a table of particles from named columns or arrays, whose names ``quantity_names`` knows."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, cast

import numpy as np

from solvers.judging.particle_data_types import RawTable
from solvers.judging.quantity_names import LETTERS, OF_THE_FILE, SCALARS, TENSORS, VECTORS, ColumnMeaning, find_meanings
from solvers.judging.scene_metadata import parse_scene_line
from solvers.translatable_message import Message, join_messages
from solvers.untrusted.quoting import FileError, quote
from solvers.untrusted.size_limits import LIMITS, SizeLimits, check_name

PLACES_OF_SIX = [0, 3, 5, 3, 1, 4, 5, 4, 2]  # of xx, yy, zz, xy, yz, xz, row by row: the order of VTK and of most codes
ORDERS = {3: [0, 2, 2, 1], 4: [0, 3, 3, 1]}  # of xx, yy, xy, and of xx, yy, zz, xy


@np.errstate(all="ignore")  # files may have any numbers
def build_table(path: str, named: Mapping[str, np.ndarray], time: float | None, cells: int | None,
                limits: SizeLimits = LIMITS, known: Mapping[str, ColumnMeaning] | None = None) -> RawTable:
    """Returns the table of named arrays (n, ...) in SI units: components are assembled, positions are completed from
    displacements, and names that are not ``known`` (by default as usual) are only listed."""
    meanings = find_meanings(named) if known is None else known
    limits.check_rows(path, max((len(named[name]) for name in meanings if named[name].ndim), default=0))
    limits.check_numbers(path, sum(named[name].size for name in meanings))
    columns: dict[str, np.ndarray] = {}
    parts: dict[str, dict[Any, np.ndarray]] = {}
    for name, meaning in meanings.items():
        key, where = meaning.key, meaning.component
        values = np.asarray(named[name], float)
        values = values if meaning.unit == 1 else meaning.unit * values
        if values.ndim > 1 and key in ("x", "X"):
            where = None  # a whole vector, called as its first component is
        if where is None and not (values.ndim == 1 and key in VECTORS + TENSORS):
            values = _reshape_array(path, key, name, values)
            if key in columns and not (columns[key].shape == values.shape and _nearly_equal(columns[key], values)):
                raise FileError(path, "has {key} twice, the second time as {name}; give it once", key, quote(name))
            columns.setdefault(key, values)
        else:
            where = ((0,) if key in VECTORS else (0, 0)) if where is None else where
            if where in parts.setdefault(key, {}):
                raise FileError(path, "has the same component of {key} twice, the second time as {name}; give it once",
                                key, quote(name))
            parts[key][where] = values
    for key, pieces in parts.items():
        if key in columns:
            raise FileError(path, "has {key} as a whole and in components; give one of the two", key)
        columns[key] = _join_components(path, key, pieces)
    _check_lengths(path, columns, named)
    from_displacement = complete_positions(columns)
    if "row" in columns and not _counts_rows(columns["row"]):
        row = columns.pop("row")
        if len(np.unique(np.stack([row, columns.get("t", 0 * row)]), axis=1).T) == len(row):
            columns["id"] = row
        else:  # the number of a body or of a material
            meanings = {name: meaning for name, meaning in meanings.items() if meaning.key != "row"}
    if "t" in columns:
        limits.check_times(path, len(np.unique(columns["t"])))
    of_file = (*OF_THE_FILE, *(name for name in named if "result" in named and "/" in name))
    not_read = tuple(name for name in named if name not in meanings and name not in of_file)
    return RawTable(path, columns, tuple(named), time, cells, not_read=not_read, from_displacement=from_displacement)


def _check_lengths(path: str, columns: Mapping[str, np.ndarray], named: Mapping[str, np.ndarray]) -> None:
    """Raises FileError for columns of several lengths, or without any particles."""
    lengths = {key: len(array) for key, array in columns.items()}
    if len(set(lengths.values())) > 1:
        told = join_messages(", ", (Message("{key} has {n}", key, n) for key, n in lengths.items()))
        raise FileError(path, "has columns of several lengths ({n}); give a row for each particle in all of them", told)
    if 0 in lengths.values():
        raise FileError(path, "holds no particles: its columns are empty; give a row for each particle in all of them")
    if not columns.keys() - {"mass", "volume"}:
        some = ", ".join(quote(name, 30) for name in list(named)[:8]) or "nothing"
        raise FileError(path, "holds no particles that are known by name, but {some}; give columns such as id, x, vx",
                        some)


@np.errstate(all="ignore")
def complete_positions(columns: dict[str, np.ndarray]) -> bool:
    """Adds X, the positions minus the displacement u, or x, X plus u, where one of them is missing, and removes u;
    returns whether X was added."""
    missing = {"x", "X"} - columns.keys()
    if len(missing) == 2 or (u := columns.pop("u", None)) is None or not missing:
        return False
    [new] = missing
    moved = columns["x" if new == "X" else "X"].copy()
    D = min(moved.shape[1], u.shape[1])
    if np.ptp(moved[:, D:], axis=0).any():  # of a direction in which the displacement is not known
        return False
    moved[:, :D] += u[:, :D] if new == "x" else -u[:, :D]
    columns[new] = moved
    return new == "X"


def _counts_rows(row: np.ndarray) -> bool:
    """Returns whether numbers (n,) only count the rows of a file, from 0 or 1, and say of none which particle it is."""
    return bool(len(row) and row[0] in (0, 1) and (row == row[0] + np.arange(len(row))).all())


def _reshape_array(path: str, key: str, name: str, values: np.ndarray) -> np.ndarray:
    """Returns an array (n, ...) as (n,), (n, d) or (n, d, d), as ``key`` requires. Raises FileError otherwise."""
    if key in SCALARS:
        if values.ndim != 1:
            raise FileError(path, "has {name} of the shape {shape}; give one number for each particle", quote(name),
                            values.shape)
        return values
    if key in VECTORS and values.ndim == 2 and values.shape[1] in (1, 2, 3):
        return values
    if key in TENSORS:
        if values.ndim == 3 and values.shape[1] == values.shape[2] and values.shape[1] in (1, 2, 3):
            return values
        size = values.shape[1] if values.ndim == 2 else 0
        if key == "sigma" and size == 6:
            return values[:, PLACES_OF_SIX].reshape(-1, 3, 3)
        # Four are those of the plane, row by row, of which two are one and the same, or have zz as the third.
        if key == "sigma" and (size == 3 or (size == 4 and not _nearly_equal(values[:, 1], values[:, 2]))):
            return values[:, ORDERS[size]].reshape(-1, 2, 2)
        if size in (1, 4, 9):
            return values.reshape(-1, math.isqrt(size), math.isqrt(size))
    raise FileError(path, "has {name} of the shape {shape}; give a row for each particle, with 1 to 3 numbers of a "
                    "vector, and 1, 4 or 9 of a tensor, row by row, or 3 or 6 of a stress: xx, yy, (zz,) xy, (yz, xz)",
                    quote(name), values.shape)


def _nearly_equal(one: np.ndarray, other: np.ndarray) -> bool:
    """Returns whether two columns (n, ...) have the same numbers, as written in six figures, or no numbers."""
    return bool(np.allclose(one, other, rtol=1e-5, atol=1e-6 * np.abs(one[np.isfinite(one)]).max(initial=0.0),
                            equal_nan=True))


def _join_components(path: str, key: str, pieces: dict[Any, np.ndarray]) -> np.ndarray:
    """Returns components (n,) by indices, or by their places in a row, as a vector (n, d) or tensor (n, d, d); a stress
    needs one of xy and yx."""
    if all(isinstance(where, int) for where in pieces):
        if len({len(values) for values in pieces.values()}) == 1 and sorted(pieces) == list(range(len(pieces))):
            return _reshape_array(path, key, key, np.stack([pieces[k] for k in range(len(pieces))], axis=1))
        raise FileError(path, "has {n} numbered components of {key}, with others missing; give all of them or none",
                        len(pieces), key)
    if any(isinstance(where, int) for where in pieces):
        raise FileError(path, "has {key} as a whole and in components; give one of the two", key)
    size = 1 + max(max(where) for where in pieces)
    n = len(next(iter(pieces.values())))
    out, rows = np.full((n, size) if key in VECTORS else (n, size, size), np.nan), cast(Any, (slice(None),))
    for where, values in pieces.items():
        if values.shape != (n,):
            raise FileError(path, "has components of {key} of several lengths; give a number for each particle", key)
        out[rows + where] = values
        if key == "sigma" and where[::-1] not in pieces:
            out[rows + where[::-1]] = values
    shape = out.shape[1:]
    missing = [w for w in np.ndindex(*shape) if w not in pieces and not (key == "sigma" and w[::-1] in pieces)]
    if size == 3:  # what concerns the third direction is not needed in the plane, or the second in that of x and z
        beyond = 1 if all(1 in w for w in missing) else 2
        missing = [w for w in missing if beyond not in w]
        out = np.where(np.isnan(out), 0.0, out) if not missing and all(np.isfinite(v).all() for v in pieces.values()) \
            else out
    if missing:
        letters = "".join(LETTERS[k] for k in missing[0])
        raise FileError(path, "has some components of {key} but not {letters}; give all of them or none",
                        {"x": Message("position"), "X": Message("material position")}.get(key, key), letters)
    return out


def table_from_arrays(path: str, arrays: Mapping[str, np.ndarray], limits: SizeLimits = LIMITS) -> RawTable:
    """Returns the table of named arrays of one time or several, as in a .npz; ``path`` is its name in messages."""
    limits.check_columns(path, len(arrays))
    for name in arrays:
        check_name(path, name)
    meanings = find_meanings(arrays)
    for name in meanings:
        if arrays[name].dtype.kind not in "iuf":
            raise FileError(path, "has no numbers in {name}; give numbers, real and not objects or texts", quote(name))
    scalars = {name: array.item() for name, array in arrays.items() if array.size == 1 and array.dtype.kind in "iuf"}
    cells = scalars.get("cells")
    times = next((arrays[name] for name, meaning in meanings.items() if meaning.key == "t"), None)
    many = {name: array for name, array in arrays.items() if name not in meanings or array.ndim > 0}
    place = next((array for name, array in many.items() if name in meanings and meanings[name].key == "x"), None)
    # Positions of T times are (T, P) or (T, P, D), those of one table (n,) or (n, D).
    stacked = place is not None and (place.ndim == 3 or (place.ndim == 2 and place.shape[1] > 3))
    line = arrays["scene"].item() if "scene" in arrays and arrays["scene"].size == 1 else None
    if times is None or times.ndim == 0 or not stacked:
        time = None if times is None or times.ndim else float(times)
        return add_scene(build_table(path, many, time, check_cell_count(path, cells), limits), line)
    rows = _flatten_times(path, many, times, {name: meanings[name].key for name in many if name in meanings}, limits)
    return add_scene(build_table(path, rows, None, check_cell_count(path, cells), limits), line)


def add_scene(raw: RawTable, line: object) -> RawTable:
    """Returns the table with the scene, cells and time step of a metadata line; unchanged if it is no scene."""
    found = parse_scene_line(raw.file, line, raw.cells)
    return raw if found is None else \
        replace(raw, metadata=found, cells=found.inputs.get("cells", raw.cells), step=found.step)


def _flatten_times(path: str, many: dict[str, np.ndarray], times: np.ndarray, keys: Mapping[str, str],
                   limits: SizeLimits) -> dict[str, np.ndarray]:
    """Returns arrays (T, P, ...) by name as rows (T P, ...), time by time; constant ones (P, ...) are repeated. The
    quantities of the known ones are in ``keys``; others are as they were."""
    T = len(times)
    place = next(many[name] for name, key in keys.items() if key == "x")
    P = place.shape[1] if place.ndim > 1 else 0
    if len(place) != T or P == 0:
        raise FileError(path, "has {t} times and positions of the shape {shape}; give positions of the shape (times, "
                        "particles, dimensions)", T, place.shape)
    limits.check_times(path, T)
    limits.check_rows(path, T * P)
    shapes = (many[name].shape[2 if many[name].shape[:2] == (T, P) else 1:] for name in keys)  # in a row
    limits.check_numbers(path, T * P, sum(int(np.prod(shape, dtype=object)) for shape in shapes))
    rows = dict(many)
    for name, key in keys.items():
        array = many[name]
        if key == "t":
            rows[name] = np.repeat(array, P)
        elif array.shape[:2] == (T, P):
            rows[name] = array.reshape(T * P, *array.shape[2:])
        elif len(array) == P and key in ("id", "row", "X", "mass", "volume"):
            rows[name] = np.tile(array, (T,) + (1,) * (array.ndim - 1))
        else:
            raise FileError(path, "has {name} of the shape {shape} beside {t} times of {p} particles; give ({t}, {p}, "
                            "...)", quote(name), array.shape, T, P)
    return rows


def check_cell_count(path: str, value: float | None) -> int | None:
    """Returns a file's number of cells as an int, or None. Raises FileError if it is not whole."""
    if value is not None and not float(value).is_integer():
        raise FileError(path, "states {value} cells; give a whole number", value)
    return None if value is None else int(value)
