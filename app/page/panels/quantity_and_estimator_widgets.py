"""What the stage shows: quantity, estimator and magnification. These widgets are built once, before the tabs, and laid
onto the stage (``css/10-shell.css``). And the estimators' cards, with switch, line, how much of the error each finds,
and its price."""

from collections.abc import Callable
from html import escape
from typing import Any

import numpy as np
import viser

from app import names_and_units
from app.frame.colour_scale import ColourScale
from app.language.translation import lazy, tr
from app.page.panels.browser_store_and_window import BrowserStore
from app.page.panels.readout_tables import line_sample
from app.page.panels.scene_widgets import SceneWidgetFactory
from app.page.visit.run_session import RunSession
from app.problems.views import VIEWS
from solvers.engine.shared_frames import FrameArrays
from solvers.problems import PROBLEMS
from solvers.scene.estimator_registry import ESTIMATORS
from solvers.scene.scene import Scene
from solvers.solver import samples

NONE = lazy("none")
_FACTORS = {f"× {factor}": factor for factor in names_and_units.MAGNIFICATIONS}
_NAMES = {factor: name for name, factor in _FACTORS.items()}


class QuantityAndEstimatorWidgets:
    """One visitor's widgets for quantity, estimator and magnification on the stage; ``on_view`` redraws the stage."""

    def __init__(self, gui: viser.GuiApi, session: RunSession, scale: ColourScale, on_view: Callable[[], None]):
        self._session, self._scale, self._on_view = session, scale, on_view
        self._quantities = {str(quantity): key for key, quantity in names_and_units.QUANTITIES.items()}
        self.quantity = next(iter(names_and_units.QUANTITIES))  # key of the one whose error is shown
        self.estimator = session.scene.first_estimator  # the one on the stage, if any
        self.magnified = 1
        self._by_problem: dict[str, str] = {}  # by problem, the estimator last chosen for the stage
        self._silent = False  # whether an estimator without values may be replaced: it was not chosen by name
        quantity_mark = gui.add_html("<i class='lab-at-quantity'></i>")
        self._quantity = gui.add_dropdown(
            tr("Error of"), tuple(self._quantities), initial_value=self._shown_quantity,
            hint=tr("the quantity whose error gives the colours, and whose field is plotted"))
        estimator_mark = gui.add_html("<i class='lab-at-estimator'></i>")
        self._estimator = gui.add_dropdown(
            tr("On the stage"), session.scene.estimators or (tr(NONE),), initial_value=self.estimator or tr(NONE),
            hint=tr("the estimator whose errors are drawn, of those that run"))
        # Removed with its widget; it would otherwise mark the next one.
        self.parts: dict[str, tuple[Any, ...]] = {
            "quantity": (quantity_mark, self._quantity), "estimators": (estimator_mark, self._estimator)}
        self._quantity.on_update(
            lambda event: self.show_quantity(self._quantities[event.target.value]) if event.client else None)
        self._estimator.on_update(lambda event: self.show_estimator(
            None if event.target.value == tr(NONE) else event.target.value) if event.client else None)

    def build_magnification(self, gui: viser.GuiApi) -> None:
        """Builds the widget for the magnification, which is made anew for another scene."""
        self._magnify = gui.add_dropdown(
            tr("Magnify error"), tuple(_FACTORS), initial_value=_NAMES[self.magnified],
            hint=tr("in the plot of the field: how many times the deviation of the particles from the exact curve is "
                    "drawn"), visible=self._session.scene.DIMENSIONS == 1)
        self._magnify.on_update(lambda event: self._choose_magnification() if event.client else None)

    def show(self, quantity: str, estimator: str | None, magnified: int) -> None:
        """Sets quantity ("x"), estimator and magnification (factor) to show; the widgets of the last two follow by
        :meth:`set_estimators` and :meth:`build_magnification`."""
        self.quantity, self.estimator, self.magnified = quantity, estimator, magnified
        self._quantity.value = self._shown_quantity  # type: ignore[misc]

    def restore_last_estimator(self, problem: str) -> None:
        """Sets the estimator to that last shown for a problem ("bar") that is put on the stage."""
        self.estimator, self._silent = self._by_problem.get(problem), True

    def ensure_estimator_has_values(self, scene: Scene, arrays: FrameArrays) -> None:
        """Replaces an estimator on the stage that has no values of a newly chosen quantity by one that has some."""
        if not self._silent or scene != self._session.scene:
            return
        self._silent, column = False, samples.QUANTITIES.index(self.quantity)
        says = [name for name, values in arrays.estimate.items() if np.isfinite(values[:, column]).any()]
        if says and self.estimator in arrays.estimate and self.estimator not in says:
            self.estimator = self._estimator.value = says[0]  # type: ignore[misc]
            self._on_view()

    def set_estimators(self, estimators: tuple[str, ...]) -> None:
        """Sets the names of the estimators that run; one of them is on the stage, redrawn if it has changed."""
        before = self.estimator
        if before not in estimators:
            first = self._session.scene.first_estimator
            self.estimator = first if first in estimators else next(iter(estimators), None)
        options, shown = estimators or (tr(NONE),), self.estimator or tr(NONE)
        if self._estimator.options != options:
            self._estimator.options = options
        self._estimator.value = shown  # type: ignore[misc]
        if self.estimator != before:
            self._on_view()

    def show_estimator(self, estimator: str | None) -> None:
        """Puts an estimator that runs on the stage, or none, and redraws."""
        self.estimator, self._silent = estimator, False
        self._estimator.value = estimator or tr(NONE)  # type: ignore[misc]
        if estimator:
            self._by_problem[self._session.scene.problem] = estimator
        self._on_view()

    def next_estimator(self) -> None:
        """Puts the next of the running estimators on the stage."""
        running = [name for name in self._estimator.options if name != tr(NONE)]
        if running:
            at = running.index(self.estimator) if self.estimator in running else -1
            self.show_estimator(running[(at + 1) % len(running)])

    def next_magnification(self) -> None:
        """Draws deviations in the field plot magnified by the next of the factors offered."""
        factors = names_and_units.MAGNIFICATIONS
        self.magnified = factors[(factors.index(self.magnified) + 1) % len(factors)]
        self._magnify.value = _NAMES[self.magnified]  # type: ignore[misc]
        self._on_view()

    def show_quantity(self, quantity: str) -> None:
        """Shows the error of a quantity (key x, v, sigma or a) on the stage and requests frames with that field."""
        self.quantity, self._silent = quantity, True
        self._quantity.value = self._shown_quantity  # type: ignore[misc]
        self._session.set_frame_options(plotted=quantity)
        self._scale.reset()
        self._on_view()

    @property
    def _shown_quantity(self) -> str:
        return str(names_and_units.QUANTITIES[self.quantity])

    def _choose_magnification(self) -> None:
        self.magnified = _FACTORS[self._magnify.value]
        self._on_view()


