"""A file whose particles are not those of the problem on the stage: its owner is asked which problem they are of."""

from collections.abc import Callable
from html import escape

import viser

from app.words import on_page
from solvers.problems import PROBLEMS

FIRST = -1e9  # in the order of what stands in the panel
ASKED, NEITHER = "Which problem is your file of?", "None of these"


def sentence(name: str, reason: str, problems: tuple[str, ...]) -> str:
    """What is asked: why the file is not judged yet, and of what it could be."""
    titles = " or the ".join(PROBLEMS[problem].scene.TITLE for problem in problems)
    return f"The file {name} {on_page(reason)}. Is it of the {titles}?"


class Question:
    """Buttons with the problems that a file fits; ``on_choice`` is called with the one that is meant, or with None."""

    def __init__(self, gui: viser.GuiApi, on_choice: Callable[[str | None], None]):
        self._folder = gui.add_folder(ASKED, order=FIRST, visible=False)
        with self._folder:
            self._text = gui.add_html("")
            self._buttons = {problem: gui.add_button(_label(problem), hint="judge the file as a run of this problem")
                             for problem in PROBLEMS}
            neither = gui.add_button(NEITHER, hint="leave the file aside")
        for problem, button in self._buttons.items():
            button.on_click(lambda _, problem=problem: on_choice(problem))  # type: ignore[misc]
        neither.on_click(lambda _: on_choice(None))

    @property
    def asked(self) -> bool:
        return self._folder.visible

    def ask(self, sentence: str, problems: tuple[str, ...]) -> None:
        self._text.content = f"<div class='lab-own' role='status'><p>{escape(sentence)}</p></div>"
        for problem, button in self._buttons.items():
            button.visible = problem in problems
        self._folder.visible = True

    def end(self) -> None:
        self._folder.visible = False


def _label(problem: str) -> str:
    title = PROBLEMS[problem].scene.TITLE
    return f"It is the {title}"
