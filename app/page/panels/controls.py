"""The right panel: everything of a scene that a visitor sets. Callbacks only pass wishes on."""

import threading
from collections.abc import Callable, Mapping
from typing import Any

import viser

from app import words
from app.page.panels.estimators import EstimatorChoice
from app.page.panels.head import WIDE_LABEL
from app.page.panels.looking import Looking
from app.page.panels.patience import Patience
from app.page.panels.size import Size, SizeControl
from app.page.panels.slow import SlowMotion
from app.page.session import Session, first_scene
from app.problems.field import MAGNIFICATIONS
from app.problems.views import VIEWS
from app.scale import ColourScale
from solvers.effects import EFFECTS, Effect
from solvers.problems import PROBLEMS
from solvers.remedies import REMEDIES, Remedy
from solvers.rules import field_label
from solvers.scene import AUTO, DEFAULT_CFL, Scene
from solvers.step_bound import SAFE

CFL = (0.01, 2.0)
PIN, UNPIN = "Pin this run", "Unpin"


class Controls:
    """Widgets of one visitor, bound to the session. ``on_view`` is called when only the drawing changes."""

    def __init__(self, gui: viser.GuiApi, tab: viser.GuiTabHandle, session: Session, scale: ColourScale,
                 on_view: Callable[[], None], looking: Looking, slow: SlowMotion):
        self._gui, self._tab, self._session, self._scale, self._on_view = gui, tab, session, scale, on_view
        self.domains, self.magnified, self._slow = False, 1, slow
        self.quantity = next(iter(words.QUANTITIES))  # key of the one whose error is shown
        self.looking = looking
        self._turn = threading.Lock()  # callbacks run side by side: what is read last is to be asked for last
        self._loading = threading.Lock()  # widgets must not be removed while others are made among them
        self._patience = Patience()
        self.estimators = EstimatorChoice(session, on_view, self._patience)
        self._problem = gui.add_dropdown("Problem", tuple(problem.scene.TITLE for problem in PROBLEMS.values()),
                                         initial_value=session.scene.TITLE, hint="what moves; each has its own scene")
        self._build()

    def begin(self) -> None:
        """The page is made: from now on another problem may be chosen, or has been meanwhile. Before, its widgets would
        be made while others are made around them."""
        self._problem.on_update(lambda _: self._choose_problem())
        self._choose_problem()

    def load(self, scene: Scene) -> None:
        """Put a scene on the stage, and all that it says into the widgets."""
        with self._loading:
            if scene.problem != self._session.scene.problem:
                self.domains = False
            self._session.choose(scene)
            self._problem.value = scene.TITLE  # type: ignore[misc]  # has been chosen: nothing follows from it
            self._widgets.remove()
            with self._tab:
                self._build()

    def _choose_problem(self) -> None:
        """Another problem has other choices and reaches."""
        if self._problem.value != self._session.scene.TITLE:
            kind = next(problem.scene for problem in PROBLEMS.values() if problem.scene.TITLE == self._problem.value)
            self.load(first_scene(kind.problem))

    def _build(self) -> None:
        self._widgets = self._gui.add_folder(None)  # without a label it is only a way to remove all at once
        with self._widgets:
            self._run()
            self._slow.build(self._gui)
            self._scene()
            self._view()
            with self._gui.add_folder("Method details and remedies", expand_by_default=False):
                for field, hint in VIEWS[self._session.scene.problem].details.items():
                    self._field(field, hint)
                self._gui.add_html("<div class='lab-group'>Remedies for long and large motions</div>")
                self._boxes("remedies", REMEDIES)
            with self._gui.add_folder("Effects: compute only what you need", expand_by_default=False):
                self._boxes("effects", EFFECTS)

    def _run(self) -> None:
        gui, session = self._gui, self._session
        acts = {"Play": lambda: session.play(True), "Pause": lambda: session.play(False),
                "Step": lambda: session.play(False, single_steps=1), "Reset": session.reset}
        buttons = gui.add_button_group("Run", tuple(acts), hint="Step pauses and takes one time step")
        buttons.on_click(lambda event: acts[event.target.value]())
        pin = gui.add_button(PIN if session.pinned is None else UNPIN, hint="keep the run on the stage beside what you "
                             "change: both begin at t = 0 and go on together, period by period")
        pin.on_click(lambda _: self._pin(pin))
        view = VIEWS[session.scene.problem]
        self._size(Size("Speed", "", view.reach.speed, view.speed,
                        "periods of the exact vibration in a second of yours"), session.speed, session.set_speed)
        self.looking.build_slider(gui)

    def _pin(self, button: viser.GuiButtonHandle) -> None:
        session = self._session
        if session.pinned is None:  # while both play, it is drawn with the other
            session.pin(lambda: None if session.report and session.report.playing else self._on_view())
        else:
            session.unpin()
        button.label = PIN if session.pinned is None else UNPIN
        self._on_view()

    def _scene(self) -> None:
        session, scene, view = self._session, self._session.scene, VIEWS[self._session.scene.problem]
        self._field("method", "shape functions that carry data between particles and grid")
        self._cells()
        per_cell = self._gui.add_slider("Particles / cell", *view.reach.ppc, 1, scene.ppc, hint="in each direction")
        self._follow(per_cell, lambda count: session.set(ppc=count))
        default = type(scene)()
        self._size(Size("Amplitude A", "m", view.reach.amplitude, default.amplitude, view.amplitude_hint),
                   scene.amplitude, lambda value: session.set(amplitude=value))
        self._size(Size("Modulus E", "Pa", view.reach.modulus, default.modulus,
                        "Young's modulus: what is stiffer vibrates faster"),
                   scene.modulus, lambda value: session.set(modulus=value))
        self._step()

    def _step(self) -> None:
        """The step as a number of one's own, or as long as the motion ahead bears: the slider shows that too."""
        session, scene = self._session, self._session.scene

        def by_hand(cfl: float) -> None:
            auto.value = False  # type: ignore[misc]
            session.set(cfl=cfl, dt=None)

        def automatic(wanted: bool) -> None:
            if wanted:
                session.set(cfl=None, dt=AUTO)
            else:  # the step stays as it was
                by_hand(float(f"{session.scene.courant_number:.3g}"))

        self._shown_step = scene.courant_number
        self._step_size = self._size(Size("CFL number", "", CFL, DEFAULT_CFL, "time step as a share of the time a wave "
                                          "takes through a cell"), scene.courant_number, by_hand)
        auto = self._gui.add_checkbox("Auto step", scene.dt == AUTO, hint=f"take {SAFE:g} of the longest step that the "
                                      "motion ahead bears by linear theory; the slider above shows it")
        self._follow(auto, automatic)

    def refresh(self) -> None:
        """Show the step that "auto" makes of the present scene: other settings change it.

        Once for each: a slider that is set while the visitor moves it would forget where to.
        """
        self._patience.show(self._session.compiling)
        with self._loading, self._turn:
            self.looking.refresh()
            scene = self._session.scene
            if scene.dt == AUTO and scene.courant_number != self._shown_step:
                self._shown_step = scene.courant_number
                self._step_size.show(scene.courant_number)

    def _cells(self) -> None:
        scene = self._session.scene
        length = f"{scene.cells * scene.spacing:g}"

        def label(count: int) -> str:
            return f"Cells, h = {length}/{count}"

        low, high, step = VIEWS[scene.problem].reach.cells
        high = max(high, scene.cells)  # of a scene that was loaded
        cells = self._gui.add_slider(label(scene.cells), low, high, step, scene.cells,
                                     hint=f"grid cells across {length} m")

        def changed(count: int) -> None:
            cells.label = label(count)
            self._session.set(cells=count)

        self._follow(cells, changed)

    def _view(self) -> None:
        gui, scale, session = self._gui, self._scale, self._session
        quantities = {str(quantity): key for key, quantity in words.QUANTITIES.items()}
        quantity = gui.add_dropdown("Error of", tuple(quantities), initial_value=str(words.QUANTITIES[self.quantity]),
                                    hint="the quantity whose error gives the colours, and whose field is plotted")
        factors = {f"× {factor}": factor for factor in MAGNIFICATIONS}
        magnify = gui.add_dropdown("Magnify error", tuple(factors), initial_value=f"× {self.magnified}",
                                   hint="in the plot of the field: how many times the deviation of the particles "
                                        "from the exact curve is drawn")
        self.estimators.build(gui)
        kind = gui.add_dropdown("Colours", ("linear", "logarithmic"), hint="of estimate and truth alike",
                                initial_value="logarithmic" if scale.logarithmic else "linear")
        hold = gui.add_checkbox("Hold colours", scale.held, hint="keep the colour scale while settings change")
        self.looking.build_trace(gui)

        def changed(_: viser.GuiEvent) -> None:
            scale.logarithmic, scale.held = kind.value == "logarithmic", hold.value
            scale.forget()
            self._on_view()

        def choose_quantity(event: viser.GuiEvent) -> None:
            self.quantity = quantities[quantity.value]
            session.plot(self.quantity)
            changed(event)

        def choose_factor(_: viser.GuiEvent) -> None:
            self.magnified = factors[magnify.value]
            self._on_view()

        quantity.on_update(choose_quantity)
        magnify.on_update(choose_factor)
        for widget in (kind, hold):
            widget.on_update(changed)
        if hint := VIEWS[session.scene.problem].domains_hint:
            domains = gui.add_checkbox("Show domains", self.domains, hint=hint)
            domains.on_update(lambda e: self._show_domains(e.target.value))

    def _show_domains(self, shown: bool) -> None:
        self.domains = shown
        self._on_view()

    def _boxes(self, field: str, kinds: Mapping[str, Effect] | Mapping[str, Remedy]) -> None:
        """A box for each of the names that the scene's field may hold, several at a time."""
        session, scene = self._session, self._session.scene
        boxes = {}
        for name in scene.choices(field):
            self._gui.add_html(WIDE_LABEL)
            boxes[name] = self._gui.add_checkbox(kinds[name].label, name in getattr(scene, field),
                                                 hint=kinds[name].explanation)
        for box in boxes.values():
            self._follow(box, lambda _: session.set(**{field: tuple(name for name, b in boxes.items() if b.value)}))

    def _follow(self, widget: Any, act: Callable[[Any], None]) -> None:
        """Call ``act`` with the widget's value whenever the visitor has changed it, for one widget at a time."""
        def changed(event: viser.GuiEvent) -> None:
            if event.client is not None:  # else the page has shown something, and nobody wishes anything
                self._patience.changed(widget)
                with self._turn:
                    act(widget.value)

        widget.on_update(changed)

    def _field(self, field: str, hint: str) -> None:
        """A dropdown of what the scene's field may be, in words; a box for one that is true or false."""
        scene, label = self._session.scene, field_label(field).capitalize()
        value, names = getattr(scene, field), words.choices(type(scene), field)
        codes = {name: code for code, name in names.items()}
        if not names:
            self._gui.add_html(WIDE_LABEL)
        widget = self._gui.add_dropdown(label, tuple(codes), hint=hint, initial_value=names[value]) if names \
            else self._gui.add_checkbox(label, value, hint=hint)
        self._follow(widget, lambda shown: self._session.set(**{field: codes.get(shown, shown)}))

    def _size(self, size: Size, value: float, act: Callable[[float], None]) -> SizeControl:
        """A slider and a text for a number of any size."""
        return SizeControl(self._gui, size, value, act, self._session.refuse, self._follow)
