"""Reader of VTK's legacy format, .vtk, of points: sections, each with a line that gives its size, as text or binary."""

import re
from collections.abc import Sequence
from typing import IO
from urllib.parse import unquote

import numpy as np

from solvers.judging.vtk_common import POINTS, NotVTK, PointData
from solvers.untrusted.quoting import quote

LONGEST_LINE = 1000
MOST_SECTIONS = 10_000
DATASETS = ("UNSTRUCTURED_GRID", "POLYDATA")  # others lay their points out by rules, and are no particles
TYPES = {"unsigned_char": "u1", "char": "i1", "unsigned_short": "u2", "short": "i2", "unsigned_int": "u4", "int": "i4",
         "unsigned_long": "u8", "long": "i8", "float": "f4", "double": "f8", "vtkidtype": "i8", "vtktypeint64": "i8",
         "vtktypeuint64": "u8", "vtktypeint32": "i4", "vtktypeuint32": "u4", "vtktypefloat32": "f4",
         "vtktypefloat64": "f8"}
#: Sections of an array of the data of points or cells: how many numbers there are of each, or which word says it.
WIDTHS = {"VECTORS": 3, "NORMALS": 3, "TENSORS": 9, "TENSORS6": 6, "GLOBAL_IDS": 1, "PEDIGREE_IDS": 1}
CELLS = ("CELLS", "VERTICES", "LINES", "POLYGONS", "TRIANGLE_STRIPS")


