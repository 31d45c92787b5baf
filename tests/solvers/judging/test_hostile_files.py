"""Files that mean harm end in one sentence, at once and in little memory; of none is more believed than can be."""

import base64
import os
import re
import struct
import subprocess
import sys
import time
import zlib
from pathlib import Path

import meshio
import numpy as np
import pytest

from app.cli import main
from app.commands.lesson import LessonGrade
from solvers.judging.particle_readers import read_file
from solvers.untrusted.quoting import FileError
from tests.support.hostile_files import FILES, LARGE, TAKES_LONG, write_file
from tests.support.paths import ROOT

LONGEST = 410  # letters of a message, "mpm-lab: " and the end of the line among them
MOST_SECONDS, MOST_MEMORY = 20, 1_000_000  # kB
ALLOWED = {"many-cells.csv"}  # which are judged: a great grid of which one particle is given
CHILD = """
import re, sys
from app.cli import main
status = main(sys.argv[1:])
found = re.search(r"VmHWM:\\s+(\\d+)", open("/proc/self/status").read()) if sys.platform == "linux" else None
print(found[1] if found else 0)
sys.exit(status)
"""


def told(error: str) -> None:
    """One short line in which every character shows."""
    assert error.startswith("mpm-lab: ") and error.count("\n") == 1 and error[:-1].isprintable()
    assert len(error) <= LONGEST and "failed:" not in error and "Traceback" not in error


@pytest.mark.parametrize("name", sorted(FILES.keys() - TAKES_LONG - ALLOWED), ids=ascii)
def test_a_file_that_means_harm_ends_in_a_sentence(name, tmp_path, capsys):
    begun = time.monotonic()
    assert main(["judge", "bar", str(write_file(name, tmp_path)), "--out", str(tmp_path / "out")]) == 2
    told(capsys.readouterr().err)
    assert time.monotonic() - begun < MOST_SECONDS


@pytest.mark.slow
@pytest.mark.parametrize("problem", ["bar", "vortex"])
@pytest.mark.parametrize("name", sorted({*FILES, *LARGE}), ids=ascii)
def test_it_does_so_at_once_and_in_little_memory(name, problem, tmp_path):
    """In a process of its own: what others have taken is not counted."""
    file = write_file(name, tmp_path, LARGE if name in LARGE else FILES)
    begun = time.monotonic()
    child = subprocess.run([sys.executable, "-c", CHILD, "judge", problem, str(file), "--out", str(tmp_path / "out"),
                            "--no-compare", "--quiet"], cwd=ROOT, capture_output=True, text=True, timeout=120)
    seconds, memory = time.monotonic() - begun, int(child.stdout.split()[-1])
    print(f"{ascii(name)[:30]:32} {problem:7} {seconds:5.1f} s {memory / 1000:6.0f} MB")
    assert seconds < MOST_SECONDS and memory < MOST_MEMORY
    if name not in ALLOWED:
        assert child.returncode == 2
        told(child.stderr)


def test_several_files_have_no_more_together_than_one(tmp_path, capsys, monkeypatch):
    from solvers.judging import particle_readers
    from solvers.untrusted import size_limits
    monkeypatch.setattr(particle_readers, "LIMITS", size_limits.SizeLimits(10**6, 10, 10, 1000, 100))
    files = []
    for k in range(3):
        (tmp_path / f"{k}.csv").write_bytes(b"id,x,t\n" + b"".join(b"%d,0,%d\n" % (p, k) for p in range(4)))
        files.append(str(tmp_path / f"{k}.csv"))
    for command in (["judge", "bar"], ["check"]):
        assert main([*command, *files, "--out", str(tmp_path / "out")]) == 2
        assert "2.csv: has 3 particles of all times together; give at most 2" in capsys.readouterr().err


def test_a_hostile_name_is_reported_as_it_is_and_draws_nothing(tmp_path, monkeypatch):
    """A file that can be judged, called as a picture in Markdown that is elsewhere, in the report of three forms."""
    monkeypatch.chdir(tmp_path)
    name = "`![](http:..evil)*<b>$x$.csv"
    if sys.platform == "win32":
        pytest.skip("no file can be called so here")
    Path(name).write_bytes(b"id,x,t\n" + b"".join(b"%d,%f,0\n" % (k, (k + 0.5) / 160) for k in (*range(100), 159)))
    assert main(["judge", "bar", name, "--out", "out", "--no-compare", "--quiet"]) == 0
    page = Path("out", "report.html").read_text()
    assert "<b>" not in page and "evil)*&lt;b&gt;$x$.csv" in page
    assert set(re.findall(r'<img[^>]* src="([^"]{10})', page)) <= {"data:image"}


