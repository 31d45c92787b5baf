"""Readers of files of particles by any code: text, NPZ, HDF5 and those of VTK; or the same as arrays."""

import gzip
import os
import tempfile
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import IO, Any, TypeVar

import numpy as np

from solvers.judging.column_names import build_table, check_cell_count, table_from_arrays
from solvers.judging.hdf5_reader import read_hdf5
from solvers.judging.particle_data_types import RawTable
from solvers.judging.quantity_names import is_known_name, parse_name
from solvers.judging.text_reader import TextReader
from solvers.judging.vtk_common import NotVTK, PointData
from solvers.judging.vtk_legacy import LegacyReader
from solvers.judging.vtk_references import read_references
from solvers.judging.vtk_xml import XmlReader
from solvers.scene.validation import SceneError
from solvers.translatable_message import Message
from solvers.untrusted.npz_reader import read_arrays
from solvers.untrusted.quoting import FileError
from solvers.untrusted.size_limits import LIMITS, SizeLimits

TEXTS = (".csv", ".txt", ".dat", ".tsv")
VTKS = {".vtk": "", ".vtu": "UnstructuredGrid", ".vtp": "PolyData"}  # with the type of an XML file
PARALLEL, HDF5, PACKED = {".pvtu": ".vtu", ".pvtp": ".vtp"}, (".h5", ".hdf5"), ".gz"
UPLOADED = (*TEXTS, ".npz", *VTKS)  # kinds of one file that needs no others; texts and VTK's may be packed
KINDS = (*UPLOADED, PACKED, ".pvd", *PARALLEL, *HDF5)
LARGEST, PIECE = 250_000_000, 1 << 20  # bytes of a file of VTK's, in memory with its numbers, and of what is unpacked
Read = TypeVar("Read")

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
                tables = [table_from_arrays(name, {key: np.asarray(array) for key, array in source.items()}, left)]
            except ValueError as error:
                raise error if isinstance(error, FileError) else \
                    FileError(name, "are no arrays: {error}", error) from None
        else:
            tables = [source] if isinstance(source, RawTable) else read_files(os.fspath(source), left)
        found += tables
        for raw in tables:
            left = left.remaining_after(raw.columns)
    return found


def check_one_table_each(sources: Sequence[Particles], tables: Sequence[RawTable], given: Sequence[float]) -> None:
    """Raises FileError where numbers are ``given`` for each of the sources and one of these names several files."""
    if given and len(tables) != len(sources):
        raise FileError(tables[0].file, "is named by a .pvd, with other files; give --time and --cells with one number "
                                        "for each file where no .pvd is among them")


def read_files(path: str, limits: SizeLimits = LIMITS) -> list[RawTable]:
    """Returns the tables of a file as :func:`read_file` does, of a .pvd those of the files that it names, with its
    times where these have none."""
    if kind_of(path) != ".pvd":
        return [read_file(path, limits)]
    named, tables = _read(path, limits, lambda file: _references(path, file, ".pvd")), []
    for name, time in named:
        raw = read_file(name, limits)
        tables.append(replace(raw, time=time) if raw.time is None and "t" not in raw.columns else raw)
        limits = limits.remaining_after(raw.columns)
    return tables


def kind_of(path: str) -> str:
    """Returns the kind of a file by its ending in small letters, with that before .gz."""
    return "".join(Path(path).suffixes[-2 if path.lower().endswith(PACKED) else -1:]).lower()


def read_file(path: str, limits: SizeLimits = LIMITS) -> RawTable:
    """Returns the table of a file of particles, of one of :data:`KINDS`, with names of columns as in
    ``solvers.judging.quantity_names``. Raises :class:`FileError` where it contains no particles that can be judged, or
    more than the ``limits`` allow."""
    kind = kind_of(path)
    bare = kind.removesuffix(PACKED)
    if kind == ".npz":
        return _read(path, limits, lambda _: table_from_arrays(path, read_arrays(path, is_known_name, limits), limits))
    if bare in TEXTS:
        return _read(path, limits, lambda file: TextReader(path, file, limits).read())
    if bare in VTKS or kind in PARALLEL:
        return _read(path, limits, lambda file: _read_vtk(path, file, bare, limits))
    if kind in HDF5:
        return _read(path, limits, lambda _: table_from_arrays(path, read_hdf5(path, limits), limits))
    raise FileError(path, "is of no kind that is known; give a file that ends in {kinds}", ", ".join(KINDS))


