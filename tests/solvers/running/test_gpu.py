"""A GPU: the same numbers as on a processor, the same ends of bad runs, and plain words where there is none.

One method, what a run is put back to, what the check finds and what is refused are for every day; the rest is slow.

Vulkan runs these tests without a GPU, by Mesa's driver, which plays one on the processor (``tests.support.gpus``).
"""

import functools
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import pytest
import taichi as ti

from app.cli import main
from app.commands.bench.command import bench_table
from solvers.bench import gpu_speedup
from solvers.kernels import elementary_functions, runtime
from solvers.kernels.dtypes import quads, reals
from solvers.problems.bar.scene import BarScene
from solvers.problems.ring import RingScene
from solvers.problems.square import SquareScene
from solvers.problems.vortex import VortexScene
from solvers.running.run import build, run
from solvers.scene import scene as scene_module
from solvers.scene.scene import MOST_ON_GPU, Scene
from solvers.scene.stabilisations import COUPLED, FILTER, FROZEN
from solvers.scene.validation import SceneError
from solvers.solver import gpu_detection, samples
from solvers.solver.base import Solver
from solvers.solver.particle_snapshot import Snapshot
from solvers.solver.serial_stepping import CHECK_EVERY
from tests.support.gpus import ARCH, require_gpu

RING = RingScene(cells=16, estimators=("companion",), arch=ARCH, sample_every=20)
VORTEX = VortexScene(cells=24, amplitude=0.5, estimators=("companion",), arch=ARCH, sample_every=20)
SQUARE = SquareScene(cells=10, method="ugimp", estimators=("companion",), arch=ARCH, sample_every=20)
METHODS = [SQUARE, *(replace(scene, method=method) for scene in (RING, VORTEX) for method in scene.choices("method"))]
QUICK = replace(RING, method="ugimp")  # the slow set has all methods in both problems, over more steps
#: Each remedy, layout and force twice, combined otherwise.
OTHERS = [replace(RING, method="cpgimp", remedies=(FILTER, COUPLED), velocity="particle", layout="cartesian",
                  body_force="two-tone"),
          replace(VORTEX, method="ugimp", remedies=(FROZEN,), body_force="none"),
          replace(RING, method="mpm", remedies=(FROZEN,), layout="cartesian", body_force="two-tone"),
          replace(VORTEX, remedies=(FILTER,), body_force="two-tone", layout="cartesian")]
#: Few; and many, for rounding to add up, which the slow set takes. A step costs Mesa's driver 0.06 s, be there
#: 30 particles or 2000: what counts is the number of steps.
FEW, MANY = 20, 200
#: Of the largest number of its kind, what two plans may differ by after a step: they add the same numbers at a node or
#: a particle, 64 at most (16 particles with four corners each), in another order, and each addition rounds by half of
#: 2.2e-16. A sound run makes of no difference a larger one, so that steps add up. Measured: a tenth of it and less.
ROUNDING = 64 * 2.2e-16


def on_processor(scene: Scene) -> Scene:
    return replace(scene, arch="cpu")


def named(scene: Scene) -> str:
    return "-".join((scene.problem, scene.method, *scene.remedies))


class Taken(NamedTuple):
    """A run after some steps. Of a solver itself nothing is left to ask once another kind of processor has started."""

    solver: Solver
    shot: Snapshot
    series: dict[str, np.ndarray]
    not_valid: dict[str, str]


def taken(scene: Scene, steps: int) -> Taken:
    """After so many steps, with samples as they are due, one at the start and one at the end."""
    solver = build(scene)
    solver.compile()
    rows = np.concatenate([solver.measure(), solver.advance(steps), solver.measure()])
    shot = solver.snapshot()
    series = samples.read_rows(rows, scene, len(shot.position))
    return Taken(solver, shot, series, solver.not_valid())


def assert_same_state(mine: Snapshot, theirs: Snapshot) -> None:
    """Positions, velocities and deformation gradients, but for rounding; crossings and their steps."""
    assert mine.step == theirs.step
    for name in ("position", "velocity", "deformation_gradient"):
        one, other = getattr(mine, name), getattr(theirs, name)
        assert np.abs(one - other).max() <= mine.step * ROUNDING * np.abs(other).max(), name
    if theirs.last_crossing is not None:
        np.testing.assert_array_equal(mine.last_crossing, theirs.last_crossing)


