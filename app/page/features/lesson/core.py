"""The core of a lesson on the page: what it takes, where one is in it, and what marks the steps that are deeper."""

from collections.abc import Callable

import viser

from app.lessons.lesson import Lesson, Step
from app.lessons.progress import Progress

ONLY = "Core only"
SKIP = "Core only: skip what is deeper"
GO_DEEPER = "Go deeper"
DEEPER = "<span class='lab-kind lab-kind-deeper'>deeper</span>"


def takes(lesson: Lesson) -> str:
    """How long the lesson takes, as its introduction begins."""
    if not lesson.deeper:
        return f"{lesson.minutes} minutes. Afterwards you can"
    return f"{lesson.core_minutes} minutes for the core, {lesson.minutes} in all. Afterwards you can"


def add_choice(gui: viser.GuiApi, lesson: Lesson, chosen: bool, change: Callable[[bool], None]) -> None:
    """A box to take the core alone."""
    hint = f"the core stands by itself and takes {lesson.core_minutes} minutes; you can go deeper at its end"
    only = gui.add_checkbox(ONLY, chosen, hint=hint)
    only.on_update(lambda _: change(only.value))


def where(lesson: Lesson, progress: Progress) -> str:
    """How far one has come, in words, and below them as a row of segments."""
    steps = [(number, step) for number, step in enumerate(lesson.steps, 1) if step.core or not progress.core]
    at, total = sum(number <= progress.step for number, _ in steps), len(steps)
    said = "introduction" if progress.step == 0 else "the end" if progress.step > len(lesson.steps) else \
        ("step {at} of {total} of the core" if progress.core else "step {at} of {total}").format(at=at, total=total)
    segments = "".join(f"<i class='{_segment(number, step, progress.step)}'></i>" for number, step in steps)
    return f"<div>{said}</div><div class='lab-segments' role='progressbar' aria-label='progress' aria-valuemin='0' " \
           f"aria-valuemax='{total}' aria-valuenow='{at}'>{segments}</div>"


def numbers(lesson: Lesson) -> str:
    """Of the core's steps, for the list, which the browser fills."""
    return " ".join(str(number) for number, step in enumerate(lesson.steps, 1) if step.core)


def deeper_from(lesson: Lesson) -> int:
    """The number of the first step that is deeper."""
    return lesson.steps.index(lesson.deeper[0]) + 1


def left(lesson: Lesson) -> str:
    """Said at the end of the core."""
    minutes = max(1, lesson.minutes - lesson.core_minutes)
    return f"<p>This was the core. The lesson has {len(lesson.deeper)} deeper steps, some {minutes} minutes.</p>"


def _segment(number: int, step: Step, at: int) -> str:
    return " ".join(filter(None, ["lab-now" if number == at else "lab-past" if number < at else "",
                                  "" if step.core else "lab-deep"]))
