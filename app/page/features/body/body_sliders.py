"""Sliders of the body on the stage: cells, particles, modulus and time step."""

from collections.abc import Callable

import viser

from app.frame.shown_body import ShownBody
from app.language.translation import lazy, tr
from app.page.panels.log_number_slider import LogNumberSlider, SliderSpec
from app.page.panels.page_header import add_widget_marker
from app.page.panels.scene_widgets import SceneWidgetFactory
from solvers.bodies.body import DEFAULT_CFL, MOST_CFL, MOST_PPC, SAMPLES

FIRST = -1e9  # order within the panel
CELLS, MODULI = (1 / 4, 4.0), (1 / 10, 10.0)  # reach of the sliders over the file's numbers
LEAST_CFL = 0.05
NOT_HERE = lazy("No budget, strips or comparison: they need an exact solution.")


class BodySliders:
    """Folder with the sliders, while a body is on the stage; ``change`` receives the value of a field of ``Body`` that
    the visitor sets, by its name, ``go_to`` the index of a frame, and ``leave`` is called by the button back to
    the run."""

    def __init__(self, gui: viser.GuiApi, bound: SceneWidgetFactory, change: Callable[..., None],
                 go_to: Callable[[int], None], leave: Callable[[], None]):
        self._gui, self._bound, self._change = gui, bound, change
        self._folder = gui.add_folder(tr("Your body on the stage"), order=FIRST, visible=False)
        with self._folder:
            self._rows = gui.add_folder(None)
            gui.add_html(f"<div class='lab-own'>{tr(NOT_HERE)}</div>")
            gui.add_html("<i class='lab-frames'></i>")
            self._frame = gui.add_slider(tr("Frame"), 0, SAMPLES, 1, 0, hint=tr("the times computed so far"))
            gui.add_html("<i class='lab-back'></i>")
            back = gui.add_button(tr("Back to our run"), icon=viser.Icon.ARROW_BACK_UP,
                                  hint=tr("go back to what was on the stage before"))
        self._frame.on_update(lambda event: go_to(round(event.target.value)) if event.client else None)
        back.on_click(lambda _: leave())
        self._sliders: dict[str, LogNumberSlider] = {}
        self._of: object = None  # file of the body that the sliders are for

    def show(self, body: ShownBody) -> None:
        """Shows the values of a body; the ends of the sliders are those of its file."""
        with self._bound.turn:
            if body.source.file != self._of:
                self._of = body.source.file
                self._build(body)
            for field, slider in self._sliders.items():
                slider.show(body.body[field])
            self._folder.visible = True

    def show_frame(self, frame: int) -> None:
        """Shows the index of the frame on the stage, from 0."""
        if self._frame.value != frame:
            self._frame.value = frame  # type: ignore[misc]

    def hide(self) -> None:
        self._folder.visible = False

    def _build(self, body: ShownBody) -> None:
        self._bound.disable_callbacks()
        self._rows.remove()
        cells, modulus = body.body["cells_per_metre"], body.body["youngs_modulus"]
        least = max(body.cells_step, CELLS[0] * cells)
        with self._folder:
            self._rows = self._gui.add_folder(None, order=FIRST)
        with self._rows:
            self._sliders = {
                "cells_per_metre": self._add("cells_per_metre", SliderSpec(
                    tr("Cells per metre"), "", (least, CELLS[1] * cells), cells,
                    tr("so that held sides lie on lines of the grid"), body.cells_step)),
                "ppc": self._add("ppc", SliderSpec(
                    tr("Particles / cell"), "", (1, MOST_PPC), body.body["ppc"], tr("in each direction"), 1)),
                "youngs_modulus": self._add("youngs_modulus", SliderSpec(
                    tr("Modulus E"), "Pa", (MODULI[0] * modulus, MODULI[1] * modulus), modulus,
                    tr("stiffness of the body"))),
                "cfl": self._add("cfl", SliderSpec(
                    tr("CFL number"), "", (LEAST_CFL, MOST_CFL), DEFAULT_CFL,
                    tr("time step as a share of the time a wave takes through a cell")))}
            for field, slider in self._sliders.items():
                slider.show(body.body[field])

    def _add(self, field: str, size: SliderSpec) -> LogNumberSlider:
        def act(value: float) -> None:
            self._change(**{field: int(value) if value == int(value) else value})

        add_widget_marker(self._gui, "lab-logarithmic")
        return LogNumberSlider(self._gui, self._bound, size, size.default, act)
