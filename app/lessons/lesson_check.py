"""Checks all claims of a lesson, without a page."""

from collections.abc import Iterator
from dataclasses import dataclass

from app.lessons.answer_marking import answer_expressions, right_answer
from app.lessons.claims import ClaimError, decide_claim
from app.lessons.lesson import CHOICE, Lesson, Numbers, Step, fill_numbers
from app.lessons.lesson_runs import RunCache, RunFailed


@dataclass(frozen=True)
class CheckedClaim:
    """Checked claim of a lesson, with one variant's numbers: whether it holds, values found, where it stands."""

    lesson: str
    step: str
    line: int
    claim: str
    holds: bool
    found: str

    def __str__(self) -> str:
        return f"{self.lesson}, line {self.line}, step \"{self.step}\": {self.claim}: " \
               f"{'holds' if self.holds else 'does not hold'}, {self.found}"


def check_lesson(lesson: Lesson, outcomes: RunCache, variants: int | None = None) -> Iterator[CheckedClaim]:
    """Yields checks of a lesson's claims and questions, for all ``variants`` of its numbers or the first so many."""
    for numbers in lesson.variants[:variants]:
        for step in lesson.steps:
            for claim in step.claims:
                text = fill_numbers(claim.text, numbers)
                try:
                    result = decide_claim(text, outcomes.scope(lesson, step, numbers, [text]))
                    came = result.holds, f"found {result.text}"
                except (ClaimError, RunFailed) as error:
                    came = False, str(error)
                yield CheckedClaim(lesson.file_stem, step.title, claim.line, text, *came)
            if step.question and answer_expressions(step.question, numbers):
                asked = step.question
                text = "one option is right" if asked.kind == CHOICE else \
                    f"{fill_numbers(asked.expected, numbers)} has a value"
                yield CheckedClaim(lesson.file_stem, step.title, asked.line, text,
                                   *_check_question(lesson, step, numbers, outcomes))


def _check_question(lesson: Lesson, step: Step, numbers: Numbers, outcomes: RunCache) -> tuple[bool, str]:
    """Returns whether a step's question has a right answer (a choice: exactly one), and what was found."""
    try:
        answer = right_answer(lesson, step, numbers, outcomes)
    except (ClaimError, RunFailed) as error:
        return False, str(error)
    if step.asked_question.kind == CHOICE:
        return len(answer.options) == 1, "right are " + (", ".join(map(str, answer.options)) or "none")
    return True, f"found {answer.value}"
