"""Marks of handed-in files: one row a student, every mark derived anew from the runs."""

import csv
import io
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from app.lessons.claims import ClaimError
from app.lessons.lesson import INTERVAL, PREDICT, TEXT, Lesson, Numbers, Step, drawn, filled
from app.lessons.marks import AnswerMark, mark, shown
from app.lessons.outcomes import Outcomes, RunFailed
from app.lessons.progress import Progress
from solvers.outside import quoting


@dataclass(frozen=True)
class Graded:
    """A student's file: the answers in words and their marks, by the steps' keys; None where there is no answer.
    ``asked`` are the questions that count."""

    file: str
    progress: Progress
    lesson: Lesson
    asked: dict[str, Step]
    answers: dict[str, tuple[str, AnswerMark | None]]

    @property
    def right(self) -> int:
        return sum(mark is not None and bool(mark.right) for _, mark in self.answers.values())

    @property
    def marked(self) -> int:
        """Questions that count and have a right answer, answered or not."""
        return sum(step.asked.kind != TEXT for step in self.asked.values())

    @property
    def minutes(self) -> float:
        return sum(answer.seconds for answer in self.progress.answers.values()) / 60


def graded(file: str, progress: Progress, lesson: Lesson, outcomes: Outcomes, core: bool = False) -> Graded:
    """Mark a file. A prediction counts as it was first made, an observation as it was made at last; with ``core`` the
    questions of deeper steps do not count, answered or not."""
    numbers, asked = drawn(lesson, progress.name), {step.key: step for step in lesson.walk(core) if step.question}
    return Graded(file, progress, lesson, asked, {
        key: _answer(lesson, key, progress, numbers, outcomes) for key in progress.answers if key in asked})


def table(rows: Sequence[Graded]) -> str:
    """The rows as CSV: two columns a question, the answer and whether it is right."""
    questions = {(row.lesson.name, key): None for row in rows for key in row.asked}
    several = len({row.lesson.name for row in rows}) > 1
    heads = [f"{lesson}: {key}" if several else key for lesson, key in questions]
    out = io.StringIO()
    write = csv.writer(out, lineterminator="\n")
    write.writerow(["name", "lesson", "right", "of", "minutes", "same lesson", "core only", "file",
                    *(part for head in heads for part in (head, f"{head}: right"))])
    for row in rows:
        cells = [row.progress.name, row.lesson.name, row.right, row.marked, f"{row.minutes:.1f}",
                 _yes(row.progress.fingerprint == row.lesson.fingerprint), _yes(row.progress.core), row.file]
        for lesson, key in questions:
            said, found = row.answers.get(key, ("", None)) if lesson == row.lesson.name else ("", None)
            cells += [said, "" if found is None or found.right is None else _yes(found.right)]
        write.writerow([quoting.cell(cell) for cell in cells])
    return out.getvalue()


def coverage(rows: Sequence[Graded]) -> list[str]:
    """How many of a class's intervals hold what came out: a sentence for each such question."""
    asked, held = Counter[tuple[str, str]](), Counter[tuple[str, str]]()
    for row in rows:
        for key, (_, found) in row.answers.items():
            question = row.lesson.questions[key].question
            if question and question.kind == INTERVAL and found is not None:
                asked[row.lesson.name, key] += 1
                held[row.lesson.name, key] += bool(found.right)
    return [f"{lesson}, {key}: {held[lesson, key]} of {count} intervals hold what came out "
            f"({held[lesson, key] / count:.0%})" for (lesson, key), count in asked.items()]


def _answer(lesson: Lesson, key: str, progress: Progress, numbers: Numbers,
            outcomes: Outcomes) -> tuple[str, AnswerMark | None]:
    step, answer = lesson.questions[key], progress.answers[key]
    given = answer.first if step.kind == PREDICT else answer.last
    said = filled(shown(step.asked, given), numbers)
    try:
        return said, mark(lesson, step, given, numbers, outcomes)
    except (ClaimError, RunFailed):
        return said, None


def _yes(true: bool) -> str:
    return "yes" if true else "no"
