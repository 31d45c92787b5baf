"""Which estimators run: a part of the control panel."""

import viser

from app.page.panels.bound import BoundWidgets
from app.page.panels.head import HALF_WIDE
from app.page.panels.stage_choice import StageChoice
from app.page.visit.session import Session
from solvers.problems import PROBLEMS
from solvers.scene.registry import ESTIMATORS


class Judges:
    """Boxes for the estimators. One of those that run is on the ``stage``."""

    def __init__(self, session: Session, stage: StageChoice, bound: BoundWidgets):
        self._session, self._stage, self._bound = session, stage, bound

    @property
    def chosen(self) -> tuple[str, ...]:
        return tuple(name for name, box in self._boxes.items() if box.value)

    def build(self, gui: viser.GuiApi) -> None:
        """Make the widgets, for the session's present scene."""
        wished = self._session.scene.estimators
        gui.add_html("<div class='lab-group'>Estimators, one or several</div>")
        self._boxes = {}
        for name in PROBLEMS[self._session.scene.problem].estimators:
            gui.add_html(HALF_WIDE)
            self._boxes[name] = gui.add_checkbox(ESTIMATORS[name].title, name in wished, hint=ESTIMATORS[name].summary)
        for box in self._boxes.values():
            self._bound.follow(box, lambda _: self._choose())
        self._stage.judge_by(wished)

    def _choose(self) -> None:
        self._stage.judge_by(self.chosen)
        self._session.set(estimators=self.chosen)
