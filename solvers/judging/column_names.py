"""Names of columns and arrays of particles, their meaning, and the assembly of components.

A quantity has one key here: ``t``, ``id``, ``X`` (material position), ``x`` (position), ``v``, ``F``, ``sigma``,
``mass`` and ``volume``. A file has it as an array or as one column for each component.
"""

import itertools
import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, cast

import numpy as np

from solvers.judging.particle_data_types import RawTable
from solvers.judging.scene_metadata import parse_scene_line
from solvers.translatable_message import Message, join_messages
from solvers.untrusted.quoting import FileError, quote
from solvers.untrusted.size_limits import LIMITS, SizeLimits, check_name

#: What else each quantity may be called. X and x, which differ only in size, are the only names whose size counts.
NAMES = {"t": ("t", "time", "timevalue"), "id": ("id", "ids", "particle_id", "particle", "pid", "global_id"),
         "X": ("X", "X0", "x0", "material_position", "initial_position", "reference_position"),
         "x": ("x", "position", "positions", "points", "coordinates", "coords"), "v": ("v", "velocity", "velocities"),
         "F": ("f", "deformation_gradient", "defgrad"), "sigma": ("sigma", "stress", "cauchy_stress", "s"),
         "mass": ("mass", "masses", "particle_mass"), "volume": ("volume", "volumes", "particle_volume")}
LETTERS = "xyz"
SCALARS, VECTORS, TENSORS = ("t", "id", "mass", "volume"), ("X", "x", "v"), ("F", "sigma")
SEPARATORS = ("", "_", ":", ".", "-")


def _known_column_names() -> dict[str, tuple[str, tuple[int, ...]]]:
    """Returns by column name its quantity and component: ``("v", (0,))`` for ``vx``."""
    found: dict[str, tuple[str, tuple[int, ...]]] = {}
    for key, names in NAMES.items():
        for name, separator in itertools.product(names, SEPARATORS):
            if key in VECTORS and name not in ("x", "X"):
                found |= {f"{name}{separator}{mark}": (key, (k,)) for k in range(3) for mark in (LETTERS[k], str(k))}
            if key in TENSORS:
                pairs = list(itertools.product(range(3), range(3)))
                found |= {f"{name}{separator}{LETTERS[i]}{LETTERS[j]}": (key, (i, j)) for i, j in pairs}
                found |= {f"{name}{separator}{i}{j}": (key, (i, j)) for i, j in pairs}
    for key, letters in (("X", "XYZ"), ("x", LETTERS)):
        found |= {letter: (key, (k,)) for k, letter in enumerate(letters)}
    return found


COMPONENTS = _known_column_names()
WHOLE = {name: (key, None) for key, names in NAMES.items() for name in names}


def parse_name(name: str) -> tuple[str, tuple[int, ...] | None] | None:
    """Returns the quantity of a column or an array, and the indices of its component, None for a whole quantity; None
    for unknown names. A unit in brackets at the end is ignored."""
    bare = re.sub(r"\s*[\[(][^\])]*[\])]\s*$", "", name.strip().strip('"'))
    tables: tuple[Mapping[str, Any], ...] = (COMPONENTS, WHOLE)
    return next((table[text] for table in tables for text in (bare, bare.lower()) if text in table), None)


def describe_columns(key: str, dimensions: int) -> str:
    """Returns the column names of a quantity in so many ``dimensions``, with commas, for a sentence."""
    names = output_column_names(key, dimensions)
    return ", ".join(name for name in names if name != "syx")  # one of sxy and syx is enough


def output_column_names(key: str, dimensions: int) -> list[str]:
    """Returns the names of the columns that we write for a quantity, in the order of its components."""
    letters = LETTERS[:dimensions]
    if key in VECTORS:
        return [{"X": letter.upper(), "x": letter, "v": f"v{letter}"}[key] for letter in letters]
    return [f"{'s' if key == 'sigma' else 'F'}{i}{j}" for i in letters for j in letters]


def build_table(path: str, named: dict[str, np.ndarray], time: float | None, cells: int | None,
                limits: SizeLimits = LIMITS) -> RawTable:
    """Returns the table of named arrays (n, ...): components are assembled, unknown names left out."""
    known_ones = [array for name, array in named.items() if parse_name(name)]
    limits.check_rows(path, max((len(array) for array in known_ones if array.ndim), default=0))
    limits.check_numbers(path, sum(array.size for array in known_ones))
    columns: dict[str, np.ndarray] = {}
    parts: dict[str, dict[tuple[int, ...], np.ndarray]] = {}
    for name, array in named.items():
        known = parse_name(name)
        if known is None:
            continue
        key, component = known
        values = np.asarray(array, float)
        if name in VECTORS and values.ndim > 1:
            component = None  # a whole vector, called as its first component is
        if component is None and not (values.ndim == 1 and key in VECTORS + TENSORS):
            if key in columns:
                raise FileError(path, "has {key} twice, the second time as {name}; give it once", key, quote(name))
            columns[key] = _reshape_array(path, key, name, values)
        else:
            where = component or ((0,) if key in VECTORS else (0, 0))
            if where in parts.setdefault(key, {}):
                raise FileError(path, "has the same component of {key} twice, the second time as {name}; give it once",
                                key, quote(name))
            parts[key][where] = values
    for key, pieces in parts.items():
        if key in columns:
            raise FileError(path, "has {key} as a whole and in components; give one of the two", key)
        columns[key] = _join_components(path, key, pieces)
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
    if "t" in columns:
        limits.check_times(path, len(np.unique(columns["t"])))
    return RawTable(path, columns, tuple(named), time, cells)


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
        size = {1: 1, 4: 2, 9: 3}.get(values.shape[1] if values.ndim == 2 else 0)
        if size:
            return values.reshape(-1, size, size)
        if values.ndim == 2 and values.shape[1] == 6 and key == "sigma":  # VTK's order: xx, yy, zz, xy, yz, xz
            return values[:, [0, 3, 5, 3, 1, 4, 5, 4, 2]].reshape(-1, 3, 3)
    raise FileError(path, "has {name} of the shape {shape}; give a row for each particle, with 1 to 3 numbers of a "
                    "vector, and 1, 4 or 9 of a tensor, row by row", quote(name), values.shape)