POINTS = np.array([[0.5, 0, 0], [0.25, 0.1, 0], [1 / 3, 0, -1]])
DATA = {"id": np.arange(3), "velocity": POINTS[::-1].copy(), "stress": np.arange(27.0).reshape(3, 9) / 7}
MESH = meshio.Mesh(POINTS, [("vertex", np.arange(3)[:, None])], point_data=DATA)


@pytest.mark.parametrize("kind, options", [
    ("vtu", {"binary": False}), *(("vtu", {"binary": True, **how}) for how in (
        {"compression": None}, {"compression": "zlib"}, {"compression": "lzma"}, {"header_type": "UInt64"})),
    *(("vtk", {"fmt_version": version, "binary": binary}) for version in ("4.2", "5.1") for binary in (False, True))],
    ids=str)
def test_vtk_and_vtu_are_read_in_every_form_that_others_write(kind, options, tmp_path):
    getattr(meshio, kind).write(str(tmp_path / f"a.{kind}"), MESH, **options)
    raw = read_file(str(tmp_path / f"a.{kind}"))
    assert (raw.columns["id"] == DATA["id"]).all()
    for mine, theirs in (("x", POINTS), ("v", DATA["velocity"]), ("sigma", DATA["stress"])):
        assert raw.columns[mine].reshape(3, -1) == pytest.approx(theirs, rel=1e-10, abs=0)  # of 11 digits as text


def test_vtk_with_attributes_and_fields_as_paraview_writes_them(tmp_path):
    (tmp_path / "a.vtk").write_text("""# vtk DataFile Version 3.0
particles
ASCII
DATASET POLYDATA
FIELD FieldData 2
TimeValue 1 1 double
0.25
METADATA
INFORMATION 0

cells 1 1 int
40
POINTS 3 double
0.5 0 0 0.25 0.1 0
1 0 -1
VERTICES 3 6
1 0 1 1 1 2
POINT_DATA 3
SCALARS id int 1
LOOKUP_TABLE default
0 1 2
VECTORS velocity double
1 2 3 4 5 6 7 8 9
TENSORS stress float
1 0 0 0 1 0 0 0 1 2 0 0 0 2 0 0 0 2 3 0 0 0 3 0 0 0 3
FIELD more 1
other%20name 1 3 float
1 2 3
""")
    raw = read_file(str(tmp_path / "a.vtk"))
    assert raw.time == 0.25 and raw.cells == 40 and raw.columns["id"].tolist() == [0, 1, 2]
    assert raw.columns["v"].tolist() == [[1, 2, 3], [4, 5, 6], [7, 8, 9]]
    assert raw.columns["sigma"][:, 0, 0].tolist() == [1, 2, 3] and "other name" in raw.names


def appended(form: str, pack: bool, header: str = "I") -> bytes:
    """A .vtp of two pieces whose data are appended, raw or as base64, in blocks of 24 bytes or as they are."""
    parts = [POINTS[:1], DATA["velocity"][:1], POINTS[1:], DATA["velocity"][1:]]
    data, offsets = b"", []
    for part in parts:
        offsets.append(len(data))
        content = part.astype(">f8").tobytes()
        if pack:
            blocks = [zlib.compress(content[k:k + 24]) for k in range(0, len(content), 24)]
            head = struct.pack(f">{3 + len(blocks)}{header}", len(blocks), 24, 0, *map(len, blocks))
            pieces = [head, b"".join(blocks)]
        else:
            pieces = [struct.pack(f">{header}", len(content)) + content]
        data += b"".join(pieces if form == "raw" else map(base64.b64encode, pieces))
    packing = " compressor='vtkZLibDataCompressor'" * pack
    kind = {"I": "UInt32", "Q": "UInt64"}[header]
    arrays = [f"<DataArray type='Float64' Name='velocity' NumberOfComponents='3' format='appended' offset='{k}'/>"
              for k in offsets]
    pieces_said = "".join(f"<Piece NumberOfPoints='{n}'><PointData>{arrays[at + 1]}</PointData><Points>{arrays[at]}"
                          "</Points></Piece>" for n, at in ((1, 0), (2, 2)))
    return (f"<VTKFile type='PolyData' byte_order='BigEndian' header_type='{kind}'{packing}><PolyData>{pieces_said}"
            f"</PolyData><AppendedData encoding='{form}'>\n_").encode() + data + b"</AppendedData></VTKFile>"


