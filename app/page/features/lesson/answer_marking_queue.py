"""Marking of visitors' answers: it waits for runs in a thread, so that the page does not."""

import logging
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from app.language.translation import lazy, tr, with_language
from app.lessons.answer_marking import TOLD_AFTER, AnswerMark, bettors_of_step, mark_answer
from app.lessons.claims import ClaimError
from app.lessons.interval_bets import Bettor
from app.lessons.lesson import EXPLAIN, PREDICT, Lesson, Step, draw_numbers
from app.lessons.lesson_runs import RunCache, RunFailed
from app.lessons.student_progress import RecordedAnswer, StudentProgress

LATER = lazy("could not be checked just now")


class AnswerMarkingQueue:
    """Marks answers, one after the other in a thread. ``marks`` of first answers, or why there is none, and ``bets``
    are by a step's key; ``outcomes`` are the runs of lessons."""

    def __init__(self, outcomes: RunCache):
        self._outcomes = outcomes
        self._thread = ThreadPoolExecutor(1)
        self.marks: dict[str, AnswerMark | str] = {}
        self.bets: dict[str, list[Bettor] | str] = {}  # shown by steps, by the steps' keys

    def close(self) -> None:
        self._thread.shutdown(wait=False, cancel_futures=True)

    def discard_marks(self) -> None:
        """Discards all marks: another lesson or another student has begun."""
        self.marks, self.bets = {}, {}

    def mark_last_answer(self, lesson: Lesson, step: Step, progress: StudentProgress,
                         tell: Callable[[AnswerMark | str], None]) -> None:
        """Marks a student's last answer to a step, and passes mark or error message to ``tell``, in a thread."""
        answer = progress.answers[step.key].last
        self._submit(lambda: tell(self._mark(lesson, step, progress, answer)))

    def mark_first_answers(self, lesson: Lesson, steps: list[Step], progress: StudentProgress,
                           tell: Callable[[], None]) -> None:
        """Fills ``marks`` for first answers to these steps, and calls ``tell`` when done, in a thread."""
        marks, answers = self.marks, dict(progress.answers)

        def work() -> None:
            for step in steps:
                if step.key in answers and step.key not in marks:
                    marks[step.key] = self._mark(lesson, step, progress, answers[step.key].first)
            tell()

        self._submit(work)

    def compute_bets(self, lesson: Lesson, step: Step, progress: StudentProgress, tell: Callable[[], None]) -> None:
        """Fills ``bets`` for the bets that a step shows, and calls ``tell`` when done, in a thread."""
        bets, given = self.bets, {key: answer.first for key, answer in progress.answers.items()}

        def work() -> None:
            try:
                bets[step.key] = bettors_of_step(lesson, step, given, draw_numbers(lesson, progress.name),
                                                 self._outcomes)
            except (RunFailed, ClaimError):
                bets[step.key] = LATER
            tell()

        self._submit(work)

    def _mark(self, lesson: Lesson, step: Step, progress: StudentProgress, answer: Any) -> AnswerMark | str:
        """Returns the mark of an answer, which may need runs, or why there is none."""
        try:
            return mark_answer(lesson, step, answer, draw_numbers(lesson, progress.name), self._outcomes)
        except (RunFailed, ClaimError):
            return tr(LATER)

    def _submit(self, work: Callable[[], None]) -> None:
        """Runs ``work`` in the thread, in the caller's language; logs its errors."""
        def safely() -> None:
            try:
                work()
            except Exception:
                logging.getLogger(__name__).exception("an answer could not be marked")

        self._thread.submit(with_language(safely))


def question_steps_of_round(lesson: Lesson, step: Step) -> list[Step]:
    """Returns a lesson's steps with questions between the last explanation before ``step`` and ``step``."""
    before = lesson.steps[:lesson.steps.index(step)]
    first = max((k for k, other in enumerate(before, 1) if other.kind == EXPLAIN), default=0)
    return [other for other in before[first:] if other.question]


def upcoming_bets_step(lesson: Lesson, step: Step) -> Step | None:
    """Returns the explanation next after ``step``, if it shows bets to be computed in advance; None on predictions."""
    ends = next((other for other in lesson.steps[lesson.steps.index(step):] if other.kind == EXPLAIN), None)
    return ends if ends is not None and ends.bets and step.kind != PREDICT else None


def answer_comment(step: Step, answer: RecordedAnswer, mark: AnswerMark | str | None) -> tuple[str, bool | None]:
    """Returns a comment on an answer with this mark or message, and whether it is right, None if not revealed."""
    if step.kind == PREDICT:
        return tr("It is recorded; now see what happens."), None
    if mark is None or isinstance(mark, str):
        return mark or "", None
    if mark.right is not False:
        return "", mark.right
    told = answer.attempts >= TOLD_AFTER
    return tr("It is {answer}.", answer=mark.expected) if told else tr("Look again, and try once more."), False
