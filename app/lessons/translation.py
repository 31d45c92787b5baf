"""A lesson in another language: a file ``NAME.CODE.md`` beside ``NAME.md`` that has other words, and nothing else."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from app.lessons.lesson import Lesson, LessonError, Step
from app.lessons.reading import read

ALIKE = ("controls", "prerequisites", "variants")


def translated(original: Lesson, path: Path, language: str) -> Lesson:
    """The ``original`` in the words of a file. It keeps its name, its steps' keys and its fingerprint, so that what has
    been answered in one language is marked in any.

    Raises :class:`LessonError` where the file has a mistake, or differs in more than words.
    """
    own = read(path)
    for line, what in _differences(original, own):
        raise LessonError(line, f"{what} differ from {original.name}.md; give the same there, for a translation has "
                                "other words only", path.name)
    steps = (replace(step, key=other.key) for step, other in zip(own.steps, original.steps, strict=True))
    return replace(own, name=original.name, steps=tuple(steps), fingerprint=original.fingerprint, language=language)


def _differences(original: Lesson, own: Lesson) -> Iterator[tuple[int, str]]:
    """In which line of the translation what differs."""
    for name in ALIKE:
        if getattr(original, name) != getattr(own, name):
            yield 1, f"the {name} of the head"
    if len(own.goals) != len(original.goals):
        yield 1, "the numbers of goals"
    if [(step.kind, step.core) for step in own.steps] != [(step.kind, step.core) for step in original.steps]:
        yield own.steps[0].line, "the kinds of the steps, or which are core,"
        return
    for step, other in zip(own.steps, original.steps, strict=True):
        for name, mine, theirs in zip(("runs", "question", "claims"), _fixed(step), _fixed(other), strict=True):
            if mine != theirs:
                yield step.line, f"of this step the {name}"


def _fixed(step: Step) -> tuple[Any, Any, Any]:
    """What of a step is no words."""
    asked = step.question and replace(step.question, line=0, options=("",) * len(step.question.options))
    return ([replace(run, line=0) for run in step.runs], step.stage), asked, [claim.text for claim in step.claims]
