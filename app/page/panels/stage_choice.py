"""What the stage shows: the error of which quantity, by which estimator, how many times magnified. The three are laid
onto the stage, beside what they change (``css/10-shell.css``), whatever tab is open: they are made once, before the
tabs."""

from collections.abc import Callable
from typing import Any

import numpy as np
import viser

from app import words
from app.frame.scale import ColourScale
from app.language.spoken import later, tr
from app.page.visit.session import Session
from solvers.engine.frames import FrameArrays
from solvers.scene.scene import Scene
from solvers.solver import samples

NONE = later("none")
_FACTORS = {f"× {factor}": factor for factor in words.MAGNIFICATIONS}
_NAMES = {factor: name for name, factor in _FACTORS.items()}


class StageChoice:
    """Widgets of one visitor. ``on_view`` is called when only the drawing changes."""

    def __init__(self, gui: viser.GuiApi, session: Session, scale: ColourScale, on_view: Callable[[], None]):
        self._session, self._scale, self._on_view = session, scale, on_view
        self._quantities = {str(quantity): key for key, quantity in words.QUANTITIES.items()}
        self.quantity = next(iter(words.QUANTITIES))  # key of the one whose error is shown
        self.estimator = next(iter(session.scene.estimators), None)  # the one on the stage, if any
        self.magnified = 1
        self._kept: dict[str, str] = {}  # by problem, the estimator that was put on the stage there
        self._silent = False  # whether an estimator that says nothing may give way: nobody has asked for it by name
        quantity_mark = gui.add_html("<i class='lab-at-quantity'></i>")
        self._quantity = gui.add_dropdown(
            tr("Error of"), tuple(self._quantities), initial_value=self._shown_quantity,
            hint=tr("the quantity whose error gives the colours, and whose field is plotted"))
        estimator_mark = gui.add_html("<i class='lab-at-estimator'></i>")
        self._estimator = gui.add_dropdown(
            tr("On the stage"), session.scene.estimators or (tr(NONE),), initial_value=self.estimator or tr(NONE),
            hint=tr("the estimator whose errors are drawn, of those that run"))
        magnify_mark = gui.add_html("<i class='lab-at-magnify'></i>")
        self._magnify = gui.add_dropdown(
            tr("Magnify error"), tuple(_FACTORS), initial_value=_NAMES[1],
            hint=tr("in the plot of the field: how many times the deviation of the particles from the exact curve is "
                    "drawn"))
        # A mark that stayed where its widget has gone would mark what comes next.
        self._parts: dict[str, tuple[Any, Any]] = {
            "quantity": (quantity_mark, self._quantity), "estimators": (estimator_mark, self._estimator),
            "magnify": (magnify_mark, self._magnify)}
        self._quantity.on_update(
            lambda event: self.measure(self._quantities[event.target.value]) if event.client else None)
        self._estimator.on_update(lambda event: self._choose_estimator() if event.client else None)
        self._magnify.on_update(lambda event: self._choose_factor() if event.client else None)

    def offer(self, controls: tuple[str, ...]) -> None:
        """Show what is among these controls, or all where there are none."""
        for control, parts in self._parts.items():
            for part in parts:
                part.visible = not controls or control in controls

    def show(self, quantity: str, estimator: str | None, magnified: int) -> None:
        """Show these; the estimator as far as it runs, see :meth:`judge_by`."""
        self.quantity, self.estimator, self.magnified = quantity, estimator, magnified
        for widget, shown in ((self._quantity, self._shown_quantity), (self._magnify, _NAMES[magnified])):
            widget.value = shown  # type: ignore[misc]

    def go_to(self, problem: str) -> None:
        """Another problem is to be on the stage: as it was left."""
        self.estimator, self._silent = self._kept.get(problem), True

    def hear(self, scene: Scene, arrays: FrameArrays) -> None:
        """A frame has come: an estimator that says nothing of a quantity chosen since gives way to one that does."""
        if not self._silent or scene != self._session.scene:
            return
        self._silent, column = False, samples.QUANTITIES.index(self.quantity)
        says = [name for name, values in arrays.estimate.items() if np.isfinite(values[:, column]).any()]
        if says and self.estimator in arrays.estimate and self.estimator not in says:
            self.estimator = self._estimator.value = says[0]  # type: ignore[misc]
            self._on_view()

    def judge_by(self, estimators: tuple[str, ...]) -> None:
        """These run: one of them is on the stage."""
        before = self.estimator
        if before not in estimators:
            self.estimator = next(iter(estimators), None)
        options, shown = estimators or (tr(NONE),), self.estimator or tr(NONE)
        if self._estimator.options != options:
            self._estimator.options = options
        self._estimator.value = shown  # type: ignore[misc]
        if self.estimator != before:
            self._on_view()

    def put(self, estimator: str) -> None:
        """Put an estimator that runs on the stage."""
        self.estimator = self._estimator.value = estimator  # type: ignore[misc]
        self._keep()
        self._on_view()

    def next_judge(self) -> None:
        """Put the estimator on the stage that runs next to the one that is there."""
        running = [name for name in self._estimator.options if name != tr(NONE)]
        if running:
            at = running.index(self.estimator) if self.estimator in running else -1
            self.put(running[(at + 1) % len(running)])

    def next_factor(self) -> None:
        """Magnify as much as comes next."""
        factors = words.MAGNIFICATIONS
        self.magnified = factors[(factors.index(self.magnified) + 1) % len(factors)]
        self._magnify.value = _NAMES[self.magnified]  # type: ignore[misc]
        self._on_view()

    def measure(self, quantity: str) -> None:
        """Show the error of a quantity, by its key."""
        self.quantity, self._silent = quantity, True
        self._quantity.value = self._shown_quantity  # type: ignore[misc]
        self._session.show(plotted=quantity)
        self._scale.forget()
        self._on_view()

    @property
    def _shown_quantity(self) -> str:
        return str(words.QUANTITIES[self.quantity])

    def _choose_estimator(self) -> None:
        self.estimator = None if self._estimator.value == tr(NONE) else self._estimator.value
        self._keep()
        self._on_view()

    def _keep(self) -> None:
        self._silent = False
        if self.estimator:
            self._kept[self._session.scene.problem] = self.estimator

    def _choose_factor(self) -> None:
        self.magnified = _FACTORS[self._magnify.value]
        self._on_view()