def assert_same_samples(mine: dict[str, np.ndarray], theirs: dict[str, np.ndarray], scene: Scene) -> None:
    """Sums over particles to 1e-7: of errors that are 1e-5 of x at least, which agrees to 1e-12 and better. Where a
    symmetric motion has its worst pair twice, either may be named; the estimates have a test of their own."""
    for name, values in theirs.items():
        if name != "place" and "companion" not in name:
            np.testing.assert_allclose(mine[name], values, rtol=1e-7, atol=1e-12 * scene.motion_amplitude, err_msg=name)


def assert_same_estimates(mine: dict[str, np.ndarray], theirs: dict[str, np.ndarray]) -> None:
    """Two companions on one mesh that take other steps in time: each is as far from the truth as its own errors are,
    and so from the other by no more than both together."""
    for quantity in samples.QUANTITIES:
        apart = abs(mine[f"companion/estimate_{quantity}"] - theirs[f"companion/estimate_{quantity}"])
        own = sum(series[f"companion/difference_{quantity}"] for series in (mine, theirs))
        assert (apart[1:] <= own[1:]).all(), quantity
        assert (own[1:] < 0.02 * theirs[f"error_{quantity}"][1:]).all(), quantity


@pytest.fixture(scope="module", autouse=True)
def leave_the_processor_running():
    """Later tests of this process begin as they would without these."""
    yield
    runtime.start()


@ti.kernel
def tabulate(x: reals, values: quads):
    """sin, cos and log of each, and in the last column twice the same, found by the kernel itself between two loops."""
    for k in range(x.shape[0]):
        values[k] = ti.Vector([elementary_functions.sin(x[k]), elementary_functions.cos(x[k]),
                               elementary_functions.log(ti.abs(x[k])), 0.0])
    one = elementary_functions.cos(x[0]) + elementary_functions.sin(x[0])
    for k in range(x.shape[0]):
        values[k][3] = one
    other = elementary_functions.cos(x[0]) + elementary_functions.sin(x[0])
    for k in range(x.shape[0]):
        values[k][3] = values[k][3] - other


@pytest.mark.slow
def test_sine_cosine_and_logarithm_in_double_precision():
    """Vulkan has none. To two units in the last place, near a zero of sine or cosine of 1; and equal to themselves,
    which Taichi's own conditions, found between two loops of a kernel, were not."""
    require_gpu()
    runtime.start(ARCH)
    chance = np.random.default_rng(0)
    x = np.concatenate([[0.3], chance.uniform(-10, 10, 20_000), chance.uniform(0, 1e6, 20_000),
                        chance.uniform(0.5, 2, 20_000), 1 + 1e-8 * chance.normal(size=20_000)])
    values = np.zeros((len(x), 4))
    tabulate(x, values)
    assert np.abs(values[:, 0] - np.sin(x)).max() < 4.5e-16 and np.abs(values[:, 1] - np.cos(x)).max() < 4.5e-16
    exact = np.log(np.abs(x))
    assert (np.abs(values[:, 2] - exact) <= 2 * np.spacing(np.abs(exact))).all()
    assert (values[:, 3] == 0).all()


@pytest.mark.parametrize(("scene", "steps"), [
    (QUICK, FEW), *(pytest.param(scene, steps, marks=pytest.mark.slow)
                    for scenes, steps in ((METHODS, MANY), (OTHERS, FEW)) for scene in scenes)],
    ids=lambda value: named(value) if isinstance(value, Scene) else str(value))
def test_every_method_remedy_layout_and_force_is_the_processors(scene, steps):
    """State, samples and, against a truth, estimates after so many steps, in which there are turns of the remedies, are
    the processor's, and the run says how it was made."""
    require_gpu()
    mine, theirs = taken(scene, steps), taken(on_processor(scene), steps)
    assert (mine.solver.arch, mine.solver.plan, mine.solver.threads, mine.solver.sound) == (ARCH, "gpu", 1, True)
    assert_same_state(mine.shot, theirs.shot)
    assert_same_samples(mine.series, theirs.series, scene)
    if scene.solution_known:
        assert_same_estimates(mine.series, theirs.series)
    assert mine.not_valid == theirs.not_valid


