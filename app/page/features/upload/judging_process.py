"""A visitor's file while a worker process judges it, with a timeout; and the question which problem it belongs to."""

import functools
import secrets
import threading
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import asdict
from html import escape
from pathlib import Path

import viser

from app.language.translation import lazy, tr, translate_message, with_language
from app.names_and_units import reword_for_page
from app.page.features.background_job import MOST_JOBS
from app.page.visit.engine_links import MOST_WATCHED
from solvers.judging.particle_readers import PACKED, UPLOADED, kind_of
from solvers.judging.uploaded_file_worker import JudgeFileRequest
from solvers.problems import PROBLEMS
from solvers.scene.scene import Scene
from solvers.study.parameter_grid import task_of
from solvers.untrusted.quoting import file_name
from solvers.workers.worker_pool import Slots, WorkerPool
from solvers.workers.worker_process import ProcessDied, WorkerTimeout

PATIENCE = 180.0  # timeout of a file in s
SLOTS = Slots(MOST_JOBS)  # files that are judged at once on this server
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}  # each thread would take memory of its own
BUSY = lazy("Other visitors' files keep this server busy; give yours again in a while")
TOO_LONG = lazy("The file {file} takes more than {seconds:g} s to judge; give fewer times, or judge it with `mpm-lab "
                "judge`")
FIRST = -1e9  # order within the panel
ASKED, NEITHER = lazy("Which problem is your file of?"), lazy("None of these")


class JudgeJob:
    """A visitor's ``file`` being judged as a run of ``scene``, which if ``chosen`` overrides the one in the file.
    ``on_message`` receives the job and the messages of its process (``solvers.judging.uploaded_file_worker``) on
    another thread, and a refusal if the process dies, but none after :meth:`cancel`."""

    def __init__(self, name: str, file: Path, scene: Scene, on_message: Callable[["JudgeJob", dict], None],
                 slots: Slots = SLOTS, chosen: bool = False):
        self.name, self._on_message, self._slots = file_name(name), on_message, slots
        kind = kind_of(name)
        say = with_language(self._forward_message)
        known = kind.removesuffix(PACKED) in UPLOADED
        self.file = file.replace(file.with_name(f"particles{kind if known else '.unknown'}"))
        self.table = file.with_name(f"table-{secrets.token_hex(4)}")
        self._pool = WorkerPool("solvers.judging.uploaded_file_worker:judge_in_worker", environment=ONE_THREAD)
        self._cancelled = threading.Event()
        if slots.acquire():
            question = JudgeFileRequest(str(self.file), self.name, task_of(scene).to_dict(), str(self.table),
                                        MOST_WATCHED, chosen)
            judged = self._pool.submit(asdict(question), say, PATIENCE)
            self._pool.lower_priority()  # stages, which all visitors share, come first
            judged.add_done_callback(with_language(self._end))
        else:
            threading.Thread(target=say, args=({"refused": tr(BUSY)},), name="judge", daemon=True).start()

    @property
    def process_id(self) -> int | None:
        return next(iter(self._pool.process_ids), None)

    def cancel(self) -> None:
        """Stops the process; no further messages come."""
        self._cancelled.set()
        self._pool.kill()

    def _forward_message(self, message: dict) -> None:
        if not self._cancelled.is_set():
            self._on_message(self, message)

    def _end(self, judged: Future[dict]) -> None:
        """Forwards a refusal if the process has failed, and frees its slot."""
        error = judged.exception()
        if isinstance(error, WorkerTimeout):
            self._forward_message({"refused": tr(TOO_LONG, file=self.name, seconds=PATIENCE)})
        elif isinstance(error, ProcessDied):
            self._forward_message({"refused": tr("The file {file} could not be judged: the process {has_ended}",
                                                 file=self.name, has_ended=translate_message(str(error)))})
        elif isinstance(error, OSError):
            self._forward_message({"refused": tr("No process could be started: {reason}",
                                                 reason=error.strerror or error)})
        self._pool.close()
        self._slots.release()


def question_sentence(name: str, reason: str, problems: tuple[str, ...]) -> str:
    """Returns the question which of ``problems`` a file is of, after the ``reason`` why it is not judged yet."""
    *others, last = (tr(PROBLEMS[problem].scene.TITLE) for problem in problems)
    titles = last
    if others:
        before = functools.reduce(lambda before, next: tr("{before}, the {next}", before=before, next=next), others)
        titles = tr("{before} or the {last}", before=before, last=last)
    return tr("The file {file} {reason}. Is it of the {problems}?", file=name, reason=reword_for_page(reason),
              problems=titles)


class FileProblemButtons:
    """Buttons with the problems that a file fits; ``on_choice`` is called with the key of the one chosen, or None."""

    def __init__(self, gui: viser.GuiApi, on_choice: Callable[[str | None], None]):
        self._folder = gui.add_folder(tr(ASKED), order=FIRST, visible=False)
        with self._folder:
            self._text = gui.add_html("")
            hint = tr("judge the file as a run of this problem")
            self._buttons = {name: gui.add_button(tr("It is the {problem}", problem=tr(kind.scene.TITLE)), hint=hint)
                             for name, kind in PROBLEMS.items()}
            neither = gui.add_button(tr(NEITHER), hint=tr("do not judge the file"))
        for problem, button in self._buttons.items():
            button.on_click(lambda _, problem=problem: on_choice(problem))  # type: ignore[misc]
        neither.on_click(lambda _: on_choice(None))

    @property
    def is_open(self) -> bool:
        return self._folder.visible

    def ask(self, sentence: str, problems: tuple[str, ...]) -> None:
        """Shows the question as a sentence, and a button for each of ``problems``."""
        self._text.content = f"<div class='lab-own' role='status'><p>{escape(sentence)}</p></div>"
        for problem, button in self._buttons.items():
            button.visible = problem in problems
        self._folder.visible = True

    def hide(self) -> None:
        self._folder.visible = False
