"""Processes as the tests see them (Linux): found, held still, waited for, and what other work on the machine cost them.

A test that must not depend on how busy the machine is waits for the event itself, holds a process still while it looks,
or counts the time in which a process could have run and did not (:class:`RunningTime`).
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from time import monotonic, perf_counter, sleep

from tests.support.paths import ROOT

PATIENCE = 30.0  # seconds: against a test that would hang, and for nothing else
STARVED = 10  # times that, when other work takes nearly all of the machine
HANG = 900.0  # seconds, by the clock on the wall: against a command that would never end, and for nothing else
LOOK = 0.5  # seconds between two looks at who waits for a processor
GONE = (FileNotFoundError, ProcessLookupError)


def run_python(*words: str, cwd: Path = ROOT, **environment: str) -> subprocess.CompletedProcess:
    """What a Python of its own comes to that finds this checkout."""
    return subprocess.run([sys.executable, *words], cwd=cwd, capture_output=True, text=True, timeout=HANG,
                          env=os.environ | {"PYTHONPATH": str(ROOT)} | environment)


def wait_until(condition: Callable[[], object], what: str, patience: float = PATIENCE, pause: float = 0.01) -> None:
    """Wait until ``condition()`` is true.

    Time in which one of this process's own processes was ready to run and other work had the processors does not try
    the patience: a sweep behind the page has a low priority and may get a tenth of a busy machine.
    """
    end, calm = monotonic() + STARVED * patience, 0.0
    at, waits = monotonic(), _waiting_seconds()
    while not condition():
        sleep(pause)
        if monotonic() < at + LOOK:
            continue
        before, earlier, at, waits = at, waits, monotonic(), _waiting_seconds()
        starved = max((wait - earlier.get(process, wait) for process, wait in waits.items()), default=0.0)
        calm += max(0.0, at - before - starved)
        assert calm < patience and at < end, f"never happened: {what}"


@contextmanager
def measure_starvation() -> Iterator[Callable[[], float]]:
    """Gives a function that says how many seconds, since then, the one of this process's own processes that had to wait
    longest was ready to run while others had the processors."""
    before = _waiting_seconds()
    yield lambda: max((wait - before.get(process, 0.0) for process, wait in _waiting_seconds().items()), default=0.0)


def _waiting_seconds() -> dict[int, float]:
    """Seconds that this process and those below it have spent ready to run without a processor."""
    below, waits, family = defaultdict(list), {}, [os.getpid()]
    for status in Path("/proc").glob("[0-9]*/stat"):
        with suppress(*GONE):
            below[int(status.read_text().rpartition(")")[2].split()[1])].append(int(status.parent.name))
    for process in family:  # which grows meanwhile
        family += below[process]
        with suppress(*GONE):
            waits[process] = _waiting_seconds_of(process)
    return waits


def _waiting_seconds_of(process: int) -> float:
    return 1e-9 * int(Path(f"/proc/{process}/schedstat").read_text().split()[1])


def children(parent: int, word: str) -> list[int]:
    """Ids of the processes that ``parent`` has started with this word in their command line."""
    found = []
    for status in Path("/proc").glob("[0-9]*/stat"):
        with suppress(*GONE):  # it ended meanwhile
            own_parent = int(status.read_text().rpartition(")")[2].split()[1])
            if own_parent == parent and word.encode() in (status.parent / "cmdline").read_bytes():
                found.append(int(status.parent.name))
    return found


def has_ended(process: int) -> bool:
    """Whether a process has ended, buried or not."""
    return process_state(process) in "Z"


def process_state(process: int) -> str:
    """What a process does, in the system's letters: R runs or could, S sleeps, Z has ended; "" for one that is gone."""
    with suppress(*GONE):
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    return ""


def has_library(process: int, name: str) -> bool:
    return name in Path(f"/proc/{process}/maps").read_text()


@contextmanager
def stop_processes(process_ids: Iterable[int]) -> Iterator[None]:
    """Meanwhile the processes stand still. One that is killed in the meantime is gone."""
    process_ids = list(process_ids)
    for process in process_ids:
        os.kill(process, signal.SIGSTOP)
    try:
        yield
    finally:
        for process in process_ids:
            with suppress(ProcessLookupError):
                os.kill(process, signal.SIGCONT)


class RunningTime:
    """Seconds since it was made in which a process ran or had nothing to do.

    That is wall time less what its first thread spent ready to run, while other work had the processors. On a machine
    at rest it is wall time.
    """

    def __init__(self, process: int):
        self._process = process
        self._begun = perf_counter() - _waiting_seconds_of(process)

    @property
    def seconds(self) -> float:
        return perf_counter() - _waiting_seconds_of(self._process) - self._begun
