"""Fixtures for the physics tests, and how tests share processes. All run on a main thread, as Taichi demands."""

from __future__ import annotations

import functools
import os
import signal
import sys
import tempfile
from pathlib import Path

import pytest
from hypothesis import settings
from xdist.scheduler import LoadScopeScheduling
from xdist.workermanage import WorkerController

from solvers.engine.pool import EnginePool
from solvers.running.result import Result
from solvers.running.run import run
from solvers.scene.scene import Scene
from tests.listening import PATIENCE, SCENE, Listener

# A shell that starts a job in the background has it ignore Ctrl-C, and its children with it; some tests send one.
signal.signal(signal.SIGINT, signal.default_int_handler)


settings.register_profile("lab", deadline=None)  # how busy the machine is says nothing about an example
settings.register_profile("always the same", settings.get_profile("lab"), derandomize=True, print_blob=True)
settings.load_profile("always the same" if os.environ.get("CI") else "lab")  # a change must not fail by chance


# What one process has compiled is there for those that start later: all kernels of the tests are more than the 100 MB
# beyond which Taichi drops the oldest, which the next tests would compile again.
os.environ["TI_OFFLINE_CACHE_MAX_SIZE_OF_FILES"] = str(500 * 2**20)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--slow", action="store_true", help="run the slow tests too")


def pytest_report_header(config: pytest.Config) -> str:
    return "slow tests: " + ("among the others" if config.getoption("--slow") else "left out, --slow runs them too")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Slow tests repeat what others show in small, at a size or in a number that takes long."""
    left_out = [] if config.getoption("--slow") else [item for item in items if item.get_closest_marker("slow")]
    if left_out:
        config.hook.pytest_deselected(items=left_out)
        items[:] = [item for item in items if not item.get_closest_marker("slow")]


def pytest_configure(config: pytest.Config) -> None:
    """Where Python may not keep the modules that it compiles, each of some two hundred processes would compile Taichi
    and more anew, for longer than many then run: keep them apart, as long as the tests last."""
    if sys.dont_write_bytecode and "PYTHONPYCACHEPREFIX" not in os.environ:
        modules = tempfile.TemporaryDirectory(prefix="mpm-lab-tests-", ignore_cleanup_errors=True)
        config.add_cleanup(modules.cleanup)
        os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
        os.environ["PYTHONPYCACHEPREFIX"] = modules.name


#: Files with tests in the browser, shared out to so many processes: each starts a server and a browser once. Three of
#: four processes would leave each browser less of a processor than a visitor's patience bears.
BROWSERS = 2
BROWSER_FILES = sorted(path.name for path in (Path(__file__).parent / "browser").rglob("test_*.py"))
#: What takes longest is begun first: one process would still be at it when the others have ended. The browser's parts
#: take most of the processes for most of the time; then come the files that take ten seconds of a processor and more.
FIRST = [*(f"browser {part}" for part in range(BROWSERS)), *(f"tests/{name}.py" for name in (
    "solvers/estimators/test_accuracy", "app/lessons/test_lessons", "solvers/judging/test_judge",
    "solvers/bar/test_budget", "app/notebook/test_notebooks", "solvers/estimators/test_extension",
    "solvers/scene/test_random_scenes", "app/commands/test_cli", "app/commands/test_bench",
    "solvers/running/test_planar_budget", "app/commands/test_sweep_command", "solvers/estimators/test_refusals",
    "solvers/judging/test_findings", "solvers/running/test_gpu", "solvers/estimators/test_recovered",
    "app/serving/test_mob", "solvers/study/test_tables", "app/pictures/test_plots", "app/serving/test_attendance"))]


class FileByFile(LoadScopeScheduling):
    """Tests of a file share what it prepares, so one process runs them; and of those in the browser each part: by the
    alphabet, which divides the time that they take better than taking turns does."""

    def _assign_work_unit(self, node: WorkerController) -> None:
        for path in reversed(FIRST):
            if path in self.workqueue:
                self.workqueue.move_to_end(path, last=False)
        super()._assign_work_unit(node)

    def _split_scope(self, nodeid: str) -> str:
        path = Path(nodeid.partition("::")[0])
        if "browser" not in path.parts:
            return str(path)
        return f"browser {BROWSERS * BROWSER_FILES.index(path.name) // len(BROWSER_FILES)}"


def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> FileByFile:
    """Who runs what where there are several processes."""
    return FileByFile(config, log)


@functools.cache
def _simulate(scene: Scene) -> Result:
    return run(scene, prices=False)


@pytest.fixture
def simulate():
    """``simulate(scene)`` is ``run(scene)``, run once for all tests that ask for the same scene, prices aside."""
    return _simulate


@pytest.fixture(scope="module")
def pool():
    """The engines of a file's tests."""
    pool = EnginePool(SCENE)
    assert pool.wait_ready(PATIENCE)
    yield pool
    pool.close()


@pytest.fixture
def session(pool):
    """A session of ``pool``, and what it hears."""
    listener = Listener()
    link = pool.open(listener)
    yield link, listener
    link.close()


@pytest.fixture(scope="module")
def here():
    """A lab without engines for a file's tests, which takes whatever many messages a second."""
    from app.viewer import hearing, server  # here: few files need the viewer
    from tests.doors import lab

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(hearing, "MESSAGES", 1e9)
        patch.setattr(server, "HANDSHAKES", 1e9)
        with lab() as one:
            yield one
