"""The referee: our own runs get our own errors, moved particles are found, every file that cannot be judged is told."""

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from app.cli import main
from solvers.judging import error_norms, particle_writers, problem_handout
from solvers.judging.error_norms import QUANTITIES, TwoMeshCompanion, count_crossings, largest_error, rms
from solvers.judging.judgement import Judgement, SingleGridJudgement, judge
from solvers.judging.particle_data_types import Frame
from solvers.judging.particle_readers import read_file
from solvers.judging.reference_runs import frame_of_snapshot, run_reference
from solvers.problems import PROBLEMS
from solvers.running.run import run
from solvers.untrusted.quoting import FileError
from tests.support.unsolved_bar import unsolved

#: A run of ours of each problem, and the form that its particles are written in.
OWN = {"bar": (["--cells", "20", "--periods", "1"], "csv"), "ring": (["--cells", "12", "--periods", "0.5"], "npz"),
       "vortex": (["--cells", "24", "--periods", "0.25"], "npz")}
WITHOUT = ["--estimator", "none", "--quiet"]  # our runs are judged by what is judged of all: their particles
TIME = 0.3  # of a period, at which exact particles are written


def scene_of(problem: str, **fields):
    return PROBLEMS[problem].scene(cells=12, **fields)


def test_a_crossing_is_one_in_either_direction():
    scene = PROBLEMS["square"].scene(cells=10)
    X = scene.spacing * np.array([[3.5, 4.5], [3.5, 7.5], [6.5, 6.5]])
    moved = [scene.spacing * np.array(steps) for steps in ([[1, 0], [0, 0], [0, 0.2]], [[1, 1], [0, -1], [0, 0.4]])]
    frames = [SimpleNamespace(material_position=X, position=X + u) for u in moved]
    assert count_crossings(scene, frames) == 1 + 2


def test_the_worst_is_that_of_all_moments():
    """Neither the first nor the last; of those that have the quantity."""
    X = np.array([[0.1], [0.2]])
    frames = [SimpleNamespace(material_position=X, number=np.array([5, 7]), time=t, file=f"{t}.csv")
              for t in (0.0, 1.0, 2.0)]
    errors = [{"x": np.array([[0.1], [0.2]])}, {"x": np.array([[0.3], [-0.9]])}, {"x": np.array([[0.4], [0.1]])}]
    found = largest_error(frames, errors, "x")
    assert (found.size, found.particle, found.place, found.time, found.file) == (0.9, 7, (0.2,), 1.0, "1.0.csv")
    assert largest_error(frames, errors, "v") is None


@pytest.mark.parametrize("problem", OWN)
def test_a_run_of_ours_is_judged_to_have_our_own_errors(problem, tmp_path):
    out, (flags, kind) = tmp_path / "verdict", OWN[problem]
    assert main(["run", problem, *flags, "--particles", str(tmp_path / f"run.{kind}"), "--json",
                 str(tmp_path / "run.json"), *WITHOUT]) == 0
    errors = json.loads((tmp_path / "run.json").read_text())["error"]
    assert main(["judge", problem, str(tmp_path / f"run.{kind}"), *flags, "--no-compare", "--quiet", "--out",
                 str(out)]) == 0
    [grid] = json.loads((out / "report.json").read_text())["grids"]
    for q in ("x", "v", "sigma"):  # rounding only: the sums are taken in another order
        assert grid["error"][q] == pytest.approx(errors[q], rel=1e-12)
        assert grid["estimate"]["index"][q] == pytest.approx(1, abs=1e-3)
        assert grid["estimate"]["own_error"][q] < 1e-2 * errors[q]["max"]
    assert grid["neighbour_gap"] is None and grid["notes"] == []
    assert {entry.name for entry in out.iterdir()} == {"report.json", "report.md", "report.html", "norms.png",
                                                       "space.png"}


