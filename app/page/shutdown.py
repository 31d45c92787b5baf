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
    """Context manager around the shutdown: the process exits after so many seconds in any case, and ignores Ctrl-C."""
    for kind in (signal.SIGINT, signal.SIGTERM):
        signal.signal(kind, signal.SIG_IGN)
    run_in_background(exit_after, seconds, INTERRUPTED)
    yield
    run_in_background(exit_after, TIDY, INTERRUPTED)


def run_in_background(work: Callable, *what: object) -> threading.Thread:
    """Runs a function on a daemon thread, and returns the thread."""
    thread = threading.Thread(target=work, args=what, daemon=True)
    thread.start()
    return thread
