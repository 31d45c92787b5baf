"""The board's state, which the server has and all boards show: how far the lesson is open, what is shown of a step.

A lecturer presses for the one next thing. Of a step with a question these are: only how many have answered, then what
they have said, then what came out. A press says which ``turn`` of the board it was meant for: of two at once, or one
that comes late, one counts.
"""

import threading
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

from app.access.log_limit import log_failure
from app.classroom.class_answers import ClassAnswers
from app.language.translation import lazy
from app.lessons.answer_check import Right, right_answer
from app.lessons.claims import ClaimError
from app.lessons.lesson import TEXT, Lesson, Step
from app.lessons.lesson_runs import RunCache, RunFailed
from app.lessons.student_progress import Progress

COUNTED, SHOWN, REVEALED = range(3)  # what is shown of a question
NEXT, BACK = "next", "back"
FAILED = lazy("The result could not be computed.")


@dataclass(frozen=True)
class Place:
    """What a board shows: a step (0 is the beginning), what of it, and whether it is ``now`` or looked back at."""

    turn: int
    at: int
    opened: int
    stage: int

    @property
    def now(self) -> bool:
        return self.at == self.opened


class Board:
    """The board of a class in one ``lesson``, or its ``core``, with the first set of numbers. Any thread may call."""

    def __init__(self, lesson: Lesson, outcomes: RunCache, core: bool = False):
        self.core = core and bool(lesson.deeper)
        self._taken = [at for at, step in enumerate(lesson.steps, 1) if step.core or not self.core]
        self.lesson, self.numbers, self._outcomes = lesson, lesson.variants[0], outcomes
        self.tally = ClassAnswers(self._changed)
        self._lock = threading.RLock()
        self._turn = self._at = self._opened = 0
        self._stages: dict[int, int] = {}  # of steps with a question
        self._rights: dict[str, Future[Right]] = {}
        self._thread = ThreadPoolExecutor(1, "board")
        self._watchers: list[Callable[[], None]] = []
        self._seats: list[BoardSeat] = []

    @property
    def place(self) -> Place:
        with self._lock:
            return Place(self._turn, self._at, self._opened, self._stages.get(self._at, COUNTED))

    @property
    def opened(self) -> int:
        """The last step that is open to all."""
        with self._lock:
            return self._opened

    @property
    def end(self) -> int:
        """The place after the last step."""
        return len(self.lesson.steps) + 1

    @property
    def total(self) -> int:
        """How many steps the class takes."""
        return len(self._taken)

    def number(self, at: int) -> int:
        """Which of the steps that the class takes is at a place, or was the last before it."""
        return sum(taken <= at for taken in self._taken)

    def after(self, at: int) -> int:
        """The place that follows."""
        return self.lesson.beside(at, 1, self.core)

    def step(self, at: int) -> Step | None:
        """The step at a place."""
        return self.lesson.steps[at - 1] if 0 < at < self.end else None

    def stage(self, at: int) -> int:
        """What is shown of the question of the step at a place."""
        with self._lock:
            return self._stages.get(at, COUNTED)

    def press(self, what: str, turn: int) -> None:
        """Do the next thing, or look back, if the board is still as it was when that was pressed."""
        with self._lock:
            before = self.place
            if turn != before.turn:
                return
            if what == NEXT:
                self._go_on()
            elif what == BACK:
                self._at = self.lesson.beside(self._at, -1, self.core)
            if self.place == before:
                return
            self._turn += 1
            seats = list(self._seats) if self._opened != before.opened else []
        self._changed()
        for seat in seats:
            seat.open()

    def came_out(self, step: Step) -> Right | str | None:
        """Returns what is right in a step's question, a sentence if that fails, None while it is worked out."""
        run = self._rights.get(step.key)
        if run is None or not run.done():
            return None
        try:
            return run.result()
        except (RunFailed, ClaimError):
            return FAILED

    def watch(self, on_change: Callable[[], None]) -> None:
        """Have ``on_change`` called, on any thread, when something that a board shows is another."""
        with self._lock:
            self._watchers.append(on_change)

    def unwatch(self, on_change: Callable[[], None]) -> None:
        with self._lock:
            self._watchers.remove(on_change)

    def seat(self, key: str) -> "BoardSeat":
        """A page of the visitor with this key."""
        seat = BoardSeat(self, key)
        with self._lock:
            self._seats.append(seat)
        return seat

    def give_up(self, seat: "BoardSeat") -> None:
        """Its page has gone."""
        with self._lock:
            self._seats.remove(seat)

    def close(self) -> None:
        """Nothing is worked out any more."""
        self._thread.shutdown(wait=False, cancel_futures=True)

    def _go_on(self) -> None:
        """The one next thing."""
        step, stage = self.step(self._at), self._stages.get(self._at, COUNTED)
        if self._at < self._opened:
            self._at = self.after(self._at)
        elif step and has_chart(step) and stage < REVEALED:
            self.tally.close(step.key)
            self._stages[self._at] = stage + 1
            self._work_out(step)
        elif self._at < self.end:
            self._at = self._opened = self.after(self._opened)
            if (step := self.step(self._at)) and has_chart(step):
                self._work_out(step)

    def _work_out(self, step: Step) -> None:
        """What is right in a step, so that it is there when it is asked for; what has failed once more."""
        run = self._rights.get(step.key)
        if run is None or (run.done() and run.exception()):
            run = self._rights[step.key] = self._thread.submit(right_answer, self.lesson, step, self.numbers,
                                                               self._outcomes)
            run.add_done_callback(lambda _: self._changed())

    def _changed(self) -> None:
        with self._lock:
            watchers = list(self._watchers)
        for tell in watchers:
            tell()


class BoardSeat:
    """A page of the visitor with this ``key``; steps are counted as in :class:`Progress`."""

    def __init__(self, board: Board, key: str):
        self._board, self._key, self._gone = board, key, False
        self._entry = board.tally.come(key)
        self._on_open: Callable[[], None] = lambda: None

    @property
    def lesson(self) -> str:
        """The name of the lesson that is paced; in others a visitor goes on as he likes."""
        return self._board.lesson.name

    @property
    def opened(self) -> int:
        """The last step that is open."""
        return self._board.opened

    def progress(self) -> Progress:
        """What this visitor has answered so far, and where he was: the class has it, and not the browser."""
        lesson = self._board.lesson
        return Progress(lesson.name, lesson.fingerprint, step=min(self._entry.step, self.opened),
                        answers=self._entry.answers, core=self._board.core)

    def listen(self, on_open: Callable[[], None]) -> None:
        """Have ``on_open`` called, on another thread, when a further step is open."""
        self._on_open = on_open

    def open(self) -> None:
        """A further step is open. One page that fails must not keep it from the others."""
        try:
            if not self._gone:
                self._on_open()
        except Exception as error:
            log_failure("a page could not be told that a step is open", error)

    def shows(self, step: int) -> None:
        self._board.tally.reach(self._key, step)

    def answered(self, step: Step, answer: Any) -> None:
        self._board.tally.say(self._key, step.key, "" if step.asked.kind == TEXT else answer)

    def leave(self) -> None:
        self._gone = True
        self._board.give_up(self)
        self._board.tally.leave(self._key)


def has_chart(step: Step) -> bool:
    """Whether what is answered to a step is shown; of free texts it is only said how many there are."""
    return step.question is not None and step.question.kind != TEXT
