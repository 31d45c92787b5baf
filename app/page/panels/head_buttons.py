"""Buttons in the page's head: the presenter's view, for a talk on a projector (headline, stage and one plot, in letters
for the last row), and which problem moves."""

import json
from collections.abc import Callable
from html import escape
from typing import Any

import viser

from app.language.spoken import later, tr
from app.page.panels.browser_store import BrowserStore
from app.words import in_a_line
from solvers.problems import PROBLEMS
from solvers.scene.scene import Scene

_BUTTON, _ON = "<i class='lab-present'></i>", "<i class='lab-present lab-presenting'></i>"
PRESENT, END = later("Present"), later("End")


class Presenter:
    """A button that turns the view on and off; so do Escape and an address that ends in ``?present`` (``present.js``).
    The style (``70-present.css``) follows a mark in the page."""

    def __init__(self, gui: viser.GuiApi):
        self.on = False
        self._scene: Scene | None = None
        self._named = gui.add_html("")
        self._mark = gui.add_html(_BUTTON)
        self._button = gui.add_button(
            tr(PRESENT), hint=tr("for a projector: stage and one plot, large text; ? lists the keys"))
        self._button.on_click(lambda _: self._turn())

    def name(self, scene: Scene) -> None:
        """Say which scene it is that is seen."""
        if scene != self._scene:
            self._scene = scene
            self._named.content = f"<i class='lab-named' data-scene='{escape(in_a_line(scene))}'></i>"

    def begin(self) -> None:
        """Show the view, if it is not."""
        if not self.on:
            self._turn()

    def _turn(self) -> None:
        self.on = not self.on
        self._mark.content = _ON if self.on else _BUTTON
        self._button.label = tr(END if self.on else PRESENT)


TITLES = {problem: kind.scene.TITLE for problem, kind in PROBLEMS.items()}


class ProblemButtons:
    """One visitor's; in a narrow window the dropdown is there in their place. ``choose`` is called with the name of
    another problem."""

    def __init__(self, gui: viser.GuiApi, store: BrowserStore, choose: Callable[[str], None]):
        self._html, self._choose = gui.add_html(""), choose
        store.heard["problem"] = self._hear

    def show(self, chosen: str, offered: bool) -> None:
        """Mark the one that is chosen; a lesson may offer none."""
        titles = {problem: tr(title) for problem, title in TITLES.items() if offered}
        said = json.dumps({"titles": titles, "chosen": chosen})
        content = f"<i class='lab-problems' data-said='{escape(said)}'></i>"
        if content != self._html.content:
            self._html.content = content

    def _hear(self, said: Any) -> None:
        if isinstance(said, str) and said in TITLES:
            self._choose(said)
