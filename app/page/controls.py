"""The right panel: widgets for everything in a scene that a visitor sets. Callbacks only forward requests."""

import threading
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

import viser

from app.frame.colour_scale import ColourScale
from app.language.translation import lazy, tr
from app.page.panels.browser_store_and_window import BrowserStore
from app.page.panels.frame_and_drawing_controls import DrawingWidgets, FrameAndTraceControls
from app.page.panels.landscape_strips import LandscapeStrips
from app.page.panels.page_header import add_widget_marker, widget_marker_html
from app.page.panels.quantity_and_estimator_widgets import EstimatorCards, QuantityAndEstimatorWidgets
from app.page.panels.scene_widgets import SceneWidgetFactory, WidgetStatusMessage
from app.page.panels.simulation_parameter_widgets import SimulationParameterWidgets
from app.page.playback_controls import PlaybackControls
from app.page.stage_source import ViewChoice
from app.page.visit.first_scene import first_scene
from app.page.visit.landscapes import Landscapes
from app.page.visit.run_session import RunSession
from app.problems.views import VIEWS
from app.shareable_state import State
from solvers.engine.engine_messages import FrameReport
from solvers.engine.shared_frames import FrameArrays
from solvers.problems import PROBLEMS
from solvers.scene.effects import ALL
from solvers.scene.scene import Scene
from solvers.scene.stabilisations import REMEDIES

ELSEWHERE = lazy("A lesson is open: its controls are in <b>Lessons</b>, below its text.")

OF_FILES = ("problem", "quantity", "magnify", "speed")  # controls, by their names in lessons


