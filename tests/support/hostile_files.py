"""Files that mean harm: those that claim more than they have, unpack to more than they seem, or say what a terminal or
a browser would do. Those in ``LARGE``, and of the others ``TAKES_LONG``, take a while to be written or refused."""

from __future__ import annotations

import base64
import io
import struct
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

EVIL = "\x1b[31m\u202eevil\x07\n![](http://evil.example)<script>|`=1+1"
SEVEN_TB = "{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000000,), }"


def npy(header: str, data: bytes = b"", version: int = 1, length: int | None = None) -> bytes:
    """An array as numpy writes it, with any header."""
    text = header.encode() + b"\n"
    said = len(text) if length is None else length
    return b"\x93NUMPY" + bytes([version, 0]) + struct.pack("<H" if version == 1 else "<I", said) + text + data


def npz(members: list[tuple[str, bytes]], packing: int = zipfile.ZIP_DEFLATED) -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", packing) as packed:
        for name, content in members:
            packed.writestr(name, content)
    return out.getvalue()


def npz_with_duplicates() -> bytes:
    """Two arrays of one name: with the ending of an array and without, and another that a change of a letter makes."""
    return npz([(name, npy(array(), bytes(32))) for name in ("x.npy", "x", "y.npy")], zipfile.ZIP_STORED)


def npz_of_arrays(**arrays) -> bytes:
    out = io.BytesIO()
    np.savez_compressed(out, **arrays)
    return out.getvalue()


def array(descr: str = "<f8", shape: str = "(4,)") -> str:
    return f"{{'descr': {descr!r}, 'fortran_order': False, 'shape': {shape}, }}"


def vtu(points: str, n: object = 1, head: str = "", said: str = "", kind: str = "UnstructuredGrid") -> bytes:
    return (f"<?xml version='1.0'?>{head}<VTKFile type='{kind}' version='1.0' byte_order='LittleEndian' {said}><{kind}>"
            f"<Piece NumberOfPoints='{n}' NumberOfCells='0'><Points>{points}</Points></Piece></{kind}>"
            "</VTKFile>").encode()


ZLIB = "compressor='vtkZLibDataCompressor' header_type='UInt64'"


def packed_array(claimed: int, blocks: int, each: int, content: bytes) -> str:
    """A binary array of blocks, each of the same content; sizes as claimed."""
    head = struct.pack(f"<{3 + blocks}Q", claimed, each, 0, *[len(content)] * blocks)
    body = base64.b64encode(head).decode() + base64.b64encode(content * blocks).decode()
    return f"<DataArray type='Float64' NumberOfComponents='3' format='binary'>{body}</DataArray>"


def zlib_bomb(megabytes: int, each: int, points: int) -> bytes:
    """Each of 100 blocks says that it has so many bytes, and unpacks to so many megabytes."""
    packer = zlib.compressobj(9)
    block = b"".join([*(packer.compress(bytes(1_000_000)) for _ in range(megabytes)), packer.flush()])
    return vtu(packed_array(100, 100, each, block), points, said=ZLIB)


def legacy(*lines: str, kind: str = "UNSTRUCTURED_GRID", form: str = "ASCII") -> bytes:
    return "\n".join(["# vtk DataFile Version 3.0", "title", form, f"DATASET {kind}", *lines, ""]).encode()


LAUGHS = "<!DOCTYPE a [<!ENTITY a 'ha'>" + "".join(
    f"<!ENTITY {chr(97 + k)} '{f'&{chr(96 + k)};' * 10}'>" for k in range(1, 10)) + "]>"
ASCII_POINT = "<DataArray type='Float64' NumberOfComponents='3' format='ascii'>0.5 0 0</DataArray>"

