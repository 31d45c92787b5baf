"""Reader of VTK's XML formats, .vtu and .vtp, as a stream: data that are not needed are never stored.

A document type or an entity is rejected where it begins. At appended data XML parsing ends, and each array is read from
its offset. The number of values is known before: the sizes of blocks must agree with it, which limits unpacking.
"""

import base64
import io
import lzma
import re
import zlib
from contextlib import suppress
from dataclasses import dataclass
from typing import IO, Any

import numpy as np

from solvers.judging.vtk_common import POINTS, NotVTK, PointData, make_xml_parser, parse_numbers, xml_errors_named
from solvers.untrusted.quoting import FileError, quote

PIECE_OF_FILE = 1 << 16
LONGEST_TAG = 1_000_000  # bytes
BLANKS = b" \t\r\n"
MOST_ELEMENTS = 100_000
TYPES = {"Float32": "f4", "Float64": "f8", "Int8": "i1", "Int16": "i2", "Int32": "i4", "Int64": "i8", "UInt8": "u1",
         "UInt16": "u2", "UInt32": "u4", "UInt64": "u8"}
APPENDED = re.compile(rb"[^>]*>\s*_")
AT_ONCE = 1 << 20  # letters, which are four for three bytes
MOST_BLOCKS = 100_000
MOST_MEMORY = 100_000_000  # bytes that unpacking may need beside its result
PACKINGS: dict[str, Any] = {"vtkZLibDataCompressor": zlib.decompressobj,
                            "vtkLZMADataCompressor": lambda: lzma.LZMADecompressor(memlimit=MOST_MEMORY)}


class _AppendedData(Exception):
    """Signal that XML ends and appended data begin."""


class XmlReader:
    """Reader that adds the points and arrays of an XML file of a ``kind``, a VTK type name, to ``data``."""

    def __init__(self, file: IO[bytes], kind: str, ending: str, data: PointData):
        self._file, self._kind, self._ending, self._data = file, kind, ending, data
        self._parser = make_xml_parser(FileError(
            data.path, f"has a document type or an entity, which no {ending} file needs and which is not read; "
                       "leave it out"))
        self._parser.StartElementHandler, self._parser.EndElementHandler = self._start_element, self._end_element
        self._parser.CharacterDataHandler = self._add_text
        self._parser.buffer_text = True
        self._inside: list[str] = []
        self._elements, self._rows, self._encoding = 0, 0, NumberEncoding.from_attributes(None, "u4", None)
        self._array: dict[str, Any] | None = None  # that is being read as text
        self._later: list[dict[str, Any]] = []  # arrays whose data are appended
        self._appended: tuple[int, bool] | None = None

    def read(self) -> None:
        fed = 0
        with suppress(_AppendedData), xml_errors_named():
            while piece := self._file.read(PIECE_OF_FILE):
                self._parser.Parse(piece)
                fed += len(piece)
                if fed - self._parser.CurrentByteIndex > LONGEST_TAG:
                    raise NotVTK(f"a tag of more than {LONGEST_TAG:,} letters")
            self._parser.Parse(b"", True)
        if not self._elements or self._inside[:1] not in ([], ["VTKFile"]):
            raise NotVTK("no VTKFile")
        if self._later:
            self._read_appended()

    def _start_element(self, tag: str, attributes: dict[str, str]) -> None:
        self._elements += 1
        if self._elements > MOST_ELEMENTS:
            raise NotVTK(f"more than {MOST_ELEMENTS:,} elements")
        if not self._inside:
            if tag != "VTKFile":
                raise NotVTK("no VTKFile")
            if attributes.get("type") != self._kind:
                raise FileError(self._data.path, f"is no {self._kind}, as a {self._ending} file is; give it the "
                                                 "ending of what it is")
            self._encoding = NumberEncoding.from_attributes(attributes.get("byte_order"),
                                                            TYPES.get(attributes.get("header_type", "UInt32")),
                                                            attributes.get("compressor"))
        self._inside.append(tag)
        if tag == "AppendedData":
            self._appended = self._parser.CurrentByteIndex, attributes.get("encoding") != "raw"
            raise _AppendedData
        if tag == "Piece":
            self._rows = _parse_size(attributes.get("NumberOfPoints"))
            self._data.begin_piece(self._rows)
        elif tag == "DataArray":
            self._begin_array(attributes)

    def _begin_array(self, attributes: dict[str, str]) -> None:
        """Reads a DataArray's attributes: checks whether it is needed, and stores where its numbers are."""
        where, name = self._inside[-2], attributes.get("Name", "")
        width = _parse_size(attributes.get("NumberOfComponents") or "1")
        if where == "Points":
            name, wants = POINTS, self._data.wants(POINTS, self._rows, width)
        elif where == "PointData":
            wants = self._data.wants(name, self._rows, width)
        elif where == "FieldData":
            width = _parse_size(attributes.get("NumberOfTuples") or "1") * width
            wants = self._data.wants_field_data(name, width)
        else:
            if where == "CellData":
                self._data.skip(name)
            return
        if wants:
            if attributes.get("type") not in TYPES:
                raise NotVTK(f"an array of the type {quote(attributes.get('type'), 20)}")
            of_point = where != "FieldData"
            array = {"name": name, "width": width, "count": width * (self._rows if of_point else 1),
                     "of_point": of_point, "type": TYPES[attributes["type"]],
                     "format": attributes.get("format", "ascii"), "text": io.BytesIO()}
            if array["format"] == "appended":
                self._later.append({**array, "offset": _parse_size(attributes.get("offset"))})
            else:
                self._array = array

    def _add_text(self, text: str) -> None:
        if self._array is not None:
            letters = text.encode("ascii", "replace")
            self._array["text"].write(letters if self._array["format"] == "ascii" else letters.translate(None, BLANKS))

    def _end_element(self, tag: str) -> None:
        self._inside.pop()
        if tag == "DataArray" and self._array is not None:
            array, self._array = self._array, None
            text = array.pop("text")
            if array["format"] == "ascii":
                values = parse_numbers(text.getvalue(), array["count"])
            else:
                values = self._encoding.read_numbers(DataSource(text, 0, True), 0, array["count"], array["type"])
            self._store_array(array, values)

    def _read_appended(self) -> None:
        if self._appended is None:
            raise NotVTK("no appended data")
        index, in_letters = self._appended
        self._file.seek(index)
        begin = APPENDED.match(self._file.read(1000))
        if begin is None:
            raise NotVTK("appended data without their beginning")
        source = DataSource(self._file, index + begin.end(), in_letters)
        for array in self._later:
            values = self._encoding.read_numbers(source, array["offset"], array["count"], array["type"])
            self._store_array(array, values)

    def _store_array(self, array: dict[str, Any], values: np.ndarray) -> None:
        if array["of_point"]:
            self._data.add_array(array["name"], values, array["width"])
        else:
            self._data.fields[array["name"]] = values


