"""Shutdown of the server: orderly if that is quick, forced otherwise."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from solvers.workers.worker_process import exit_after

TIDY = 0.2  # seconds for Python's own cleanup
INTERRUPTED = 130  # exit status of a process that was ended by Ctrl-C


@contextmanager
def exit_within(seconds: float) -> Iterator[None]:
    """Context manager around the shutdown: ignores Ctrl-C, and ends the process after so many seconds in any case, or
    0.2 s after the block."""
    for kind in (signal.SIGINT, signal.SIGTERM):
        signal.signal(kind, signal.SIG_IGN)
    run_in_background(exit_after, seconds, INTERRUPTED)
    yield
    run_in_background(exit_after, TIDY, INTERRUPTED)


def run_in_background(function: Callable, *arguments: object) -> threading.Thread:
    """Starts a daemon thread that calls a function with these arguments; returns the thread."""
    thread = threading.Thread(target=function, args=arguments, daemon=True)
    thread.start()
    return thread