class LegacyReader:
    """Reader that adds the points and arrays of an open .vtk file to ``data``."""

    def __init__(self, file: IO[bytes], data: PointData):
        self._file, self._data = file, data
        self._size = file.seek(0, 2)
        file.seek(0)
        self._binary, self._old = False, True
        self._rows, self._of_points = 0, False  # of the data that come, and whether they are of points
        self._before_data = True

    def read(self) -> None:
        self._read_header()
        for _ in range(MOST_SECTIONS):
            if not (line := self._read_line()):
                return
            if words := line.split():
                self._read_section(words[0].upper(), words[1:])
        raise NotVTK(f"more than {MOST_SECTIONS:,} sections")

    def _read_line(self) -> str:
        line = self._file.readline(LONGEST_LINE)
        if len(line) >= LONGEST_LINE:
            raise NotVTK(f"a line of more than {LONGEST_LINE} letters where a section should begin")
        return line.decode("utf-8", "replace")

    def _read_header(self) -> None:
        first, _, form, dataset = (self._read_line() for _ in range(4))
        version = re.match(r"#\s*vtk DataFile Version\s+([0-9])\.([0-9])", first, re.IGNORECASE)
        if not version or form.strip().upper() not in ("ASCII", "BINARY"):
            raise NotVTK("not the first lines of a .vtk file")
        self._old = (int(version[1]), int(version[2])) < (5, 0)
        self._binary = form.strip().upper() == "BINARY"
        while not dataset.strip() and dataset:
            dataset = self._read_line()
        word, _, kind = dataset.strip().upper().partition(" ")
        if word != "DATASET" or kind.strip() not in DATASETS:
            raise NotVTK(f"{quote(dataset.strip(), 40)}, and {' or '.join(DATASETS)} can be read")

    def _read_section(self, name: str, words: Sequence[str]) -> None:
        if name == "METADATA":
            while self._read_line().strip():
                pass
        elif name == POINTS.upper():
            rows = _parse_count(words, 0)
            self._data.begin_piece(rows)
            self._read_array(POINTS, words[1:2], rows, 3, self._data.wants(POINTS, rows, 3))
        elif name in CELLS:
            self._skip_cells(words)
        elif name == "CELL_TYPES":
            self._read_numbers("i4", _parse_count(words, 0), False)
        elif name in ("POINT_DATA", "CELL_DATA"):
            self._rows, self._of_points, self._before_data = _parse_count(words, 0), name == "POINT_DATA", False
        elif name == "FIELD":
            self._read_fields(_parse_count(words, 1))
        elif name == "LOOKUP_TABLE":
            self._read_numbers("u1" if self._binary else "f8", 4 * _parse_count(words, 1), False)
        elif name == "COLOR_SCALARS":
            self._read_numbers("u1" if self._binary else "f8", _parse_count(words, 1) * self._rows, False)
        else:
            self._read_attribute(name, words)

    def _read_attribute(self, name: str, words: Sequence[str]) -> None:
        """Reads an array of the data of points or cells: the section ``name``, whose line goes on with ``words``."""
        if len(words) < 2 or name not in (*WIDTHS, "SCALARS", "TEXTURE_COORDINATES"):
            raise NotVTK(f"the section {quote(name, 40)}")
        kind = words[2:3] if name == "TEXTURE_COORDINATES" else words[1:2]
        width = WIDTHS.get(name) or (_parse_count(words, 1) if name == "TEXTURE_COORDINATES"
                                     else _parse_count(words, 2) if len(words) > 2 else 1)
        if name == "SCALARS":
            here = self._file.tell()
            if not self._read_line().upper().startswith("LOOKUP_TABLE"):
                self._file.seek(here)
        self._read_array(unquote(words[0]), kind, self._rows, width, self._wants(unquote(words[0]), self._rows, width))

    def _wants(self, name: str, rows: int, width: int) -> bool:
        """Returns whether an array of the data of points or cells is needed; one of cells is not."""
        if not self._of_points:
            self._data.skip(name)
        return self._of_points and self._data.wants(name, rows, width)

    def _read_fields(self, count: int) -> None:
        for _ in range(min(count, MOST_SECTIONS)):
            words = self._read_line().split()
            while words[:1] == ["METADATA"] or not words:
                while words and self._read_line().strip():
                    pass
                if not (line := self._read_line()):
                    raise NotVTK("fields that end too early")
                words = line.split()
            if len(words) != 4:
                raise NotVTK("a field without its name, sizes and type")
            name, width, rows = unquote(words[0]), _parse_count(words, 1), _parse_count(words, 2)
            if self._before_data:
                wants = self._data.wants_field_data(name, width * rows)
                if (values := self._read_numbers(_parse_type(words[3:]), width * rows, wants)) is not None:
                    self._data.fields[name] = values
            else:
                self._read_array(name, words[3:], rows, width, self._wants(name, rows, width))

    def _read_array(self, name: str, kind: Sequence[str], rows: int, width: int, wants: bool) -> None:
        if (values := self._read_numbers(_parse_type(kind), rows * width, wants)) is not None:
            self._data.add_array(name, values, width)

    def _skip_cells(self, words: Sequence[str]) -> None:
        """Skips cells, which are not needed: their sizes, and the indices of their points."""
        if self._old:
            self._read_numbers("i4", _parse_count(words, 1), False)
            return
        for name, size in (("OFFSETS", _parse_count(words, 0)), ("CONNECTIVITY", _parse_count(words, 1))):
            head = self._read_line().split() or self._read_line().split()
            if head[:1] != [name]:
                raise NotVTK(f"cells without {name}")
            self._read_numbers(_parse_type(head[1:]), size, False)

    def _read_numbers(self, kind: str, count: int, wants: bool) -> np.ndarray | None:
        """Reads ``count`` numbers of a numpy type; None unless ``wants``. Raises NotVTK for more than are there."""
        size = count * np.dtype(kind).itemsize if self._binary else 2 * count - 1
        here = self._file.tell()
        if size > self._size - here:
            raise NotVTK(f"{count:,} numbers announced in {self._size - here:,} bytes" if count < 10**12
                         else "more numbers announced than there are bytes")
        if self._binary:
            if not wants:
                self._file.seek(size, 1)
                return None
            return np.frombuffer(self._file.read(size), np.dtype(f">{kind}"))
        values = np.fromfile(self._file, dtype=float, sep=" ", count=count) if count else np.empty(0)
        if len(values) != count:
            raise NotVTK(f"{len(values):,} numbers where {count:,} are announced")
        return values if wants else None


def _parse_count(words: Sequence[str], which: int) -> int:
    if which >= len(words) or not re.fullmatch(r"[0-9]{1,15}", words[which]):
        raise NotVTK("a section that does not say its size")
    return int(words[which])


def _parse_type(words: Sequence[str]) -> str:
    if not words or words[0].lower() not in TYPES:
        raise NotVTK(f"numbers of the type {quote(' '.join(words), 20)}")
    return TYPES[words[0].lower()]
