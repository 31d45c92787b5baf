"""Files as other codes, tools and people write them: read as what they are, or refused in one sentence of their own."""

import gzip
import json
import sys

import numpy as np
import pytest

from app.cli import main
from solvers.judging import particle_readers
from solvers.judging.check import CONSISTENT, check
from solvers.judging.findings.finding import HOLDS
from solvers.judging.judgement import judge
from solvers.judging.moment_joining import join_moments
from solvers.judging.particle_data_types import RawTable
from solvers.judging.particle_readers import read_all
from solvers.judging.particle_scene_matching import match_files
from solvers.problems import PROBLEMS
from solvers.untrusted.quoting import FileError
from tests.findings import forms_section
from tests.support.foreign_files import CELLS, PLAIN, STRESS, TIMES, Text, components, frames, same
from tests.support.foreign_forms import FORMS, OTHERS
from tests.support.paths import ROOT

SCENE = PROBLEMS["ring"].scene(cells=CELLS)
WRITERS = {**{name: form.write for name, form in FORMS.items()}, **OTHERS}


@pytest.mark.parametrize("name", WRITERS)
def test_particles_of_others_are_those_that_we_wrote(name, tmp_path):
    files = list(map(str, WRITERS[name](tmp_path)))
    times = TIMES if name in FORMS and not FORMS[name].times else ()
    tables, cells, times_left = join_moments(read_all(files), [CELLS], times)
    _, [grid] = match_files(tables, SCENE, cells, times_left)
    assert grid.times == pytest.approx(TIMES, rel=1e-9)
    for frame, own in zip(grid.frames, frames(), strict=True):
        apart = frame.material_position[:, None] - own.material_position
        order = np.argmin(np.sum(apart**2, axis=2), axis=0)
        for key in ("material_position", "position", "velocity", "stress", "deformation_gradient"):
            mine = getattr(own, key)
            if (theirs := getattr(frame, key)) is not None:
                assert theirs[order] == pytest.approx(mine, rel=3e-8, abs=3e-8 * np.abs(mine).max()), key
    first = grid.frames[0]
    assert any(values is not None for values in (first.velocity, first.stress, first.deformation_gradient))
    assert check(files, times=times).verdict == CONSISTENT


def test_the_documentation_lists_whose_files_are_read():
    assert (ROOT / "assets" / "judge.md").read_text(encoding="utf-8").endswith(forms_section())


def plain(rows: str, head: str = "id,x,y,vx,vy\n") -> bytes:
    return f"# t = 0.1\n{head}{rows}".encode()