def _read(path: str, limits: SizeLimits, read: Callable[[IO[bytes]], Read]) -> Read:
    """Returns what ``read`` makes of the file, which is unpacked before. Raises FileError where it cannot be opened."""
    try:
        size = os.stat(path).st_size
        if not os.path.isfile(path):
            raise FileError(path, "is not a file; give files that end in {kinds}", ", ".join(KINDS))
        if size == 0:
            raise FileError(path, "is empty; give a file with particles in it")
        limits.check_bytes(path, size)
        with open(path, "rb") as file:
            if not path.lower().endswith(PACKED):
                return read(file)
            with tempfile.TemporaryFile() as unpacked:
                _unpack(path, file, unpacked, limits)
                return read(unpacked)
    except (OSError, ValueError) as error:
        if isinstance(error, FileError):
            raise
        if isinstance(error, OSError) or "\0" in path:
            raise FileError.from_os_error(path, error) from None
        raise


def _unpack(path: str, file: IO[bytes], unpacked: IO[bytes], limits: SizeLimits) -> None:
    """Writes the content of a packed file to another one, no more than the limits allow."""
    limits = replace(limits, bytes=min(limits.bytes, LARGEST))
    try:
        with gzip.GzipFile(fileobj=file) as packed:
            while piece := packed.read(PIECE):
                limits.check_unpacked(path, unpacked.tell() + len(piece))
                unpacked.write(piece)
    except (EOFError, zlib.error, gzip.BadGzipFile):
        raise FileError(path, "is no complete .gz file; pack it again, or give it as it is") from None
    unpacked.seek(0)


def _parse(path: str, kind: str, parse: Callable[[], Read]) -> Read:
    """Returns what ``parse`` makes of a file of VTK's. Raises FileError, with the reason, for a broken one."""
    try:
        return parse()
    except (FileError, OSError):
        raise
    except Exception as error:  # what a broken file makes of a parser
        why = str(error) if isinstance(error, NotVTK) else type(error).__name__
        raise FileError(path, "cannot be read as {kind} ({why}); write points with data, in text or binary", kind,
                        why) from None


def _references(path: str, file: IO[bytes], kind: str) -> list[tuple[str, float | None]]:
    return _parse(path, kind, lambda: read_references(path, file, kind))


def _read_vtk(path: str, file: IO[bytes], kind: str, limits: SizeLimits) -> RawTable:
    """Returns a VTK file's table: points are positions, point data the rest; time may be field data (``TimeValue``)."""
    found = PointData(path, limits)
    if kind in PARALLEL:
        for name, _ in _references(path, file, kind):
            _read(name, limits, lambda piece, name=name: _add_points(name, piece, PARALLEL[kind], found))  # type: ignore[misc]
    else:
        _add_points(path, file, kind, found)
    time = next((float(values[0]) for name, values in found.fields.items()
                 if len(values) and (known := parse_name(name)) is not None and known.key == "t"), None)
    cells = found.fields.get("cells", np.empty(0))
    return build_table(path, found.concatenated_arrays(), time,
                       check_cell_count(path, float(cells[0]) if len(cells) else None), limits)


def _add_points(path: str, file: IO[bytes], kind: str, found: PointData) -> None:
    """Adds the points of an open .vtk, .vtu or .vtp file to those ``found``."""
    if (size := file.seek(0, 2)) > LARGEST:
        raise FileError(path, "has {size:,.0f} MB; give at most {most:,.0f} MB of this kind, with fewer data for "
                        "example, or a .npz", size / 1e6, LARGEST / 1e6)
    file.seek(0)
    found.path = path
    _parse(path, kind, (LegacyReader(file, found) if kind == ".vtk" else XmlReader(file, VTKS[kind], kind, found)).read)
