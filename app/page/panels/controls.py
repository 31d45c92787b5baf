"""The right panel: everything of a scene that a visitor sets. Callbacks only pass wishes on."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import viser

from app.page.panels.choices import (
    BODY_FORCES,
    CFL,
    EFFECTS,
    LAYOUTS,
    METHODS,
    PROBLEMS,
    QUANTITIES,
    REACH,
    VELOCITIES,
)
from app.page.panels.estimators import EstimatorChoice
from app.page.panels.furniture import LOGARITHMIC
from app.page.session import Session
from app.scale import ColourScale
from solvers import problems
from solvers.scene import Scene

RUN_BUTTONS = ("Play", "Pause", "Step", "Reset")


class Controls:
    """Widgets of one visitor, bound to the session. ``on_view`` is called when only the drawing changes."""

    def __init__(self, gui: viser.GuiApi, tab: viser.GuiTabHandle, session: Session, scale: ColourScale,
                 on_view: Callable[[], None]):
        self._gui, self._tab, self._session, self._scale, self._on_view = gui, tab, session, scale, on_view
        self.domains = False
        self.estimators = EstimatorChoice(session, on_view)
        self._problem = gui.add_dropdown("Problem", tuple(PROBLEMS.values()),
                                         initial_value=PROBLEMS[session.scene.problem])
        self._problem.on_update(lambda _: self._choose_problem())
        self._build()

    @property
    def quantity(self) -> str:
        """Label of the quantity whose error is shown."""
        return self._quantity.value

    def load(self, scene: Scene) -> None:
        """Put a scene on the stage, and all that it says into the widgets."""
        if scene.problem != self._session.scene.problem:
            self.domains = False
        self._session.choose(scene)
        self._problem.value = PROBLEMS[scene.problem]  # has been chosen: nothing follows from it
        self._rebuild()

    def _choose_problem(self) -> None:
        """Another problem has other choices and reaches."""
        problem = _code_of(PROBLEMS, self._problem.value)
        if problem != self._session.scene.problem:
            self._session.choose(problems.PROBLEMS[problem].scene(periods=1))
            self.domains = False
            self._rebuild()

    def _rebuild(self) -> None:
        """Widgets for the session's present scene take the place of those there are."""
        self._widgets.remove()
        with self._tab:
            self._build()

    def _build(self) -> None:
        self._widgets = self._gui.add_folder(None)  # without a label it is only a way to remove all at once
        with self._widgets:
            self._run()
            self._scene()
            self._view()
            with self._gui.add_folder("Method details", expand_by_default=False):
                self._details()
            with self._gui.add_folder("Effects: compute only what you need", expand_by_default=False):
                self._effects()

    # ---- groups of widgets --------------------------------------------------------------------------------

    def _run(self) -> None:
        gui, session = self._gui, self._session
        acts = {"Play": lambda: session.play(True), "Pause": lambda: session.play(False),
                "Step": session.step, "Reset": session.reset}
        buttons = gui.add_button_group("Run", RUN_BUTTONS, hint="Step pauses and takes one time step")
        buttons.on_click(lambda event: acts[event.target.value]())
        self._logarithmic("Speed", "s/s", REACH[session.scene.problem].speed, session.speed, session.set_speed,
                          "simulated seconds per second of yours")

    def _scene(self) -> None:
        session, scene = self._session, self._session.scene
        reach = REACH[scene.problem]
        self._choice("Method", METHODS, "method", "shape functions that carry data between particles and grid")
        self._cells()
        low, high = reach.ppc
        per_cell = self._gui.add_slider("Particles / cell", low, high, 1, scene.ppc,
                                        hint="in each direction")
        per_cell.on_update(lambda e: session.set(ppc=e.target.value))
        self._logarithmic("A", "m", reach.amplitude, scene.amplitude, lambda v: session.set(amplitude=v),
                          reach.amplitude_hint)
        self._logarithmic("E", "Pa", reach.modulus, scene.modulus, lambda v: session.set(modulus=v),
                          "Young's modulus: what is stiffer vibrates faster")
        self._logarithmic("CFL", "", CFL, scene.courant_number, lambda v: session.set(cfl=v),
                          "time step as a share of the time a wave takes through a cell")

    def _cells(self) -> None:
        session, scene = self._session, self._session.scene
        reach = REACH[scene.problem]

        def label(count: int) -> str:
            return f"Cells, h = {reach.length}/{count}"

        low, high, step = reach.cells
        high = max(high, scene.cells)  # of a scene that was loaded
        cells = self._gui.add_slider(label(scene.cells), low, high, step, scene.cells,
                                     hint=f"grid cells across {reach.length} m")

        def changed(_: viser.GuiEvent) -> None:
            with session.turn:
                cells.label = label(cells.value)
                session.set(cells=cells.value)

        cells.on_update(changed)

    def _view(self) -> None:
        gui, scale, session = self._gui, self._scale, self._session
        self._quantity = gui.add_dropdown("Error of", tuple(QUANTITIES), initial_value="displacement x",
                                          hint="the quantity whose error gives the colours")
        self.estimators.build(gui)
        kind = gui.add_dropdown("Colours", ("linear", "logarithmic"), hint="of estimate and truth alike",
                                initial_value="logarithmic" if scale.logarithmic else "linear")
        hold = gui.add_checkbox("Hold colours", scale.held, hint="keep the colour scale while settings change")

        def changed(_: viser.GuiEvent) -> None:
            scale.logarithmic, scale.held = kind.value == "logarithmic", hold.value
            scale.forget()
            self._on_view()

        for widget in (self._quantity, kind, hold):
            widget.on_update(changed)
        if session.scene.DIMENSIONS == 2:
            self._domains_box()

    def _domains_box(self) -> None:
        box = self._gui.add_checkbox("Show domains", self.domains, hint="outline what each particle stands for: a box "
                                     "for GIMP, a parallelogram for CPDI; up to 5,000 particles")

        def changed(_: viser.GuiEvent) -> None:
            self.domains = box.value
            self._on_view()

        box.on_update(changed)

    def _details(self) -> None:
        session, scene = self._session, self._session.scene
        if scene.problem == "bar":
            preserving = self._gui.add_checkbox(
                "Linearity preserving", scene.linearity_preserving,
                hint="correct the gradient so that linear stress gives the exact force")
            preserving.on_update(lambda e: session.set(linearity_preserving=e.target.value))
        else:
            self._choice("Layout", LAYOUTS, "layout", "where particles begin: the Cartesian rim is a staircase")
        self._choice("Body force", BODY_FORCES, "body_force", "where the force is evaluated")
        self._choice("Velocity", VELOCITIES, "velocity", "the velocity that moves the particles")

    def _effects(self) -> None:
        boxes = {effect: self._gui.add_checkbox(label, effect in self._session.scene.effects)
                 for effect, label in EFFECTS.items()}

        def changed(_: viser.GuiEvent) -> None:
            self._session.set(effects=tuple(effect for effect, box in boxes.items() if box.value))

        for box in boxes.values():
            box.on_update(changed)

    # ---- kinds of widget ----------------------------------------------------------------------------------

    def _choice(self, label: str, words: dict[str, str], field: str, hint: str) -> None:
        """A dropdown of what the scene's field may be, in words."""
        scene = self._session.scene
        options = {words[code]: code for code in words if code in scene.choices(field)}
        widget = self._gui.add_dropdown(label, tuple(options), initial_value=words[getattr(scene, field)], hint=hint)
        widget.on_update(lambda e: self._session.set(**{field: options[e.target.value]}))

    def _logarithmic(self, name: str, unit: str, reach: tuple[float, float], value: float,
                     act: Callable[[float], None], hint: str) -> None:
        """A slider whose steps are factors. Its value stands in its label, for its box would show a logarithm."""
        def label(v: float) -> str:
            return f"{name} {v:.3g} {unit}".rstrip() if len(name) > 3 else f"{name} = {v:.3g} {unit}".rstrip()

        self._gui.add_html(LOGARITHMIC)
        low, high = (float(np.log10(end)) for end in (min(*reach, value), max(*reach, value)))
        decades = range(int(np.ceil(low)), int(np.floor(high)) + 1)
        slider = self._gui.add_slider(label(value), low, high, 0.005, float(np.log10(value)), hint=hint,
                                      marks=tuple((float(d), f"{10.0 ** d:g}") for d in decades))

        def changed(_: viser.GuiEvent) -> None:
            with self._session.turn:
                v = float(f"{10 ** slider.value:.3g}")
                slider.label = label(v)
                act(v)

        slider.on_update(changed)


def _code_of(words: dict[str, str], word: str) -> str:
    return next(code for code, label in words.items() if label == word)
