"""A file whose particles are not those of the problem on the stage: its owner is asked which problem they are of."""

import functools
from collections.abc import Callable
from html import escape

import viser

from app.language.spoken import later, tr
from app.words import on_page
from solvers.problems import PROBLEMS

FIRST = -1e9  # in the order of what stands in the panel
ASKED, NEITHER = later("Which problem is your file of?"), later("None of these")


def sentence(name: str, reason: str, problems: tuple[str, ...]) -> str:
    """What is asked: why the file is not judged yet, and of what it could be."""
    titles = functools.reduce(lambda before, last: tr("{before} or the {last}", before=before, last=last),
                              (tr(PROBLEMS[problem].scene.TITLE) for problem in problems))
    return tr("The file {file} {reason}. Is it of the {problems}?", file=name, reason=on_page(reason), problems=titles)


class Question:
    """Buttons with the problems that a file fits; ``on_choice`` is called with the one that is meant, or with None."""

    def __init__(self, gui: viser.GuiApi, on_choice: Callable[[str | None], None]):
        self._folder = gui.add_folder(tr(ASKED), order=FIRST, visible=False)
        with self._folder:
            self._text = gui.add_html("")
            hint = tr("judge the file as a run of this problem")
            self._buttons = {problem: gui.add_button(_label(problem), hint=hint) for problem in PROBLEMS}
            neither = gui.add_button(tr(NEITHER), hint=tr("leave the file aside"))
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
    return tr("It is the {problem}", problem=tr(PROBLEMS[problem].scene.TITLE))
