"""The presenter's view: stage, sentence and one plot with large text, for a room that looks at a projector."""

import viser

ENLARGED = 1.35  # of the stage's text
_BUTTON, _ON = "<i class='lab-present'></i>", "<i class='lab-present lab-presenting'></i>"


class Presenter:
    """A button that turns the view on and off; so do Escape and an address that ends in ``?present`` (ground.html).
    The style (present.css) follows a mark in the page."""

    def __init__(self, gui: viser.GuiApi):
        self.on = False
        self._mark = gui.add_html(_BUTTON)
        self._button = gui.add_button("Present", hint="for a projector: stage and one plot, large text; Escape ends it")
        self._button.on_click(lambda _: self._turn())

    def _turn(self) -> None:
        self.on = not self.on
        self._mark.content = _ON if self.on else _BUTTON
        self._button.label = "End" if self.on else "Present"
