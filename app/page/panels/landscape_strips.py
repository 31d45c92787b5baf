"""Strips under the sliders of a run: its error and its time over each parameter (``js/landscape.js`` draws them)."""

import json
import math
from collections.abc import Callable, Mapping
from html import escape
from threading import RLock
from typing import Any

import viser

from app.colour_palette import ESTIMATE
from app.language.translation import tr
from app.names_and_units import format_number, with_unit
from app.page.panels.browser_store_and_window import BrowserStore
from app.page.panels.log_number_slider import LogNumberSlider, SliderSpec
from app.page.panels.page_header import widget_marker_html
from app.page.panels.readout_tables import TRUE, line_sample, line_svg
from app.page.panels.scene_widgets import SceneWidgetFactory
from app.page.visit.landscapes import Landscapes
from app.page.visit.run_session import RunSession
from app.viewer.widget_validation import is_number_between
from solvers.engine.engine_messages import FrameReport
from solvers.scene.estimator_registry import ESTIMATORS
from solvers.scene.scene import Scene
from solvers.study.landscape.landscape import Landscape

PARAMETERS = ("cells", "ppc", "amplitude", "modulus", "cfl")
DIGITS = 4  # of the numbers in a strip


class LandscapeStrips:
    """Strips of one visitor: the ``landscapes`` of the session's scene, for the quantity and the estimator on the
    stage, as returned by ``on_stage``; requested while the browser shows any strip. While one thread has its ``turn``
    no other changes widgets."""

    def __init__(self, gui: viser.GuiApi, session: RunSession, landscapes: Landscapes, store: BrowserStore,
                 turn: RLock, on_stage: Callable[[], tuple[str, str | None]]):
        self._session, self._landscapes, self._turn, self._on_stage = session, landscapes, turn, on_stage
        # One element for all rows, that stays: a browser reports an error if, of one that it removes, news come.
        self._html = gui.add_html("")
        self._sliders: dict[str, LogNumberSlider] = {}
        self._seen, self._hand, self._held = False, None, False
        self._until = 0.0  # the instant on the stage, in periods
        store.heard["strips"] = self._on_hand
        store.heard["point"] = self._on_point

    def build_heading(self, gui: viser.GuiApi) -> None:
        """Builds the panel's heading with the legend of the strips, and forgets the strips of sliders built before."""
        self._sliders = {}
        gui.add_html(heading_html())

    def add(self, gui: viser.GuiApi, bound: SceneWidgetFactory, parameter: str, size: SliderSpec, value: float,
            act: Callable[[float], None]) -> LogNumberSlider:
        """Adds a slider for one of the ``PARAMETERS`` with a strip under it; arguments as of ``LogNumberSlider``."""
        def act_and_request(value: float) -> None:
            before = self._session.scene
            act(value)
            if self._session.scene is not before and not self._session.playing:  # not only when its frame comes
                self._until = self._session.first_instant
                self.refresh()

        gui.add_html(widget_marker_html("lab-logarithmic", "lab-row", parameter=parameter))
        self._sliders[parameter] = slider = LogNumberSlider(gui, bound, size, value, act_and_request)
        self._show({})
        return slider

    def follow(self, report: FrameReport) -> None:
        """Requests the landscapes of the session's scene until the instant of a frame, and shows what is known."""
        self._until = report.time / report.scene.period
        self.refresh()

    def refresh(self) -> None:
        """Requests the landscapes of the scene until the instant of the last frame, and shows what is known."""
        with self._turn:
            quantity, estimator = self._on_stage()
            if self._seen:
                self._landscapes.request(self._hand, self._until, quantity, estimator, held=self._held)
            self._show(self._landscapes.curves() if self._seen else {})

    def _show(self, curves: Mapping[str, Landscape]) -> None:
        """Sends what the rows show, with the landscapes that are known by parameter."""
        line = line_of(self._on_stage()[1])
        rows = {parameter: row_data(parameter, slider.size, self._session.scene, line, curves.get(parameter))
                for parameter, slider in self._sliders.items()}
        said = json.dumps(rows, separators=(",", ":"))
        content = f"<i class='lab-landscapes' data-said='{escape(said)}'></i>"
        if self._html.content != content:
            self._html.content = content

    def _on_hand(self, said: Any) -> None:
        """Notes whether the browser shows any strip, which slider is in the visitor's hand, and whether it is held."""
        if isinstance(said, dict):
            hand = said.get("hand")
            self._hand = hand if hand in PARAMETERS else None
            self._seen, self._held = said.get("seen") is True, said.get("held") is True

    def _on_point(self, said: Any) -> None:
        """Sets a slider to a point of its strip, which the visitor has clicked or reached by a key."""
        match said:
            case [str() as parameter, value] if parameter in self._sliders and is_number_between(value, 1e-12, 1e12):
                self._sliders[parameter].choose(float(value))


def line_of(estimator: str | None) -> tuple[str, tuple[int, ...]]:
    """Returns the colour, as CSS, and the dashes in pixels of an estimator's line."""
    known = ESTIMATORS.get(estimator or "")
    return (f"var(--{known.name.replace('-', '')}, {known.colour})", known.dashes) if known else (ESTIMATE, ())


def heading_html() -> str:
    """Returns the heading of the rows, with a legend of the lines in the strips; the browser draws the estimate's."""
    lines = (tr(TRUE), line_sample(TRUE)), (tr("estimate"), line_svg(ESTIMATE)), (tr("time"), line_svg("var(--time)"))
    legend = "".join(f"<span>{sample} {escape(word)}</span>" for word, sample in lines)
    return f"<h2 class='lab-h2'>{tr('Change the run')}<small class='lab-legend'>{legend}</small></h2>"


def words_beside(parameter: str, scene: Scene) -> str:
    """Returns the words beside the name of a parameter: the cells' size, the time step in s, or what it is."""
    match parameter:
        case "cells":
            return f"h = {with_unit(scene.spacing, 'm')}"
        case "cfl":
            return f"CFL {format_number(scene.courant_number)} = {with_unit(scene.time_step, 's')}"
        case "ppc":
            return tr("how fine the body is")
        case "amplitude":
            return tr("how far it swings")
    return ""


def row_data(parameter: str, size: SliderSpec, scene: Scene, line: tuple[str, tuple[int, ...]],
             landscape: Landscape | None) -> dict[str, Any]:
    """Returns all that the browser needs for the row of a slider, as for json; ``line`` as of :func:`line_of`."""
    colour, dashes = line
    row: dict[str, Any] = {"words": words_beside(parameter, scene), "unit": size.unit, "multiple": size.multiple,
                           "line": [colour, " ".join(map(str, dashes))]}
    if parameter == "modulus":
        row["keeps"] = "dt" if isinstance(scene.dt, float) else "cfl"
    if landscape:
        row |= {"v": list(landscape.values), "true": _rounded(landscape.true), "est": _rounded(landscape.estimated),
                "sec": _rounded(landscape.seconds), "state": list(landscape.status), "flat": landscape.flat,
                "cross": landscape.first_crossing, "bound": landscape.step_bound, "complete": landscape.complete}
    return row


def _rounded(numbers: tuple[float, ...]) -> list[float | None]:
    return [float(f"{number:.{DIGITS}g}") if math.isfinite(number) else None for number in numbers]
