"""``mpm-lab problem``: files that set the problem up, true to the equations, and one line for every mistake."""

import json
from dataclasses import replace

import meshio
import numpy as np
import pytest

from app.cli import main
from solvers.estimators.standalone_companion import solve
from solvers.judging.particle_readers import read_file
from solvers.judging.problem_handout import companion_frames, exact_frame
from solvers.problems import PROBLEMS
from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.problems.vortex import VortexScene
from solvers.running.run import build

FILES = {"particles.csv", "particles.vtu", "body_force.csv", "exact.csv", "problem.json", "problem.md"}


@pytest.fixture(scope="module", params=PROBLEMS)
def folder(request, tmp_path_factory):
    """The files of a problem at two times."""
    path = tmp_path_factory.mktemp("problem") / request.param
    assert main(["problem", request.param, "--cells", "12", "--times", "0.003", "0.001", "--out", str(path)]) == 0
    return request.param, path


def test_particles_are_those_that_our_runs_begin_with(folder):
    """That runs begin with them is in tests/solvers/problems/test_exact.py; here what both files say."""
    problem, path = folder
    scene = PROBLEMS[problem].scene(cells=12)
    raw, one, vtu = read_file(str(path / "particles.csv")), exact_frame(scene,
                                                                        0.0), read_file(str(path / "particles.vtu"))
    assert (raw.columns["id"] == np.arange(len(one.position))).all() and raw.cells == 12 and raw.time == vtu.time == 0
    assert (raw.columns["X"] == PROBLEMS[problem].reference.start(scene).material_position).all()
    assert (raw.columns["v"] == one.velocity).all() and (raw.columns["x"] == one.position).all()
    mesh, D = meshio.read(path / "particles.vtu"), one.position.shape[1]
    assert (mesh.points[:, :D] == raw.columns["X"]).all() and (vtu.columns["v"][:, :D] == raw.columns["v"]).all()
    assert (mesh.point_data["velocity"][:, :D] == raw.columns["v"]).all()


def test_the_mass_is_the_bodys(folder):
    problem, path = folder
    text = (path / "particles.csv").read_text().splitlines()
    names = text[4].split(",")
    mass = sum(float(line.split(",")[names.index("mass")]) for line in text[5:])
    whole = {"bar": 1.0, "ring": 1000 * np.pi / 4 * (0.6**2 - 0.4**2), "vortex": 1000 * np.pi * (1.25**2 - 0.75**2),
             "square": 1000.0}
    # polar volumes are exact for thin wedges: r dr dtheta at the middle
    assert mass == pytest.approx(whole[problem], rel=1e-12)


def test_the_table_of_the_force_is_the_problems(folder):
    """Which makes the exact solution one: tests/solvers/scene/test_exact_solutions.py. Printed as it is."""
    problem, path = folder
    scene, reference = PROBLEMS[problem].scene(cells=12), PROBLEMS[problem].reference
    rows = np.loadtxt(path / "body_force.csv", delimiter=",", skiprows=2)
    t, X, b = np.split(rows, [1, 1 + scene.DIMENSIONS], axis=1)
    assert len(set(t[:, 0])) > 2 and np.abs(b).max() > 0
    for time in sorted(set(t[:, 0])):
        now = t[:, 0] == time
        np.testing.assert_allclose(b[now], reference.body_force(scene, X[now], time), atol=1e-12 * np.abs(b).max())


def test_the_exact_file_has_the_times_in_order_and_the_law(folder):
    problem, path = folder
    scene = PROBLEMS[problem].scene(cells=12)
    raw = read_file(str(path / "exact.csv"))
    assert sorted(set(raw.columns["t"])) == [0.001, 0.003]
    stress = PROBLEMS[problem].reference.stress(scene, raw.columns["F"])
    assert np.abs(stress - raw.columns["sigma"]).max() < 1e-12 * scene.modulus


def test_the_page_names_the_numbers_and_every_file(folder):
    problem, path = folder
    assert {entry.name for entry in path.iterdir()} == FILES
    page, numbers = (path / "problem.md").read_text(), json.loads((path / "problem.json").read_text())
    assert all(name in page for name in FILES - {"problem.md"})
    assert f"mpm-lab judge {problem}" in page and numbers["problem"] == problem
    assert numbers["particles"] == len(read_file(str(path / "particles.csv")).columns["id"])


@pytest.mark.parametrize("scene", [
    BarScene(body_force="two-tone"), *(pytest.param(scene, marks=pytest.mark.slow) for scene in (
        BarScene(body_force="none"), *(RingScene(cells=48, body_force=force) for force in ("two-tone", "none")),
        *(VortexScene(amplitude=0.1, body_force=force) for force in ("two-tone", "none"))))])
def test_the_companion_alone_is_the_one_beside_our_particles(scene):
    """Two meshes of their own: 1e-4 of the motion is what the coarser one may be off."""
    solver = build(replace(scene, estimators=("companion",)))
    solver.advance(round(0.4 * scene.period / scene.time_step))
    shot = solver.snapshot()
    frame = companion_frames(scene, [solver.time])[0]
    error = np.linalg.norm(shot.position.reshape(frame.position.shape) - frame.position, axis=1)
    assert np.abs(error - np.abs(shot.estimate["companion"][:, 0])).max() < 1e-4 * scene.size_of("x")


@pytest.mark.parametrize("problem", PROBLEMS)
def test_the_companion_alone_finds_the_exact_solution(problem):
    scene = PROBLEMS[problem].scene()
    reference = PROBLEMS[problem].reference
    X, times = reference.start(scene).material_position, [0.3 * scene.period, scene.period]
    for fine, allowed in ((True, 1e-6), (False, 1e-4)):
        body = reference.companion(scene, fine)
        for t, (u, v) in zip(times, solve(body, times), strict=True):
            moved, gradient = body.values_and_gradients(u, X)
            speed = body.values_and_gradients(v, X)[0]
            assert np.abs(moved - reference.displacement(scene, X, t)).max() < allowed * scene.size_of("x")
            assert np.abs(speed - reference.velocity(scene, X, t)).max() < 10 * allowed * scene.size_of("v")
            F = np.eye(X.shape[1]) + gradient
            known = reference.deformation_gradient(scene, X, t)
            assert np.abs(F - known).max() < 10 * allowed * np.abs(known).max()


def test_a_problem_without_a_solution_brings_the_companions(tmp_path):
    assert main(["problem", "ring", "--cells", "12", "--body-force", "none", "--out", str(tmp_path / "free")]) == 0
    names = {entry.name for entry in (tmp_path / "free").iterdir()}
    assert names == FILES - {"exact.csv"} | {"companion.csv"}
    assert "None is built in" in (tmp_path / "free" / "problem.md").read_text()
