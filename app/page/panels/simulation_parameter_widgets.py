"""Widgets of the run: method, cells, particles, amplitude, modulus, step."""

from collections.abc import Callable
from typing import Any

import viser

from app import names_and_units
from app.language.translation import tr
from app.page.panels.browser_store_and_window import BrowserStore
from app.page.panels.landscape_strips import LandscapeStrips
from app.page.panels.log_number_slider import SliderSpec
from app.page.panels.method_tiles import MethodTiles
from app.page.panels.page_header import add_widget_marker
from app.page.panels.scene_widgets import SceneWidgetFactory
from app.page.visit.landscapes import CFL
from app.page.visit.run_session import RunSession
from app.problems.views import VIEWS
from solvers.scene.scene import AUTO, DEFAULT_CFL
from solvers.scene.step_bound import SAFE


class SimulationParameterWidgets:
    """One visitor's widgets for method, cells, particles, amplitude, modulus and time step, made by ``bound``."""

    def __init__(self, session: RunSession, bound: SceneWidgetFactory, store: BrowserStore, strips: LandscapeStrips):
        self._session, self._bound, self._strips = session, bound, strips
        self._methods = MethodTiles(session, bound, store)
        store.heard["keep"] = self._keep

    def build(self, gui: viser.GuiApi, part: Callable[[str], viser.GuiFolderHandle]) -> None:
        """Builds the widgets for the session's scene; ``part`` returns the folder for a control of lessons (name)."""
        scene, view = self._session.scene, VIEWS[self._session.scene.problem]
        default, ranges = type(scene)(), view.slider_ranges
        self._strips.build_heading(gui)
        with part("method"):
            self._methods.build(gui)
        with part("cells"):
            across = scene.cells * scene.spacing
            low, high, step = ranges.cells
            self._build_row(gui, "cells", SliderSpec(tr("Cells"), "", (low, high), default.cells,
                                                     tr("grid cells across {across:g} m", across=across), step))
        with part("ppc"):
            multiple, hint = (1, tr("in each direction")) if scene.swings else (0.5, tr("need not be whole here"))
            self._build_row(gui, "ppc", SliderSpec(tr("Particles / cell"), "", ranges.ppc, default.ppc, hint, multiple))
        if "amplitude" in scene.motion_fields:
            with part("amplitude"):
                self._build_row(gui, "amplitude", SliderSpec(
                    tr("Amplitude A"), names_and_units.unit_of(type(scene), "amplitude"), ranges.amplitude,
                    default.amplitude, tr(view.amplitude_hint)))
        elif view.motion and not scene.swings:
            with part("stretch"):
                self._bound.add_sliders(view.motion.sliders)
        with part("modulus"):
            self._build_row(gui, "modulus", SliderSpec(tr("Modulus E"), "Pa", ranges.modulus, default.modulus,
                                                       tr(view.modulus_hint)))
        with part("step"):
            self._build_time_step(gui)

    def _build_row(self, gui: viser.GuiApi, field: str, size: SliderSpec) -> None:
        """Builds the slider of a scene's field, with the strip under it; whole multiples become whole numbers."""
        def act(value: float) -> None:
            self._session.set_scene_fields(**{field: int(value) if size.multiple and value == int(value) else value})

        self._strips.add(gui, self._bound, field, size, getattr(self._session.scene, field), act)

    def _build_time_step(self, gui: viser.GuiApi) -> None:
        """Builds a slider for the CFL number and a checkbox for an automatic time step, which the slider shows too."""
        def by_hand(cfl: float) -> None:
            self._auto.value = False  # type: ignore[misc]
            scene = self._session.scene
            if isinstance(scene.dt, float):  # it is kept in seconds
                self._session.set_scene_fields(cfl=None, dt=cfl * scene.spacing / scene.wave_speed)
            else:
                self._session.set_scene_fields(cfl=cfl, dt=None)

        scene = self._session.scene
        add_widget_marker(gui, "lab-auto")
        self._auto = gui.add_checkbox(tr("Auto step"), scene.dt == AUTO, hint=tr(
            "take {safe:g} of the longest stable step along the motion, by linear theory; the slider shows it",
            safe=SAFE))
        size = SliderSpec(tr("CFL number"), "", CFL, DEFAULT_CFL,
                          tr("time step as a share of the time a wave takes through a cell"))
        self._step = self._strips.add(gui, self._bound, "cfl", size, scene.courant_number, by_hand)
        self._bound.on_change_or_reset(self._auto, lambda wanted: self._keep(AUTO if wanted else "cfl"))

    def _keep(self, what: Any) -> None:
        """Keeps the CFL number ("cfl"), the time step in seconds ("dt") or an automatic step ("auto") when other
        settings change; the first two begin with the present step."""
        scene, session = self._session.scene, self._session
        with self._bound.turn:
            self._auto.value = what == AUTO  # type: ignore[misc]
            match what:
                case "auto":
                    session.set_scene_fields(cfl=None, dt=AUTO)
                case "dt":
                    session.set_scene_fields(cfl=None, dt=float(f"{scene.time_step:.12g}"))
                case "cfl":
                    session.set_scene_fields(cfl=float(f"{scene.courant_number:.3g}"), dt=None)

    def refresh(self) -> None:
        """Shows the time step and the method of the session's scene, if others have changed them."""
        scene = self._session.scene
        if scene.dt is not None and (number := float(f"{scene.courant_number:.3g}")) != self._step.value:
            self._step.show(number)
        self._methods.refresh()
