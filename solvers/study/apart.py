"""Rows measured in a process of their own, one at a time.

Taichi wants one thread for all its calls, holds Python's lock while it runs, and can take its process down; a timing
wants nothing else going on beside it. So wherever a study runs (here, in the page, on a worker of a cluster) a row is
measured by a fresh Python process that does nothing else, stays for the next row, and can be killed.

Tasks go in on standard input, rows come out on standard output, a line of JSON each. ``multiprocessing`` would not do:
workers of a Dask cluster are daemons, which must not have children of that kind.
"""

from __future__ import annotations

import contextlib
import json
import os
import queue
import signal
import subprocess
import sys
import threading
from typing import TextIO

from solvers.study.grid import Task

START = "import json, sys; sys.path[:] = json.loads(sys.argv[1]); from {module} import main; main()"


class ProcessDied(Exception):
    """The process went down with a row; the sentence says how."""


class RowProcess:
    """A process that measures rows. It starts with the first row, and again after it died. Safe from any thread."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._process: subprocess.Popen | None = None
        self._closed = False

    @property
    def process_id(self) -> int | None:
        """Of the process that runs now, if one does."""
        process = self._process
        return process.pid if process and process.poll() is None else None

    def measure(self, task: Task) -> dict:
        """The row of a task; :class:`ProcessDied` if the process ends before it is done."""
        with self._lock:
            process = self._ready()
            try:
                process.stdin.write(json.dumps(task.to_dict()) + "\n")
                process.stdin.flush()
                line = process.stdout.readline()
            except OSError:
                line = ""
            if not line.endswith("\n"):
                raise ProcessDied(how_it_ended(end_process(process)))
            return json.loads(line)

    def close(self) -> None:
        """End the process, whatever it does. From any thread, also while a row is measured."""
        self._closed = True
        process = self._process
        if process:
            process.kill()  # whoever waits for a row learns it now, and lets go of the lock
            with self._lock:
                end_process(process)

    def _ready(self) -> subprocess.Popen:
        if self._closed:
            raise ProcessDied("was closed")
        if self._process is None or self._process.poll() is not None:
            if self._process:
                end_process(self._process)
            self._process = start_process(__name__)
            if self._closed:  # meanwhile
                self._process.kill()
        return self._process


def start_process(module: str) -> subprocess.Popen:
    """A fresh process that runs ``main`` of a module, with pipes for lines of text."""
    paths = json.dumps([path or os.getcwd() for path in sys.path])
    return subprocess.Popen([sys.executable, "-c", START.format(module=module), paths], stdin=subprocess.PIPE,
                            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)


def end_process(process: subprocess.Popen) -> int:
    """Make sure that a process has ended and left nothing behind; its status."""
    process.kill()
    for pipe in (process.stdin, process.stdout):
        with contextlib.suppress(OSError):  # what was not written yet
            pipe.close()
    return process.wait()


def how_it_ended(status: int) -> str:
    if status >= 0:
        return f"ended with status {status}"
    with contextlib.suppress(ValueError):
        return f"was ended by {signal.Signals(-status).name}"
    return f"was ended by signal {-status}"


def pipes() -> tuple[queue.SimpleQueue[str], TextIO]:
    """In such a process: the lines that come in, and where answers go. It ends when whoever started it is gone.

    Reading has a thread of its own: when whoever asked is gone, nobody wants what is being measured.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for whoever started this
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what native code prints is not an answer
    lines: queue.SimpleQueue[str] = queue.SimpleQueue()

    def read() -> None:
        for line in sys.stdin:
            lines.put(line)
        os._exit(0)

    threading.Thread(target=read, daemon=True).start()
    return lines, answers


def main() -> None:
    """The process: measure the tasks that come in until standard input closes, then end at once."""
    tasks, answers = pipes()
    from solvers.study.row import measure

    while True:
        row = measure(Task(**json.loads(tasks.get())))
        answers.write(json.dumps(row, allow_nan=False) + "\n")
        answers.flush()
