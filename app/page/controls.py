"""The right panel: everything of a scene that a visitor sets. Callbacks only pass wishes on."""

from collections.abc import Callable

import viser

from app import words
from app.frame.scale import ColourScale
from app.page.features.slow.panel import SlowMotion
from app.page.panels.bound import BoundWidgets, Patience, Size
from app.page.panels.estimators import EstimatorChoice
from app.page.panels.looking import Looking
from app.page.source import Choice
from app.page.visit.session import Session, first_scene
from app.problems.views import VIEWS
from app.state import State
from solvers.problems import PROBLEMS
from solvers.scene.effects import ALL
from solvers.scene.remedies import REMEDIES
from solvers.scene.scene import AUTO, DEFAULT_CFL, Scene
from solvers.scene.step_bound import SAFE

CFL = (0.01, 2.0)
PIN, UNPIN = "Pin this run", "Unpin"


class Controls:
    """Widgets of one visitor, bound to the session. ``on_view`` is called when only the drawing changes."""

    def __init__(self, gui: viser.GuiApi, tab: viser.GuiTabHandle, session: Session, scale: ColourScale,
                 on_view: Callable[[], None], looking: Looking, slow: SlowMotion):
        self._gui, self._tab, self._session, self._scale, self._on_view = gui, tab, session, scale, on_view
        self.domains, self.magnified, self._slow = False, 1, slow
        self._offered: tuple[str, ...] = ()  # the controls that a lesson leaves; without any all are
        self.quantity = next(iter(words.QUANTITIES))  # key of the one whose error is shown
        self.looking = looking
        self._patience = Patience()
        self._bound = BoundWidgets(gui, session, self._patience)
        self._turn = self._bound.turn  # widgets must not be removed while others are made or changed among them
        self.estimators = EstimatorChoice(session, on_view, self._bound)
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
        with self._turn:
            if scene.problem != self._session.scene.problem:
                self.domains = False
            self._session.choose(scene)
            self._rebuild()

    def offer(self, controls: tuple[str, ...]) -> None:
        """Show only these controls, or all where there are none: ``app.lessons.lesson.CONTROLS`` names them."""
        with self._turn:
            if controls != self._offered:
                self._offered = controls
                self._problem.visible = not controls or "problem" in controls
                self._rebuild()

    def show(self, state: State) -> None:
        """Put all of a state on the stage and into the widgets."""
        session = self._session
        with self._turn:
            self.quantity, self.magnified, self.domains = state.quantity, state.magnified, state.domains
            self._scale.logarithmic = state.logarithmic
            self._scale.forget()
            self.estimators.drawn, self.estimators.difference = state.estimator, state.difference
            session.unpin()
            session.choose(state.scene, state.speed, state.stops)
            if state.pinned is not None:
                session.pin(self._pinned_drawn, state.pinned)
            session.show(differences=state.difference, plotted=state.quantity)
            self.looking.trace(state.traced)
            self._rebuild()
        self._on_view()

    @property
    def choice(self) -> Choice:
        """What is to be seen of a run."""
        return Choice(self.quantity, self.estimators.drawn, self.estimators.difference, self.domains, self.magnified,
                      self.looking.latest)

    @property
    def state(self) -> State:
        """What the visitor sees."""
        session, first = self._session, next(iter(self._session.scene.estimators), None)
        drawn, speed, pinned = self.estimators.drawn, VIEWS[session.scene.problem].speed, session.pinned
        return State(session.scene, self.quantity, drawn if drawn != first else None, self.estimators.difference,
                     self.magnified, self._scale.logarithmic, self.domains,
                     session.speed if session.speed != speed else None, self.looking.traced, session.ends,
                     pinned.scene if pinned else None)

    def _rebuild(self) -> None:
        """Make the widgets anew, for the session's present scene."""
        self._problem.value = self._session.scene.TITLE  # type: ignore[misc]  # it is chosen: nothing follows from it
        self._bound.forget()
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
            with self._part("slow-motion"):
                self._slow.build(self._gui)
            self._scene()
            self._view()
            with self._part("details"), self._gui.add_folder("Method details and remedies", expand_by_default=False):
                for field, hint in VIEWS[self._session.scene.problem].details.items():
                    if field != "body_force" or self._session.scene.swings:
                        self._bound.field(field, hint)
                self._gui.add_html("<div class='lab-group'>Remedies for long and large motions</div>")
                self._bound.boxes("remedies", REMEDIES)
            with self._part("effects"), \
                    self._gui.add_folder("Effects: compute only what you need", expand_by_default=False):
                self._bound.boxes("effects", ALL)

    def _part(self, control: str) -> viser.GuiFolderHandle:
        """Room for a control, which a lesson may do without. Without a label nothing of it is seen."""
        return self._gui.add_folder(None, visible=not self._offered or control in self._offered)

    def _run(self) -> None:
        gui, session = self._gui, self._session
        acts = {"Play": lambda: session.play(True), "Pause": lambda: session.play(False),
                "Step": lambda: session.play(False, single_steps=1), "Reset": session.reset}
        buttons = gui.add_button_group("Run", tuple(acts), hint="Step pauses and takes one time step")
        buttons.on_click(lambda event: acts[event.target.value]())
        with self._part("pin"):
            pin = gui.add_button(PIN if session.pinned is None else UNPIN, hint="keep the run on the stage beside what "
                                 "you change: both begin at t = 0 and go on together, period by period")
        pin.on_click(self._bound.in_turn(lambda _: self._pin(pin)))
        view = VIEWS[session.scene.problem]
        with self._part("speed"):
            self._bound.size(Size("Speed", "", view.reach.speed, view.speed,
                            "periods of the exact vibration in a second of yours"), session.speed, session.set_speed)
        with self._part("look-back"):
            self.looking.build_slider(gui)

    def _pin(self, button: viser.GuiButtonHandle) -> None:
        session = self._session
        if session.pinned is None:
            session.pin(self._pinned_drawn)
        else:
            session.unpin()
        button.label = PIN if session.pinned is None else UNPIN
        self._on_view()

    def _pinned_drawn(self) -> None:
        """The pinned run has a frame: while both play, it is drawn with the other's."""
        if not (self._session.report and self._session.report.playing):
            self._on_view()

    def _scene(self) -> None:
        session, scene, view = self._session, self._session.scene, VIEWS[self._session.scene.problem]
        with self._part("motion"):
            self._bound.motions(self._move)
        with self._part("method"):
            self._bound.field("method", "shape functions that carry data between particles and grid")
        with self._part("cells"):
            self._cells()
        with self._part("ppc"):
            low, high = view.reach.ppc
            step, hint = (1, "in each direction") if scene.swings else (0.5, "need not be whole here")
            per_cell = self._gui.add_slider("Particles / cell", low, max(high, scene.ppc), step, scene.ppc, hint=hint)
            self._bound.follow(per_cell, lambda count: session.set(ppc=count))
        default = type(scene)()
        if scene.swings:
            with self._part("amplitude"):
                self._bound.size(Size("Amplitude A", words.unit_of(type(scene), "amplitude"), view.reach.amplitude,
                                      default.amplitude, view.amplitude_hint),
                                 scene.amplitude, lambda value: session.set(amplitude=value))
        elif view.motion:
            with self._part("stretch"):
                self._bound.sliders(view.motion.sliders)
        with self._part("modulus"):
            self._bound.size(Size("Modulus E", "Pa", view.reach.modulus, default.modulus, view.modulus_hint),
                             scene.modulus, lambda value: session.set(modulus=value))
            self._bound.sliders(view.material)
        with self._part("step"):
            self._step()

    def _move(self, changed: Scene, quantity: str | None, speed: float | None) -> None:
        """Another motion has other controls."""
        self.show(State(changed, quantity or self.quantity, magnified=self.magnified, speed=speed,
                        logarithmic=self._scale.logarithmic))

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
        self._step_size = self._bound.size(
            Size("CFL number", "", CFL, DEFAULT_CFL, "time step as a share of the time a wave takes through a cell"),
            scene.courant_number, by_hand)
        auto = self._gui.add_checkbox("Auto step", scene.dt == AUTO, hint=f"take {SAFE:g} of the longest step that the "
                                      "motion ahead bears by linear theory; the slider above shows it")
        self._bound.follow(auto, automatic)

    def refresh(self) -> None:
        """Show the step that "auto" makes of the present scene: other settings change it.

        Once for each: a slider that is set while the visitor moves it would forget where to.
        """
        self._patience.show(self._session.compiling)
        with self._turn:
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

        self._bound.follow(cells, changed)

    def _view(self) -> None:
        gui, scale, session = self._gui, self._scale, self._session
        quantities = {str(quantity): key for key, quantity in words.QUANTITIES.items()}
        with self._part("quantity"):
            quantity = gui.add_dropdown("Error of", tuple(quantities),
                                        initial_value=str(words.QUANTITIES[self.quantity]),
                                        hint="the quantity whose error gives the colours, and whose field is plotted")
        factors = {f"× {factor}": factor for factor in words.MAGNIFICATIONS}
        with self._part("magnify"):
            magnify = gui.add_dropdown("Magnify error", tuple(factors), initial_value=f"× {self.magnified}",
                                       hint="in the plot of the field: how many times the deviation of the particles "
                                            "from the exact curve is drawn")
        with self._part("estimators"):
            self.estimators.build(gui)
        with self._part("colours"):
            kind = gui.add_dropdown("Colours", ("linear", "logarithmic"), hint="of estimate and truth alike",
                                    initial_value="logarithmic" if scale.logarithmic else "linear")
            hold = gui.add_checkbox("Hold colours", scale.held, hint="keep the colour scale while settings change")
        with self._part("trace"):
            self.looking.build_trace(gui)

        def changed(_: viser.GuiEvent) -> None:
            scale.logarithmic, scale.held = kind.value == "logarithmic", hold.value
            scale.forget()
            self._on_view()

        def choose_quantity(event: viser.GuiEvent) -> None:
            self.quantity = quantities[quantity.value]
            session.show(plotted=self.quantity)
            changed(event)

        def choose_factor(_: viser.GuiEvent) -> None:
            self.magnified = factors[magnify.value]
            self._on_view()

        quantity.on_update(choose_quantity)
        magnify.on_update(choose_factor)
        for widget in (kind, hold):
            widget.on_update(changed)
        if hint := VIEWS[session.scene.problem].stage.DOMAINS_HINT:
            with self._part("domains"):
                domains = gui.add_checkbox("Show domains", self.domains, hint=hint)
            domains.on_update(lambda e: self._show_domains(e.target.value))

    def _show_domains(self, shown: bool) -> None:
        self.domains = shown
        self._on_view()
