"""The end of the server: orderly if that is done soon, and in any case."""

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from solvers.workers.worker_process import end_after

TIDY = 0.2  # seconds in which Python tidies up when all is done
INTERRUPTED = 130  # what a shell expects of a process that was ended by Ctrl-C


@contextmanager
def exit_within(seconds: float) -> Iterator[None]:
    """The last that this process does: after so many seconds it ends in any case, and ignores Ctrl-C."""
    for kind in (signal.SIGINT, signal.SIGTERM):
        signal.signal(kind, signal.SIG_IGN)
    in_background(end_after, seconds, INTERRUPTED)
    yield
    in_background(end_after, TIDY, INTERRUPTED)


def in_background(work: Callable, *what: object) -> threading.Thread:
    """Do this on a thread that keeps nobody waiting."""
    thread = threading.Thread(target=work, args=what, daemon=True)
    thread.start()
    return thread