class Controls:
    """Widgets of one visitor for everything in a scene, and the view options read from them. Those outside the tab are
    built at once, the others by :meth:`build`; ``on_view`` redraws the stage, ``of_body`` makes widgets for a body."""

    def __init__(self, gui: viser.GuiApi, session: RunSession, scale: ColourScale, on_view: Callable[[], None],
                 history: FrameAndTraceControls, store: BrowserStore, landscapes: Landscapes):
        self._gui, self._session, self._scale, self._on_view = gui, session, scale, on_view
        self._history = history
        self._extensions: dict[str, Callable[[], Any]] = {}
        self._offered: tuple[str, ...] = ()  # the controls that a lesson shows; all if empty
        self._answers = WidgetStatusMessage(gui)
        self._turn = threading.RLock()  # widgets must not be removed while others are built or changed
        self._bound, self._lasting, self.of_body = (
            SceneWidgetFactory(gui, session, self._answers, self._turn) for _ in range(3))
        problem_mark = gui.add_html("<i class='lab-at-problem'></i>")
        self.problem = gui.add_dropdown(tr("Problem"), tuple(tr(problem.scene.TITLE) for problem in PROBLEMS.values()),
                                        initial_value=tr(session.scene.TITLE),
                                        hint=tr("what moves; each has its own scene"))
        self.stage = QuantityAndEstimatorWidgets(gui, session, scale, on_view)
        self._transport = PlaybackControls(gui, session, history, self._lasting, on_view)
        self._parts: dict[str, tuple[Any, ...]] = {
            "problem": (problem_mark, self.problem), **self.stage.parts, **self._transport.parts}
        self._drawing = DrawingWidgets(session, scale, history, self.stage, on_view)
        self.strips = LandscapeStrips(gui, session, landscapes, store, self._turn,
                                      lambda: (self.stage.quantity, self.stage.estimator))
        self._run = SimulationParameterWidgets(session, self._bound, store, self.strips)
        self.estimator_cards = EstimatorCards(gui, session, self.stage, self._bound, store)
        store.heard |= {"entered": self._on_entered, "compare": self._transport.on_choice}

    def add_extension(self, control: str, build: Callable[[], Any], *widgets: Any) -> None:
        """Adds ``build``, which makes widgets in the tab beside a control (its name in lessons) and is called at each
        rebuild; lessons show and hide ``widgets``, which are elsewhere, with that control."""
        self._extensions[control] = build
        self._parts[control] = (*self._parts.get(control, ()), *widgets)

    def set_initial_state(self, state: State) -> None:
        """Sets view options and second run to a state whose scene the session already has, before :meth:`build`."""
        self._set_view(state)
        self._begin_second_run(state)

    def build(self, tab: viser.GuiTabHandle) -> None:
        """Builds the scene's widgets within a tab."""
        self._home = tab
        self._parent: viser.GuiTabHandle | viser.GuiFolderHandle = tab
        self._elsewhere = self._gui.add_html(f"<p class='lab-elsewhere'>{tr(ELSEWHERE)}</p>", visible=False)
        self._build()

    def on_frame(self, report: FrameReport, arrays: FrameArrays) -> None:
        """Replaces the estimator on the stage if the frame shown has no values of the quantity chosen, and shows the
        error over each slider until that instant."""
        with self._turn:
            self.stage.ensure_estimator_has_values(report.scene, arrays)
            self.strips.follow(report)

    def enable_problem_choice(self) -> None:
        """Makes the dropdown of problems work, once the page is built, and applies a choice made in it before."""
        self.problem.on_update(lambda _: self._choose_problem())
        self._choose_problem()

    def choose_problem(self, problem: str) -> None:
        """Puts the first scene of a problem, by its key ("bar"), on the stage, unless the stage has that problem, with
        its own motion."""
        if problem == self._session.scene.problem and self._session.scene.to_dict().get("displacement"):
            self.load(first_scene(problem), rests=not self._session.playing)
        self.problem.value = tr(PROBLEMS[problem].scene.TITLE)  # type: ignore[misc]
        self._choose_problem()

    def load(self, scene: Scene, rests: bool = False) -> None:
        """Puts a scene on the stage and its values into the widgets; ``rests`` as of :meth:`RunSession.set_scene`."""
        with self._turn:
            if scene.problem != self._session.scene.problem:
                self._drawing.domains = False
                self.stage.restore_last_estimator(scene.problem)
            self._session.set_scene(scene, rests=rests)
            self._rebuild()

    def show_only(self, controls: tuple[str, ...], place: viser.GuiFolderHandle | None = None) -> None:
        """Shows only these controls (names in lessons, "cells"), or all for (), in the folder ``place`` or the tab."""
        with self._turn:
            if controls != self._offered or (place or self._home) is not self._parent:
                self._offered, self._parent = controls, place or self._home
                self._elsewhere.visible = place is not None
                for control, parts in self._parts.items():
                    for part in parts:
                        part.visible = not controls or control in controls
                self._rebuild()

    def show_for_own(self, play: Callable[[bool], None] | None, controls: tuple[str, ...] = ()) -> None:
        """Shows only those controls that a file or body on the stage has in common with the run, and has Play and Pause
        call ``play``; for None all controls, for the run. A lesson keeps its own controls."""
        with self._turn:
            self._transport.play = play or self._session.play
            if self._parent is self._home:
                self.show_only(controls)

    def show(self, state: State) -> None:
        """Puts a state on the stage and into the widgets."""
        with self._turn:
            self._set_view(state)
            self._session.unpin()
            self._session.set_scene(state.scene, state.speed, state.stops)
            self._begin_second_run(state)
            self._rebuild()
        self._on_view()

    def _set_view(self, state: State) -> None:
        self.stage.show(state.quantity, state.estimator, state.magnified)
        self._drawing.difference, self._drawing.domains = state.difference, state.domains
        self._scale.logarithmic = state.logarithmic
        self._scale.reset()

    def _begin_second_run(self, state: State) -> None:
        self._transport.show_second_run(state)
        self._session.set_frame_options(differences=state.difference, plotted=state.quantity)
        self._history.trace(state.traced)

    def restore(self, state: State) -> None:
        """Puts scene, second run and estimator of an earlier state back: of the same problem at the instant shown."""
        now, session = self.state, self._session
        if state.scene.problem != now.scene.problem:
            return self.show(state)
        with self._turn:
            session.set_scene_fields(**asdict(state.scene))
            if (state.compared, state.pinned) != (now.compared, now.pinned):
                session.unpin()
                self._transport.show_second_run(state)
            self.stage.show(self.stage.quantity, state.estimator or state.scene.first_estimator, self.stage.magnified)
            self._rebuild()
        self._on_view()

    def set_field_from_text(self, field: str, text: str, parse: Callable[[Scene], object]) -> None:
        """Sets a scene's field to ``parse(scene)``, for a lesson's button with this ``text``. Shows a refusal to the
        visitor if ``parse`` raises ValueError or the field does not allow the value."""
        with self._turn:
            scene = self._session.scene
            try:
                value = parse(scene)
            except ValueError:
                value = None
            if value is None or (scene.choices(field) and value not in scene.choices(field)):
                self._session.refuse(tr("{said}: not of the {problem}; press On the stage first", said=text,
                                        problem=tr(scene.TITLE)))
                return
            self._session.set_scene_fields(**{field: value}, **({"dt": None} if field == "cfl" else {}))
            self._rebuild()

    def show_error(self, quantity: str = "", estimator: str = "") -> None:
        """Colours the stage by a quantity's error ("x"), or by an estimator's errors; refuses one that does not run."""
        with self._turn:
            if quantity:
                self.stage.show_quantity(quantity)
            elif estimator in self._session.scene.estimators:
                self.stage.show_estimator(estimator)
            else:
                self._session.refuse(tr("{estimator} does not run here; press On the stage first", estimator=estimator))

    def press(self, name: str) -> None:
        """Acts like a click on a playback button by its English label: "Play", "Pause", "Step" or "Reset"."""
        self._transport.acts[name]()

    def next_method(self) -> None:
        """Switches the scene to the problem's next MPM method that is valid with its other settings."""
        with self._turn:
            methods = self._session.scene.choices("method")
            at = methods.index(self._session.scene.method)
            for method in (*methods[at + 1:], *methods[:at]):
                self._session.set_scene_fields(method=method)
                if self._session.scene.method == method:
                    return self._rebuild()

    @property
    def choice(self) -> ViewChoice:
        stage, drawn = self.stage, self._drawing
        return ViewChoice(stage.quantity, stage.estimator, drawn.difference, drawn.domains, stage.magnified,
                          self._history.latest)

    @property
    def state(self) -> State:
        """The state that the visitor sees."""
        session, stage, first = self._session, self.stage, self._session.scene.first_estimator
        speed = VIEWS[session.scene.problem].speed
        return State(session.scene, stage.quantity, stage.estimator if stage.estimator != first else None,
                     self._drawing.difference, stage.magnified, self._scale.logarithmic, self._drawing.domains,
                     session.speed if session.speed != speed else None, self._history.traced_particle,
                     session.stops_at_end, session.pinned.follows if session.pinned else None, session.pinned_scene)

    def _rebuild(self) -> None:
        """Rebuilds the widgets for the session's present scene."""
        self.problem.value = tr(self._session.scene.TITLE)  # type: ignore[misc]  # already chosen: this triggers nothing
        self._transport.show()
        self._bound.disable_callbacks()
        self._widgets.remove()
        with self._parent:
            self._build()

    def _choose_problem(self) -> None:
        """Puts the first scene of the problem chosen in the dropdown on the stage, if that is another problem."""
        if self.problem.value != tr(self._session.scene.TITLE):
            kind = next(problem.scene for problem in PROBLEMS.values() if tr(problem.scene.TITLE) == self.problem.value)
            self.load(first_scene(kind.problem), rests=not self._session.playing)

    def _build(self) -> None:
        self._widgets = self._gui.add_folder(None)  # without a label: only a container, to remove all at once
        self._folds: dict[str, viser.GuiHtmlHandle] = {}
        with self._widgets:
            self._run.build(self._gui, self._add_part)
            with self._add_part("estimators"):
                self.estimator_cards.build(self._gui)
                self._build_extension("estimators")
            with self._add_part("slow-motion"):
                self._build_extension("slow-motion")
            with self._add_folder("look", tr("Look"), "estimators", "colours", "trace", "domains", "magnify"):
                self._drawing.build(self._gui, self._add_part)
            with self._add_folder("physics", tr("Physics and method"), "motion", "modulus", "details", "effects"):
                self._build_physics()

    def _build_physics(self) -> None:
        """Builds the widgets for motion, material, method details, remedies and effects."""
        view, scene = VIEWS[self._session.scene.problem], self._session.scene
        with self._add_part("motion"):
            self._bound.add_motion_dropdown(self._on_motion)
            if view.formula and scene.swings:
                self._bound.add_formula(*view.formula)
        with self._add_part("modulus"):
            self._bound.add_sliders(view.material)
        with self._add_part("details"), self._add_fold("details", tr("Method details and remedies")):
            for field, hint in view.details.items():
                if field != "body_force" or scene.swings:
                    self._bound.add_field(field, hint)
            self._gui.add_html(f"<div class='lab-group'>{tr('Remedies for long and large motions')}</div>")
            self._bound.add_checkboxes("remedies", REMEDIES)
        with self._add_part("effects"), self._add_fold("effects", tr("What is computed")):
            self._bound.add_checkboxes("effects", ALL)

    def _on_entered(self, said: Any) -> None:
        """Applies the text that a visitor has finished typing: the browser sends the field's widget id and the text."""
        match said:
            case [str() as widget, str() as text]:
                for bound in (self._bound, self._lasting, self.of_body):
                    bound.apply_entered_text(widget, text)

    def _build_extension(self, control: str) -> None:
        if build := self._extensions.get(control):
            build()

    def _add_part(self, control: str) -> viser.GuiFolderHandle:
        return self._gui.add_folder(None, visible=not self._offered or control in self._offered)

    def _add_folder(self, name: str, label: str, *controls: str) -> viser.GuiFolderHandle:
        """Returns a collapsible folder for controls of lessons; without a label if a lesson shows only a few."""
        if self._offered:
            return self._gui.add_folder(None, visible=not {*controls}.isdisjoint(self._offered))
        return self._add_fold(name, label)

    def _add_fold(self, name: str, label: str) -> viser.GuiFolderHandle:
        """Returns a collapsible folder with a summary of its settings beside its ``label``."""
        self._folds[name] = add_widget_marker(self._gui, words=self._folder_summaries()[name])
        return self._gui.add_folder(label, expand_by_default=False)

    def _folder_summaries(self) -> dict[str, str]:
        """Returns a summary of each collapsible folder's settings, shown to the right of its name."""
        scene = self._session.scene
        remedies = ", ".join(tr(REMEDIES[name].label) for name in scene.remedies)
        return {"look": self._drawing.summary, "physics": remedies or tr("motion, remedies, effects"),
                "details": remedies or tr("none"),
                "effects": tr("{n} of {all}", n=len(scene.effects), all=len(scene.choices("effects")))}

    def _on_motion(self, changed: Scene, quantity: str | None, speed: float | None) -> None:
        """Puts a scene with another motion on the stage; for None with the present quantity and the usual speed."""
        self.show(State(changed, quantity or self.stage.quantity, magnified=self.stage.magnified, speed=speed,
                        logarithmic=self._scale.logarithmic))

    def refresh(self) -> None:
        """Updates the widgets from the session, and the summaries beside the folders."""
        with self._turn:
            self._history.refresh()
            self._transport.refresh()
            self._run.refresh()
            says = self._folder_summaries()
            for fold, handle in self._folds.items():
                handle.content = widget_marker_html(words=says[fold])
        self._answers.refresh(self._session.compiling)