@pytest.mark.slow
def test_a_run_can_be_put_back_taken_apart_and_taken_in_pieces():
    """To the bit what it was when it was bookmarked; a step taken apart is the processor's; pieces are the whole."""
    require_gpu()
    scene = replace(RING, method="ugimp", sample_every=4)
    mine, whole = build(scene), build(scene)
    rows = np.concatenate([mine.advance(n) for n in (1, 7, 16)])
    assert len(rows) == 24 // scene.sample_interval == len(whole.advance(24))
    shots, bookmark, before = (mine.snapshot(), whole.snapshot()), mine.bookmark(), mine.state()
    breakdown = mine.break_down(5)[1]
    bookmark()
    step, arrays = mine.state()
    assert step == before[0] == 24
    for name, values in before[1].items():
        np.testing.assert_array_equal(arrays[name], values, err_msg=name)
    theirs = build(on_processor(scene))
    theirs.advance(24)
    for shot in shots:
        assert_same_state(shot, theirs.snapshot())
    for name, values in vars(theirs.break_down(5)[1]).items():
        if isinstance(values, np.ndarray) and values.dtype.kind == "f":
            np.testing.assert_allclose(getattr(breakdown, name), values, rtol=1e-9, atol=1e-9 * np.abs(values).max())


#: What is wrong with which particles, and what the check must find.
SPOILED: dict[str, dict[int, Any]] = {
    "inverted": {7: (-1.0, 0.0, 0.0, 1.0)}, "crushed": {7: (1e-4, 0.0, 0.0, 1.0), 9: (2e-4, 0.0, 0.0, 1.0)},
    "no number": {3: (-1.0, 0.0, 0.0, 1.0), 7: (np.nan, 0.0, 0.0, 1.0), 9: (np.nan, 0.0, 0.0, 1.0)},
    "alike": {9: (-1.0, 0.0, 0.0, 1.0), 7: (-1.0, 0.0, 0.0, 1.0)}, "escaped": {9: 100.0, 11: 100.0},
    "escaped and crushed": {2: 100.0, 7: (1e-4, 0.0, 0.0, 1.0)}}


@functools.cache  # one kind of processor after the other: each time that it changes, Taichi starts and compiles anew
def verdicts(scene: Scene) -> dict[str, list[tuple[bool, str]]]:
    """For each kind of what is wrong whether the run is sound, and why not, on the GPU and on the processor."""
    found: dict[str, list[tuple[bool, str]]] = {kind: [] for kind in SPOILED}
    for arch in (ARCH, "cpu"):
        for kind, spoiled in SPOILED.items():
            solver = build(replace(scene, arch=arch, effects=(), estimators=()))
            step, arrays = solver.state()
            for particle, what in spoiled.items():
                if isinstance(what, float):
                    arrays["position_velocity"][particle, 0] = what
                else:
                    arrays["deformation_gradient"][particle] = what
            solver.restore(step, arrays)
            solver.measure()
            found[kind].append((solver.sound, solver.reason()))
    return found


@pytest.mark.parametrize("kind", SPOILED)
@pytest.mark.parametrize("scene", [RING, pytest.param(VORTEX, marks=pytest.mark.slow)], ids=lambda scene: scene.problem)
def test_the_check_finds_the_particle_that_the_processors_finds(scene, kind):
    require_gpu()
    mine, theirs = verdicts(scene)[kind]
    assert mine == theirs and not mine[0]


@pytest.mark.slow
@pytest.mark.parametrize(("scene", "breaking"), [  # steps in which the run breaks, measured: at 24 and at 88
    (replace(RING, method="ugimp", cfl=0.85, effects=("truth",), estimators=()), 40),
    (replace(VORTEX, method="mpm", amplitude=1.0, estimators=()), 104)],
    ids=["ring-ugimp", "vortex-mpm"])
