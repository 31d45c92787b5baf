"""The server's own processes are killed while a class is on: everyone moves again and is told why."""

from __future__ import annotations

import os
import signal
from contextlib import ExitStack
from pathlib import Path

import pytest

from app.commands.bench.class_load import serving
from solvers.workers.processes import LINUX, descendants
from tests.processes import GONE, until
from tests.raw import Raw

# An engine that is killed under one visitor is for every day: tests/browser/page/test_page.py, tests/solvers/engine.
pytestmark = [pytest.mark.skipif(not LINUX, reason="finds processes in /proc"), pytest.mark.slow]
VISITORS = 10
AGAIN = "The simulation process ended unexpectedly"


def kill(server: int, kind: str) -> None:
    """Kill the oldest of the server's processes that has this in its command line."""
    def command(process):
        try:
            return Path(f"/proc/{process}/cmdline").read_text()
        except GONE:
            return ""

    found = []
    until(lambda: found.extend(p for p in descendants(server) if kind in command(p)) or found, kind)
    os.kill(min(found), signal.SIGKILL)


def test_each_process_is_killed_in_turn():
    """The helper that tidies up shared memory first: an engine that then starts one of its own must not take the
    newcomer's frames along when it is killed in its turn."""
    with ExitStack() as stack:
        address, server = stack.enter_context(serving("--max-sessions", str(VISITORS), "--no-warm-up"))
        class_ = [stack.enter_context(Raw(f"http://{address}")) for _ in range(VISITORS - 1)]

        def moved(before):
            return all(visitor.frames > count + 5 for visitor, count in zip(class_, before, strict=True))

        for kind, told in (("resource_tracker", False), ("spawn_main", True)):
            until(lambda: moved([0] * len(class_)), "all moving")
            for visitor in class_:
                visitor.html.clear()
            kill(server, kind)
            if told:
                said = set()
                until(lambda said=said: said.update(k for k, visitor in enumerate(class_) if any(
                    AGAIN in text for text in visitor.html.copy().values())) or len(said) == VISITORS, "all told")
            else:
                class_.append(stack.enter_context(Raw(f"http://{address}")))
            at = [visitor.frames for visitor in class_]
            until(lambda at=at: moved(at), f"all moving again without {kind}")
