"""Files of particles, as any code may write them: CSV, NPZ, and VTK, VTU and VTP through meshio."""

import os
import re
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from solvers.judging.columns import gathered, meaning
from solvers.judging.frames import FileError, Raw
from solvers.judging.said import read_line

KINDS = (".csv", ".npz", ".vtk", ".vtu", ".vtp")
MOST_BYTES = 2_000_000_000  # of a file, unpacked
COMMENT = re.compile(r"#\s*([A-Za-z]\w*)\s*[=:]\s*(\S+)\s*$")


def read(path: str, most: int = MOST_BYTES) -> Raw:
    """Read a file of particles.

    Parameters
    ----------
    path
        .csv, .npz, .vtk, .vtu or .vtp; names of columns as in ``solvers.judging.columns``.
    most
        Bytes that it may have, packed and unpacked.

    Raises
    ------
    FileError
        Where it holds no particles that can be judged.
    """
    kind = Path(path).suffix.lower()
    if kind not in KINDS:
        raise FileError(path, f"is of no kind that is known; give a file that ends in {', '.join(KINDS)}")
    try:
        size = os.stat(path).st_size
        if not os.path.isfile(path):
            raise FileError(path, f"is not a file; give files that end in {', '.join(KINDS)}")
        if size == 0:
            raise FileError(path, "is empty; give a file with particles in it")
        if size > most:
            raise FileError(path, f"has {size / 1e9:.2g} GB; give at most {most / 1e9:g} GB, fewer times for example")
        if kind == ".npz":
            return read_npz(path, most)
        if kind == ".csv":
            return read_csv(path)
        from solvers.judging.vtk import read_vtk  # here: meshio is needed for these kinds alone
        return read_vtk(path)
    except OSError as error:
        raise FileError(path, f"cannot be read: {(error.strerror or str(error)).lower()}; give a file that exists and "
                              "may be read") from None


def read_csv(path: str) -> Raw:
    """Names in the first line, a particle a line, commas, semicolons, tabs or spaces between; lines such as
    ``# t = 0.1`` or ``# cells = 40`` say what holds for all, ``# scene = ...`` the scene (``solvers.judging.said``)."""
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise FileError(path, "is no text; a .csv file has names in its first line and a particle in each "
                              "other") from None
    lines = text.splitlines()
    said = {found[1].lower(): found[2] for line in lines if (found := COMMENT.match(line))}
    rows = [line for line in lines if line.strip() and not line.lstrip().startswith("#")]
    if len(rows) < 2:
        raise FileError(path, "holds no particles; give names in the first line and a particle in each other")
    mark = next((mark for mark in ",;\t" if mark in rows[0]), None)
    names = [name.strip().strip('"') for name in rows[0].split(mark)]
    if all(_is_number(name) for name in names):
        raise FileError(path, "has no names in its first line; begin with a line such as id,x,vx")
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise FileError(path, f"has two columns called {twice}; give each its own name")
    try:
        values = np.loadtxt(rows[1:], delimiter=mark, ndmin=2, dtype=float)
    except ValueError as error:
        reason = str(error).replace("\n", " ")
        raise FileError(path, f"has a line that is no row of {len(names)} numbers ({reason}); give a number in every "
                              "column of every line") from None
    if values.shape[1] != len(names):
        raise FileError(path, f"has {len(names)} names and {values.shape[1]} numbers in a line; give as many of both")
    columns = {name: values[:, k] for k, name in enumerate(names)}
    raw = gathered(path, columns, _number(path, said, "t", "time"), _whole(path, _number(path, said, "cells")))
    return _with_scene(raw, said.get("scene"))


def read_npz(path: str, most: int = MOST_BYTES) -> Raw:
    """Arrays of (P, ...) at one time, or of (T, P, ...) at the T times in ``t``; ``cells`` may say the grid, ``scene``
    the scene (``solvers.judging.said``)."""
    try:
        with zipfile.ZipFile(path) as packed:
            size = sum(member.file_size for member in packed.infolist())
        if size > most:
            raise FileError(path, f"unpacks to {size / 1e9:.2g} GB; give at most {most / 1e9:g} GB")
        with np.load(path, allow_pickle=False) as packed:
            arrays = {name: packed[name] for name in packed.files}
    except FileError:
        raise
    except (zipfile.BadZipFile, ValueError, EOFError, KeyError, NotImplementedError, zlib.error) as error:
        raise FileError(path, f"is no .npz of plain numbers ({type(error).__name__}); write it with "
                              "numpy.savez") from None
    return from_arrays(path, arrays)


def from_arrays(path: str, arrays: Mapping[str, np.ndarray]) -> Raw:
    """The table of named arrays, as they stand in a .npz; ``path`` is what messages call it."""
    for name, array in arrays.items():
        if meaning(name) and array.dtype.kind not in "iuf":
            raise FileError(path, f"has no numbers in {name}; give numbers, real and not objects or texts")
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
        return _with_scene(gathered(path, many, time, _whole(path, cells)), line)
    return _with_scene(gathered(path, _unstacked(path, many, times), None, _whole(path, cells)), line)


def _with_scene(raw: Raw, line: object) -> Raw:
    """The file with what it says of its scene."""
    said = read_line(raw.file, line, raw.cells)
    return raw if said is None else replace(raw, said=said, cells=said.inputs.get("cells", raw.cells))


def _unstacked(path: str, many: dict[str, np.ndarray], times: np.ndarray) -> dict[str, np.ndarray]:
    """Arrays (T, P, ...) as rows, one for every time and particle; what is known once for all, ids and material
    positions, is repeated."""
    T = len(times)
    place = next(array for name, array in many.items() if _key(name) == "x")
    P = place.shape[1] if place.ndim > 1 else 0
    if len(place) != T or P == 0:
        raise FileError(path, f"has {T} times and positions of the shape {place.shape}; give positions of the shape "
                              "(times, particles, dimensions)")
    rows: dict[str, np.ndarray] = {}
    for name, array in many.items():
        if _key(name) == "t":
            rows[name] = np.repeat(array, P)
        elif array.shape[:2] == (T, P):
            rows[name] = array.reshape(T * P, *array.shape[2:])
        elif len(array) == P and _key(name) in ("id", "X"):
            rows[name] = np.tile(array, (T,) + (1,) * (array.ndim - 1))
        else:
            raise FileError(path, f"has {name} of the shape {array.shape} beside {T} times of {P} particles; give "
                                  f"({T}, {P}, ...)")
    return rows


def _key(name: str) -> str:
    return (meaning(name) or ("",))[0]


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _number(path: str, said: dict[str, str], *names: str) -> float | None:
    """What a comment says of the time or the cells; None where it says nothing."""
    text = next((said[name] for name in names if name in said), None)
    if text is not None and not _is_number(text):
        raise FileError(path, f"says {names[0]} = {text}; give a number")
    return None if text is None else float(text)


def _whole(path: str, value: float | None) -> int | None:
    if value is not None and not float(value).is_integer():
        raise FileError(path, f"says that it has {value} cells; give a whole number")
    return None if value is None else int(value)