def test_an_unstable_run_ends_as_on_the_processor(scene, breaking):
    """With the same verdict at the same step; nothing moves after it, though the GPU had been given more steps."""
    require_gpu()
    mine = build(scene)
    mine.advance(breaking)
    before = mine.snapshot()
    mine.advance(8)
    np.testing.assert_array_equal(mine.snapshot().position, before.position)
    theirs = build(on_processor(scene))
    theirs.advance(breaking)
    assert not mine.sound and mine.step == theirs.step < breaking
    assert list(mine._arrays.verdict[:2]) == list(theirs._arrays.verdict[:2])


@pytest.mark.slow
def test_a_run_that_is_lost_before_it_breaks_is_lost_from_the_same_time_on():
    require_gpu()
    scene = RingScene(method="mpm", cells=8, cfl=0.3, periods=2, effects=("truth", "soundness"), estimators=(),
                      amplitude=0.2, arch=ARCH)
    mine, theirs = run(scene, prices=False), run(on_processor(scene), prices=False)
    assert theirs.status == "unstable" and theirs.broken_at < 0.5 * theirs.time
    assert (mine.status, mine.broken_at) == (theirs.status, theirs.broken_at)
    assert abs(mine.steps - theirs.steps) <= CHECK_EVERY  # sums in another order break in another step


@pytest.mark.slow
def test_no_vector_is_shared_by_two_loops_of_a_kernel():
    """Taichi 1.7.4 stores one after an odd number of integers at an address that CUDA refuses and Vulkan accepts."""
    require_gpu()
    build_and_compile = "from tests.solvers.running.test_gpu import *; build(RING).compile()"
    code = subprocess.run([sys.executable, "-c", build_and_compile], check=True, capture_output=True, text=True,
                          errors="replace", env={**os.environ, "TI_PRINT_IR": "1", "TI_OFFLINE_CACHE": "0"}).stdout
    shared = [line for line in code.splitlines() if "global tmp var" in line]
    assert shared and not [line for line in shared if "Tensor" in line]


@pytest.mark.slow
def test_processors_and_gpus_take_turns():
    """Arrays of a Taichi that has ended are not freed in the next one, at addresses that now are others': once, after
    some turns, that took an array away."""
    require_gpu()
    kept = []
    for _ in range(5):
        for arch in (ARCH, "cpu"):
            solver = build(replace(RING, arch=arch, cells=8, effects=("truth",), estimators=()))
            kept.append(solver)
            assert len(solver.measure()) == 1 and np.isfinite(solver.snapshot().position).all()


@pytest.mark.slow
def test_rebuilding_does_not_grow():
    """Taichi by itself keeps arrays of vectors: 15 MB of each ring, 150 for ten; 40 allows for its habits."""
    require_gpu()

    def resident() -> float:
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1]) * 4096e-6

    scene = RingScene(cells=300, method="ugimp", effects=(), estimators=(), arch=ARCH)
    for k in range(13):
        solver = build(replace(scene, amplitude=0.05 + 0.001 * k))
        solver.advance(1)
        if k == 2:
            before = resident()
    assert solver.bytes > 15e6
    assert resident() - before < 40


def test_other_estimators_are_refused_in_words():
    """Those of a processor say so and do not run; the companion does. Whether there is a GPU does not matter."""
    scene = replace(RING, arch="gpu", estimators=("transport", "companion", "recovered"))
    assert scene.active_estimators == ("companion",)
    assert set(scene.not_valid) == {"transport", "recovered"}
    assert scene.not_valid["transport"].startswith("not valid here: transport works on the particles in every step")
    assert not on_processor(scene).not_valid


@pytest.mark.parametrize("make, field, words", [
    (lambda: BarScene(arch="cuda"), "arch", "runs on the processor"),
    (lambda: RingScene(arch="vulkan", plan="parallel"), "plan", "is for CPUs"),
    (lambda: VortexScene(arch="gpu", plan="serial"), "plan", "give auto"),
    (lambda: RingScene(arch="gpu", cells=9000, ppc=3), "ppc", f"{MOST_ON_GPU:,}"),
    (lambda: RingScene(cells=1600), "ppc", "1,000,000")])
def test_what_a_gpu_does_not_take_is_refused_in_words(make: Callable[[], Scene], field, words):
    with pytest.raises(SceneError, match=words) as refusal:
        make()
    assert refusal.value.field == field


