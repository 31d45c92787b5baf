"""The methods as radio buttons, each with a picture of its shape function."""

from html import escape
from typing import Any

import numpy as np
import viser

from app.language.translation import lazy, tr
from app.names_and_units import METHODS, MethodName, choice_labels
from app.page.panels.browser_store_and_window import BrowserStore
from app.page.panels.scene_widgets import SceneWidgetFactory
from app.page.visit.run_session import RunSession
from solvers.scene.step_bound import stencil

REACH = 1.6  # cells at either side of the node
POINTS = 81
WIDTH, HEIGHT = 44.0, 22.0  # of a picture, in svg units
HALF_WIDTH = 0.125  # of a particle at rest, in cells: four in each
STRETCHED = 0.32  # of a stretched one, for methods whose domains deform: wide enough to be visible
FOLLOWS = ("cpgimp", "cpgimp-v", "cpdi")
NAMES = {"mpm": lazy("hat")}  # where the picture has another name than the method


class MethodTiles:
    """One visitor's choice of the method; ``js/judges.js`` sends the one that is clicked."""

    def __init__(self, session: RunSession, bound: SceneWidgetFactory, store: BrowserStore):
        self._session, self._bound = session, bound
        store.heard["method"] = self._choose

    def build(self, gui: viser.GuiApi) -> None:
        """Builds the buttons for the methods of the session's problem."""
        self._names = choice_labels(type(self._session.scene), "method")
        self._shown = self._session.scene.method
        self._html = gui.add_html(method_tiles(self._names, self._shown))

    def refresh(self) -> None:
        """Marks the method of the session's scene, if it has changed."""
        if self._shown != self._session.scene.method:
            self._shown = self._session.scene.method
            self._html.content = method_tiles(self._names, self._shown)

    def _choose(self, method: Any) -> None:
        """Switches to the method (key) that the visitor has clicked."""
        with self._bound.turn:
            if isinstance(method, str) and method in self._names:
                self._bound.apply_or_reset(self._html, lambda: self._session.set_scene_fields(method=method),
                                           lambda: None)
                self.refresh()


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


def method_tiles(names: dict[str, str], chosen: str) -> str:
    """Returns html of a radio button for each method, by key with its name, the ``chosen`` one checked."""
    def short_name(method: str) -> str:
        return tr(NAMES[method]) if method in NAMES else (METHODS[method].name if method in METHODS else method)

    buttons = (f"<button type='button' role='radio' class='lab-method' data-method='{escape(method)}' "
               f"aria-checked='{'true' if method == chosen else 'false'}' tabindex='{0 if method == chosen else -1}' "
               f"aria-label='{escape(name)}' title='{escape(str(METHODS.get(method) or MethodName(method)))}'>"
               f"{_shape_function_svg(method)}{escape(short_name(method))}</button>" for method, name in names.items())
    return f"<div class='lab-methods' role='radiogroup' aria-label='{tr('Method')}'>{''.join(buttons)}</div>"


def _shape_function_svg(method: str) -> str:
    if method not in METHODS:
        return ""
    at, weight = shape_function_curve(method)
    points = " ".join(f"{(x / REACH + 1) / 2 * WIDTH:.1f},{HEIGHT - 3 - (HEIGHT - 6) * w:.1f}"
                      for x, w in zip(at, weight, strict=True))
    return f"<svg viewBox='0 0 {WIDTH:.0f} {HEIGHT:.0f}' aria-hidden='true'><polyline points='{points}'/></svg>"
