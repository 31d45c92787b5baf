"""Worker process: a fresh Python process that does nothing else, with questions and answers in lines of JSON.

Taichi needs one thread for all its calls, holds Python's lock while it runs, and can crash its process; a timing needs
an otherwise idle process. So rows of a study, visitors' sweeps and searches and the bench's start-up times run in
processes that can be killed. They have the import paths of their parent, and end with it. ``multiprocessing`` is not
possible: workers of a Dask cluster are daemons, which must not have such children.
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

from solvers.translatable_message import message_from_json, messages_to_json

#: Start of such a process: it sets the search path for modules, and takes these ones from their own place.
HOME = Path(__file__).resolve().parents[2]
START = ("import sys; sys.path[:] = sys.argv[2:]; import solvers.workers.worker_process as p; del sys.path[0]; "
         "p.serve(sys.argv[1])")

SHUTDOWN_SECONDS = 1.5  # seconds that a process may take to store compiled kernels
LINUX = sys.platform == "linux"
KILL_SIGNAL = getattr(signal, "SIGKILL", signal.SIGTERM)  # on Windows there is no other end
PARENT_DEATH_SIGNAL, SUBREAPER = 1, 36  # options of Linux's prctl


class ProcessDied(Exception):
    """Raised if a worker process ended before its work was done, or the work failed; the message says how."""


class WorkerTimeout(ProcessDied):
    """Raised if a worker process was killed because it gave no answer in time; the message names that time."""


class WorkerProcess:
    """Process that does the ``work`` of a function, given as "module:function", which is called with every question
    and with a callback for each answer. ``environment`` has additions to the environment variables. The process starts
    with the first question, and again after it died. Thread-safe: questions wait for each other."""

    def __init__(self, work: str, environment: Mapping[str, str] | None = None):
        self._work, self._environment = work, environment
        self._lock = threading.Lock()
        self._process: subprocess.Popen[str] | None = None
        self._closed = False

    @property
    def process_id(self) -> int | None:
        """Id of the running process, or None."""
        process = self._process
        return process.pid if process and process.poll() is None else None

    def start(self) -> subprocess.Popen[str]:
        """Starts the process unless it runs; returns it. Raises :class:`ProcessDied` if it has been closed."""
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
        """Asks a question, as for json, and yields its answers as they come. Raises :class:`ProcessDied` if the process
        ends before the last, :class:`WorkerTimeout` after ``patience`` s. Closing the generator kills the process."""
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
            message = json.loads(line, object_hook=message_from_json)
            if "answer" in message:
                yield message["answer"]
            elif message["failure"] is None:
                return
            else:
                failure = message["failure"]
        status = self._end()
        raise ProcessDied(failure or status)

    def kill(self) -> None:
        """Kills the process at once and for good; a pending question raises :class:`ProcessDied`."""
        self._closed = True
        if process := self._process:
            process.kill()

    def close(self) -> None:
        """Stops the process for good and waits for its end: a busy one is killed, and its question raises
        :class:`ProcessDied`; an idle one may first store compiled kernels."""
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
        """Kills the process if it runs and waits for its end; returns how it ended, as the rest of a sentence."""
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
    """Returns the only answer to a question to a fresh :class:`WorkerProcess`, which is stopped afterwards. Raises
    :class:`ProcessDied`, also after ``patience`` s."""
    with contextlib.closing(WorkerProcess(work, environment)) as process:
        [answer] = process.ask(question or {}, patience)
        return answer


def serve(work: str) -> None:
    """Runs a worker process for the function ``work``, "module:function": reads questions from standard input and
    writes answers to standard output, a line of JSON each, until its parent is gone, or the function raises an
    exception; then ends the process. A thread of its own reads: without the parent, results are useless."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the parent
    output = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what native code prints is not an answer
    questions: queue.SimpleQueue[str | None] = queue.SimpleQueue()

    def read() -> None:
        for line in sys.stdin:
            questions.put(line)
        questions.put(None)
        time.sleep(SHUTDOWN_SECONDS)  # an idle process ends by itself; otherwise its result is not needed
        os._exit(0)

    def say(**message: object) -> None:
        output.write(json.dumps(messages_to_json(message), allow_nan=False) + "\n")
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
    os._exit(1)  # at once, without clean-up


def adopt_orphans() -> None:
    """Makes this process the parent of its descendants whose own parent has ended (Linux; otherwise does nothing)."""
    _process_control(SUBREAPER, 1)


def exit_after(seconds: float, status: int) -> None:
    """Ends this process, after ``seconds`` s, with an exit status and without clean-up; meant for a thread."""
    time.sleep(seconds)
    sys.stderr.flush()
    os._exit(status)


def die_with_parent(enabled: bool) -> None:
    """Sets whether this process is killed when its parent ends (Linux; otherwise does nothing)."""
    _process_control(PARENT_DEATH_SIGNAL, KILL_SIGNAL if enabled else 0)


def _process_control(option: int, value: int) -> None:
    if LINUX:
        ctypes.CDLL(None).prctl(option, value)


def descendants(process: int) -> list[int]:
    """Returns the ids of all running descendants of the process with this id (Linux)."""
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
    """Returns the memory in bytes of the process with this id, with its part of shared memory (Linux); 0 if ended."""
    with contextlib.suppress(FileNotFoundError, ProcessLookupError):
        for line in Path(f"/proc/{process}/smaps_rollup").read_text().splitlines():
            if line.startswith("Pss:"):
                return 1024 * int(line.split()[1])
    return 0


def processor_seconds(process: int) -> float | None:
    """Returns the CPU time in s of the process with this id so far, without its children (Linux); None if unknown."""
    with contextlib.suppress(OSError):
        ticks = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[11:13]
        return sum(map(int, ticks)) / float(os.sysconf("SC_CLK_TCK"))
    return None


def free_port() -> int:
    """Returns a TCP port of this machine that is not in use."""
    with socket.socket() as trial:
        trial.bind(("127.0.0.1", 0))
        return trial.getsockname()[1]