#: By name: the content of the file, or the function that makes it.
FILES: dict[str, bytes | Callable[[Path], bytes]] = {
    "late.csv": b"id,x,t\n0,0.5,1e6\n", "latest.csv": b"id,x,t\n0,0.5,1e308\n",
    "later.csv": b"# t = 1e300\nid,x\n0,0.5\n",
    "long-time.csv": b"# t = " + b"9" * 10_000 + b"\nid,x\n0,0.5\n",
    "wide.csv": lambda _: b",".join(b"c%d" % k for k in range(30_000)) + b"\n" + b",".join([b"1"] * 30_000) + b"\n",
    "wider-rows.csv": b"id,x\n" + (b"1," * 100_000 + b"1\n") * 3,
    "one-line.csv": lambda _: b"id," + b"x" * 3_000_000,
    "brackets.csv": b"id,x" + b"(" * 100_000 + b"\n0,1\n",
    "moments.csv": lambda _: b"id,x,t\n" + b"".join(b"0,0.5,%d\n" % k for k in range(100_000)),
    "moments.npz": lambda _: npz_of_arrays(t=np.arange(1e5), id=np.arange(1), x=np.zeros((100_000, 1, 1))),
    "escapes.csv": f"id,x,{EVIL[:30].splitlines()[0]},{EVIL[:5]}\n0,1,2,\x1b[31m\n".encode(),
    "names.csv": f"\x1b[31m{'z' * 5000},\u202eb\n1,2\n".encode(),
    "wide-digits.csv": "id,x,t\n0,４,0\n".encode(), "underscore.csv": b"id,x,t\n0,4_0,0\n",
    "comments.csv": lambda _: b"# a = 1\n" * 200_000,
    "says.csv": f"# cells = \x1b[31m{'9' * 9000}\nid,x,t\n0,0,0\n".encode(),
    "scene.csv": (b'# scene = {"schema":"mpm-lab/particles/1\x1b[31m","problem":"\x1b","inputs":{}}'
                  b"\nid,x,t\n0,0,0\n"),
    "huge-cells.csv": b"# cells = 1e300\nid,x,t\n0,0,0\n", "many-cells.csv": b"# cells = 100000\nid,x,t\n0,0,0\n",
    "huge-ids.csv": b"id,x,t\n1e300,0,0\n", "huge-places.csv": b"id,x,t\n0,1e308,0\n",
    "double.npz": lambda _: npz_with_duplicates(),
    "overlap.npz": lambda _: npz_with_duplicates().replace(b"y.npy", b"x.npy"),
    "terabytes.npz": npz([("x.npy", npy(SEVEN_TB)), ("t.npy", npy(array(shape="()"), bytes(8)))]),
    "negative.npz": npz([("x.npy", npy(array(shape="(-5,)")))]), "nothing.npz": npz([("x.npy", b"")]),
    "digits.npz": npz([("x.npy", npy(array(shape=f"({'9' * 4000},)")))]),
    "directions.npz": npz([("x.npy", npy(array(shape="(1,)".replace("1", "1,1,1,1,1,1,1,1"))))]),
    "void.npz": npz([("x.npy", npy(array("|V1000000")))]), "object.npz": npz([("x.npy", npy(array("|O")))]),
    "nested.npz": npz([("x.npy", npy(array([("a", [("b", "<f8", (1000, 1000))])]))),]),
    "sub.npz": npz([("x.npy", npy(array("(100000,10000)<f8")))]),
    "parentheses.npz": npz([("x.npy", npy("(" * 9000))]), "unbalanced.npz": npz([("x.npy", npy("{'descr': ("))]),
    "minus.npz": npz([("x.npy", npy("-" * 9000 + "1"))]), "list.npz": npz([("x.npy", npy("[" * 90 + "]" * 90))]),
    "short.npz": npz([("x.npy", npy(array(shape="(1000000,)")))]),
    "long-head.npz": lambda _: npz([("x.npy", npy(" " * 200_000_000, version=2, length=200_000_000))]),
    "text.npz": npz([("x.npy", npy(array("<U1000000000", "()")))]),
    "version.npz": npz([("x.npy", b"\x93NUMPY\x09\x00\x00\x00")]),
    "zeros.npz": lambda _: npz_of_arrays(t=np.array(0.0), id=np.zeros(3_000_000, np.int8),
                                         x=np.zeros(3_000_000, np.int8)),
    "bytes.npz": lambda _: npz_of_arrays(t=np.array(0.0), x=np.zeros(100_000_000, np.int8)),
    "tiled.npz": lambda _: npz_of_arrays(t=np.arange(9000.0), id=np.arange(40_000),
                                         x=np.zeros((9000, 40_000), np.int8)),
    "members.npz": lambda _: npz([(f"a{k}.npy", b"") for k in range(30_000)], zipfile.ZIP_STORED),
    "bzip.npz": npz([("x.npy", npy(array(), bytes(32)))], zipfile.ZIP_BZIP2),
    "lzma.npz": npz([("x.npy", npy(array(), bytes(32)))], zipfile.ZIP_LZMA),
    "name.npz": npz([("x\x1b[31m" + "y" * 60_000 + ".npy", npy(array(), bytes(32)))]),
    "bomb.vtu": lambda _: zlib_bomb(100, 24, 100), "honest.vtu": lambda _: zlib_bomb(96, 96_000_000, 400_000_000),
    "blocks.vtu": vtu(packed_array(10**15, 0, 1, b""), 5, said=ZLIB),
    "points.vtu": vtu(ASCII_POINT, 10**12), "digits.vtu": vtu(ASCII_POINT, "9" * 9000),
    "few.vtu": vtu(ASCII_POINT, 1000), "laughs.vtu": vtu(ASCII_POINT, head=LAUGHS),
    "laughs16.vtu": vtu(ASCII_POINT, head=LAUGHS).decode().encode("utf-16"),
    "outside.vtp": vtu(ASCII_POINT, head="<!DOCTYPE a SYSTEM 'file:///etc/passwd'>", kind="PolyData"),
    "type.vtu": vtu(ASCII_POINT.replace("Float64", EVIL[:10])), "tag.vtu": lambda _: b"<VTKFile " + b"a" * 3_000_000,
    "deep.vtu": lambda _: b"<a>" * 1_000_000, "elements.vtu": lambda _: vtu("<a/>" * 1_000_000),
    "packing.vtu": vtu(ASCII_POINT, said="compressor='evil'"),
    "struct.vtk": legacy("DIMENSIONS 100000 100000 1000", "ORIGIN 0 0 0", "SPACING 1 1 1", kind="STRUCTURED_POINTS"),
    "points.vtk": legacy("POINTS 1000000000000 double", "1 2 3"), "digits.vtk": legacy(f"POINTS {'9' * 900} double"),
    "binary.vtk": legacy("POINTS 3000000 double", form="BINARY"), "grid.vtk": legacy("X", kind=EVIL[:12]),
    "field.vtk": legacy("FIELD FieldData 1000000000"), "section.vtk": legacy("\x1b[31m" * 100),
    "\x1b[31m\u202e![](http:..evil).csv": b"x\n1\n", "<script>.npz": b"x", "n" * 200 + ".csv": b"x\n1\n"}


