"""The presenter's view, a talk on a projector: headline, stage and one plot, in letters for the last row."""

from html import escape

import viser

from app.language.spoken import later, tr
from app.words import in_a_line
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
