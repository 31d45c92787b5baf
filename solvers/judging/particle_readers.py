"""Readers of files of particles by any code: CSV, NPZ, and VTK, VTU and VTP; or the same as arrays."""

import itertools
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, TextIO

import numpy as np

from solvers.judging.column_names import add_scene, build_table, check_cell_count, is_known_name, table_from_arrays
from solvers.judging.particle_data_types import RawTable
from solvers.judging.vtk_common import NotVTK, PointData
from solvers.judging.vtk_legacy import LegacyReader
from solvers.judging.vtk_xml import XmlReader
from solvers.scene.validation import SceneError
from solvers.translatable_message import Message
from solvers.untrusted import number_parsing
from solvers.untrusted.npz_reader import read_arrays
from solvers.untrusted.quoting import FileError, quote
from solvers.untrusted.size_limits import LIMITS, LONGEST_LINE, SizeLimits, check_name

KINDS = (".csv", ".npz", ".vtk", ".vtu", ".vtp")
COMMENT = re.compile(r"#\s*([A-Za-z]\w*)\s*[=:]\s*(\S+)\s*$")
COMMENT_KEYS = ("t", "time", "cells", "scene")
MOST_REMARKS = 100_000  # lines that are no rows
LARGEST = 250_000_000  # bytes of a text file, which is in memory together with its numbers
OF_KIND = {".vtu": "UnstructuredGrid", ".vtp": "PolyData"}
TIMES = ("TimeValue", "TIME", "Time", "time", "t")

Particles = str | os.PathLike | Mapping[str, Any] | RawTable  # what they may be given as


def as_list(files: Particles | Sequence[Particles]) -> list[Particles]:
    """Returns one or several files as a list. Raises :class:`SceneError` for none."""
    sources = [files] if isinstance(files, (str, os.PathLike, Mapping, RawTable)) else list(files)
    if not sources:
        raise SceneError("files", "none", "give one or several files of particles, or their arrays")
    return sources


def read_all(files: Particles | Sequence[Particles]) -> list[RawTable]:
    """Returns the tables of the files or arrays. Raises :class:`FileError` beyond the limits for all together."""
    left, found = LIMITS, list[RawTable]()
    for k, source in enumerate(as_list(files)):
        if isinstance(source, Mapping):
            name = Message("arrays {k}", k + 1)
            try:
                raw = table_from_arrays(name, {key: np.asarray(array) for key, array in source.items()}, left)
            except ValueError as error:
                raise error if isinstance(error, FileError) else \
                    FileError(name, "are no arrays: {error}", error) from None
        else:
            raw = source if isinstance(source, RawTable) else read_file(os.fspath(source), left)
        found.append(raw)
        left = left.remaining_after(found[-1].columns)
    return found


def read_file(path: str, limits: SizeLimits = LIMITS) -> RawTable:
    """Returns the table of a file of particles: .csv, .npz, .vtk, .vtu or .vtp, with names of columns as in
    ``solvers.judging.column_names``. Raises :class:`FileError` where it contains no particles that can be judged, or
    more than the ``limits`` allow."""
    kind = Path(path).suffix.lower()
    if kind not in KINDS:
        raise FileError(path, "is of no kind that is known; give a file that ends in {kinds}", ", ".join(KINDS))
    try:
        size = os.stat(path).st_size
        if not os.path.isfile(path):
            raise FileError(path, "is not a file; give files that end in {kinds}", ", ".join(KINDS))
        if size == 0:
            raise FileError(path, "is empty; give a file with particles in it")
        limits.check_bytes(path, size)
        if kind == ".npz":
            return table_from_arrays(path, read_arrays(path, is_known_name, limits), limits)
        return read_csv(path, limits) if kind == ".csv" else read_vtk(path, limits)
    except (OSError, ValueError) as error:
        if isinstance(error, FileError):
            raise
        if isinstance(error, OSError) or "\0" in path:
            why = quote((getattr(error, "strerror", None) or str(error)).lower())
            raise FileError(path, "cannot be read: {why}; give a file that exists and may be read", why) from None
        raise


