"""Files of another problem, grid or scene than they are judged with: refused in one sentence that names what fits."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from app.cli import main
from solvers.judging import particle_writers
from solvers.judging.judgement import judge
from solvers.judging.particle_data_types import ProblemMismatch, RawTable
from solvers.judging.particle_readers import read_file
from solvers.judging.problem_handout import exact_frame
from solvers.problems import PROBLEMS
from solvers.problems.bar.scene import BarScene
from solvers.running.scene_json_line import MAX_LINE, SCHEMA, scene_line
from solvers.untrusted.quoting import FileError


def scene_of(problem: str, **more):
    return PROBLEMS[problem].scene(cells=12, **more)


def frames_of(problem: str, **more):
    scene = scene_of(problem, **more)
    return [exact_frame(scene, part * scene.period) for part in (0.0, 0.1)]


@pytest.fixture(scope="module")
def own(tmp_path_factory):
    """Files that say their scene as ours do, of an amplitude that is not the default."""
    folder = tmp_path_factory.mktemp("own")
    for problem in PROBLEMS:
        frames, scene = frames_of(problem, amplitude=0.01), scene_of(problem, amplitude=0.01)
        (folder / f"{problem}.npz").write_bytes(particle_writers.npz_bytes(frames, scene))
        table = particle_writers.csv_text(particle_writers.frame_columns(frames), {"scene": scene_line(scene)})
        (folder / f"{problem}.csv").write_bytes(table)
    return folder


def judged(problem: str, file: Path, *flags: str) -> int:
    return main(["judge", problem, str(file), "--no-compare", "--quiet", *flags])


@pytest.fixture
def refused(capsys):
    """What the command says, in one line, of a file that it does not judge."""
    def said(problem: str, file: Path, *flags: str) -> str:
        assert judged(problem, file, *flags) == 2
        error = capsys.readouterr().err
        assert error.count("\n") == 1
        return error

    return said


@pytest.mark.parametrize("problem, file", [("bar", "ring"), ("bar", "vortex"), ("ring", "vortex"), ("vortex", "bar")])
def test_a_file_of_ours_on_another_problem_names_its_own(problem, file, own, refused):
    says = f"is a file of the {file}; it fits `mpm-lab judge {file}`"
    assert says in refused(problem, own / f"{file}.npz")


def test_what_is_asked_for_and_what_the_file_says_must_not_contradict(own, refused):
    assert judged("bar", own / "bar.npz", "--amplitude", "0.01") == 0
    said = refused("bar", own / "bar.npz", "--amplitude", "0.02")
    assert "has amplitude 0.01, but --amplitude is 0.02; give the value of the run" in said
    said = refused("bar", own / "bar.npz", "--motion", "patch")
    assert "has motion vibrate, but --motion is patch" in said


def test_files_of_several_scenes_are_not_one_run(own, tmp_path):
    frames = frames_of("bar", amplitude=0.02)
    scene = replace(scene_of("bar", amplitude=0.02), cells=12)
    (tmp_path / "b.npz").write_bytes(particle_writers.npz_bytes(frames, scene))
    with pytest.raises(FileError, match=r"has amplitude 0\.02, but .*bar\.npz has 0\.01"):
        judge(PROBLEMS["bar"].scene(), [str(own / "bar.npz"), str(tmp_path / "b.npz")])


def stranger(problem: str, folder: Path, **changed) -> Path:
    """A file that says nothing of its scene."""
    columns = particle_writers.frame_columns(frames_of(problem)) | changed
    file = folder / "theirs.csv"
    file.write_bytes(particle_writers.csv_text({name: values for name,
                                                values in columns.items() if values is not None}))
    return file


NO_X = {"X": None, "Y": None}


@pytest.mark.parametrize("columns", [{}, NO_X], ids=["material positions", "ids"])
@pytest.mark.parametrize("problem", ["ring", "vortex"])
def test_a_strangers_file_of_two_directions_is_no_bars(problem, columns, tmp_path, refused):
    """Ids alone can be those of both; material positions are of one."""
    said = refused("bar", stranger(problem, tmp_path, **columns), "--cells", "12")
    assert "has positions in two directions, and the bar has one; it fits " in said
    assert f"`mpm-lab judge {problem}`" in said


def test_a_direction_in_which_nothing_reaches_is_none(tmp_path):
    """Codes write three components; the second of a bar's is rounding."""
    still = np.full(len(particle_writers.frame_columns(frames_of("bar"))["t"]), 0.3)
    file = stranger("bar", tmp_path, y=still + 1e-12 * np.arange(len(still)), z=0 * still)
    judgement = judge(scene_of("bar"), str(file))
    assert judgement.grids[0].norms["x"].max() < 1e-15 and judgement.grids[0].notes() == []