#: Content and what is said of it.
REFUSED = {
    "empty.csv": (plain("0,1,2,3,4\n1,1,,3,4\n"), "has nothing in the column y of line 4; give a number in all rows"),
    "missing.csv": (plain("0,1,2,3,4\n1,1,NA,3,4\n"), "has NA in the column y of line 4; give a number"),
    "overflow.dat": (plain("0 1 2 3 4\n1 ***** 2 3 4\n", "id x y vx vy\n"), "has ***** in the column x of line 4"),
    "thousands.csv": (plain("0;0,5;1;2;3\n1;1.234,5;1;2;3\n", "id;x;y;vx;vy\n"),
                      "has 1.234,5 in the column x of line 4, beside numbers with a decimal comma"),
    "english.csv": (plain('0,"1,234.5",2,3,4\n'), "has 1,234.5 in the column x of line 3; give a number"),
    "grouped.csv": (plain('"1,234",0.5,2,3,4\n'), "has 0.5 in the column x of line 3, beside numbers "
                                                                   "with a decimal comma"),
    "null.dat": (plain("0 1 2 3 4\n1 1 2 2*\n", "id x y vx vy\n"), "has 5 columns, but 4 in line 4"),
    "array.csv": (plain('0,"[1, 2]",3,4\n1,"[1]",3,4\n', "id,x,vx,vy\n"), "has 5 columns, but 4 in line 4"),
    "words.csv": (plain('0,"[1, two]",3,4\n', "id,x,vx,vy\n"), "has [1, two] in the column x of line 3; give a number"),
    "ragged.txt": (plain("0 1 2 3 4\n1 1 2 3\n", "id x y vx vy\n"), "has 5 columns, but 4 in line 4"),
    "longer.csv": (plain("0,1,2,3,4\n1,1,2,3,4,5\n"), "has 5 columns, but 6 in line 4"),
    "more.csv": (plain("0,1,2,3,4,5\n"), "has 5 names and 6 numbers in a line"),
    "unnamed.txt": (b"0 1 2\n1 2 3\n", "has no names in its first line"),
    "texts.csv": (plain("abc,1\n", "id,phase\n"), "has no number in the first row of any column that is known"),
    "unknown.csv": (plain("0,1\n", "colour,phase\n"), "holds no particles that are known by name, but colour, phase"),
    "feet.csv": (plain("0,1,2\n", "id,x [ft],y [ft]\n"), "has no positions (x, y or position); its columns are "
                                                "id, x [ft]"),
    "twice.csv": (plain("0,1,1,2\n", "id,x,x,y\n"), "has two columns called x"),
    "late.csv": (b"id,x,y\n0,1,2\n# t = 0.1\n0,1,2\n# t = 0.2\n0,1,2\n", "has rows before the first time that it "
                                                                           "states"),
    "binary.csv": (b"\x7fELF\0\1\2\3" * 9, "is no text"),
    "cut.csv.gz": (gzip.compress(plain("0,1,2,3,4\n" * 99))[:-20], "is no complete .gz file"),
    "none.csv.gz": (b"0,1,2\n", "is no complete .gz file"),
    "far.pvd": (b'<VTKFile type="Collection"><Collection><DataSet file="../a.vtu"/></Collection></VTKFile>',
                "names the file ../a.vtu; give one in its own folder or below"),
    "gone.pvd": (b'<VTKFile type="Collection"><Collection><DataSet file="a.vtu"/></Collection></VTKFile>',
                 "a.vtu: cannot be read: no such file"),
    "none.pvd": (b'<VTKFile type="Collection"><Collection/></VTKFile>', "as .pvd (no files that it names)"),
    "laughs.pvd": (b"<!DOCTYPE a [<!ENTITY a 'ha'>]><VTKFile type='Collection'/>", "(a document type or an entity)"),
    "other.pvtu": (b'<VTKFile type="PPolyData"/>', "cannot be read as .pvtu (no PUnstructuredGrid)"),
    "none.h5": (b"nothing", "cannot be read as HDF5"),
    "half.csv": (plain("0,1\n", "id,y\n"), "has some components of position but not x; give all of them or none"),
    "scalar.csv": (plain("0,1,2,3\n", "x,y,stress_0,stress_5\n"), "has 2 numbered components of sigma"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_read_is_told_in_the_words_of_the_file(name, tmp_path):
    content, said = REFUSED[name]
    (tmp_path / name).write_bytes(content)
    with pytest.raises(FileError) as refused:
        match_files(read_all(str(tmp_path / name)), SCENE, [CELLS], [])
    assert said in str(refused.value) and "\n" not in str(refused.value)


def test_what_is_packed_has_the_limits_of_what_is_not(tmp_path, monkeypatch):
    monkeypatch.setattr(particle_readers, "LARGEST", 10_000_000)
    (tmp_path / "bomb.csv.gz").write_bytes(gzip.compress(b"0" * 11_000_000))
    with pytest.raises(FileError, match="unpacks to 10 MB; give at most 10 MB"):
        read_all(str(tmp_path / "bomb.csv.gz"))


def test_without_the_package_that_reads_hdf5_it_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "h5py", None)
    (tmp_path / "a.h5").write_bytes(b"\x89HDF")
    with pytest.raises(FileError, match="only the package h5py reads"):
        read_all(str(tmp_path / "a.h5"))


UPRIGHT = {"id": "id", "x": "x", "z": "y", "vx": "vx", "vz": "vy", "sxx": "sxx", "szz": "syy", "sxz": "sxy"}


@pytest.mark.parametrize("names", [UPRIGHT, UPRIGHT | {"y": "0", "vy": "0", "syy": "szz"}], ids=["two", "three"])
def test_a_plane_of_x_and_z_is_read_where_one_says_so(names, tmp_path):
    files = list(map(str, Text(names)(tmp_path)))
    with pytest.raises(FileError, match="three directions, and the ring has two; give --plane xz"):
        judge(SCENE, files, cells=[CELLS])
    [grid] = judge(SCENE, files, cells=[CELLS], plane="xz").grids
    [own] = judge(SCENE, list(map(str, Text(PLAIN | STRESS, ending=".txt")(tmp_path))), cells=[CELLS]).grids
    assert grid.norms["sigma"] == pytest.approx(own.norms["sigma"], rel=1e-12)


def test_two_layers_are_no_plane(tmp_path):
    columns = components(frames()[0])
    rows = {"id": np.arange(128), "t": np.zeros(128), "x": np.tile(columns["x"], 2), "y": np.tile(columns["y"], 2),
            "z": np.repeat([0.0, 0.1], 64)}
    with pytest.raises(FileError, match="three directions, and the ring has two; give x, y and nothing beyond"):
        judge(SCENE, rows, cells=[CELLS])


def test_columns_that_were_not_read_are_named_by_both_commands(tmp_path, capsys):
    files = list(map(str, Text({"index": "row", "kind": "steel", **PLAIN, "temp": "0"})(tmp_path)))
    for command in (["judge", "ring", "--cells", str(CELLS), "--no-compare"], ["check"]):
        out = tmp_path / command[0]
        assert main([*command, *files, "--out", str(out)]) == 0
        assert "Columns that were not read: index, kind, temp." in capsys.readouterr().out
        report = json.loads((out / "report.json").read_text())
        assert report.get("grids", [report])[0]["not_read"] == ["index", "kind", "temp"]
        assert "not read: index" in (out / "report.md").read_text()


def test_rows_that_nothing_identifies_are_followed_only_while_they_keep_their_order(tmp_path):
    for permuted, known in ((False, True), (True, False)):
        files = list(map(str, Text({"mark": "id", **same("x", "y", "vx", "vy")}, permuted=permuted)(tmp_path)))
        told = check(files)
        [order] = [one for one in told.findings if one.name == "neighbours keep their order"]
        assert told.verdict == CONSISTENT and (order.verdict == HOLDS) == known
        assert known or "not read: mark; if one of them says which particle is which, call it id" in order.says
        with pytest.raises(FileError, match="not read: mark; if one of them says which particle is which, call it id"):
            judge(SCENE, files, cells=[CELLS])


def test_ids_from_1_are_seen_where_particles_are_missing(tmp_path):
    frame = frames()[0]
    some = np.arange(len(frame.number)) % 5 != 4
    some[-1] = some[0] = False
    arrays = {"t": 0.0, "id": frame.number[some] + 1, "x": frame.position[some]}
    [grid] = judge(SCENE, arrays, cells=[CELLS]).grids
    assert grid.norms["x"].max() < 2e-4 and "the ids seem to be counted from 1" in " ".join(grid.notes())


def part(ids: list[int], time: float) -> RawTable:
    """Two particles of a moment, at X = 0.1 id, displaced by 0.01 m times the time."""
    X = 0.1 * np.array(ids, float)[:, None]
    return RawTable(f"{ids}-{time}", {"id": np.array(ids), "X": X, "x": X + 0.01 * time}, ("id",), time=time,
                    from_displacement=True)


def test_parts_of_one_moment_are_joined_where_they_are():
    """And not moved, though nothing in them differs from moment to moment; those of a moment close by stay apart."""
    [joined], _, _ = join_moments([part([1, 2], 1.0), part([3, 4], 1.0)], [], [])
    assert joined.columns["id"].tolist() == [1, 2, 3, 4]
    assert joined.columns["X"][:, 0] == pytest.approx([0.1, 0.2, 0.3, 0.4])
    assert joined.columns["x"] - joined.columns["X"] == pytest.approx(0.01)
    found, _, _ = join_moments([part(ids, t) for ids, t in (([1, 2], 1.0), ([3, 4], 1.0001), ([5, 6], 1.0))], [], [])
    assert [(one.time, one.columns["id"].tolist()) for one in found] == [(1.0, [1, 2, 5, 6]), (1.0001, [3, 4])]
