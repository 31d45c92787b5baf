"""Fixtures for the physics tests, and how tests share processes. All run on a main thread, as Taichi demands."""

from __future__ import annotations

import functools
import os
import signal

import pytest
from hypothesis import settings
from xdist.scheduler import LoadScopeScheduling

from solvers.result import Result
from solvers.run import run
from solvers.scene import Scene

# A shell that starts a job in the background has it ignore Ctrl-C, and its children with it; some tests send one.
signal.signal(signal.SIGINT, signal.default_int_handler)


settings.register_profile("lab", deadline=None)  # how busy the machine is says nothing about an example
settings.register_profile("always the same", settings.get_profile("lab"), derandomize=True, print_blob=True)
settings.load_profile("always the same" if os.environ.get("CI") else "lab")  # a change must not fail by chance


class FileByFile(LoadScopeScheduling):
    """Tests of a file share what it prepares, so one process runs them; and all in the browser are one file's, for two
    browsers at once would only wait for each other."""

    def _split_scope(self, nodeid: str) -> str:
        path = nodeid.partition("::")[0]
        return "browser" if "/browser/" in path else path


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
