"""Numbers as VTK's XML files have them in binary: after their size, in letters or not, packed in blocks or not.

How much there will be is known before: what a file says of its blocks must fit that, and no block is unpacked to more.
"""

from __future__ import annotations

import base64
import lzma
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import IO, Any

import numpy as np

from solvers.judging.vtk_parts import NotVTK
from solvers.outside.quoting import quoted

AT_ONCE = 1 << 20  # letters, which are four for three bytes
MOST_BLOCKS = 100_000
MOST_MEMORY = 100_000_000  # bytes that unpacking may take beside what it unpacks
PACKINGS: dict[str, Any] = {
    "vtkZLibDataCompressor": zlib.decompressobj,
    "vtkLZMADataCompressor": lambda: lzma.LZMADecompressor(memlimit=MOST_MEMORY)}


@dataclass(frozen=True)
class Source:
    """Where the data lie: what ``read(place, length)`` gives, as they are or, three bytes in four letters, as
    base64."""

    read: Callable[[int, int], bytes]
    in_letters: bool

    @classmethod
    def inline(cls, letters: bytearray) -> Source:
        return cls(lambda place, length: bytes(memoryview(letters)[place:place + length]), True)

    @classmethod
    def appended(cls, file: IO[bytes], begin: int, in_letters: bool) -> Source:
        """In a file, from a place on."""
        def read(place: int, length: int) -> bytes:
            file.seek(begin + place)
            return file.read(length)

        return cls(read, in_letters)

    def unit(self, place: int, size: int) -> tuple[bytes | bytearray, int]:
        """The ``size`` bytes that begin at a place, and the place after them."""
        length = -(-size // 3) * 4 if self.in_letters else size
        content = bytearray()
        for begin in range(0, length, AT_ONCE):
            part = self.read(place + begin, min(AT_ONCE, length - begin))
            if len(part) < min(AT_ONCE, length - begin):
                raise NotVTK("data that end too early")
            content += _decoded(part) if self.in_letters else part
        del content[size:]
        if len(content) < size:
            raise NotVTK("data that end too early")
        return content, place + length


@dataclass(frozen=True)
class Encoding:
    """How numbers stand in a file: the ``order`` of their bytes, the type of sizes before them, and the ``packing``."""

    order: str
    size: np.dtype
    packing: str | None

    @classmethod
    def of(cls, byte_order: str | None, header: str | None, packing: str | None) -> Encoding:
        if byte_order not in (None, "LittleEndian", "BigEndian") or header not in ("u4", "u8"):
            raise NotVTK("an order or a size of numbers that is not known")
        if packing is not None and packing not in PACKINGS:
            raise NotVTK(f"data packed by {quoted(packing, 30)}; {' and '.join(PACKINGS)} can be read")
        order = ">" if byte_order == "BigEndian" else "<"
        return cls(order, np.dtype(order + header), packing)

    def numbers(self, source: Source, place: int, count: int, kind: str) -> np.ndarray:
        """So many numbers of a type that lie at a place."""
        dtype = np.dtype(self.order + kind)
        content = (self._plain if self.packing is None else self._unpacked)(source, place, count * dtype.itemsize)
        return np.frombuffer(content, dtype)

    def _plain(self, source: Source, place: int, size: int) -> bytes | bytearray:
        head, after = source.unit(place, self.size.itemsize)
        said = self._sizes(head)[0]
        if said != size:
            raise NotVTK(f"{said:,} bytes where {size:,} are announced")
        if not source.in_letters or _ends(source, after):  # the size stands by itself
            return source.unit(after, size)[0]
        return source.unit(place, self.size.itemsize + size)[0][self.size.itemsize:]

    def _unpacked(self, source: Source, place: int, size: int) -> bytearray:
        """Blocks one after the other: how many, the size of each and of the last, and their sizes as they are packed
        stand before them."""
        width = self.size.itemsize
        blocks = self._sizes(source.unit(place, width)[0])[0]
        if blocks > MOST_BLOCKS:
            raise NotVTK(f"more than {MOST_BLOCKS:,} blocks")
        head, after = source.unit(place, (3 + blocks) * width)
        _, each, last, *packed = self._sizes(head)
        sizes = [each] * blocks
        if blocks and last:
            sizes[-1] = last
        if sum(sizes) != size:
            raise NotVTK(f"blocks of {sum(sizes):,} bytes where {size:,} are announced")
        data, _ = source.unit(after, sum(packed))
        out, done, begin = bytearray(size), 0, 0
        for length, unpacked in zip(packed, sizes, strict=True):
            packed_block = data[begin:begin + length]
            piece = PACKINGS[self.packing or ""]().decompress(packed_block, unpacked + 1)
            if len(piece) != unpacked:
                raise NotVTK("a block that does not unpack to its size")
            out[done:done + unpacked] = piece
            begin, done = begin + length, done + unpacked
        return out

    def _sizes(self, content: bytes | bytearray) -> list[int]:
        return np.frombuffer(content, self.size).tolist()


def _decoded(letters: bytes) -> bytes:
    try:
        return base64.b64decode(letters)
    except ValueError:
        raise NotVTK("letters that are no base64") from None


def _ends(source: Source, place: int) -> bool:
    """Whether letters before a place are padded: there something ends."""
    return source.read(place - 1, 1) == b"="
