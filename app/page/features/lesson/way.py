"""The way through a lesson: the buttons below a step, and why the one for the next is not free yet."""

from collections.abc import Callable

import viser

from app.page.features.lesson import core
from app.page.panels.head import BESIDE
from app.viewer.widgets import is_removed

BESIDE_MAIN = "<i class='lab-beside lab-main'></i>"
LINK = "<i class='lab-link'></i>"  # the button that is less than others
FIRST_PREDICT = "You predict first: Next opens when your answer is recorded."
WAITS = "The next step is not open yet. Your lecturer opens it for all; you need not do anything."


class Way:
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
        gui.add_button("Back", icon=viser.Icon.ARROW_LEFT, disabled=not back).on_click(lambda _: go(-1))
        gui.add_html(BESIDE_MAIN if main else BESIDE)
        self._following = gui.add_button("Next", icon=viser.Icon.CHEVRON_RIGHT, disabled=waits() or not done)
        self._following.on_click(lambda _: go(1))
        self._below = gui.add_html(self._said)
        if deeper:
            gui.add_html(LINK)
            gui.add_button(core.SKIP).on_click(lambda _: skip())
        gui.add_html(LINK)
        gui.add_button("Close the lesson").on_click(lambda _: leave())

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
        said = [FIRST_PREDICT] * (self._first and not self._done) + [f"<b role='status'>{WAITS}</b>"] * self._waits()
        return f"<p class='lab-lesson lab-kept-here'>{' '.join([*said, self._kept])}</p>"
