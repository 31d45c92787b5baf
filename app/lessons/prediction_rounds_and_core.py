"""Rounds, from a prediction to its explanation, and the core of a lesson: the rounds that are self-contained.

The first step of a core round is marked, ``## Predict (core): ...``; others are optional, unless no round is marked."""

from collections.abc import Sequence
from dataclasses import replace

from app.lessons.claims import runs_needed
from app.lessons.lesson import EXPLAIN, Lesson, LessonError, Step, fill_numbers


def split_rounds(steps: Sequence[Step]) -> list[tuple[Step, ...]]:
    """Splits a lesson's steps into rounds, each of which ends with an explanation; the last may lack it."""
    found: list[tuple[Step, ...]] = [()]
    for step in steps:
        found[-1] += (step,)
        if step.kind == EXPLAIN:
            found.append(())
    return [one for one in found if one]


def mark_core_rounds(steps: Sequence[Step]) -> tuple[Step, ...]:
    """Returns a lesson's steps, of which ``core`` is set for the first of a round, with ``core`` set for whole rounds;
    for all if none is. Raises :class:`LessonError` if another step than a first is marked, or every round."""
    every = split_rounds(steps)
    for first, *others in every:
        if stray := next((step for step in others if step.core), None):
            raise LessonError(stray.line, f"(core) stands at the first step of a round, which is in line {first.line}")
    core = any(first.core for first, *_ in every)
    if core and all(first.core for first, *_ in every):
        raise LessonError(every[0][0].line, "every round is (core); where none is deeper mark none")
    return tuple(replace(step, core=first.core or not core) for first, *others in every for step in (first, *others))


def check_core_self_contained(lesson: Lesson) -> None:
    """Raises :class:`LessonError` if claims or questions of the core need a run of an optional step."""
    deeper = {run.name: step.line for step in lesson.optional_steps for run in step.runs}
    for step in lesson.steps_to_take(core=True):
        found = [(claim.text, claim.line) for claim in step.claims]
        if asked := step.question:
            found += [(text, asked.line) for text in (*asked.holds, asked.expected) if text]
        for text, line in found:
            uses = runs_needed(fill_numbers(text, lesson.variants[0]), lesson.runs, lesson.main_run(step))
            for name in sorted(uses & deeper.keys()):
                raise LessonError(line, f"the core needs the run {name} of the deeper step in line {deeper[name]}; "
                                        "move it into the core, or this out of it")