def test_a_patch_test_may_be_wrapped_and_is_as_its_problem_says(tmp_path, capsys):
    patch = ["--motion", "patch", "--ppc", "2.5", "--cells", "20"]
    assert main(["problem", "bar", *patch, "--times", "0.7", "1.3", "--out", str(tmp_path / "patch")]) == 0
    raw, first = (read_file(str(tmp_path / "patch" / f"{name}.csv")) for name in ("exact", "particles"))
    assert (first.columns["F"] == 1.02).all() and (first.columns["v"] == 1).all()
    assert raw.columns["sigma"] == pytest.approx(np.full((100, 1, 1), 4 * (1.02 - 1)), rel=1e-12)
    assert first.columns["mass"].sum() == pytest.approx(1 / 1.02, rel=1e-12)
    scene = PROBLEMS["bar"].scene(motion="patch", ppc=2.5, cells=20)
    [grid] = judge(scene, replace(raw, columns=raw.columns | {"x": raw.columns["x"] % 1.0})).to_dict()["grids"]
    assert all(grid["error"][q]["max"] < 1e-14 for q in ("x", "v", "sigma"))
    assert "moved back by a period" in " ".join(grid["notes"])
    assert main(["judge", "bar", str(tmp_path / "patch" / "exact.csv"), *patch, "--no-compare"]) == 0
    text = capsys.readouterr().out
    assert text.startswith("# Patch test of the bar") and "F = 1.02, v = 1 m/s" in text


def test_crossings_are_counted_on_the_problems_own_grid():
    """The vortex's lines begin at -1.5 m, and with an odd number of cells none passes through the centre."""
    scene = PROBLEMS["vortex"].scene(cells=15)
    X = np.array([[1.0, 0.0], [0.0, 1.0]])
    assert count_crossings(scene, [Frame("", 0.1, np.arange(2), X, X - 0.09)]) == 0
    assert count_crossings(scene, [Frame("", 0.1, np.arange(2), X, X + 0.11)]) == 2
    scene = scene_of("bar")
    X = problem_handout.start(scene).material_position
    frames = [Frame("", t, np.arange(len(X)), X, X + shift) for t, shift in ((0.1, scene.spacing), (0.2, 0.0))]
    assert count_crossings(scene, frames) == 2 * len(X)


def test_a_companion_that_is_lost_is_told_in_a_sentence(tmp_path, capsys):
    """A free vortex of 1 rad runs faster than its waves, and tears."""
    assert main(["problem", "vortex", "--body-force", "none", "--cells", "12", "--out", str(tmp_path / "free")]) == 2
    error = capsys.readouterr().err
    assert "--amplitude 1: is so large that the companion" in error and error.count("\n") == 1
    assert not (tmp_path / "free").exists()


@pytest.mark.parametrize("problem", PROBLEMS)
def test_moved_particles_are_found_with_their_place(problem):
    """3 % of the exact particles, by a tenth of a cell."""
    scene = PROBLEMS[problem].scene(cells=24)
    frame = problem_handout.exact_frame(scene, TIME * scene.period)
    X, x = frame.material_position, frame.position.copy()
    moved = np.random.default_rng(7).choice(len(x), round(0.03 * len(x)), replace=False)
    turn = np.random.default_rng(8).normal(size=(len(moved), X.shape[1]))
    x[moved] += 0.1 * scene.spacing * turn / np.linalg.norm(turn, axis=1)[:, None]
    judged = judge(scene, {"t": frame.time, "x": x, "X": X, "cells": 24})
    [grid] = judged.to_dict()["grids"]
    assert set(judged.grids[0].position_outliers.which) == set(moved)
    assert grid["neighbour_gap"]["farthest_over_h"] == pytest.approx(0.1, rel=0.2)
    assert grid["neighbour_gap"]["particle"] in moved and grid["worst"]["x"]["particle"] in moved
    assert grid["worst"]["x"]["X"] in X[moved].tolist()


