"""Widgets of the run: method, with a picture of its weights, cells, particles, amplitude, modulus, step."""

from collections.abc import Callable
from html import escape
from typing import Any

import numpy as np
import viser

from app import names_and_units
from app.language.translation import lazy, tr
from app.names_and_units import METHODS, MethodName
from app.page.panels.browser_store_and_window import BrowserStore
from app.page.panels.landscape_strips import LandscapeStrips
from app.page.panels.log_number_slider import SliderSpec
from app.page.panels.page_header import add_widget_marker
from app.page.panels.scene_widgets import SceneWidgetFactory
from app.page.visit.run_session import RunSession
from app.problems.views import VIEWS
from solvers.scene.scene import AUTO, DEFAULT_CFL
from solvers.scene.step_bound import SAFE, stencil

CFL = (0.01, 2.0)

# Pictures of methods:
REACH = 1.6  # cells at either side of the node
POINTS = 81
WIDTH, HEIGHT = 44.0, 22.0  # of a picture, in svg units
HALF_WIDTH = 0.125  # of a particle at rest, in cells: four in each
STRETCHED = 0.32  # of a stretched one, for methods whose domains deform: wide enough to be visible
FOLLOWS = ("cpgimp", "cpgimp-v", "cpdi")
NAMES = {"mpm": lazy("hat")}  # where the picture has another name than the method


class SimulationParameterWidgets:
    """One visitor's widgets for method, cells, particles, amplitude, modulus and time step, made by ``bound``."""

    def __init__(self, session: RunSession, bound: SceneWidgetFactory, store: BrowserStore, strips: LandscapeStrips):
        self._session, self._bound, self.strips = session, bound, strips
        store.heard["method"] = self._choose_method
        store.heard["keep"] = self._keep

    def build(self, gui: viser.GuiApi, part: Callable[[str], viser.GuiFolderHandle]) -> None:
        """Builds the widgets for the session's scene; ``part`` returns the folder for a control of lessons (name)."""
        scene, view = self._session.scene, VIEWS[self._session.scene.problem]
        default, ranges = type(scene)(), view.slider_ranges
        self.strips.build_heading(gui)
        with part("method"):
            self._build_method(gui)
        with part("cells"):
            across = scene.cells * scene.spacing
            self._build_row(gui, "cells", SliderSpec(tr("Cells"), "", ranges.cells[:2], default.cells,
                                                     tr("grid cells across {across:g} m", across=across), 1))
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
        """Builds the slider of a scene's field, with the strip under it; a field with a ``multiple`` of 1 is whole."""
        def act(value: float) -> None:
            self._session.set_scene_fields(**{field: int(value) if size.multiple and value == int(value) else value})

        self.strips.add(gui, self._bound, field, size, getattr(self._session.scene, field), act)

    def _build_method(self, gui: viser.GuiApi) -> None:
        scene = self._session.scene
        self._names = names_and_units.choice_labels(type(scene), "method")
        codes = {name: code for code, name in self._names.items()}
        self._shown_method = gui.add_dropdown(
            tr("Method"), tuple(codes), initial_value=self._names[scene.method],
            hint=tr("shape functions that carry data between particles and grid"))
        self._pictured = scene.method
        self._pictures = gui.add_html(method_pictures(tuple(self._names), scene.method))
        self._bound.on_change_or_reset(self._shown_method,
                                       lambda name: self._session.set_scene_fields(method=codes[name]))

    def _choose_method(self, method: Any) -> None:
        """Switches to the method (key) whose picture the visitor has clicked."""
        with self._bound.turn:
            if isinstance(method, str) and method in self._names and self._shown_method.visible:
                self._shown_method.value = self._names[method]  # type: ignore[misc]
                self._bound.apply_or_reset(
                    self._shown_method, lambda: self._session.set_scene_fields(method=method),
                    lambda: setattr(self._shown_method, "value", self._names[self._session.scene.method]))

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
        self._step = self.strips.add(gui, self._bound, "cfl", size, scene.courant_number, by_hand)
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
        if scene.dt is not None and (number := float(f"{scene.courant_number:.3g}")) != self._step.shown_value:
            self._step.show(number)
        if scene.method != self._pictured:
            self._pictured = scene.method
            self._pictures.content = method_pictures(tuple(self._names), scene.method)


def shape_function_curve(method: str) -> tuple[np.ndarray, np.ndarray]:
    """Returns particle positions (S,) relative to a node, in cells, and the node's weights (S,) for a particle at each,
    for a method by its key."""
    at = np.linspace(-REACH, REACH, POINTS)
    half = np.full_like(at, STRETCHED if method in FOLLOWS else HALF_WIDTH)
    if method == "cpdi":
        left, right = (_shape_function_values("mpm", at + side * half, half) for side in (-1, 1))
        return at, 0.5 * (left + right)
    return at, _shape_function_values(method, at, half)


def _shape_function_values(method: str, at: np.ndarray, half_width: np.ndarray) -> np.ndarray:
    """Returns the weights (S,) of the node at 0 for particles at positions ``at`` (S,), all in cells."""
    first, values, _ = stencil(method.removesuffix("-v"), at, half_width)
    here = np.clip(-first, 0, 2)
    return np.where((first <= 0) & (first > -3), values[np.arange(len(at)), here], 0.0)


def method_pictures(methods: tuple[str, ...], chosen: str) -> str:
    """Returns html with a picture of each method's shape function, the ``chosen`` one marked; methods are keys."""
    def name(method: str) -> str:
        return tr(NAMES[method]) if method in NAMES else (METHODS[method].name if method in METHODS else method)

    pictures = (f"<span class='lab-method{' lab-chosen' * (method == chosen)}' data-method='{escape(method)}' "
                f"title='{escape(str(METHODS.get(method) or MethodName(method)))}'>"
                f"{_shape_function_svg(method)}{escape(name(method))}</span>" for method in methods)
    return f"<div class='lab-methods' aria-hidden='true'>{''.join(pictures)}</div>"


def _shape_function_svg(method: str) -> str:
    if method not in METHODS:
        return ""
    at, weight = shape_function_curve(method)
    points = " ".join(f"{(x / REACH + 1) / 2 * WIDTH:.1f},{HEIGHT - 3 - (HEIGHT - 6) * w:.1f}"
                      for x, w in zip(at, weight, strict=True))
    nodes = "".join(f"<circle cx='{(x / REACH + 1) / 2 * WIDTH:.1f}' cy='{HEIGHT - 3:.0f}' r='1.5'/>"
                    for x in (-1, 0, 1))
    return f"<svg viewBox='0 0 {WIDTH:.0f} {HEIGHT:.0f}'><polyline points='{points}'/>{nodes}</svg>"
