"""Grades of handed-in files: one row per student; each mark is computed anew from runs."""

from collections.abc import Sequence
from dataclasses import dataclass

from app.lessons.answer_marking import AnswerMark, format_answer, mark_answer
from app.lessons.claims import ClaimError
from app.lessons.interval_bets import YOURS, Bettor, IntervalBet
from app.lessons.lesson import INTERVAL, PREDICT, TEXT, Lesson, Numbers, Step, draw_numbers, fill_numbers
from app.lessons.lesson_runs import RunCache, RunFailed
from app.lessons.student_progress import StudentProgress
from solvers.untrusted import quoting

BETS = ("intervals", "held", "mean score")  # columns of a table with bets


@dataclass(frozen=True)
class GradedFile:
    """Student's file: answers in words, marks (None: failed), and the ``steps`` whose questions count, by key."""

    file: str
    progress: StudentProgress
    lesson: Lesson
    steps: dict[str, Step]
    answers: dict[str, tuple[str, AnswerMark | None]]

    @property
    def points(self) -> float:
        """Number of right answers; an interval counts by its score, from 1 down to 0."""
        return sum(mark.points for _, mark in self.answers.values() if mark is not None)

    @property
    def bettor(self) -> Bettor:
        """The student as a bettor, with the intervals given in all answers."""
        marks = (mark for _, mark in self.answers.values() if mark is not None)
        return Bettor(YOURS, tuple(mark.bet for mark in marks if mark.bet))

    @property
    def maximum(self) -> int:
        """Number of questions that count and have a right answer, answered or not."""
        return sum(step.asked_question.kind != TEXT for step in self.steps.values())

    @property
    def minutes(self) -> float:
        """Minutes from the display of each step to its answer, in all."""
        return sum(answer.seconds for answer in self.progress.answers.values()) / 60


def grade_file(file: str, progress: StudentProgress, lesson: Lesson, outcomes: RunCache,
               core: bool = False) -> GradedFile:
    """Returns the graded file of a student's progress: first answers to predictions count, last ones to observations;
    with ``core`` only questions of the core. Runs scenes."""
    numbers = draw_numbers(lesson, progress.name)
    asked = {step.key: step for step in lesson.steps_to_take(core) if step.question}
    answers = {key: _mark_recorded_answer(lesson, key, progress, numbers, outcomes)
               for key in progress.answers if key in asked}
    return GradedFile(file, progress, lesson, asked, answers)


def grades_csv(rows: Sequence[GradedFile]) -> str:
    """Returns CSV with a row per file: name, points ("right"), minutes and, per question, the answer, whether it is
    right and an interval's score; an interval gives 1 - score/2 points, at least 0."""
    questions = {(row.lesson.name, key): None for row in rows for key in row.steps}
    several = len({row.lesson.name for row in rows}) > 1
    bets = {(row.lesson.name, key) for row in rows for key, step in row.steps.items()
            if step.asked_question.kind == INTERVAL}
    heads = []
    for lesson, key in questions:
        head = f"{lesson}: {key}" if several else key
        heads += [head, f"{head}: right", *([f"{head}: score"] if (lesson, key) in bets else [])]
    lines: list[list[object]] = [["name", "lesson", "right", "of", "minutes", "same lesson", "core only", "file",
                                  *(BETS if bets else ()), *heads]]
    for row in rows:
        cells = [row.progress.name, row.lesson.name, f"{round(row.points, 2):g}", row.maximum, f"{row.minutes:.1f}",
                 _yes_or_no(row.progress.fingerprint == row.lesson.fingerprint), _yes_or_no(row.progress.core),
                 row.file]
        if bets:
            cells += [len(row.bettor.placed_bets), row.bettor.hits, _format_score(row.bettor.score)]
        for lesson, key in questions:
            said, found = row.answers.get(key, ("", None)) if lesson == row.lesson.name else ("", None)
            cells += [said, "" if found is None or found.right is None else _yes_or_no(found.right)]
            if (lesson, key) in bets:
                cells.append(_format_score(found.bet.score if found is not None and found.bet else None))
        lines.append(cells)
    return quoting.csv_text(lines)


def interval_coverage(rows: Sequence[GradedFile]) -> list[str]:
    """Returns sentences on how many of a class's intervals contain the true value, and how many should, for each
    question with intervals and, over several questions, for each lesson."""
    found: dict[tuple[str, str], list[IntervalBet]] = {}
    for row in rows:
        for key, (_, answer) in row.answers.items():
            if answer is not None and answer.bet:
                found.setdefault((row.lesson.name, key), []).append(answer.bet)
    told = [_coverage_text(f"{lesson}, {key}", bets) for (lesson, key), bets in found.items()]
    for lesson in dict.fromkeys(lesson for lesson, _ in found):
        questions = [bets for (name, _), bets in found.items() if name == lesson]
        told += [_coverage_text(lesson, [bet for bets in questions for bet in bets])] if len(questions) > 1 else []
    return told


def _coverage_text(what: str, bets: Sequence[IntervalBet]) -> str:
    """Returns a sentence about ``what``: how many bets contain the true value, their mean level and score."""
    bettor, said = Bettor(YOURS, tuple(bets)), sum(bet.level for bet in bets) / len(bets)
    return f"{what}: {bettor.hits} of {len(bets)} intervals hold what came out, {bettor.hits / len(bets):.0%} where " \
           f"{said:.0%} was said; their mean score is {_format_score(bettor.score)}, and less is better"


def _mark_recorded_answer(lesson: Lesson, key: str, progress: StudentProgress, numbers: Numbers,
                          outcomes: RunCache) -> tuple[str, AnswerMark | None]:
    """Returns the answer that counts for a step's ``key`` in words, and its mark, None if its runs fail."""
    step, answer = lesson.questions[key], progress.answers[key]
    given = answer.first if step.kind == PREDICT else answer.last
    said = fill_numbers(format_answer(step.asked_question, given), numbers)
    try:
        return said, mark_answer(lesson, step, given, numbers, outcomes)
    except (ClaimError, RunFailed):
        return said, None


def _format_score(score: float | None) -> str:
    return "" if score is None else f"{score:.2f}"


def _yes_or_no(true: bool) -> str:
    return "yes" if true else "no"
