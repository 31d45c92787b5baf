"""Fixtures for the physics tests. Everything runs on pytest's one thread, as Taichi demands."""

from __future__ import annotations

import functools
import signal

import pytest

from solvers.result import Result
from solvers.run import run
from solvers.scene import Scene

# A shell that starts a job in the background has it ignore Ctrl-C, and its children with it; some tests send one.
signal.signal(signal.SIGINT, signal.default_int_handler)


@functools.cache
def _simulate(scene: Scene) -> Result:
    return run(scene)


@pytest.fixture
def simulate():
    """``simulate(scene)`` is ``run(scene)``, run once for all tests that ask for the same scene."""
    return _simulate