def test_a_bar_on_a_line_is_no_ring(tmp_path):
    frames = frames_of("bar")
    with pytest.raises(ProblemMismatch) as refused:
        judge(scene_of("ring"), {"t": 0.1, "id": frames[1].number, "x": np.pad(frames[1].position, ((0, 0), (0, 1)))})
    assert "has positions in one direction, and the ring has two" in str(refused.value)


@pytest.mark.parametrize("problem", ["bar", "vortex"])
def test_ids_of_another_grid_are_refused_with_the_grid_that_fits(problem, tmp_path, refused):
    """Of a coarse one, whose particles are but the first of many here; and of a fine one."""
    file = stranger(problem, tmp_path, **NO_X)
    count = PROBLEMS[problem].scene(cells=12).particles
    said = refused(problem, file, "--cells", "24")
    assert f"has ids from 0 to {count - 1}, and 24 cells" in said and "(so many are those of 12 cells)" in said
    if problem != "vortex":  # which has 12 at least
        assert "(so many are those of 12 cells)" in refused(problem, file, "--cells", "8")
    assert judged(problem, file, "--cells", "12") == 0


def test_some_particles_of_a_grid_are_enough(tmp_path):
    """Every third, and the first few: they are judged, with a word on what is missing."""
    for few in (slice(None, None, 3), slice(0, 5)):
        frame = frames_of("bar")[1]
        arrays = {"t": frame.time, "id": frame.number[few], "x": frame.position[few]}
        [grid] = judge(scene_of("bar"), arrays).to_dict()["grids"]
        assert grid["error"]["x"]["max"] < 1e-15 and "particles cover" in " ".join(grid["notes"])


def test_ids_in_another_order_do_not_begin_where_ours_do(tmp_path):
    frame = frames_of("ring")[0]
    with pytest.raises(ProblemMismatch, match="m off the initial positions of the ring"):
        judge(scene_of("ring"), {"t": 0.0, "id": frame.number[::-1], "x": frame.position})


def test_a_file_that_lies_about_its_problem_is_not_believed(tmp_path, refused):
    """A bar's particles that say they are a ring's, to whomever asks."""
    (tmp_path / "liar.npz").write_bytes(particle_writers.npz_bytes(frames_of("bar"), scene_of("ring")))
    said = refused("ring", tmp_path / "liar.npz")
    assert "is a file of the ring, and has x in one direction, and the ring has two; it fits" in said
    assert "`mpm-lab judge bar`" in said
    said = refused("bar", tmp_path / "liar.npz")
    assert "is a file of the ring, and its particles are not; take the line called scene out" in said


def test_a_file_that_lies_about_its_cells_is_refused(tmp_path):
    frames = frames_of("bar")
    np.savez(tmp_path / "a.npz", t=frames[1].time, x=frames[1].position, id=frames[1].number, cells=40,
             scene=np.array(scene_line(scene_of("bar"))))
    with pytest.raises(FileError, match="states 40 cells, but 12 in its scene"):
        read_file(str(tmp_path / "a.npz"))


def said(**changed) -> str:
    return json.dumps({"schema": SCHEMA, "problem": "bar", "inputs": {}} | changed)


