"""VTK's XML formats, .vtu and .vtp, read as they stream in: of what is not asked for nothing is kept.

A document type or an entity is refused where it begins. Where data are appended the reading of XML ends, and each array
is taken from where it says that it lies.
"""

from __future__ import annotations

import re
from typing import IO, Any
from xml.parsers import expat

import numpy as np

from solvers.judging.vtk_data import Encoding, Source
from solvers.judging.vtk_parts import POINTS, NotVTK, Points, from_text
from solvers.outside.file_error import FileError
from solvers.outside.quoting import quoted

PIECE_OF_FILE = 1 << 16
LONGEST_TAG = 1_000_000  # bytes
BLANKS = b" \t\r\n"
MOST_ELEMENTS = 100_000
TYPES = {"Float32": "f4", "Float64": "f8", "Int8": "i1", "Int16": "i2", "Int32": "i4", "Int64": "i8", "UInt8": "u1",
         "UInt16": "u2", "UInt32": "u4", "UInt64": "u8"}
APPENDED = re.compile(rb"[^>]*>\s*_")


def read_xml(file: IO[bytes], kind: str, ending: str, found: Points) -> None:
    """Put what a file of a ``kind``, as VTK calls it, holds into ``found``."""
    _Reader(file, kind, ending, found).read()


class _Appended(Exception):
    """There is no more XML, but data."""


class _Reader:
    def __init__(self, file: IO[bytes], kind: str, ending: str, found: Points):
        self._file, self._kind, self._ending, self._found = file, kind, ending, found
        self._parser = expat.ParserCreate("UTF-8")  # whatever the file says of itself
        self._parser.StartElementHandler, self._parser.EndElementHandler = self._start, self._end
        self._parser.CharacterDataHandler = self._text
        self._parser.buffer_text = True
        self._parser.StartDoctypeDeclHandler = self._parser.EntityDeclHandler = self._refuse_doctype
        self._inside: list[str] = []
        self._elements, self._rows, self._encoding = 0, 0, Encoding.of(None, "u4", None)
        self._array: dict[str, Any] | None = None  # that is being read, of which the text comes
        self._later: list[dict[str, Any]] = []  # arrays whose data are appended
        self._appended: tuple[int, bool] | None = None

    def read(self) -> None:
        fed = 0
        try:
            while piece := self._file.read(PIECE_OF_FILE):
                self._parser.Parse(piece)
                fed += len(piece)
                if fed - self._parser.CurrentByteIndex > LONGEST_TAG:
                    raise NotVTK(f"a tag of more than {LONGEST_TAG:,} letters")
            self._parser.Parse(b"", True)
        except _Appended:
            pass
        except expat.ExpatError as error:
            raise NotVTK(f"no XML in UTF-8: {expat.ErrorString(error.code)}") from None
        if not self._elements or self._inside[:1] not in ([], ["VTKFile"]):
            raise NotVTK("no VTKFile")
        if self._later:
            self._read_appended()

    def _refuse_doctype(self, *_: object) -> None:
        raise FileError(self._found.path, f"has a document type or an entity, which no {self._ending} file needs and "
                                          "which is not read; leave it out")

    def _start(self, tag: str, said: dict[str, str]) -> None:
        self._elements += 1
        if self._elements > MOST_ELEMENTS:
            raise NotVTK(f"more than {MOST_ELEMENTS:,} elements")
        if not self._inside:
            self._begin(tag, said)
        self._inside.append(tag)
        if tag == "AppendedData":
            self._appended = self._parser.CurrentByteIndex, said.get("encoding") != "raw"
            raise _Appended
        if tag == "Piece":
            self._rows = _count(said.get("NumberOfPoints"))
            self._found.begin_piece(self._rows)
        elif tag == "DataArray":
            self._begin_array(said)

    def _begin(self, tag: str, said: dict[str, str]) -> None:
        if tag != "VTKFile":
            raise NotVTK("no VTKFile")
        if said.get("type") != self._kind:
            raise FileError(self._found.path, f"is no {self._kind}, as a {self._ending} file is; give it the ending of "
                                              "what it is")
        self._encoding = Encoding.of(said.get("byte_order"), TYPES.get(said.get("header_type", "UInt32")),
                                     said.get("compressor"))

    def _begin_array(self, said: dict[str, str]) -> None:
        """Ask whether an array is wanted, and remember where its data are."""
        where, name = self._inside[-2], said.get("Name", "")
        width = _count(said.get("NumberOfComponents") or "1")
        if where == "Points":
            name, wants = POINTS, self._found.wants(POINTS, self._rows, width)
        elif where == "PointData":
            wants = self._found.wants(name, self._rows, width)
        elif where == "FieldData":
            width = _count(said.get("NumberOfTuples") or "1") * width
            wants = self._found.wants_field(name, width)
        else:
            return
        if wants:
            if said.get("type") not in TYPES:
                raise NotVTK(f"an array of the type {quoted(said.get('type'), 20)}")
            of_point = where != "FieldData"
            array = {"name": name, "width": width, "count": width * (self._rows if of_point else 1),
                     "of_point": of_point, "type": TYPES[said["type"]], "format": said.get("format", "ascii"),
                     "text": bytearray()}
            if array["format"] == "appended":
                self._later.append({**array, "offset": _count(said.get("offset"))})
            else:
                self._array = array

    def _text(self, text: str) -> None:
        if self._array is not None:
            letters = text.encode("ascii", "replace")
            self._array["text"] += letters if self._array["format"] == "ascii" else letters.translate(None, BLANKS)

    def _end(self, tag: str) -> None:
        self._inside.pop()
        if tag == "DataArray" and self._array is not None:
            array, self._array = self._array, None
            text = array.pop("text")
            if array["format"] == "ascii":
                values = from_text(bytes(text), array["count"])
            else:
                values = self._encoding.numbers(Source.inline(text), 0, array["count"], array["type"])
            self._put(array, values)

    def _read_appended(self) -> None:
        if self._appended is None:
            raise NotVTK("no appended data")
        index, in_letters = self._appended
        self._file.seek(index)
        begin = APPENDED.match(self._file.read(1000))
        if begin is None:
            raise NotVTK("appended data without their beginning")
        source = Source.appended(self._file, index + begin.end(), in_letters)
        for array in self._later:
            self._put(array, self._encoding.numbers(source, array["offset"], array["count"], array["type"]))

    def _put(self, array: dict[str, Any], values: np.ndarray) -> None:
        if array["of_point"]:
            self._found.put(array["name"], values, array["width"])
        else:
            self._found.fields[array["name"]] = values


def _count(text: str | None) -> int:
    """A size that the file says."""
    if text is None or not re.fullmatch(r"[0-9]{1,15}", text.strip()):
        raise NotVTK(f"a size that is none: {quoted(text or '', 20)}")
    return int(text)
