"""Work in a process of its own: a fresh Python that does nothing else, asked and answering in lines of JSON.

Taichi wants one thread for all its calls, holds Python's lock while it runs, and can take its process down; a timing
wants nothing else going on beside it. So rows of a study, visitors' sweeps and searches and the bench's start-up times
are done by processes that can be killed. They find modules where whoever started them does, and end when that is gone.
``multiprocessing`` would not do: workers of a Dask cluster are daemons, which must not have children of that kind.
"""

import contextlib
import ctypes
import importlib
import json
import os
import queue
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Generator, Iterator, Mapping, Sequence
from pathlib import Path
from typing import IO, cast

from solvers.message import from_json, to_json

#: What such a process does first: it looks for modules where it is told to, and takes these ones from their own place.
HOME = Path(__file__).resolve().parents[2]
START = ("import sys; sys.path[:] = sys.argv[2:]; import solvers.workers.worker_process as p; del sys.path[0]; "
         "p.serve(sys.argv[1])")

SHUTDOWN_SECONDS = 1.5  # seconds that a process may take to put away what it has compiled
LINUX = sys.platform == "linux"
KILL_SIGNAL = getattr(signal, "SIGKILL", signal.SIGTERM)  # on Windows there is no other end
PARENT_DEATH_SIGNAL, SUBREAPER = 1, 36  # options of Linux's prctl


class ProcessDied(Exception):
    """The process ended before its work was done, or the work failed in it; the sentence says how."""


class WorkerTimeout(ProcessDied):
    """The process was ended because whoever asked would wait no longer."""


