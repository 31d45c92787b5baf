"""The right panel: everything of a scene that a visitor sets. Callbacks only pass wishes on."""

from __future__ import annotations

from collections.abc import Callable
from typing import get_args

import numpy as np
import viser

from app.panels.furniture import LOGARITHMIC
from app.scale import ColourScale
from app.session import Session
from solvers.bar.scene import BodyForce, Method, PositionUpdate
from solvers.scene import EFFECTS, ESTIMATORS

METHODS = {"mpm": "MPM (hat functions)", "ugimp": "uGIMP", "cpgimp": "cpGIMP", "bspline": "B-spline"}
#: Label, key in samples, unit. The order is that of the error columns.
QUANTITIES = {"displacement x": ("x", "m"), "velocity v": ("v", "m/s"), "stress σ": ("sigma", "Pa"),
              "acceleration a": ("a", "m/s²")}
BODY_FORCES = {"at the particles": "material", "at the nodes": "node", "none": "none"}
POSITION_UPDATES = {"grid velocity": "grid", "particle velocity": "particle", "domain corners": "corners"}
EFFECT_LABELS = {"truth": "true error", "estimate": "estimate", "crossings": "grid crossings",
                 "energy": "energy", "acceleration": "acceleration error"}
RUN_BUTTONS = ("Play", "Pause", "Step", "Reset")

assert set(METHODS) == set(get_args(Method)) and set(EFFECT_LABELS) == set(EFFECTS)
assert set(BODY_FORCES.values()) == set(get_args(BodyForce))
assert set(POSITION_UPDATES.values()) == set(get_args(PositionUpdate))


