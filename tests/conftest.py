"""Fixtures for the physics tests. Everything runs on pytest's one thread, as Taichi demands."""

from __future__ import annotations

import functools

import pytest

from solvers.result import Result
from solvers.run import run
from solvers.scene import Scene


@functools.cache
def _simulate(scene: Scene) -> Result:
    return run(scene)


@pytest.fixture
def simulate():
    """``simulate(scene)`` is ``run(scene)``, run once for all tests that ask for the same scene."""
    return _simulate