def test_a_particle_is_named_by_its_id_and_not_by_its_line(tmp_path):
    """Rows backwards, and particle 7 off by a twentieth of a cell."""
    scene = scene_of("bar")
    columns = {name: values[::-1].copy() for name, values in table(X=None).items()}
    columns["x"][columns["id"] == 7] += 0.05 * scene.spacing
    [grid] = judge(scene, csv_file(tmp_path, columns)).to_dict()["grids"]
    worst, X = grid["worst"]["x"], problem_handout.start(scene).material_position
    assert worst["particle"] == grid["neighbour_gap"]["particle"] == 7 and worst["X"] == X[7].tolist()


@pytest.mark.parametrize("problem", PROBLEMS)
def test_the_exact_particles_have_no_error(problem):
    scene = scene_of(problem)
    times = [TIME * scene.period, 0.4 * scene.period]
    [grid] = judge(scene, particle_writers.frame_columns([problem_handout.exact_frame(scene, t) for t in times])).grids
    assert grid.grid.times.tolist() == times
    for q, values in grid.norms.items():
        assert values.max() < 1e-12 * scene.size_of(q), q


@pytest.mark.parametrize("problem, force", [("bar", "material"), *(
    pytest.param(problem, force, marks=pytest.mark.slow)
    for problem in ("ring", "vortex") for force in ("two-tone", "none"))])
def test_without_a_truth_the_companion_judges(problem, force):
    """A run of ours, by its own companion and by the judge's: the same to the per cent that the former is off."""
    # 0.1 is the bar's and the ring's size too; a free vortex of the default 1 rad is torn apart.
    scene = PROBLEMS[problem].scene(cells=24, periods=0.4, body_force=force, estimators=("companion",),
                                    **({"amplitude": 0.1} if problem == "vortex" else {}))
    scene = unsolved(scene) if problem == "bar" else scene
    shots = []
    result = run(scene, prices=False, on_sample=shots.append)
    [grid] = judge(scene,
                   particle_writers.frame_columns([frame_of_snapshot(shot,
                                                                     scene) for shot in shots])).to_dict()["grids"]
    assert grid["error"] is None and grid["estimate"]["index"] is None
    for q in ("x", "v", "sigma"):
        own = result.estimate["companion"][q]["max"]
        assert grid["estimate"]["companion"][q]["max"] == pytest.approx(own, rel=0.02)
        assert grid["worst"][q]["size"] > 0


def test_the_start_is_no_part_of_what_norms_are_summed_up_to():
    """There a file has what it was given: the largest and the mean are of later times, as those of a run."""
    found = error_norms.summarise_norms(np.array([0.0, 1.0, 2.0]), {"x": np.array([9.0, 1.0, 2.0])})
    assert found == {"x": {"final": 2.0, "max": 2.0, "mean": 1.5}}


def test_rounding_is_that_of_the_steps_that_the_run_took():
    """As many as its own step makes, if the file says it, and else ours."""
    scene, grid = PROBLEMS["bar"].scene(), SimpleNamespace(frames=(), times=np.array([0.0, 1.0]), step=None)
    ours, own = (SingleGridJudgement(scene, one, None).largest_rounding_error("x") for one in (
        grid, SimpleNamespace(**{**vars(grid), "step": scene.time_step / 100})))
    assert own == pytest.approx(10 * ours)  # like the root of their number


def test_several_grids_have_the_order_of_the_method_that_made_them(tmp_path):
    """Linearity-preserving uGIMP is of second order; our own runs on the same grids stand beside."""
    files = []
    for cells in (20, 40):
        file = tmp_path / f"n{cells}.csv"
        assert main(["run", "bar", "--cells", str(cells), "--amplitude", "2.5e-4", "--linearity-preserving",
                     "--periods", "1", "--sample-every", str(5 * cells), "--particles", str(file), *WITHOUT]) == 0
        files.append(str(file))
    out = tmp_path / "verdict"
    assert main(["judge", "bar", *files, "--amplitude", "2.5e-4", "--quiet", "--out", str(out)]) == 0
    report = json.loads((out / "report.json").read_text())
    assert [g["cells"] for g in report["grids"]] == [20, 40]
    assert report["order"]["x"]["order"] == pytest.approx(2, abs=0.2)
    for grid in report["grids"]:
        same = next(run for run in grid["ours"] if run["method"] == "ugimp" and run["linearity_preserving"])
        assert same["error"]["x"]["max"] == pytest.approx(grid["error"]["x"]["max"], rel=1e-12)
        assert len(grid["ours"]) == len(PROBLEMS["bar"].scene.candidates())
    text = (out / "report.md").read_text()
    assert "## Order in h" in text and "![" in text and (out / "order.png").exists()
    page = (out / "report.html").read_text()
    assert "data:image/png;base64" in page and "<script" not in page and "http" not in page.replace("http-equiv", "")


