"""Where an engine process begins. Taichi is imported there and only there: the page's process stays light."""

from __future__ import annotations

from multiprocessing.connection import Connection

from solvers.scene import Scene


def main(pipe: Connection, warm_up: Scene) -> None:
    """Become an engine (see ``solvers.engine.worker.main``)."""
    from solvers.engine import worker

    worker.main(pipe, warm_up)
