"""Marks for the visitors of lessons: they wait for runs, and the page does not wait for them."""

import logging
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any

from app.lessons.claims import ClaimError
from app.lessons.lesson import EXPLAIN, Lesson, Step, drawn
from app.lessons.marks import AnswerMark, mark
from app.lessons.outcomes import Outcomes, RunFailed
from app.lessons.progress import Progress

LATER = "could not be checked just now"
POLITE = 10  # more than the engines: marks can wait, stages cannot


@dataclass(frozen=True)
class Classroom:
    """What all visitors of one server share: the lesson that everyone is opened on, if any, whether teacher's notes are
    shown, what answers are marked by, and whether lessons begin with their core alone."""

    lesson: str = ""
    teacher: bool = False
    outcomes: Outcomes = field(default_factory=lambda: Outcomes(politeness=POLITE))
    core: bool = False

    def begun(self, lesson: Lesson) -> Progress:
        """How somebody begins a lesson."""
        return Progress(lesson.name, lesson.fingerprint, core=self.core and bool(lesson.deeper))


class Marker:
    """Marks answers one after the other in a thread of its own. ``marks`` are those of what was answered first, by the
    steps' keys; a sentence stands where there can be none."""

    def __init__(self, outcomes: Outcomes):
        self._outcomes = outcomes
        self._thread = ThreadPoolExecutor(1)
        self.marks: dict[str, AnswerMark | str] = {}

    def close(self) -> None:
        self._thread.shutdown(wait=False, cancel_futures=True)

    def forget(self) -> None:
        """Another lesson, or another student: marks mean something else."""
        self.marks = {}

    def check(self, lesson: Lesson, step: Step, progress: Progress, tell: Callable[[AnswerMark | str], None]) -> None:
        """Mark what a step was answered last, and ``tell``."""
        answer = progress.answers[step.key].last
        self._later(lambda: tell(self._marked(lesson, step, progress, answer)))

    def mark_first(self, lesson: Lesson, steps: list[Step], progress: Progress, tell: Callable[[], None]) -> None:
        """Mark what these steps were answered first, and ``tell`` that it is done."""
        marks, answers = self.marks, dict(progress.answers)

        def work() -> None:
            for step in steps:
                if step.key in answers and step.key not in marks:
                    marks[step.key] = self._marked(lesson, step, progress, answers[step.key].first)
            tell()

        self._later(work)

    def _marked(self, lesson: Lesson, step: Step, progress: Progress, answer: Any) -> AnswerMark | str:
        try:
            return mark(lesson, step, answer, drawn(lesson, progress.name), self._outcomes)
        except (RunFailed, ClaimError):
            return LATER

    def _later(self, work: Callable[[], None]) -> None:
        def safely() -> None:
            try:
                work()
            except Exception:
                logging.getLogger(__name__).exception("an answer could not be marked")

        self._thread.submit(safely)


def asked_since(lesson: Lesson, step: Step) -> list[Step]:
    """The steps with questions since the explanation before this one."""
    before = lesson.steps[:lesson.steps.index(step)]
    first = max((k for k, other in enumerate(before, 1) if other.kind == EXPLAIN), default=0)
    return [other for other in before[first:] if other.question]