@pytest.fixture
def nothing_there(monkeypatch):
    """A machine without any GPU."""
    monkeypatch.setattr(gpu_detection, "probe_device",
                        lambda kind: {"name": "", "software": False, "missing": "Taichi sees none"})


@pytest.mark.parametrize("arch, title", [("cuda", "CUDA"), ("vulkan", "Vulkan")])
def test_a_gpu_that_is_asked_for_by_name_and_is_not_there(nothing_there, capsys, arch, title):
    status = main(["run", "ring", "--cells", "8", "--periods", "0.1", "--arch", arch])
    out, err = capsys.readouterr()
    assert (status, out, err.count("\n")) == (2, "", 1)
    assert f"--arch {arch}: no {title} device was found" in err and "give gpu" in err


@pytest.mark.parametrize("problem, words", [("ring", "no GPU was found: this ran on the processor"),
                                            ("bar", "the bar is built for processors: this ran on the processor")])
def test_a_run_for_any_gpu_goes_to_the_processor_where_there_is_none(nothing_there, capsys, problem, words):
    """As it always has, with a remark."""
    status = main(["run", problem, "--cells", "8", "--periods", "0.1", "--arch", "gpu", "--estimator", "none"])
    assert status == 0 and words in capsys.readouterr().err


def test_so_many_particles_need_the_gpu(nothing_there):
    with pytest.raises(SceneError, match="no GPU was found for these 1,136,889 particles; at most 1,000,000"):
        build(RingScene(cells=1600, arch="gpu", estimators=()))


def test_any_gpu_is_not_one_that_the_processor_plays(monkeypatch):
    there = {"cuda": {"name": "", "software": False, "missing": "Taichi sees none"},
             "vulkan": {"name": "llvmpipe", "software": True, "missing": None}}
    monkeypatch.setattr(gpu_detection, "probe_device", there.get)
    assert [gpu_detection.resolve_arch(arch) for arch in ("gpu", "vulkan", "cpu")] == ["cpu", "vulkan", "cpu"]
    there["vulkan"]["software"] = False
    assert gpu_detection.resolve_arch("gpu") == "vulkan"
    there["cuda"]["missing"] = None
    assert gpu_detection.resolve_arch("gpu") == "cuda"


def test_what_is_found_is_known_by_name_and_a_search_that_fails_finds_nothing():
    """A process that dies in the search takes nobody along."""
    require_gpu()
    assert ARCH != "vulkan" or gpu_detection.probe_device("vulkan")["name"]
    assert "the process that looked for one" in gpu_detection.probe_device("no such kind")["missing"]


@pytest.mark.slow
def test_the_bench_of_a_gpu(monkeypatch):
    """Its parts are there and make sense, at sizes that software can do, also where there are too many particles for a
    processor; and its table says what it is."""
    require_gpu()
    found = gpu_speedup.measure_device(ARCH, {"ring": (16,)}, copied=100_000)
    assert found["arch"] == ARCH and found["bandwidth"] > 0 and found["missing"] is None
    assert [(row["problem"],
             row["method"]) for row in found["rows"]] == [("ring", method) for method in gpu_speedup.METHODS]
    for row in found["rows"]:
        assert all(row["rates"][name] > 0 for name in ("gpu", "serial", "parallel")) and 0 < row["share"]
    empty = {"rates": [], "estimators": [], "effects": [], "off": [], "limit": [], "start": {"failed": "not here"},
             "arch": "x64", "precision": "double", "quick": True, "seconds": 1.0,
             "machine": {"load": 0.0, "system": "", "processor": "", "cores": 2, "python": "", "taichi": ""}}
    monkeypatch.setattr(gpu_speedup, "MOST_PARTICLES", 100)
    monkeypatch.setattr(scene_module, "MOST_PARTICLES", 100)
    only_gpu = gpu_speedup.measure_device(ARCH, {"ring": (16,)}, copied=100)["rows"][0]
    assert only_gpu["rates"]["gpu"] > 0 and only_gpu["rates"]["serial"] is only_gpu["rates"]["parallel"] is None
    text = bench_table({**empty, "gpu": found})
    assert found["name"] in text and "of the limit" in text and "ring cpdi 16" in text
    assert "no GPU was found" in bench_table({**empty, "gpu": {"missing": "no GPU was found"}})
