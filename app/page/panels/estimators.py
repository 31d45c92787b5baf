"""Which estimators run, which of them the stage shows, and against what: a part of the control panel."""

from collections.abc import Callable

import viser

from app.frame.captions import DIFFERENCE, SIDE_BY_SIDE
from app.page.panels.bound import BoundWidgets
from app.page.panels.head import HALF_WIDE
from app.page.visit.session import Session
from solvers.problems import PROBLEMS
from solvers.scene.registry import ESTIMATORS

NONE = "none"


class EstimatorChoice:
    """Boxes for the estimators and two dropdowns for the stage. ``on_view`` is called when only the drawing changes."""

    def __init__(self, session: Session, on_view: Callable[[], None], bound: BoundWidgets):
        self._session, self._on_view, self._bound = session, on_view, bound
        self.drawn: str | None = None  # the estimator on the stage, if any
        self.difference = False

    @property
    def chosen(self) -> tuple[str, ...]:
        return tuple(name for name, box in self._boxes.items() if box.value)

    def build(self, gui: viser.GuiApi) -> None:
        wished = self._session.scene.estimators
        gui.add_html("<div class='lab-group'>Estimators, one or several</div>")
        self._boxes = {}
        for name in PROBLEMS[self._session.scene.problem].estimators:
            gui.add_html(HALF_WIDE)
            self._boxes[name] = gui.add_checkbox(ESTIMATORS[name].title, name in wished, hint=ESTIMATORS[name].summary)
        self.drawn = self.drawn if self.drawn in wished else next(iter(wished), None)
        self._shown = gui.add_dropdown("On the stage", wished or (NONE,), initial_value=self.drawn or NONE,
                                       hint="the estimator whose errors are drawn, of those that run")
        stage = gui.add_dropdown("Compare", (SIDE_BY_SIDE, DIFFERENCE),
                                 initial_value=DIFFERENCE if self.difference else SIDE_BY_SIDE,
                                 hint="estimate − truth is drawn as the size of what the estimate misses, direction "
                                      "and all; its norm over that of the truth is the distance")
        for box in self._boxes.values():
            self._bound.follow(box, lambda _: self._choose())
        self._shown.on_update(lambda _: self._draw(self._shown.value))
        stage.on_update(lambda e: self._compare(e.target.value == DIFFERENCE))

    def _choose(self) -> None:
        self._shown.options = self.chosen or (NONE,)  # a value that is not among them gives way to the first
        self._draw(self._shown.value)
        self._session.set(estimators=self.chosen)

    def _draw(self, name: str) -> None:
        self.drawn = None if name == NONE else name
        self._on_view()

    def _compare(self, difference: bool) -> None:
        self.difference = difference
        self._session.show(differences=difference)
        self._on_view()