def read_csv(path: str, limits: SizeLimits = LIMITS) -> RawTable:
    """Returns the table of a CSV file: names in the first line, one particle per line, separated by commas, semicolons,
    tabs or spaces; lines such as ``# t = 0.1`` or ``# cells = 40`` apply to all particles, ``# scene = ...`` has the
    scene (``solvers.judging.scene_metadata``)."""
    comments: dict[str, str] = {}
    try:
        with open(path, encoding="utf-8-sig") as text:
            rows = _particle_lines(path, text, comments, limits)
            head, first = next(rows, ""), next(rows, None)
            if first is None:
                raise FileError(path, "holds no particles; give names in the first line and a particle in each other")
            mark = next((mark for mark in ",;\t" if mark in head), None)
            names = _parse_header(path, head, mark, limits)
            width = _count_columns(first, mark)  # the first line says how many are read of all others
            if width != len(names):
                raise FileError(path, "has {names} names and {width} numbers in a line; give as many of both",
                                len(names), width)
            counted = _limit_rows(path, itertools.chain([first], rows), width, limits)
            values = np.loadtxt(counted, delimiter=mark, ndmin=2, dtype=float)
    except UnicodeDecodeError:
        raise FileError(path, "is no text; a .csv file has names in its first line and a particle in each "
                              "other") from None
    except ValueError as error:
        if isinstance(error, FileError):
            raise
        raise FileError(path, "has a line that is no row of {names} numbers ({error}); give a number in every column "
                        "of every line", len(names), quote(error, 100)) from None
    columns = {name: values[:, k] for k, name in enumerate(names)}
    time, cells = _comment_number(path, comments, "t", "time"), _comment_number(path, comments, "cells")
    return add_scene(build_table(path, columns, time, check_cell_count(path, cells), limits), comments.get("scene"))


def _particle_lines(path: str, text: TextIO, comments: dict[str, str], limits: SizeLimits) -> Iterator[str]:
    """Yields the lines of names or numbers; adds values in comments to ``comments``, the last of each name."""
    remarks = 0
    while line := text.readline(LONGEST_LINE):
        if len(line) >= LONGEST_LINE:
            raise FileError(path, "has a line of more than {n:,} letters; give a line for each particle", LONGEST_LINE)
        if (bare := line.strip()) and not bare.startswith("#"):
            yield line
            continue
        if (remarks := remarks + 1) > MOST_REMARKS:
            raise FileError(path, "has more than {most:,} lines that are no particles; leave them out", MOST_REMARKS)
        if (found := COMMENT.match(line)) and found[1].lower() in COMMENT_KEYS:
            comments[found[1].lower()] = found[2]


def _count_columns(line: str, mark: str | None) -> int:
    bare = line.partition("#")[0]
    return bare.count(mark) + 1 if mark else len(bare.split())


def _parse_header(path: str, head: str, mark: str | None, limits: SizeLimits) -> list[str]:
    limits.check_columns(path, _count_columns(head, mark))
    names = [name.strip().strip('"') for name in head.split(mark)]
    if all(map(number_parsing.is_number, names)):
        raise FileError(path, "has no names in its first line; begin with a line such as id,x,vx")
    for name in names:
        check_name(path, name)
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise FileError(path, "has two columns called {twice}; give each its own name", quote(twice))
    return names


def _limit_rows(path: str, rows: Iterator[str], width: int, limits: SizeLimits) -> Iterator[str]:
    """Yields the rows, of ``width`` numbers each, and raises FileError where there are too many."""
    most = min(limits.rows, limits.numbers // width)
    for count, row in enumerate(rows, 1):
        if count > most:
            limits.check_rows(path, count)
            limits.check_numbers(path, count, width)
        yield row


def _comment_number(path: str, comments: dict[str, str], *names: str) -> float | None:
    """Returns the number that comments give for the first known of ``names``, such as t in s; None without one."""
    text = next((comments[name] for name in names if name in comments), None)
    if text is not None and not number_parsing.is_number(text):
        raise FileError(path, "has {names} = {text}; give a number", names[0], quote(text))
    return None if text is None else number_parsing.parse_float(text)


def read_vtk(path: str, limits: SizeLimits = LIMITS) -> RawTable:
    """Returns a VTK file's table: points are positions, point data the rest; time may be field data (``TimeValue``)."""
    kind = Path(path).suffix.lower()
    with open(path, "rb") as file:
        if (size := file.seek(0, 2)) > LARGEST:
            raise FileError(path, "has {size:,.0f} MB; give at most {most:,.0f} MB of this kind, with fewer data for "
                            "example, or a .npz", size / 1e6, LARGEST / 1e6)
        file.seek(0)
        found = PointData(path, limits)
        try:
            (LegacyReader(file, found) if kind == ".vtk" else XmlReader(file, OF_KIND[kind], kind, found)).read()
        except (FileError, OSError):
            raise
        except Exception as error:  # what a broken file makes of a parser
            why = str(error) if isinstance(error, NotVTK) else type(error).__name__
            raise FileError(path, "cannot be read as {kind} ({why}); write points with data, in text or binary", kind,
                            why) from None
    fields = found.fields
    time, cells = (next((float(fields[name][0]) for name in names if len(fields.get(name, ()))), None)
                   for names in (TIMES, ("cells",)))
    return build_table(path, found.concatenated_arrays(), time, check_cell_count(path, cells), limits)
