"""Widgets of the run: method, cells, particles, amplitude, modulus, step."""

from collections.abc import Callable

import viser

from app import names_and_units
from app.language.translation import tr
from app.names_and_units import with_unit
from app.page.panels.browser_store_and_window import BrowserStore
from app.page.panels.log_number_slider import LogNumberSlider, SliderSpec
from app.page.panels.method_tiles import MethodTiles
from app.page.panels.page_header import add_widget_marker, widget_marker_html
from app.page.panels.scene_widgets import SceneWidgetFactory
from app.page.visit.landscapes import CFL
from app.page.visit.run_session import RunSession
from app.problems.views import VIEWS
from solvers.scene.scene import AUTO, DEFAULT_CFL
from solvers.scene.step_bound import SAFE


class SimulationParameterWidgets:
    """One visitor's widgets for method, cells, particles, amplitude, modulus and time step, made by ``bound``."""

    def __init__(self, session: RunSession, bound: SceneWidgetFactory, store: BrowserStore):
        self._session, self._bound, self._methods = session, bound, MethodTiles(session, bound, store)

    def build(self, gui: viser.GuiApi, part: Callable[[str], viser.GuiFolderHandle]) -> None:
        """Builds the widgets for the session's scene; ``part`` returns the folder for a control of lessons (name)."""
        session, scene, view = self._session, self._session.scene, VIEWS[self._session.scene.problem]
        default = type(scene)()
        gui.add_html(f"<h2 class='lab-h2'>{tr('Change the run')}<small>{tr('takes effect at once')}</small></h2>")
        with part("method"):
            self._methods.build(gui)
        with part("cells"):
            self._build_cells(gui)
        with part("ppc"):
            low, high = view.slider_ranges.ppc
            step, hint = (1, tr("in each direction")) if scene.swings else (0.5, tr("need not be whole here"))
            add_widget_marker(gui, words=tr("how fine the body is"))
            per_cell = gui.add_slider(tr("Particles / cell"), low, max(high, scene.ppc), step, scene.ppc, hint=hint)
            self._bound.on_change_or_reset(per_cell, lambda count: session.set_scene_fields(ppc=count))
        if "amplitude" in scene.motion_fields:
            with part("amplitude"):
                amplitude = SliderSpec(tr("Amplitude A"), names_and_units.unit_of(type(scene), "amplitude"),
                                       view.slider_ranges.amplitude, default.amplitude, tr(view.amplitude_hint),
                                       tr("how far it swings"))
                LogNumberSlider(gui, self._bound, amplitude, scene.amplitude,
                                lambda value: session.set_scene_fields(amplitude=value))
        elif view.motion and not scene.swings:
            with part("stretch"):
                self._bound.add_sliders(view.motion.sliders)
        with part("modulus"):
            modulus = SliderSpec(tr("Modulus E"), "Pa", view.slider_ranges.modulus, default.modulus,
                                 tr(view.modulus_hint), tr("how stiff it is"))
            LogNumberSlider(gui, self._bound, modulus, scene.modulus,
                            lambda value: session.set_scene_fields(modulus=value))
        with part("step"):
            self._build_time_step(gui)

    def _build_cells(self, gui: viser.GuiApi) -> None:
        scene = self._session.scene
        across = scene.cells * scene.spacing

        def label(count: int) -> str:
            return tr("Cells, h = {across:g}/{count}", across=across, count=count)

        def size(count: int) -> str:
            return tr("{size} each", size=with_unit(across / count, "m", 3))

        low, high, step = VIEWS[scene.problem].slider_ranges.cells
        high = max(high, scene.cells)  # of a scene that was loaded
        words_beside = add_widget_marker(gui, words=size(scene.cells))
        cells = gui.add_slider(label(scene.cells), low, high, step, scene.cells,
                               hint=tr("grid cells across {across:g} m", across=across))

        def on_cells(count: int) -> None:
            cells.label, words_beside.content = label(count), widget_marker_html(words=size(count))
            self._session.set_scene_fields(cells=count)

        self._bound.on_change_or_reset(cells, on_cells)

    def _build_time_step(self, gui: viser.GuiApi) -> None:
        """Builds a slider for the CFL number and a checkbox for an automatic time step, which the slider shows too."""
        session, scene = self._session, self._session.scene

        def by_hand(cfl: float) -> None:
            self._auto.value = False  # type: ignore[misc]
            session.set_scene_fields(cfl=cfl, dt=None)

        def automatic(wanted: bool) -> None:
            if wanted:
                session.set_scene_fields(cfl=None, dt=AUTO)
            else:  # the step stays as it was
                by_hand(float(f"{session.scene.courant_number:.3g}"))

        add_widget_marker(gui, "lab-auto")
        self._auto = gui.add_checkbox(tr("Auto step"), scene.dt == AUTO, hint=tr(
            "take {safe:g} of the longest stable step along the motion, by linear theory; the slider shows it",
            safe=SAFE))
        self._shown_step = scene.courant_number
        self._step_size = LogNumberSlider(gui, self._bound,
                                          SliderSpec(tr("CFL number"), "", CFL, DEFAULT_CFL,
                                                     tr("time step as a share of the time a wave takes through a cell"),
                                                     tr("time step")),
                                          scene.courant_number, by_hand)
        self._bound.on_change_or_reset(self._auto, automatic)

    def refresh(self) -> None:
        """Shows the automatic time step and the method of the session's scene, if they have changed."""
        scene = self._session.scene
        if scene.dt == AUTO and scene.courant_number != self._shown_step:
            self._shown_step = scene.courant_number
            self._step_size.show(scene.courant_number)
        self._methods.refresh()