@pytest.mark.parametrize("cells", [(20,), (20, 30)], ids=["one grid", "two"])
def test_particles_that_miss_nothing_have_their_pictures(cells, tmp_path, capsys):
    """The start, and no other time: all errors are zero, and so are those of our methods beside."""
    starts = {n: problem_handout.exact_frame(PROBLEMS["bar"].scene(cells=n), 0.0) for n in cells}
    files = [csv_file(tmp_path, particle_writers.frame_columns([start]), f"{n}.csv") for n, start in starts.items()]
    assert main(["judge", "bar", *files, "--cells", *map(str, cells), "--out", str(tmp_path / "out"), "--quiet"]) == 0
    assert (tmp_path / "out" / "order.png").exists() and not capsys.readouterr().err


def test_times_between_our_steps_are_met(tmp_path):
    """At times that no step of ours ends at, ours is interpolated: its error is that of its neighbours in time."""
    scene = scene_of("bar", estimators=(), effects=())
    t = 0.1 * scene.period
    near = run_reference(scene, [t, t + 0.37 * scene.time_step, t + scene.time_step]).norms
    for q in ("x", "v", "sigma"):
        assert min(near[q][::2]) * 0.98 < near[q][1] < max(near[q][::2]) * 1.02


def test_another_law_of_the_material_is_noticed():
    scene = scene_of("bar")
    frame = problem_handout.exact_frame(scene, TIME * scene.period)
    log = replace(frame, stress=scene.modulus * np.log(frame.deformation_gradient))
    [grid] = judge(scene, particle_writers.frame_columns([log])).to_dict()["grids"]
    assert "another material" in grid["notes"][0] and grid["error"]["x"]["max"] < 1e-15 < grid["error"]["sigma"]["max"]


@pytest.mark.parametrize("problem", PROBLEMS)
def test_the_companions_own_error_is_the_difference_of_its_two_meshes(problem):
    """Of exact particles, and not nothing: the two meshes are two, and differ by about the error of the coarser one."""
    scene = PROBLEMS[problem].scene(cells=12, periods=0.3)
    times = (0.1 * scene.period, 0.3 * scene.period)
    companions, frame = TwoMeshCompanion(scene, times), problem_handout.exact_frame(scene, times[1])
    doubt = companions.mesh_difference(frame)
    X, found = frame.material_position, []
    for fine in (True, False):
        body, solved = problem_handout.solve_companion(scene, fine, times)
        u, v, _, sigma = problem_handout.fields_at_points(scene, body, solved[1], X)
        found.append((u, v, sigma))
    coarser = companions.errors(frame, fine=False)
    for q, one, other in zip(QUANTITIES, *found, strict=True):
        assert doubt[q] == pytest.approx(rms(one - other), rel=1e-9)
        assert doubt[q] > 0 and doubt[q] == pytest.approx(rms(coarser[q]), rel=0.5)


@pytest.mark.parametrize("cells", [(20, 30, 60), (12, 16)], ids=str)
def test_the_order_of_any_grids_is_that_of_their_errors(cells):
    """Errors made up as C h^2 of x, C h^1.3 of v and C h^0.4 of sigma have these orders, pair by pair, to rounding."""
    orders, times = {"x": 2.0, "v": 1.3, "sigma": 0.4}, np.array([0.0, 0.1, 0.2])
    scenes = [PROBLEMS["bar"].scene(cells=n) for n in cells]
    grids = [SimpleNamespace(scene=scene, grid=SimpleNamespace(times=times),
                             norms={q: 1e-3 * scene.spacing**p * np.array([9.0, 1.0, 0.5]) for q, p in orders.items()},
                             largest_rounding_error=lambda quantity: 0.0)
             for scene in scenes]
    found = Judgement(scenes[0], grids).orders
    for q, p in orders.items():
        assert found[q].order == pytest.approx(p, abs=1e-9)
        assert found[q].pairwise == pytest.approx([p] * (len(cells) - 1), abs=1e-9)