class WorkerProcess:
    """A process that does ``work``, given as ``"module:function"``: the function is called with every question and with
    another to call with each answer. It starts with the first question, and again after it died. Safe from any thread:
    questions wait for each other."""

    def __init__(self, work: str, environment: Mapping[str, str] | None = None):
        self._work, self._environment = work, environment
        self._lock = threading.Lock()
        self._process: subprocess.Popen[str] | None = None
        self._closed = False

    @property
    def process_id(self) -> int | None:
        """Of the process that runs now, if one does."""
        process = self._process
        return process.pid if process and process.poll() is None else None

    def start(self) -> subprocess.Popen[str]:
        """Start the process unless it runs."""
        if self._closed:
            raise ProcessDied("was closed")
        if self.process_id is None:
            self._end()
            paths = [path or os.getcwd() for path in sys.path]
            self._process = subprocess.Popen([sys.executable, "-c", START, self._work, str(HOME), *paths],
                                             env={**os.environ, **(self._environment or {})}, stdin=subprocess.PIPE,
                                             stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
            if self._closed:  # meanwhile
                self._process.kill()
        return cast(subprocess.Popen, self._process)

    def ask(self, question: Mapping | Sequence, patience: float | None = None) -> Generator[dict]:
        """The answers to a question as they come; :class:`ProcessDied` if there will be no more of them, and
        :class:`WorkerTimeout` if ``patience`` seconds have passed. Who listens no more ends the process."""
        late = threading.Event()
        with self._lock:
            process = self.start()

            def give_up() -> None:
                late.set()
                process.kill()

            timer = threading.Timer(patience or 0, give_up)
            timer.daemon = True
            if patience is not None:
                timer.start()
            try:
                yield from self._answers(process, question)
            except GeneratorExit:
                self._end()
                raise
            except ProcessDied:
                if late.is_set():
                    raise WorkerTimeout(f"gave no answer within {patience:g} seconds") from None
                raise
            finally:
                timer.cancel()

    def _answers(self, process: subprocess.Popen[str], question: Mapping | Sequence) -> Iterator[dict]:
        questions, answers = cast(IO[str], process.stdin), cast(IO[str], process.stdout)
        with contextlib.suppress(OSError):  # it has ended: there is nothing to read
            questions.write(json.dumps(question) + "\n")
            questions.flush()
        failure = None
        for line in answers:
            if not line.endswith("\n"):
                break  # it was killed in the middle of it
            message = json.loads(line, object_hook=from_json)
            if "answer" in message:
                yield message["answer"]
            elif message["failure"] is None:
                return
            else:
                failure = message["failure"]
        status = self._end()
        raise ProcessDied(failure or status)

    def kill(self) -> None:
        """End the process at once, whatever it does, and for good; who waits for an answer learns it."""
        self._closed = True
        if process := self._process:
            process.kill()

    def close(self) -> None:
        """End the process and leave nothing behind: one that works is killed, and whoever asks waits to learn it; one
        that rests may put away what it has compiled."""
        self._closed = True
        if self._lock.acquire(blocking=False):
            try:
                if process := self._process:  # there will be no more questions
                    with contextlib.suppress(OSError, subprocess.TimeoutExpired):
                        cast(IO[str], process.stdin).close()
                        process.wait(SHUTDOWN_SECONDS)
                self._end()
            finally:
                self._lock.release()
            return
        self.kill()
        with self._lock:
            self._end()

    def _end(self) -> str:
        """Make sure that the process has ended; says how it ended."""
        process = self._process
        if process is None:
            return "has not begun"
        process.kill()
        for pipe in (process.stdin, process.stdout):
            with contextlib.suppress(OSError):  # what was not written yet
                cast(IO[str], pipe).close()
        status = process.wait()
        if status >= 0:
            return f"ended with status {status}"
        with contextlib.suppress(ValueError):
            return f"was ended by {signal.Signals(-status).name}"
        return f"was ended by signal {-status}"


def ask_fresh(work: str, question: Mapping | None = None, environment: Mapping[str, str] | None = None,
              patience: float = 120.0) -> dict:
    """The only answer of a fresh process; :class:`ProcessDied` if none comes within ``patience`` seconds."""
    with contextlib.closing(WorkerProcess(work, environment)) as process:
        [answer] = process.ask(question or {}, patience)
        return answer


def serve(work: str) -> None:
    """Be such a process: answer questions until whoever asks is gone, or the work fails. Reading has a thread of its
    own: when whoever asked is gone, nobody wants what is being done. What has been compiled is kept on disk."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for whoever started this
    output = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what native code prints is not an answer
    questions: queue.SimpleQueue[str | None] = queue.SimpleQueue()

    def read() -> None:
        for line in sys.stdin:
            questions.put(line)
        questions.put(None)
        time.sleep(SHUTDOWN_SECONDS)  # it rests, and ends by itself; else nobody wants what is being done
        os._exit(0)

    def say(**message: object) -> None:
        output.write(json.dumps(to_json(message), allow_nan=False) + "\n")
        output.flush()

    threading.Thread(target=read, daemon=True).start()
    try:
        module, _, name = work.partition(":")
        function = getattr(importlib.import_module(module), name)
        while (question := questions.get()) is not None:
            function(json.loads(question), lambda answer: say(answer=answer))
            say(failure=None)
        if runtime := sys.modules.get("solvers.kernels.runtime"):
            runtime.leave()
    except Exception as error:
        say(failure=f"failed: {type(error).__name__}: {error}")
    os._exit(1)  # at once: nothing here is worth tidying up


def adopt_orphans() -> None:
    """Have the processes that outlive their parents below this one become its own children, where that can be."""
    _process_control(SUBREAPER, 1)


def exit_after(seconds: float, status: int) -> None:
    """End this process after so many seconds, whatever it does then."""
    time.sleep(seconds)
    sys.stderr.flush()
    os._exit(status)


def die_with_parent(wanted: bool) -> None:
    """Have this process killed when its parent ends, or no longer, where that can be."""
    _process_control(PARENT_DEATH_SIGNAL, KILL_SIGNAL if wanted else 0)


def _process_control(option: int, value: int) -> None:
    if LINUX:
        ctypes.CDLL(None).prctl(option, value)


def descendants(process: int) -> list[int]:
    """The numbers of the processes that a process has started, and of those that these have (Linux)."""
    below: dict[int, list[int]] = {}
    for status in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(FileNotFoundError, ProcessLookupError):  # it has ended
            parent = int(status.read_text().rpartition(")")[2].split()[1])
            below.setdefault(parent, []).append(int(status.parent.name))
    found = [process]
    for parent in found:  # which grows meanwhile
        found += below.get(parent, [])
    return found[1:]


def proportional_bytes(process: int) -> int:
    """Memory that a process holds, and its part of what it shares with others (Linux); 0 of one that has ended."""
    with contextlib.suppress(FileNotFoundError, ProcessLookupError):
        for line in Path(f"/proc/{process}/smaps_rollup").read_text().splitlines():
            if line.startswith("Pss:"):
                return 1024 * int(line.split()[1])
    return 0


def processor_seconds(process: int) -> float | None:
    """What a process has had of the processors so far, without those that it has started (Linux); None if unknown."""
    with contextlib.suppress(OSError):
        ticks = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[11:13]
        return sum(map(int, ticks)) / float(os.sysconf("SC_CLK_TCK"))
    return None


def free_port() -> int:
    """A port of this machine on which nobody listens now."""
    with socket.socket() as trial:
        trial.bind(("127.0.0.1", 0))
        return trial.getsockname()[1]
