"""The core of a lesson on the page: what it takes, where one is in it, and what marks the steps that are deeper."""

from collections.abc import Callable

import viser

from app.language.spoken import later, tr
from app.lessons.lesson import Lesson, Step
from app.lessons.progress import Progress

ONLY = later("Core only")
SKIP = later("Core only: skip what is deeper")
GO_DEEPER = later("Go deeper")


def deeper() -> str:
    """The mark of a step that is no core."""
    word = tr("deeper")
    return f"<span class='lab-kind lab-kind-deeper'>{word}</span>"


def takes(lesson: Lesson) -> str:
    """How long the lesson takes, as its introduction begins."""
    if not lesson.deeper:
        return tr("{minutes} minutes. Afterwards you can", minutes=lesson.minutes)
    return tr("{core} minutes for the core, {minutes} in all. Afterwards you can", core=lesson.core_minutes,
              minutes=lesson.minutes)


def add_choice(gui: viser.GuiApi, lesson: Lesson, chosen: bool, change: Callable[[bool], None]) -> None:
    """A box to take the core alone."""
    hint = tr("the core stands by itself and takes {minutes} minutes; you can go deeper at its end",
              minutes=lesson.core_minutes)
    only = gui.add_checkbox(tr(ONLY), chosen, hint=hint)
    only.on_update(lambda _: change(only.value))


def where(lesson: Lesson, progress: Progress) -> str:
    """How far one has come, in words, and below them as a row of segments."""
    steps = [(number, step) for number, step in enumerate(lesson.steps, 1) if step.core or not progress.core]
    at, total = sum(number <= progress.step for number, _ in steps), len(steps)
    name = tr("progress")
    if progress.step == 0 or progress.step > len(lesson.steps):
        said = tr("the end") if progress.step else tr("introduction")
    else:
        said = tr("step {at} of {total} of the core", at=at, total=total) if progress.core else \
            tr("step {at} of {total}", at=at, total=total)
    segments = "".join(f"<i class='{_segment(number, step, progress.step)}'></i>" for number, step in steps)
    return f"<div>{said}</div><div class='lab-segments' role='progressbar' aria-label='{name}' aria-valuemin='0' " \
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
    told = tr("This was the core. The lesson has {steps} deeper steps, some {minutes} minutes.",
              steps=len(lesson.deeper), minutes=minutes)
    return f"<p>{told}</p>"


def _segment(number: int, step: Step, at: int) -> str:
    return " ".join(filter(None, ["lab-now" if number == at else "lab-past" if number < at else "",
                                  "" if step.core else "lab-deep"]))
