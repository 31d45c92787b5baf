"""The core of a lesson on the page: its duration, the marks of deeper steps, and the buttons from step to step."""

from collections.abc import Callable

import viser

from app.language.translation import lazy, tr
from app.lessons.lesson import Lesson
from app.lessons.student_progress import Progress
from app.page.panels.page_header import BESIDE
from app.viewer.widgets import is_removed

ONLY = lazy("Core only")
SKIP = lazy("Core only: skip what is deeper")
GO_DEEPER = lazy("Go deeper")
MAIN = "<i class='lab-main'></i>"  # the button that is meant
KEPT = lazy("Your answers stay in this browser.")
PACED = lazy("The board shows what the class has answered, without names; nothing of it is stored.")
BESIDE_MAIN = "<i class='lab-beside lab-main'></i>"
LINK = "<i class='lab-link'></i>"  # the button that is less than others
FIRST_PREDICT = lazy("You predict first: Next opens when your answer is recorded.")
WAITS = lazy("The next step is not open yet. Please wait until your lecturer opens it.")


def optional_step_mark() -> str:
    """The mark of a step that is no core."""
    return f"<span class='lab-kind lab-kind-deeper'>{tr('deeper')}</span>"


def duration_text(lesson: Lesson) -> str:
    """How long the lesson takes, as its introduction begins."""
    if not lesson.deeper:
        return tr("{minutes} minutes. Afterwards you can", minutes=lesson.minutes)
    return tr("{core} minutes for the core, {minutes} in all. Afterwards you can", core=lesson.core_minutes,
              minutes=lesson.minutes)


def core_checkbox(gui: viser.GuiApi, lesson: Lesson, chosen: bool) -> viser.GuiCheckboxHandle:
    """A box to take the core alone."""
    return gui.add_checkbox(tr(ONLY), chosen, hint=tr(
        "the core is self-contained and takes {minutes} minutes; you can go deeper at its end",
        minutes=lesson.core_minutes))


def progress_html(lesson: Lesson, progress: Progress) -> str:
    """How far one has come, in words, and below them as a row of segments."""
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
    """Said at the end of the core."""
    minutes = max(1, lesson.minutes - lesson.core_minutes)
    told = tr("This was the core. The lesson has {steps} deeper steps, some {minutes} minutes.",
              steps=len(lesson.deeper), minutes=minutes)
    return f"<p>{told}</p>"


class StepNavigation:
    """Back, Next and Close, made where the gui stands.

    Parameters
    ----------
    gui
        Of the visitor.
    back
        Whether there is a step before.
    done
        Whether nothing is asked here, or it is answered, and there is a step to go on to.
    main
        Whether Next is what is meant to be pressed, and not an answer to be given.
    first
        Whether a prediction is asked for, without which Next stays shut.
    waits
        Tells whether the next step is still to be opened to all.
    kept
        A sentence: what becomes of answers.
    go, leave, skip
        Are called to go so many steps on, to close the lesson, and to skip what is deeper.
    deeper
        Whether there is a button for that.
    """

    def __init__(self, gui: viser.GuiApi, back: bool, done: bool, main: bool, first: bool, waits: Callable[[], bool],
                 kept: str, go: Callable[[int], None], leave: Callable[[], None], skip: Callable[[], None],
                 deeper: bool):
        self._done, self._first, self._waits, self._kept = done, first, waits, kept
        gui.add_html(BESIDE)
        gui.add_button(tr("Back"), icon=viser.Icon.ARROW_LEFT, disabled=not back).on_click(lambda _: go(-1))
        gui.add_html(BESIDE_MAIN if main else BESIDE)
        self._following = gui.add_button(tr("Next"), icon=viser.Icon.CHEVRON_RIGHT, disabled=waits() or not done)
        self._following.on_click(lambda _: go(1))
        self._below = gui.add_html(self._said)
        if deeper:
            gui.add_html(LINK)
            gui.add_button(tr(SKIP)).on_click(lambda _: skip())
        gui.add_html(LINK)
        gui.add_button(tr("Close the lesson")).on_click(lambda _: leave())

    def answered(self) -> None:
        """What is asked here is."""
        self._done = True
        self.refresh()

    def refresh(self) -> None:
        """A step may have been opened to all, or the visitor may have gone on meanwhile."""
        if not is_removed(self._following):
            self._following.disabled = self._waits() or not self._done
            self._below.content = self._said

    @property
    def _said(self) -> str:
        said = [tr(FIRST_PREDICT)] * (self._first and not self._done)
        said += [f"<b role='status'>{tr(WAITS)}</b>"] * self._waits()
        return f"<p class='lab-lesson lab-kept-here'>{' '.join([*said, self._kept])}</p>"