@pytest.mark.parametrize("form", ["raw", "base64"])
@pytest.mark.parametrize("pack", [False, True])
@pytest.mark.parametrize("header", ["I", "Q"])
def test_appended_data_of_several_pieces_are_read(form, pack, header, tmp_path):
    (tmp_path / "a.vtp").write_bytes(appended(form, pack, header))
    raw = read_file(str(tmp_path / "a.vtp"))
    assert (raw.columns["x"] == POINTS).all() and (raw.columns["v"] == DATA["velocity"]).all()


@pytest.mark.parametrize("content, said", [
    (appended("raw", False)[:-60], "data that end too early"),
    (appended("raw", False).replace(b"offset='0'", b"offset='10'"), "bytes where 24 are announced"),
    (appended("raw", True).replace(b"NumberOfPoints='1'", b"NumberOfPoints='2'"), "where 48 are announced"),
    (appended("base64", True).replace(b"type='Float64'", b"type='String'"), "an array of the type String"),
], ids=["short", "place", "blocks", "type"])
def test_what_does_not_fit_is_named(content, said, tmp_path):
    (tmp_path / "a.vtp").write_bytes(content)
    with pytest.raises(FileError) as refusal:
        read_file(str(tmp_path / "a.vtp"))
    assert said in refusal.value.sentence


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes have names here")
def test_a_directory_or_a_pipe_among_answers_is_refused_and_waited_for_by_nobody(tmp_path, capsys):
    pipe = tmp_path / "pipe.json"
    os.mkfifo(pipe)
    assert LessonGrade(files=(str(pipe), str(tmp_path))).execute() == 1
    assert capsys.readouterr().err.count("is not a file") == 2


def honest(kind: str, folder: Path) -> bytes:
    """A file that can be read."""
    path = str(folder / f"honest{kind}")
    if kind == ".npz":
        np.savez_compressed(path, t=np.array([0.0, 1.0]), id=np.arange(3), x=np.zeros((2, 3, 3)), cells=np.array(40))
    elif kind == ".csv":
        Path(path).write_text("# t = 0.5\n# cells = 40\nid,x,vx\n0,0.5,1\n1,0.25,2\n")
    elif kind == ".vtp":
        Path(path).write_bytes(appended("raw", True))
    else:
        getattr(meshio, kind[1:]).write(path, MESH, binary=True)
    return Path(path).read_bytes()


@pytest.mark.parametrize("kind", [".csv", ".npz", ".vtk", ".vtu", ".vtp"])
@pytest.mark.parametrize("count", [150, pytest.param(3000, marks=pytest.mark.slow)])
def test_a_file_with_bytes_that_are_others_is_read_or_refused_in_a_sentence(kind, count, tmp_path):
    """Some changed, taken out, doubled or put in: nothing else comes of it than a table or a refusal."""
    content, random = honest(kind, tmp_path), np.random.default_rng(count)
    read_file(str(tmp_path / f"honest{kind}"))
    file = tmp_path / f"changed{kind}"
    for _ in range(count):
        changed = bytearray(content)
        for _ in range(random.integers(1, 6)):
            start, length = random.integers(len(changed) + 1), int(random.choice([1, 1, 2, 8, 50]))
            way = random.integers(4)
            new = random.integers(0, 256, length, dtype=np.uint8).tobytes() if way else bytes(changed[start:start + 50])
            changed[start:start + (length if way != 1 else 0)] = b"" if way == 2 else new
        file.write_bytes(changed)
        try:
            read_file(str(file))
        except FileError as error:
            assert str(error).isprintable() and len(str(error)) <= 400
