"""Runs of one visitor's bodies in a worker process, the last one asked for instead of those before."""

import functools
import secrets
import shutil
import tempfile
import threading
import weakref
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import asdict
from functools import cached_property
from pathlib import Path

from app.frame.shown_body import BodySource
from app.language.translation import lazy, tr, translate_message, with_language
from app.page.features.background_job import MOST_JOBS
from app.page.visit.engine_links import MOST_WATCHED
from solvers.bodies.body_file import MOST_BYTES
from solvers.bodies.body_run_worker import BodyRunRequest
from solvers.workers.worker_pool import Slots, WorkerPool
from solvers.workers.worker_process import ProcessDied, WorkerTimeout

PATIENCE = 180.0  # timeout of a run in s
SLOTS = Slots(MOST_JOBS)  # visitors of this server who run bodies at once
BUSY = lazy("The server is busy running the bodies of other visitors; try again in a minute")
TOO_LONG = lazy("The body {name} takes more than {seconds:g} s to run; give it fewer cells, or run it with "
                "`mpm-lab run`")


class BodyRuns:
    """One visitor's runs, one at a time. ``on_message`` receives the source of the last run asked for, its table, and
    the messages of its process (``solvers.bodies.body_run_worker``) on another thread; a refusal if the process dies.
    """

    def __init__(self, on_message: Callable[[BodySource, Path, dict], None]):
        self._on_message = on_message
        self._pool: WorkerPool | None = None
        self._table: Path | None = None  # of the last run asked for
        self._pending, self._lock = 0, threading.Lock()  # runs that have not ended: all of them take one slot

    @cached_property
    def _folder(self) -> Path:
        """The folder of this visitor's tables and files; deleted at the end of the process at the latest."""
        folder = Path(tempfile.mkdtemp(prefix="mpm-lab-"))
        weakref.finalize(self, shutil.rmtree, folder, ignore_errors=True)
        return folder

    def take_file(self, file: Path) -> Path:
        """Copies an uploaded file to where the next upload does not replace it, and returns the new path; of one that
        is too large for a body, as much as it takes to refuse it."""
        own = self._folder / f"body-{secrets.token_hex(4)}.toml"
        with file.open("rb") as upload:
            own.write_bytes(upload.read(MOST_BYTES + 1))
        return own

    def begin(self, source: BodySource) -> None:
        """Runs a body instead of the one before; the process stays, with what it has compiled."""
        self.cancel()
        table = self._folder / f"table-{secrets.token_hex(4)}"
        table.touch()
        with self._lock:
            busy = not self._pending and not SLOTS.acquire()
            self._pending += not busy
        if busy:
            return self._on_message(source, table, {"refused": tr(BUSY)})
        self._table = table
        new = self._pool is None
        pool = self._pool = self._pool or WorkerPool("solvers.bodies.body_run_worker:run_in_worker")
        question = BodyRunRequest(str(source.file), source.name, source.changes, str(table), MOST_WATCHED)
        forward = with_language(functools.partial(self._forward, source, table))
        run = pool.submit(asdict(question), forward, PATIENCE)
        if new:
            pool.lower_priority()  # stages, which all visitors share, come first
        run.add_done_callback(with_language(functools.partial(self._end, source, forward)))

    def cancel(self) -> None:
        """Ends the present run at its next sample; no further messages come."""
        if self._table:
            self._table.unlink(missing_ok=True)
        self._table = None

    def close(self) -> None:
        """Ends the process."""
        self.cancel()
        if self._pool:
            self._pool.kill()
        self._pool = None

    def _forward(self, source: BodySource, table: Path, message: dict) -> None:
        if table == self._table:
            self._on_message(source, table, message)

    def _end(self, source: BodySource, forward: Callable[[dict], None], run: Future[dict]) -> None:
        """Forwards a refusal if the process has failed; frees the slot after the last run."""
        with self._lock:
            self._pending -= 1
            if not self._pending:
                SLOTS.release()
        error = run.exception()
        if isinstance(error, WorkerTimeout):
            forward({"refused": tr(TOO_LONG, name=source.name, seconds=PATIENCE)})
        elif isinstance(error, ProcessDied):
            forward({"refused": tr("The body {name} could not be run: the process {has_ended}", name=source.name,
                                   has_ended=translate_message(str(error)))})
        elif isinstance(error, OSError):
            forward({"refused": tr("No process could be started: {reason}", reason=error.strerror or error)})
