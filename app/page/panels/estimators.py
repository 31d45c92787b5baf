"""Who judges the run: a card for each estimator, with a switch, its line, its idea, its error index and its price."""

from html import escape
from typing import Any

import viser

from app.frame.captions import TRUE
from app.language.spoken import later, tr
from app.page.panels.bound import BoundWidgets
from app.page.panels.browser_store import BrowserStore
from app.page.panels.readout import sample
from app.page.panels.stage_choice import StageChoice
from app.page.visit.session import Session
from app.problems.views import VIEWS
from solvers.problems import PROBLEMS
from solvers.scene.registry import ESTIMATORS

#: What an estimator does, in the few words that a card has room for; others say their summary.
IDEAS = {"recovered": later("smooths the particles' motion"), "transport": later("the method's own equations"),
         "companion": later("a hidden, finer solve beside it"), "two-grid": later("the same run on wider cells")}
INDEX = later("error index: estimated over true, summed over the run so far; price: the running time that it adds to "
              "the usual scene")


class Judges:
    """Widgets of one visitor. One of the estimators that run is on the ``stage``; a click on a card's name puts it
    there (``js/judges.js``)."""

    def __init__(self, gui: viser.GuiApi, session: Session, stage: StageChoice, bound: BoundWidgets,
                 store: BrowserStore):
        self._session, self._stage, self._bound = session, stage, bound
        self._boxes: dict[str, viser.GuiCheckboxHandle] = {}
        self._said = gui.add_html("")
        store.heard["judge"] = self._put

    @property
    def chosen(self) -> tuple[str, ...]:
        offered = PROBLEMS[self._session.scene.problem].estimators
        return tuple(name for name in offered if name in self._boxes and self._boxes[name].value)

    def build(self, gui: viser.GuiApi) -> None:
        """Make the widgets, for the session's present scene."""
        wished, problem = self._session.scene.estimators, self._session.scene.problem
        gui.add_html(f"<h2 class='lab-h2'>{tr('Who judges the run?')}<small title='{escape(tr(INDEX))}'>"
                     f"{tr('index, 1 is perfect · price')}</small></h2><div class='lab-judge-true'>{sample(TRUE)} "
                     f"<b>{tr(TRUE)}</b> <span>{tr('norm now')}</span> <strong></strong></div>")
        self._boxes = {}
        usual = VIEWS[problem].estimators
        for name in (*usual, *(name for name in PROBLEMS[problem].estimators if name not in usual)):
            gui.add_html("<i class='lab-switch'></i>")
            self._boxes[name] = gui.add_checkbox(ESTIMATORS[name].title, name in wished)
            gui.add_html(_card(name, problem))
        for box in self._boxes.values():
            self._bound.follow(box, lambda _: self._choose())
        self._stage.judge_by(wished)

    def show(self, judged: str) -> None:
        """Have the cards say what :func:`app.page.panels.readout.judged` does; nothing if it is empty."""
        self._said.content = f"<i class='lab-judged' data-said='{escape(judged)}'></i>"

    def _choose(self) -> None:
        self._stage.judge_by(self.chosen)
        self._session.set(estimators=self.chosen)

    def _put(self, name: Any) -> None:
        """The visitor wants to see the errors by an estimator."""
        with self._bound.turn:
            if not isinstance(name, str) or (box := self._boxes.get(name)) is None or not box.visible:
                return
            if not box.value:
                box.value = True  # type: ignore[misc]
                self._session.set(estimators=self.chosen)
                self._stage.judge_by(self.chosen)
            self._stage.put(name)


def _card(name: str, problem: str) -> str:
    """A card, which the browser fills from runs of the problem. The price is what an estimator adds to the rest."""
    estimator, price = ESTIMATORS[name], VIEWS[problem].prices.get(name)
    cost = "" if price is None else f"+{100 * price / (1 - price):.0f}\N{NO-BREAK SPACE}%"
    idea, stage = escape(tr(IDEAS.get(name, estimator.summary))), tr("put it on the stage: {summary}",
                                                                     summary=tr(estimator.summary))
    return (f"<div class='lab-judge lab-off' data-judge='{escape(name)}' data-problem='{escape(problem)}'>"
            f"<button type='button' class='lab-judge-name' title='{escape(stage)}'>"
            f"{sample(name)} {escape(estimator.title)}</button><span class='lab-tag'>{tr('on the stage')}</span>"
            f"<p class='lab-idea'>{idea}</p><p class='lab-index'><strong></strong> <span>{cost}</span></p>"
            "<i class='lab-gauge' aria-hidden='true'><b></b></i><p class='lab-trust'></p><p class='lab-why'></p></div>")