def _join_components(path: str, key: str, pieces: dict[tuple[int, ...], np.ndarray]) -> np.ndarray:
    """Returns components (n,) by indices as a vector (n, d) or tensor (n, d, d); a stress needs one of xy and yx."""
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
    if size == 3:  # what concerns the third direction is not needed in the plane
        missing = [w for w in missing if 2 not in w]
        out = np.where(np.isnan(out), 0.0, out) if not missing and all(np.isfinite(v).all() for v in pieces.values()) \
            else out
    if missing:
        letters = "".join("xyz"[k] for k in missing[0])
        raise FileError(path, "has some components of {key} but not {letters}; give all of them or none", key, letters)
    return out


def is_known_name(name: str) -> bool:
    """Returns whether an array of this name is read: particles' quantities, the number of cells, the scene."""
    return bool(parse_name(name)) or name in ("cells", "scene")


def table_from_arrays(path: str, arrays: Mapping[str, np.ndarray], limits: SizeLimits = LIMITS) -> RawTable:
    """Returns the table of named arrays of one time or several, as in a .npz; ``path`` is its name in messages."""
    limits.check_columns(path, len(arrays))
    for name, array in arrays.items():
        check_name(path, name)
        if parse_name(name) and array.dtype.kind not in "iuf":
            raise FileError(path, "has no numbers in {name}; give numbers, real and not objects or texts", quote(name))
    scalars = {name: array.item() for name, array in arrays.items() if array.size == 1 and array.dtype.kind in "iuf"}
    cells = scalars.get("cells")
    times = next((arrays[name] for name in arrays if _quantity_of_column(name) == "t"), None)
    many = {name: array for name, array in arrays.items() if parse_name(name) and array.ndim > 0}
    place = next((array for name, array in many.items() if _quantity_of_column(name) == "x"), None)
    # Positions of T times are (T, P) or (T, P, D), those of one table (n,) or (n, D).
    stacked = place is not None and (place.ndim == 3 or (place.ndim == 2 and place.shape[1] > 3))
    line = arrays["scene"].item() if "scene" in arrays and arrays["scene"].size == 1 else None
    if times is None or times.ndim == 0 or not stacked:
        time = None if times is None or times.ndim else float(times)
        return add_scene(build_table(path, many, time, check_cell_count(path, cells), limits), line)
    rows = _flatten_times(path, many, times, limits)
    return add_scene(build_table(path, rows, None, check_cell_count(path, cells), limits), line)


def add_scene(raw: RawTable, line: object) -> RawTable:
    """Returns the table with the scene, cells and time step of a metadata line; unchanged if it is no scene."""
    found = parse_scene_line(raw.file, line, raw.cells)
    return raw if found is None else \
        replace(raw, metadata=found, cells=found.inputs.get("cells", raw.cells), step=found.step)


def _flatten_times(path: str, many: dict[str, np.ndarray], times: np.ndarray,
                   limits: SizeLimits) -> dict[str, np.ndarray]:
    """Returns arrays (T, P, ...) by name as rows (T P, ...), time by time; constant ones (P, ...) are repeated."""
    T = len(times)
    place = next(array for name, array in many.items() if _quantity_of_column(name) == "x")
    P = place.shape[1] if place.ndim > 1 else 0
    if len(place) != T or P == 0:
        raise FileError(path, "has {t} times and positions of the shape {shape}; give positions of the shape (times, "
                        "particles, dimensions)", T, place.shape)
    limits.check_times(path, T)
    limits.check_rows(path, T * P)
    shapes = (array.shape[2 if array.shape[:2] == (T, P) else 1:] for array in many.values())  # in a row
    limits.check_numbers(path, T * P, sum(int(np.prod(shape, dtype=object)) for shape in shapes))
    rows: dict[str, np.ndarray] = {}
    for name, array in many.items():
        if _quantity_of_column(name) == "t":
            rows[name] = np.repeat(array, P)
        elif array.shape[:2] == (T, P):
            rows[name] = array.reshape(T * P, *array.shape[2:])
        elif len(array) == P and _quantity_of_column(name) in ("id", "X", "mass", "volume"):
            rows[name] = np.tile(array, (T,) + (1,) * (array.ndim - 1))
        else:
            raise FileError(path, "has {name} of the shape {shape} beside {t} times of {p} particles; give ({t}, {p}, "
                            "...)", quote(name), array.shape, T, P)
    return rows


def _quantity_of_column(name: str) -> str:
    return (parse_name(name) or ("",))[0]


def check_cell_count(path: str, value: float | None) -> int | None:
    """Returns a file's number of cells as an int, or None. Raises FileError if it is not whole."""
    if value is not None and not float(value).is_integer():
        raise FileError(path, "states {value} cells; give a whole number", value)
    return None if value is None else int(value)