def _parse_size(text: str | None) -> int:
    """Returns a size written in the file, of at most 15 digits. Raises NotVTK for an invalid one."""
    if text is None or not re.fullmatch(r"[0-9]{1,15}", text.strip()):
        raise NotVTK(f"a size that is none: {quote(text or '', 20)}")
    return int(text)


@dataclass(frozen=True)
class DataSource:
    """Location of data in a ``file`` from the byte ``begin`` on, raw or as base64, three bytes in four letters."""

    file: IO[bytes]
    begin: int
    in_letters: bool

    def read(self, place: int, length: int) -> bytes:
        self.file.seek(self.begin + place)
        return self.file.read(length)

    def read_decoded_bytes(self, place: int, size: int) -> tuple[bytes | bytearray, int]:
        """Returns the ``size`` bytes, decoded, that begin ``place`` bytes after ``begin``, and the place after them."""
        length = -(-size // 3) * 4 if self.in_letters else size
        content = bytearray()
        for begin in range(0, length, AT_ONCE):
            part = self.read(place + begin, min(AT_ONCE, length - begin))
            if len(part) < min(AT_ONCE, length - begin):
                raise NotVTK("data that end too early")
            try:
                content += base64.b64decode(part) if self.in_letters else part
            except ValueError:
                raise NotVTK("letters that are no base64") from None
        del content[size:]
        if len(content) < size:
            raise NotVTK("data that end too early")
        return content, place + length


@dataclass(frozen=True)
class NumberEncoding:
    """Number encoding: byte ``order`` (< or >), type of sizes before them, ``packing``, a VTK compressor or None."""

    order: str
    size: np.dtype
    packing: str | None

    @classmethod
    def from_attributes(cls, byte_order: str | None, header: str | None, packing: str | None) -> "NumberEncoding":
        if byte_order not in (None, "LittleEndian", "BigEndian") or header not in ("u4", "u8"):
            raise NotVTK("an order or a size of numbers that is not known")
        if packing is not None and packing not in PACKINGS:
            raise NotVTK(f"data packed by {quote(packing, 30)}; {' and '.join(PACKINGS)} can be read")
        order = ">" if byte_order == "BigEndian" else "<"
        return cls(order, np.dtype(order + header), packing)

    def read_numbers(self, source: DataSource, place: int, count: int, kind: str) -> np.ndarray:
        """Returns ``count`` numbers of a numpy type (``kind``, such as f8) that begin at a place of a source."""
        dtype = np.dtype(self.order + kind)
        content = (self._read_plain if self.packing is None else self._unpack)(source, place, count * dtype.itemsize)
        return np.frombuffer(content, dtype)

    def _read_plain(self, source: DataSource, place: int, size: int) -> bytes | bytearray:
        head, after = source.read_decoded_bytes(place, self.size.itemsize)
        stated = self._parse_sizes(head)[0]
        if stated != size:
            raise NotVTK(f"{stated:,} bytes where {size:,} are announced")
        if not source.in_letters or source.read(after - 1, 1) == b"=":  # padded: the size stands by itself
            return source.read_decoded_bytes(after, size)[0]
        return source.read_decoded_bytes(place, self.size.itemsize + size)[0][self.size.itemsize:]

    def _unpack(self, source: DataSource, place: int, size: int) -> bytearray:
        """Returns the ``size`` bytes of consecutive packed blocks, decompressed. Their header has their number, the
        size of each and of the last, and their packed sizes."""
        width = self.size.itemsize
        blocks = self._parse_sizes(source.read_decoded_bytes(place, width)[0])[0]
        if blocks > MOST_BLOCKS:
            raise NotVTK(f"more than {MOST_BLOCKS:,} blocks")
        head, after = source.read_decoded_bytes(place, (3 + blocks) * width)
        _, each, last, *packed = self._parse_sizes(head)
        sizes = [each] * blocks
        if blocks and last:
            sizes[-1] = last
        if sum(sizes) != size:
            raise NotVTK(f"blocks of {sum(sizes):,} bytes where {size:,} are announced")
        data, _ = source.read_decoded_bytes(after, sum(packed))
        out, done, begin = bytearray(size), 0, 0
        for length, unpacked in zip(packed, sizes, strict=True):
            piece = PACKINGS[self.packing or ""]().decompress(data[begin:begin + length], unpacked + 1)
            if len(piece) != unpacked:
                raise NotVTK("a block that does not unpack to its size")
            out[done:done + unpacked] = piece
            begin, done = begin + length, done + unpacked
        return out

    def _parse_sizes(self, content: bytes | bytearray) -> list[int]:
        return np.frombuffer(content, self.size).tolist()
