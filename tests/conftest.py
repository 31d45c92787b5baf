"""Fixtures for the physics tests. All run on a main thread, as Taichi demands."""

from __future__ import annotations

import functools
import os
import signal
import sys

import pytest
from hypothesis import settings

from solvers.engine.engine_pool import EnginePool
from solvers.running.result import Result
from solvers.running.run import run
from solvers.scene.scene import Scene
from tests.support.session_listener import PATIENCE, SCENE, Listener

pytest_plugins = ["tests.tiers"]

# A shell that starts a job in the background has it ignore Ctrl-C, and its children with it; some tests send one.
signal.signal(signal.SIGINT, signal.default_int_handler)

settings.register_profile("lab", deadline=None)  # how busy the machine is says nothing about an example
settings.register_profile("always the same", settings.get_profile("lab"), derandomize=True, print_blob=True)
settings.load_profile("always the same" if os.environ.get("CI") else "lab")  # a change must not fail by chance


def pytest_configure(config: pytest.Config) -> None:
    """Where Python may not keep the modules that it compiles, each of some two hundred processes would compile Taichi
    and more anew, for longer than many then run: keep them apart, for the next tests as well."""
    if sys.dont_write_bytecode and "PYTHONPYCACHEPREFIX" not in os.environ:
        os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
        os.environ["PYTHONPYCACHEPREFIX"] = str(config.rootpath / ".pytest_cache" / "modules")


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
    link = pool.open_session(listener)
    yield link, listener
    link.close()


@pytest.fixture(scope="module")
def here():
    """A lab without engines for a file's tests, which takes whatever many messages a second."""
    from app.viewer import incoming_messages, web_server  # here: few files need the viewer
    from tests.support.page_server import start_server

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(incoming_messages, "MESSAGES", 1e9)
        patch.setattr(web_server, "HANDSHAKES", 1e9)
        with start_server() as one:
            yield one
