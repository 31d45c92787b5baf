"""State of the board, kept by the server and shown on all boards: the step that is open, and what is shown of it.

One button leads to the next thing: for a question the number of answers, the answers, the result. A press names the
``turn`` of the board that it is meant for: of two simultaneous ones, or a late one, only one counts."""

import threading
from collections.abc import Callable, Iterable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

from app.access.rate_limited_log import log_failure
from app.classroom.class_answers import ClassAnswers
from app.language.translation import current_language, lazy
from app.lessons.answer_marking import RightAnswer, right_answer
from app.lessons.claims import ClaimError
from app.lessons.lesson import TEXT, Lesson, Step
from app.lessons.lesson_runs import RunCache, RunFailed
from app.lessons.student_progress import StudentProgress

COUNTED, SHOWN, REVEALED = range(3)  # stages of a question
NEXT, BACK = "next", "back"
FAILED = lazy("The result could not be computed.")


@dataclass(frozen=True)
class ShownBoardStep:
    """What boards show: step ``at`` (0: introduction), its ``question_phase``; ``turn`` counts changes."""

    turn: int
    at: int
    last_open_step: int
    question_phase: int

    @property
    def shows_last_open_step(self) -> bool:
        return self.at == self.last_open_step


class ClassBoardState:
    """Board of a class in one ``lesson``, or its ``core``, with the first set of numbers. Thread-safe. Steps are
    numbered ``at`` from 1; 0 is the introduction. ``outcomes`` runs the scenes of right answers; ``translations`` are
    the lesson in other languages."""

    def __init__(self, lesson: Lesson, outcomes: RunCache, core: bool = False, translations: Iterable[Lesson] = ()):
        self.core = core and bool(lesson.optional_steps)
        self._step_numbers = [at for at, step in enumerate(lesson.steps, 1) if step.core or not self.core]
        self._original, self._by_language = lesson, {one.language: one for one in translations}
        self.numbers, self._outcomes = lesson.variants[0], outcomes
        self.tally = ClassAnswers(self._notify_watchers)
        self._lock = threading.RLock()
        self._turn = self._at = self._opened = 0
        self._stages: dict[int, int] = {}  # by number of a step with a question
        self._rights: dict[str, Future[RightAnswer]] = {}
        self._thread = ThreadPoolExecutor(1, "board")
        self._watchers: list[Callable[[], None]] = []
        self._seats: list[VisitorBoardSeat] = []

    @property
    def shown_step(self) -> ShownBoardStep:
        with self._lock:
            return ShownBoardStep(self._turn, self._at, self._opened, self._stages.get(self._at, COUNTED))

    @property
    def last_open_step(self) -> int:
        """Number of the last step that is open to all, 0 at first."""
        return self.shown_step.last_open_step

    @property
    def end_position(self) -> int:
        """The number after the lesson's last step."""
        return len(self.lesson.steps) + 1

    @property
    def lesson(self) -> Lesson:
        """The lesson in the current language, if it is translated."""
        return self._by_language.get(current_language(), self._original)

    @property
    def step_count(self) -> int:
        """Number of steps that the class takes."""
        return len(self._step_numbers)

    def step_number(self, at: int) -> int:
        """Returns the number that the class sees for step ``at``, as steps beyond the core may be left out."""
        return sum(taken <= at for taken in self._step_numbers)

    def next_position(self, at: int) -> int:
        """Returns the number of the class's step after step ``at``, or :attr:`end_position`."""
        return self.lesson.neighbour_step(at, 1, self.core)

    def step(self, at: int) -> Step | None:
        """Returns the lesson's step number ``at``; None before the first and after the last."""
        return self.lesson.steps[at - 1] if 0 < at < self.end_position else None

    def question_phase(self, at: int) -> int:
        """Returns the phase of the question of step ``at``: ``COUNTED``, ``SHOWN`` or ``REVEALED``."""
        with self._lock:
            return self._stages.get(at, COUNTED)

    def press_button(self, button: str, turn: int) -> None:
        """Goes on (``NEXT``) or ``BACK``, unless the board has changed since ``turn``, at which it was pressed."""
        with self._lock:
            before = self.shown_step
            if turn != before.turn:
                return
            if button == NEXT:
                self._advance()
            elif button == BACK:
                self._at = self.lesson.neighbour_step(self._at, -1, self.core)
            if self.shown_step == before:
                return
            self._turn += 1
            seats = list(self._seats) if self._opened != before.last_open_step else []
        self._notify_watchers()
        for seat in seats:
            seat.notify_step_open()

    def computed_right_answer(self, step: Step) -> RightAnswer | str | None:
        """Returns the right answer to a step's question, a sentence if that fails, None while it is computed."""
        run = self._rights.get(step.key)
        if run is None or not run.done():
            return None
        try:
            return run.result()
        except (RunFailed, ClaimError):
            return FAILED

    def watch(self, on_change: Callable[[], None]) -> None:
        """Has ``on_change`` called, on any thread, whenever the board or its answers change."""
        with self._lock:
            self._watchers.append(on_change)

    def unwatch(self, on_change: Callable[[], None]) -> None:
        with self._lock:
            self._watchers.remove(on_change)

    def add_seat(self, key: str) -> "VisitorBoardSeat":
        """Returns a seat, by which a page follows the board; ``key`` is that of its visitor's cookie."""
        seat = VisitorBoardSeat(self, key)
        with self._lock:
            self._seats.append(seat)
        return seat

    def remove_seat(self, seat: "VisitorBoardSeat") -> None:
        """Removes the seat of a closed page."""
        with self._lock:
            self._seats.remove(seat)

    def stop_computations(self) -> None:
        """Stops computing right answers, for the server's end."""
        self._thread.shutdown(wait=False, cancel_futures=True)

    def _advance(self) -> None:
        """Goes to the question's next phase, else to the next step, which it opens to all."""
        step, stage = self.step(self._at), self._stages.get(self._at, COUNTED)
        if self._at < self._opened:
            self._at = self.next_position(self._at)
        elif step and has_chart(step) and stage < REVEALED:
            self.tally.close_question(step.key)
            self._stages[self._at] = stage + 1
            self._compute_right_answer(step)
        elif self._at < self.end_position:
            self._at = self._opened = self.next_position(self._opened)
            if (step := self.step(self._at)) and has_chart(step):
                self._compute_right_answer(step)

    def _compute_right_answer(self, step: Step) -> None:
        """Starts computing the right answer to a step's question, unless it is known; repeats a failed attempt."""
        run = self._rights.get(step.key)
        if run is None or (run.done() and run.exception()):
            run = self._rights[step.key] = self._thread.submit(right_answer, self.lesson, step, self.numbers,
                                                               self._outcomes)
            run.add_done_callback(lambda _: self._notify_watchers())

    def _notify_watchers(self) -> None:
        with self._lock:
            watchers = list(self._watchers)
        for tell in watchers:
            tell()


