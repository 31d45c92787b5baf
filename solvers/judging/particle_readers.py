"""Readers of files of particles by any code: CSV, NPZ, and VTK, VTU and VTP; or the same as arrays."""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from solvers.judging.column_names import build_table, check_cell_count, table_from_arrays
from solvers.judging.particle_data_types import RawTable
from solvers.judging.quantity_names import is_known_name
from solvers.judging.text_reader import TextReader
from solvers.judging.vtk_common import NotVTK, PointData
from solvers.judging.vtk_legacy import LegacyReader
from solvers.judging.vtk_xml import XmlReader
from solvers.scene.validation import SceneError
from solvers.translatable_message import Message
from solvers.untrusted.npz_reader import read_arrays
from solvers.untrusted.quoting import FileError, quote
from solvers.untrusted.size_limits import LIMITS, SizeLimits

TEXTS = (".csv", ".txt", ".dat", ".tsv")
KINDS = (*TEXTS, ".npz", ".vtk", ".vtu", ".vtp")
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
        if kind in TEXTS:
            with open(path, "rb") as file:
                return TextReader(path, file, limits).read()
        return read_vtk(path, limits)
    except (OSError, ValueError) as error:
        if isinstance(error, FileError):
            raise
        if isinstance(error, OSError) or "\0" in path:
            why = quote((getattr(error, "strerror", None) or str(error)).lower())
            raise FileError(path, "cannot be read: {why}; give a file that exists and may be read", why) from None
        raise


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