class Controls:
    """Widgets of one visitor, bound to the session. ``on_view`` is called when only the drawing changes."""

    def __init__(self, gui: viser.GuiApi, session: Session, scale: ColourScale, on_view: Callable[[], None]):
        self._gui, self._session, self._scale, self._on_view = gui, session, scale, on_view
        self._run()
        self._scene()
        self._view()
        with gui.add_folder("Method details", expand_by_default=False):
            self._details()
        with gui.add_folder("Effects: compute only what you need", expand_by_default=False):
            self._effects()

    @property
    def quantity(self) -> str:
        """Label of the quantity whose error is shown."""
        return self._quantity.value

    @property
    def estimator(self) -> str | None:
        """The estimator shown, if the scene has one."""
        active = self._session.scene.active_estimators
        return active[0] if active else None

    # ---- groups of widgets --------------------------------------------------------------------------------

    def _run(self) -> None:
        gui, session = self._gui, self._session
        acts = {"Play": lambda: session.play(True), "Pause": lambda: session.play(False),
                "Step": session.step, "Reset": session.reset}
        buttons = gui.add_button_group("Run", RUN_BUTTONS, hint="Step pauses and takes one time step")
        buttons.on_click(lambda event: acts[event.target.value]())
        self._logarithmic("Speed", "s/s", 1e-3, 4.0, session.speed, session.set_speed,
                          "simulated seconds per second of yours")

    def _scene(self) -> None:
        gui, session = self._gui, self._session
        scene = session.scene
        method = gui.add_dropdown("Method", tuple(METHODS.values()), initial_value=METHODS[scene.method],
                                  hint="shape functions that carry data between particles and grid")
        codes = {label: code for code, label in METHODS.items()}
        method.on_update(lambda e: session.set(method=codes[e.target.value]))
        cells = gui.add_slider(f"Cells, h = 1/{scene.cells}", 8, 160, 1, scene.cells,
                               hint="grid cells in the bar of unit length")

        def set_cells(event: viser.GuiEvent) -> None:
            cells.label = f"Cells, h = 1/{cells.value}"
            session.set(cells=cells.value)

        cells.on_update(set_cells)
        per_cell = gui.add_slider("Particles / cell", 1, 8, 1, scene.particles_per_cell)
        per_cell.on_update(lambda e: session.set(particles_per_cell=e.target.value))
        self._logarithmic("A", "m", 1e-4, 0.2, scene.amplitude, lambda v: session.set(amplitude=v),
                          "amplitude of the vibration; from 0.159 m on the exact bar turns inside out")
        self._logarithmic("E", "Pa", 1.0, 1000.0, scene.modulus, lambda v: session.set(modulus=v),
                          "Young's modulus: a stiffer bar vibrates faster")
        self._logarithmic("CFL", "", 0.01, 2.0, scene.courant_number, lambda v: session.set(cfl=v),
                          "time step as a share of the time a wave takes through a cell")

    def _view(self) -> None:
        gui, scale = self._gui, self._scale
        self._quantity = gui.add_dropdown("Error of", tuple(QUANTITIES), initial_value="displacement x",
                                          hint="the quantity whose error colours both lanes")
        estimator = gui.add_dropdown("Estimator", (*ESTIMATORS, "none"),
                                     initial_value=self._session.scene.estimators[0])
        estimator.on_update(lambda e: self._session.set(
            estimators=() if e.target.value == "none" else (e.target.value,)))
        kind = gui.add_dropdown("Colours", ("linear", "logarithmic"), initial_value="linear",
                                hint="of both lanes alike")
        hold = gui.add_checkbox("Hold colours", False, hint="keep the colour scale while settings change")

        def changed(_: viser.GuiEvent) -> None:
            scale.logarithmic, scale.held = kind.value == "logarithmic", hold.value
            scale.forget()
            self._on_view()

        for widget in (self._quantity, kind, hold):
            widget.on_update(changed)

    def _details(self) -> None:
        gui, session = self._gui, self._session
        preserving = gui.add_checkbox("Linearity preserving", session.scene.linearity_preserving,
                                      hint="correct the gradient so that linear stress gives the exact force")
        preserving.on_update(lambda e: session.set(linearity_preserving=e.target.value))
        self._choice("Body force", BODY_FORCES, "body_force", "where the force is evaluated")
        self._choice("Velocity", POSITION_UPDATES, "velocity",
                     "the velocity that moves the particles; corners need cpGIMP")

    def _effects(self) -> None:
        boxes = {effect: self._gui.add_checkbox(EFFECT_LABELS[effect], effect in self._session.scene.effects)
                 for effect in EFFECTS}

        def changed(_: viser.GuiEvent) -> None:
            self._session.set(effects=tuple(effect for effect, box in boxes.items() if box.value))

        for box in boxes.values():
            box.on_update(changed)

    # ---- kinds of widget ----------------------------------------------------------------------------------

    def _choice(self, label: str, options: dict[str, str], field: str, hint: str) -> None:
        current = getattr(self._session.scene, field)
        widget = self._gui.add_dropdown(label, tuple(options), initial_value=_key_of(options, current), hint=hint)
        widget.on_update(lambda e: self._session.set(**{field: options[e.target.value]}))

    def _logarithmic(self, name: str, unit: str, low: float, high: float, value: float,
                     act: Callable[[float], None], hint: str) -> None:
        """A slider whose steps are factors. Its value stands in its label, for its box would show a logarithm."""
        def label(v: float) -> str:
            return f"{name} = {v:.3g} {unit}".rstrip()

        self._gui.add_html(LOGARITHMIC)
        decades = range(int(np.ceil(np.log10(low))), int(np.floor(np.log10(high))) + 1)
        slider = self._gui.add_slider(label(value), float(np.log10(low)), float(np.log10(high)), 0.005,
                                      float(np.log10(value)), hint=hint,
                                      marks=tuple((float(d), f"{10.0 ** d:g}") for d in decades))

        def changed(_: viser.GuiEvent) -> None:
            v = float(f"{10 ** slider.value:.3g}")
            slider.label = label(v)
            act(v)

        slider.on_update(changed)


def _key_of(options: dict[str, str], value: str) -> str:
    return next(label for label, code in options.items() if code == value)
