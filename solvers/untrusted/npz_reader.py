"""Reader of untrusted .npz files: neither their directories nor the headers of their arrays are trusted.

A .npz is a zip with a .npy file for each array: a header, which is a Python literal, and the numbers. Only requested
arrays are unpacked, each to the size in its header, which is checked before.
"""

import io
import zipfile
from collections.abc import Callable, Iterator
from typing import IO, Any, cast

import numpy as np

from solvers.translatable_message import Message
from solvers.untrusted.quoting import FileError, quote
from solvers.untrusted.size_limits import SizeLimits, check_name

ENDING = ".npy"
LONGEST_READ = 1_000_000  # bytes that are read at once, of which the zip's directory is the largest part
LONGEST_HEAD = 20_000  # bytes before the numbers; numpy reads no more than 10,000
LONGEST_TEXT = 20_000  # letters of an array that is a text
MOST_DIRECTIONS = 4  # of an array
PACKINGS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)  # as numpy writes them; others may take any memory to unpack
ENCRYPTED = 1
TEXTS = ("scene", "result")  # arrays that may be a text
HEADS = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}


class _NotPlainArrays(ValueError):
    """Error for a file that is not a .npz of plain numbers; the message says why."""


def read_arrays(path: str, is_wanted: Callable[[str], bool], limits: SizeLimits) -> dict[str, np.ndarray]:
    """Returns the arrays of a .npz file by name, each of numbers or one text; those for whose name ``is_wanted`` is
    false are not read, and empty here. Raises :class:`FileError` for an invalid or too large file."""
    try:
        with open(path, "rb", buffering=0) as raw, _ReadSizeLimitedFile(raw) as measured, \
                zipfile.ZipFile(cast(IO[bytes], measured)) as packed:
            members = dict(_read_members(path, packed, limits))
            return {name: _read_array(path, name, packed, member, limits) if is_wanted(name) else np.empty(0)
                    for name, member in members.items()}
    except (FileError, OSError):
        raise
    except _NotPlainArrays as error:
        raise FileError(path, "is no .npz of plain numbers ({error}); write it with numpy.savez", error) from None
    except Exception as error:  # what a broken file makes of a parser
        raise FileError(path, "is no .npz of plain numbers ({name}); write it with numpy.savez",
                        type(error).__name__) from None


class _ReadSizeLimitedFile(io.BufferedReader):
    """File that refuses to read more than a million bytes at once: the size of a zip's directory is untrusted."""

    def read(self, size: int | None = -1, /) -> bytes:
        content = super().read(LONGEST_READ + 1 if size is None or not 0 <= size <= LONGEST_READ else size)
        if len(content) > LONGEST_READ:
            raise _NotPlainArrays(Message("its directory is too long"))
        return content


def _read_members(path: str, packed: zipfile.ZipFile, limits: SizeLimits) -> Iterator[tuple[str, zipfile.ZipInfo]]:
    """Yields name and zip entry of each array, checked for duplicates, their number and their unpacked sizes."""
    listed = packed.infolist()
    limits.check_columns(path, len(listed))
    limits.check_unpacked(path, sum(member.file_size for member in listed))
    seen: set[str] = set()
    for member in listed:
        name = member.filename.removesuffix(ENDING)
        check_name(path, name)
        if name in seen:
            raise FileError(path, "has two arrays called {name}; give each its own name", quote(name))
        seen.add(name)
        yield name, member


def _read_array(path: str, name: str, packed: zipfile.ZipFile, member: zipfile.ZipInfo,
                limits: SizeLimits) -> np.ndarray:
    if member.compress_type not in PACKINGS or member.flag_bits & ENCRYPTED:
        raise _NotPlainArrays(Message("{name} is packed in a way that numpy does not use", quote(name)))
    with packed.open(member) as content:
        begun = io.BytesIO(content.read(LONGEST_HEAD))  # no more, whatever length the header claims
        shape, in_columns, dtype = _read_header(path, name, begun)
        limits.check_numbers(path, *shape)
        data = bytearray(int(np.prod(shape, dtype=object)) * dtype.itemsize)
        done = begun.readinto(data)
        while piece := content.read(min(len(data) - done, LONGEST_READ // 2)):
            data[done:done + len(piece)] = piece
            done += len(piece)
    if done < len(data):
        raise _NotPlainArrays(Message("{name} ends before its last number", quote(name)))
    return np.frombuffer(data, dtype).reshape(shape, order="F" if in_columns else "C")


def _read_header(path: str, name: str, content: IO[bytes]) -> tuple[tuple[int, ...], bool, Any]:
    """Returns shape, whether in Fortran order, and dtype from a .npy header; raises for other than numbers."""
    version = np.lib.format.read_magic(content)
    if version not in HEADS:
        raise _NotPlainArrays(Message("{name} is of another version", quote(name)))
    shape, in_columns, dtype = HEADS[version](content)
    text = dtype.kind in "US" and dtype.itemsize <= 4 * LONGEST_TEXT and shape in ((), (1,))
    if dtype.kind in "bcUS" and not (text and name in TEXTS):
        raise FileError(path, "has no numbers in {name}; give numbers, real and not objects or texts", quote(name))
    if dtype.kind not in "iufUS":
        raise _NotPlainArrays(Message("{name} is no array of numbers", quote(name)))
    if len(shape) > MOST_DIRECTIONS or not all(0 <= size < 2**62 for size in shape):
        raise _NotPlainArrays(Message("{name} has a shape that none can have", quote(name)))
    return shape, in_columns, dtype