def table(problem="bar", **changed):
    """The exact particles as columns, some of them changed or, where None, left out."""
    scene = scene_of(problem)
    columns = particle_writers.frame_columns([problem_handout.exact_frame(scene, TIME * scene.period)])
    columns |= changed
    return {name: values for name, values in columns.items() if values is not None}


def csv_file(folder: Path, columns, name="bad.csv") -> str:
    rows = [columns, *zip(*columns.values(), strict=True)]
    (folder / name).write_text("".join(",".join(map(str, row)) + "\n" for row in rows))
    return str(folder / name)


IDS, SHIFT = table()["id"], 0.3
SPOILT = {
    "no positions": ({"x": None}, "has no positions (x or position); its columns are t, id"),
    "no identity": ({"id": None, "X": None}, "does not identify its particles: give id"),
    "ids from 2": ({"X": None, "id": IDS + 2}, "has ids from 2 to 49, and 12 cells with 4 particles each way have 0 "
                                               "to 47"),
    "half ids": ({"X": None, "id": IDS + 0.5}, "has ids that are no whole numbers"),
    "no time": ({"t": None}, "has no time; give a column t"),
    "negative time": ({"t": 0 * IDS - 1.0}, "has the time -1; give seconds from 0 on"),
    "a position that is none": ({"x": np.where(IDS == 5, np.nan, table()["x"])},
                                f"has x that is no number in 1 of {len(IDS)} rows, first particle 5"),
    "an infinite velocity": ({"vx": np.where(IDS == 7, np.inf, 0.0)}, "has v that is no number in 1 of "
                                                                      f"{len(IDS)} rows, first particle 7"),
    "shifted origin": ({"x": table()["x"] + SHIFT}, "has all positions shifted by 0.3 m"),
    "shifted material": ({"X": table()["X"] + SHIFT}, "its origin may be shifted; particles begin at X from"),
    "twice": ({"X": None, "id": np.where(IDS == 3, 4, IDS)}, "has particle 4 2 times at t ="),
    "one place": ({"id": None, "X": np.where(IDS == 3, table()["X"][4], table()["X"])}, "particles with the material "
                                                                                        "position"),
}


@pytest.mark.parametrize("case", SPOILT)
def test_a_spoilt_file_is_named_with_what_is_allowed(case, tmp_path, capsys):
    changed, said = SPOILT[case]
    file = csv_file(tmp_path, table(**changed))
    _refused(["judge", "bar", file, "--cells", "12"], said, tmp_path, capsys, file)


CONTENTS = {
    "empty.csv": (b"", "is empty; give a file with particles"),
    "names.csv": (b"id,x\n", "holds no particles; give names in the first line"),
    "numbers.csv": (b"1,2\n3,4\n", "has no names in its first line"),
    "ragged.csv": (b"id,x\n1,2\n3\n", "has 2 columns, but 1 in line 3; give as many in all lines"),
    "words.csv": (b"id,x\n1,two\n", "has two in the column x of line 2; give a number in all rows"),
    "more.csv": (b"id,x\n1,2,3\n", "has 2 names and 3 numbers in a line"),
    "same.csv": (b"id,x,x\n1,2,3\n", "has two columns called x"),
    "other.csv": (b"mass,colour\n1,2\n", "holds no particles that are known by name, but mass, colour"),
    "cells.csv": (b"# cells = many\nid,x,t\n1,2,3\n", "has cells = many; give a number"),
    "halfcells.csv": (b"# cells = 1.5\nid,x,t\n1,2,3\n", "states 1.5 cells"),
    "grid.csv": (b"# cells = 2\nid,x,t\n1,2,3\n", "belongs to a grid of 2 cells, which cannot be"),
    "binary.csv": (b"id,x\0\n1,2\n", "is no text"),
    "no.npz": (b"nothing", "is no .npz of plain numbers"),
    "no.vtu": (b'<VTKFile type="UnstructuredGrid">', "cannot be read as .vtu ("),
    "letters.vtu": (b'<VTKFile type="UnstructuredGrid"><UnstructuredGrid><Piece NumberOfPoints="1"><Points><DataArray '
                    b'type="Float64" NumberOfComponents="3" format="binary">A=======</DataArray></Points></Piece>',
                    "cannot be read as .vtu (letters that are no base64)"),
    "no.vtk": (b"nothing", "cannot be read as .vtk ("),
    "no.vtp": (b'<VTKFile type="UnstructuredGrid"/>', "is no PolyData"),
    "no.xyz": (b"1", "is of no kind that is known; give a file that ends in .csv, .txt"),
}


