"""What is right in each question of a lesson, found out beforehand for every variant: the player runs nothing."""

from collections.abc import Callable
from typing import Any

from app.lessons.claims import ClaimError, needed
from app.lessons.lesson import CHOICE, TEXT, Lesson, Numbers, Step, filled
from app.lessons.marks import expressions, right
from app.lessons.outcomes import Outcomes, RunFailed


def rules(lesson: Lesson, processes: int,
          on_progress: Callable[[float, str], None]) -> dict[str, list[dict[str, Any] | None]]:
    """What is right in each question with the numbers of each variant; None where it could not be found out."""
    outcomes, found = Outcomes(processes), dict[str, list[dict[str, Any] | None]]()
    try:
        outcomes.prepare(_needed(lesson), lambda done, total: on_progress(done / total, f"answer {done} of {total}"))
        for step in lesson.questions.values():
            found[step.key] = [_rule(lesson, step, numbers, outcomes) for numbers in lesson.variants]
    finally:
        outcomes.close()
    return found


def _needed(lesson: Lesson) -> list[str]:
    """The scenes of all runs that questions are about."""
    found = []
    for step in lesson.questions.values():
        asked = step.question
        assert asked is not None
        for numbers in lesson.variants:
            for expression in expressions(asked, numbers):
                names = needed(expression, lesson.runs, lesson.main_run(step)) - {""}
                found += [filled(text, numbers) for name in names for text in lesson.runs[name].texts]
    return found


def _rule(lesson: Lesson, step: Step, numbers: Numbers, outcomes: Outcomes) -> dict[str, Any] | None:
    """How the player marks an answer: ``options`` that are right, or the ``value`` and how far off one may be; and
    what came out, in words."""
    asked = step.question
    assert asked is not None
    if asked.kind == TEXT:
        return {"told": ""}
    try:
        found = right(lesson, step, numbers, outcomes)
    except (ClaimError, RunFailed):
        return None
    if asked.kind == CHOICE:
        return {"options": list(found.options), "told": found.told}
    return {"value": found.value, "tolerance": asked.tolerance, "told": found.told}