class VisitorBoardSeat:
    """A page's part in the class: follows the ``board`` and reports steps, from 1, of the visitor with this ``key``."""

    def __init__(self, board: ClassBoardState, key: str):
        self._board, self._key, self._gone = board, key, False
        self._entry = board.tally.register_page(key)
        self._on_open: Callable[[], None] = lambda: None

    @property
    def lesson(self) -> str:
        """Name of the lesson whose steps the board opens; others are open at once."""
        return self._board.lesson.name

    @property
    def last_open_step(self) -> int:
        """Number of the last step that the board has opened, 0 at first."""
        return self._board.last_open_step

    def progress(self) -> StudentProgress:
        """Returns the visitor's step and answers in the lesson, which the server stores instead of the browser."""
        lesson = self._board.lesson
        return StudentProgress(lesson.name, lesson.fingerprint, step=min(self._entry.step, self.last_open_step),
                               answers=self._entry.answers, core=self._board.core)

    def watch_open_steps(self, on_open: Callable[[], None]) -> None:
        """Has ``on_open`` called, on any thread, whenever the board opens a step; replaces an earlier one."""
        self._on_open = on_open

    def notify_step_open(self) -> None:
        """Calls the page's function that a further step is open; an error in one page does not affect others."""
        try:
            if not self._gone:
                self._on_open()
        except Exception as error:
            log_failure("a page could not be told that a step is open", error)

    def report_step(self, step: int) -> None:
        """Reports that the visitor has reached the step with this number."""
        self._board.tally.record_step(self._key, step)

    def report_answer(self, step: Step, answer: Any) -> None:
        """Reports the visitor's answer to a step's question: a choice or a number; of a text only that there is one."""
        self._board.tally.record_answer(self._key, step.key, "" if step.asked_question.kind == TEXT else answer)

    def leave(self) -> None:
        """Ends the page's part in the class, when the page is closed."""
        self._gone = True
        self._board.remove_seat(self)
        self._board.tally.unregister_page(self._key)


def has_chart(step: Step) -> bool:
    """Whether a step has a question whose answers the board shows; free texts are only counted."""
    return step.question is not None and step.question.kind != TEXT