#: Short descriptions of estimators that fit on a card; others show their summary.
IDEAS = {"recovered": lazy("smooths the particles' motion"), "transport": lazy("the method's own equations"),
         "companion": lazy("a hidden, finer solve beside it"), "two-grid": lazy("the same run on wider cells")}
FINDS = lazy("now: the estimated error in per cent of the true one; price: the running time that it adds to the usual "
             "scene")


class EstimatorCards:
    """One visitor's cards of estimators, with a checkbox that runs each; a click on a card puts it on the ``stage``."""

    def __init__(self, gui: viser.GuiApi, session: RunSession, stage: QuantityAndEstimatorWidgets,
                 bound: SceneWidgetFactory, store: BrowserStore):
        self._session, self._stage, self._bound = session, stage, bound
        self._boxes: dict[str, viser.GuiCheckboxHandle] = {}
        self._html = gui.add_html("")
        store.heard["judge"] = self._show_estimator_on_stage

    @property
    def chosen_names(self) -> tuple[str, ...]:
        """Names of the estimators whose checkboxes are set, in the problem's order."""
        offered = PROBLEMS[self._session.scene.problem].estimators
        return tuple(name for name in offered if name in self._boxes and self._boxes[name].value)

    def build(self, gui: viser.GuiApi) -> None:
        """Builds a card for each estimator of the session's problem."""
        wished, problem = self._session.scene.estimators, self._session.scene.problem
        gui.add_html(f"<h2 class='lab-h2'>{tr('Who judges the run?')}<small title='{escape(tr(FINDS))}'>"
                     f"{tr('finds, now · price')}</small></h2>")
        self._boxes = {}
        usual = PROBLEMS[problem].scene().estimators
        for name in (*usual, *(name for name in PROBLEMS[problem].estimators if name not in usual)):
            gui.add_html("<i class='lab-switch'></i>")
            self._boxes[name] = gui.add_checkbox(ESTIMATORS[name].title, name in wished)
            gui.add_html(_estimator_card_html(name, problem))
        gui.add_html(f"<button type='button' class='lab-ask' aria-expanded='false' hidden>{tr('Ask another judge')}: "
                     "<span></span></button>")
        for box in self._boxes.values():
            self._bound.on_change_or_reset(box, lambda _: self._run_chosen_estimators())
        self._stage.set_estimators(wished)

    def fill_cards(self, cards_json: str) -> None:
        """Sends the numbers on the cards, :func:`app.page.panels.readout_tables.estimator_cards_json`; "" clears
        them."""
        self._html.content = f"<i class='lab-judged' data-said='{escape(cards_json)}'></i>"

    def _run_chosen_estimators(self) -> None:
        self._session.set_scene_fields(estimators=self.chosen_names)
        self._stage.set_estimators(self.chosen_names)

    def _show_estimator_on_stage(self, name: Any) -> None:
        """Puts an estimator, by the name that the browser sends, on the stage; runs it if it does not run yet."""
        with self._bound.turn:
            if not isinstance(name, str) or (box := self._boxes.get(name)) is None or not box.visible:
                return
            if not box.value:
                box.value = True  # type: ignore[misc]
                self._session.set_scene_fields(estimators=self.chosen_names)
                self._stage.set_estimators(self.chosen_names)
            self._stage.show_estimator(name)


def _estimator_card_html(name: str, problem: str) -> str:
    """Returns an estimator's card, whose numbers the browser fills in; the price is its added run time in per cent."""
    estimator, price = ESTIMATORS[name], VIEWS[problem].prices.get(name)
    cost = "" if price is None else f"+{100 * price / (1 - price):.0f}\N{NO-BREAK SPACE}%"
    idea, stage = tr(IDEAS.get(name, estimator.summary)), tr("put it on the stage: {summary}",
                                                             summary=tr(estimator.summary))
    return (f"<div class='lab-judge lab-off' data-judge='{escape(name)}' data-problem='{escape(problem)}' "
            f"data-idea='{escape(idea)}' title='{escape(stage)}'><b>{line_sample(name)} {escape(estimator.title)} "
            f"<span class='lab-tag'>{tr('on the stage')}</span></b>"
            f"<p class='lab-finds'><strong></strong> <span>{cost}</span></p><p class='lab-trust'></p></div>")
