"""What is right in each question of a lesson, found out beforehand for every variant: the player runs nothing."""

from collections.abc import Callable
from typing import Any

from app.lessons.claims import ClaimError, needed, value
from app.lessons.lesson import CHOICE, INTERVAL, TEXT, Lesson, Step
from app.lessons.marks import mark
from app.lessons.outcomes import Outcomes, RunFailed
from app.lessons.variants import Numbers, filled


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
            for expression in filter(None, (*asked.holds, asked.expected)):
                names = needed(filled(expression, numbers), lesson.runs, lesson.main_run(step)) - {""}
                found += [filled(text, numbers) for name in names for text in lesson.runs[name].texts]
    return found


def _rule(lesson: Lesson, step: Step, numbers: Numbers, outcomes: Outcomes) -> dict[str, Any] | None:
    """How the player marks an answer: ``options`` that are right, or the ``value`` and how far off one may be; and
    what came out, in words."""
    asked = step.question
    assert asked is not None
    try:
        if asked.kind == TEXT:
            return {"told": ""}
        if asked.kind == CHOICE:
            marks = [mark(lesson, step, k, numbers, outcomes) for k in range(1, len(asked.options) + 1)]
            return {"options": [k for k, one in enumerate(marks, 1) if one.right], "told": marks[0].expected}
        expected = filled(asked.expected, numbers)
        right = value(expected, outcomes.scope(lesson, step, numbers, [expected]))
        dummy = (0.0, 0.0) if asked.kind == INTERVAL else 0.0
        return {"value": right, "tolerance": asked.tolerance,
                "told": mark(lesson, step, dummy, numbers, outcomes).expected}
    except (ClaimError, RunFailed):
        return None
