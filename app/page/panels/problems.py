"""Which problem moves, as buttons in the page's head; in a narrow window the dropdown is there in their place."""

import json
from collections.abc import Callable
from html import escape
from typing import Any

import viser

from app.language.spoken import tr
from app.page.panels.browser_store import BrowserStore
from solvers.problems import PROBLEMS

TITLES = {problem: kind.scene.TITLE for problem, kind in PROBLEMS.items()}


class ProblemButtons:
    """One visitor's. ``choose`` is called with the name of another problem."""

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
