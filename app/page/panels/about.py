"""The About tab: what the page shows, in the words of someone who sees it for the first time."""

from __future__ import annotations

from pathlib import Path

import viser

from app.problems.views import VIEWS
from solvers.estimators.registry import ESTIMATORS

TEXTS = Path(__file__).parents[1]


def add_about(gui: viser.GuiApi) -> None:
    """Fill the tab: the page, each estimator behind its name, and something to try."""
    views = VIEWS.values()
    gui.add_html(_text("about.html").format(problems="".join(view.about for view in views),
                                            divisions=", ".join(view.division for view in views)))
    for estimator in ESTIMATORS.values():
        with gui.add_folder(f"The estimator {estimator.title}", expand_by_default=False):
            gui.add_html(f"<div class='lab-about lab-explanation'>{estimator.explanation}</div>")
    gui.add_html(_text("try.html"))


def _text(name: str) -> str:
    return (TEXTS / name).read_text(encoding="utf-8")
