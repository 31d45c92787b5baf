"""The other way to the nodes' sums on a GPU, over sorted particles: the same numbers, each time to the bit."""

from dataclasses import replace

import numpy as np
import pytest

from solvers.kernels import runtime
from solvers.problems import PROBLEMS
from solvers.problems.planar.method.cpdi import NODES
from solvers.problems.planar.method.kept import by_particle
from solvers.problems.planar.plans.sorted_sums import CORNERS
from solvers.problems.ring.scene import RingScene
from solvers.problems.vortex.scene import VortexScene
from solvers.scene.remedies import COUPLED, FILTER, FROZEN
from solvers.scene.scene import Scene
from solvers.solver.base import Solver
from tests.gpus import ARCH, require_gpu

RING = RingScene(cells=16, estimators=(), effects=("crossings",))
VORTEX = VortexScene(cells=24, amplitude=0.5, estimators=(), effects=("crossings",))
SCENES = [replace(RING, method="ugimp"), replace(RING, method="cpdi"),
          *(pytest.param(replace(scene, **inputs), marks=pytest.mark.slow) for scene, inputs in (
              (RING, {"method": "mpm", "remedies": (FROZEN,), "layout": "cartesian", "body_force": "two-tone"}),
              (RING, {"method": "cpgimp", "remedies": (FILTER, COUPLED)}),
              (VORTEX, {"method": "cpgimp-v"}), (VORTEX, {"method": "cpdi", "remedies": (FROZEN,)}),
              (VORTEX, {"method": "ugimp", "body_force": "none"})))]
STEPS = 20
#: Of the largest number of its kind, after a step: see ``test_gpu``; the same numbers are added, in another order.
ROUNDING = 64 * 2.2e-16


@pytest.fixture(scope="module", autouse=True)
def leave_the_processor_running():
    """Later tests of this process begin as they would without these."""
    yield
    runtime.start()


def sorted_solver(scene: Scene) -> Solver:
    require_gpu()
    return PROBLEMS[scene.problem].solver(replace(scene, arch=ARCH), sorted_sums=True)


def taken(solver: Solver) -> list[np.ndarray]:
    """x and v, F, and when each particle has crossed a cell's edge last, after some steps."""
    solver.advance(STEPS)
    arrays = solver.state()[1]
    return [arrays[name] for name in ("position_velocity", "deformation_gradient", "last_crossing")]


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: "-".join((scene.problem, scene.method, *scene.remedies)))
def test_sorted_sums_are_a_processors_but_for_rounding_and_the_same_again(scene):
    mine, again = taken(sorted_solver(scene)), taken(sorted_solver(scene))
    theirs = taken(PROBLEMS[scene.problem].solver(scene))
    for one, other, expected in zip(mine, again, theirs, strict=True):
        np.testing.assert_array_equal(one, other)
        assert np.abs(one - expected).max() <= STEPS * ROUNDING * np.abs(expected).max()


@pytest.mark.parametrize("method", ["ugimp", "cpdi"])
def test_items_lie_in_the_order_of_their_cells_and_of_their_own_within_one(method):
    solver = sorted_solver(replace(RING, method=method))
    solver.advance(1)
    arrays, (own, found) = solver._arrays, (solver._stepping._own, solver._stepping._sorting)
    own.fetch("weights", "first_node")
    found.fetch("sorted_items", "cell_begins", "cell_counts")
    cells = arrays.first_node if method == "ugimp" else \
        by_particle(arrays.weights, method, arrays.particles)[:, NODES:NODES + CORNERS].astype(int).ravel()
    np.testing.assert_array_equal(found.arrays["sorted_items"], np.argsort(cells, kind="stable"))
    counts = np.bincount(cells, minlength=arrays.nodes)
    np.testing.assert_array_equal(found.arrays["cell_counts"], counts)
    np.testing.assert_array_equal(found.arrays["cell_begins"], np.cumsum(counts) - counts)


def test_a_run_gone_bad_stands_still():
    """Steps that were queued before anybody looked do nothing, and the nodes keep what they had."""
    solver = sorted_solver(replace(RING, method="ugimp"))
    solver.advance(8)
    step, arrays = solver.state()
    arrays["verdict"][:] = 1, step, 0
    solver.put(step, arrays)
    solver.advance(8)
    after = solver.state()[1]
    for name in ("position_velocity", "deformation_gradient", "node_motion"):
        np.testing.assert_array_equal(after[name], arrays[name])
