"""Core and optional steps of a lesson: its duration, the marks of optional steps, and the navigation between steps."""

from collections.abc import Callable

import viser

from app.language.translation import lazy, tr
from app.lessons.lesson import Lesson
from app.lessons.student_progress import StudentProgress
from app.page.panels.page_header import BESIDE
from app.viewer.widget_validation import is_removed

ONLY = lazy("Core only")
SKIP = lazy("Core only: skip what is deeper")
GO_DEEPER = lazy("Go deeper")
MAIN = "<i class='lab-main'></i>"  # marks the main button
KEPT = lazy("Your answers stay in this browser.")
PACED = lazy("The board shows what the class has answered, without names; nothing of it is stored.")
BESIDE_MAIN = "<i class='lab-beside lab-main'></i>"
LINK = "<i class='lab-link'></i>"  # marks a secondary button
FIRST_PREDICT = lazy("You predict first: Next opens when your answer is recorded.")
WAITS = lazy("The next step is not open yet. Please wait until your lecturer opens it.")


def optional_step_mark() -> str:
    """Returns the html mark of a lesson's step outside its core."""
    return f"<span class='lab-kind lab-kind-deeper'>{tr('deeper')}</span>"


def duration_text(lesson: Lesson) -> str:
    """Returns the minutes that a lesson takes as text, the first words of its introduction."""
    if not lesson.optional_steps:
        return tr("{minutes} minutes. Afterwards you can", minutes=lesson.minutes)
    return tr("{core} minutes for the core, {minutes} in all. Afterwards you can", core=lesson.core_minutes,
              minutes=lesson.minutes)


def core_checkbox(gui: viser.GuiApi, lesson: Lesson, chosen: bool) -> viser.GuiCheckboxHandle:
    """Adds a checkbox to take only a lesson's core, checked if ``chosen``."""
    return gui.add_checkbox(tr(ONLY), chosen, hint=tr(
        "the core is self-contained and takes {minutes} minutes; you can go deeper at its end",
        minutes=lesson.core_minutes))


def progress_html(lesson: Lesson, progress: StudentProgress) -> str:
    """Returns the progress in a lesson as html: in words, and below as a row of segments."""
    steps = [(number, step) for number, step in enumerate(lesson.steps, 1) if step.core or not progress.core]
    at, total = sum(number <= progress.step for number, _ in steps), len(steps)
    name = tr("progress")
    if progress.step == 0 or progress.step > len(lesson.steps):
        said = tr("the end") if progress.step else tr("introduction")
    else:
        said = tr("step {at} of {total} of the core", at=at, total=total) if progress.core else \
            tr("step {at} of {total}", at=at, total=total)
    kinds = ((("lab-now" if number == progress.step else "lab-past" if number < progress.step else ""),
              "" if step.core else "lab-deep") for number, step in steps)
    segments = "".join(f"<i class='{' '.join(filter(None, kind))}'></i>" for kind in kinds)
    return f"<div>{said}</div><div class='lab-segments' role='progressbar' aria-label='{name}' aria-valuemin='0' " \
           f"aria-valuemax='{total}' aria-valuenow='{at}'>{segments}</div>"


def core_end_note(lesson: Lesson) -> str:
    """Returns the note at the end of a lesson's core, as html: how much is left."""
    minutes = max(1, lesson.minutes - lesson.core_minutes)
    told = tr("This was the core. The lesson has {steps} deeper steps, some {minutes} minutes.",
              steps=len(lesson.optional_steps), minutes=minutes)
    return f"<p>{told}</p>"


class StepNavigation:
    """The buttons Back, Next and Close.

    Parameters
    ----------
    gui
        The visitor's GUI.
    back
        Whether there is a step before.
    done
        Whether nothing is left to answer here, and there is a next step.
    main
        Whether Next is the main button, and not an answer.
    first
        Whether a prediction is required before Next.
    waits
        Returns whether the lecturer has not opened the next step yet.
    storage_note
        A sentence on where answers are stored.
    go, leave, skip
        Callbacks: to go so many steps on, to close the lesson, and to skip the optional steps.
    deeper
        Whether there is a button to skip them.
    """

    def __init__(self, gui: viser.GuiApi, back: bool, done: bool, main: bool, first: bool, waits: Callable[[], bool],
                 storage_note: str, go: Callable[[int], None], leave: Callable[[], None], skip: Callable[[], None],
                 deeper: bool):
        self._done, self._first, self._waits, self._saved_note = done, first, waits, storage_note
        gui.add_html(BESIDE)
        gui.add_button(tr("Back"), icon=viser.Icon.ARROW_LEFT, disabled=not back).on_click(lambda _: go(-1))
        gui.add_html(BESIDE_MAIN if main else BESIDE)
        self._following = gui.add_button(tr("Next"), icon=viser.Icon.CHEVRON_RIGHT, disabled=waits() or not done)
        self._following.on_click(lambda _: go(1))
        self._below = gui.add_html(self._note_html)
        if deeper:
            gui.add_html(LINK)
            gui.add_button(tr(SKIP)).on_click(lambda _: skip())
        gui.add_html(LINK)
        gui.add_button(tr("Close the lesson")).on_click(lambda _: leave())

    def mark_answered(self) -> None:
        """Enables Next, because the step's question has an answer."""
        self._done = True
        self.refresh()

    def refresh(self) -> None:
        """Updates Next and the note below, unless they were removed: a lecturer may have opened a step."""
        if not is_removed(self._following):
            self._following.disabled = self._waits() or not self._done
            self._below.content = self._note_html

    @property
    def _note_html(self) -> str:
        said = [tr(FIRST_PREDICT)] * (self._first and not self._done)
        said += [f"<b role='status'>{tr(WAITS)}</b>"] * self._waits()
        return f"<p class='lab-lesson lab-kept-here'>{' '.join([*said, self._saved_note])}</p>"