N = 3_600_000  # particles: as many numbers as are allowed, and every byte of them eight
PLANE = {"X": (2,), "x": (2,), "v": (2,), "F": (2, 2)}


def _file_of_many_rows(folder: Path) -> bytes:
    row = b"0,0,0,0\n" * 100_000
    return b"id,x,vx,t\n" + row * 100


#: These take seconds to be written, or to be refused.
LARGE: dict[str, bytes | Callable[[Path], bytes]] = {
    "rows.csv": _file_of_many_rows,
    "zeros.npz": lambda _: npz_of_arrays(t=np.array(0.0), **dict.fromkeys(("id", "x", "vx", "F"), np.zeros(
        4_000_000))),
    "gigabytes.npz": lambda _: npz([(f"{name}.npy", npy(array(shape="(60000000,)"), bytes(480_000_000)))
                                    for name in ("x", "v", "F", "sigma")]),
    "full.npz": lambda _: npz_of_arrays(t=np.array(0.0), id=np.zeros(N, np.int8), **{
        name: np.zeros((N, *shape), np.int8) for name, shape in PLANE.items()}),
    "stacked.npz": lambda _: npz_of_arrays(t=np.arange(1000.0), id=np.arange(3300), **{
        name: np.zeros((1000, 3300, *shape), np.int8) for name, shape in PLANE.items()}),
    "nan.npz": lambda _: npz_of_arrays(t=np.array(0.0), id=np.arange(N), x=np.full((N, 2), np.nan),
                                       F=np.zeros((N, 2, 2))),
    "text.vtu": lambda _: vtu(ASCII_POINT.replace("0.5 0 0", "0 " * 60_000_000), 4_000_000),
    "many.vtu": lambda _: vtu(ASCII_POINT.replace("0.5 0 0", "0 " * 12_000_000), 4_000_000)}


TAKES_LONG = {"long-head.npz", "bytes.npz", "tiled.npz", "zeros.npz", "honest.vtu", "members.npz"}


def write_file(name: str, folder: Path, files: dict[str, bytes | Callable[[Path], bytes]] = FILES) -> Path:
    content = files[name]
    path = folder / name
    try:
        path.write_bytes(content(folder) if callable(content) else content)
    except OSError:
        pytest.skip("no file can be called so here")
    return path