@pytest.mark.parametrize("name", CONTENTS)
def test_a_file_that_is_none_is_named(name, tmp_path, capsys):
    content, said = CONTENTS[name]
    (tmp_path / name).write_bytes(content)
    _refused(["judge", "bar", str(tmp_path / name)], said, tmp_path, capsys, str(tmp_path / name))


@pytest.mark.parametrize("arrays, said", [
    ({"x": np.zeros((3, 8, 1)), "t": np.arange(2.0)}, "has 2 times and positions of the shape"),
    ({"x": np.zeros((3, 8, 1)), "t": np.arange(3.0), "v": np.zeros((2, 8, 1))}, "has v of the shape (2, 8, 1)"),
    ({"x": np.zeros(0), "id": np.zeros(0), "t": 1.0}, "holds no particles: its columns are empty"),
    ({"x": np.zeros(4), "v": np.zeros(3), "t": 1.0}, "has columns of several lengths"),
    ({"x": np.zeros(4), "F": np.zeros((4, 5)), "t": 1.0}, "has F of the shape (4, 5)"),
    ({"x": np.zeros(4), "v": np.array(list("abcd")), "t": 1.0}, "has no numbers in v"),
    ({"x": np.zeros(4), "sxy": np.zeros(4), "t": 1.0}, "has some components of sigma but not xx"),
    ({"x": np.zeros((4, 2)), "position": np.ones((4, 2)), "t": 1.0}, "has x twice"),
])
def test_arrays_that_do_not_fit_are_named(arrays, said, tmp_path):
    np.savez(tmp_path / "bad.npz", **arrays)
    with pytest.raises(FileError) as error:
        read_file(str(tmp_path / "bad.npz"))
    assert said in error.value.sentence


@pytest.mark.parametrize("flags, said", [
    (["--time", "9"], "its column t has 0.3 s and --time has 9 s"), (["OTHER"], "has the time 0.3 s, which")])
def test_times_that_contradict_are_one_line(flags, said, tmp_path, capsys):
    file = csv_file(tmp_path, table(t=np.full(len(IDS), 0.3)))
    other = csv_file(tmp_path, table(t=np.full(len(IDS), 0.3), x=table()["X"]), "bad.csv.other.csv")
    flags = [other if flag == "OTHER" else flag for flag in flags]
    _refused(["judge", "bar", file, *flags, "--cells", "12"], said, tmp_path, capsys, file)


def test_without_a_directory_the_summary_is_printed(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["judge", "bar", csv_file(tmp_path, table()), "--cells", "12", "--no-compare"]) == 0
    said = capsys.readouterr().out
    assert said.startswith("# Vibrating bar: 1 file judged") and "**12 cells:** the error of x is up to" in said
    assert "## " not in said
    assert [entry.name for entry in tmp_path.iterdir()] == ["bad.csv"]


def _refused(arguments, said, folder, capsys, file) -> None:
    assert main([*arguments, "--out", str(folder / "new")]) == 2
    error = capsys.readouterr().err
    assert said in error and Path(file).name in error and error.count("\n") == 1