@pytest.mark.parametrize("text, why", [
    (said(problem="dam"), "names an unknown problem"),
    (said(problem=["bar"]), "names an unknown problem"),
    (said(schema="mpm-lab/particles/2"), "of another format version (mpm-lab/particles/2)"),
    (said(inputs={"amplitude": 1e9}), "has an invalid scene: amplitude 1000000000:"),
    (said(inputs={"amplitude": "much"}), "invalid scene"), (said(inputs={"cells": True}), "invalid scene"),
    (said(inputs={"amplitude": float("nan")}), "has an invalid scene: amplitude nan"),
    (said(inputs={"cells": 10**9}), "has an invalid scene: cells"),
    (said(inputs={"amplitude": [1]}), "has a scene with inputs that the bar does not accept"),
    (said(inputs={"__class__": 1}), "has a scene with inputs that the bar does not accept"),
    (said(inputs={"body_force": "x" * 100}), "has a scene with inputs that the bar does not accept"),
    (said(inputs=[1, 2]), "has a scene that cannot be read"), (said()[:-1], "has a scene that cannot be read"),
    (said(inputs={"a": "x" * MAX_LINE}), "has a scene that cannot be read"),
    ('{"schema":"mpm-lab/particles/1","problem":' + "[" * 3000, "has a scene that cannot be read")])
def test_a_scene_that_is_none_is_refused_in_one_sentence(text, why, tmp_path):
    frame = frames_of("bar")[1]
    np.savez(tmp_path / "a.npz", t=frame.time, x=frame.position, id=frame.number, scene=np.array(text))
    with pytest.raises(FileError) as refused:
        read_file(str(tmp_path / "a.npz"))
    assert why in refused.value.sentence and "\n" not in refused.value.sentence and len(refused.value.sentence) < 400


@pytest.mark.parametrize("other", [np.array("my own scene"), np.arange(3.0), np.array(b"mpm-lab/particles/1")])
def test_what_others_call_a_scene_is_theirs(other, tmp_path):
    frame = frames_of("bar")[1]
    np.savez(tmp_path / "a.npz", t=frame.time, x=frame.position, id=frame.number, scene=other)
    assert read_file(str(tmp_path / "a.npz")).metadata is None


def test_a_file_of_ours_is_judged_with_the_scene_that_it_says(tmp_path):
    """Of each problem and motion, in both forms; nothing else says its amplitude or its cells."""
    for scene in (scene_of("bar", motion="patch", ppc=2.5), scene_of("ring", amplitude=0.02),
                  scene_of("vortex", body_force="two-tone")):
        frames = [exact_frame(replace(scene, body_force="material"), 0.1 * scene.period)]
        (tmp_path / "a.npz").write_bytes(particle_writers.npz_bytes(frames, scene))
        (tmp_path / "a.csv").write_bytes(particle_writers.csv_text(particle_writers.frame_columns(frames),
                                                                   {"scene": scene_line(scene)}))
        for kind in ("npz", "csv"):
            raw: RawTable = read_file(str(tmp_path / f"a.{kind}"))
            [grid] = judge(PROBLEMS[scene.problem].scene(), raw).grids
            own = grid.scene
            assert "judged with the scene" in " ".join(grid.notes())
            assert (own.ppc, own.amplitude, own.body_force) == (scene.ppc, scene.amplitude, scene.body_force)
            assert own.particles == scene.particles


def test_a_flag_that_contradicts_the_cells_of_a_file_is_refused(tmp_path):
    """Also where the file says nothing but its cells; a flag at its default contradicts nothing."""
    file = {"X": (np.arange(40) + 0.5) / 40, "x": (np.arange(40) + 0.5) / 40, "t": 0.0, "cells": 10}
    with pytest.raises(FileError, match="states 10 cells, but --cells is 20; give the value of the run"):
        judge(BarScene(cells=20), file, cells=[20])
    assert judge(BarScene(), file).grids[0].scene.cells == judge(BarScene(cells=10), file).grids[0].scene.cells == 10
