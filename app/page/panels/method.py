"""The method, as a dropdown and as pictures of what it is: the weight that a particle has at a node, over its place."""

from html import escape

import numpy as np

from app.language.spoken import later, tr
from app.words import METHODS, Method
from solvers.scene.step_bound import stencil

REACH = 1.6  # cells at either side of the node
POINTS = 81
WIDTH, HEIGHT = 44.0, 22.0  # of a picture, in its own units
HALF_WIDTH = 0.125  # of a particle at rest, in cells: four in each
STRETCHED = 0.32  # of one that is stretched, for methods whose particles follow the motion: wide enough to be seen
FOLLOWS = ("cpgimp", "cpgimp-v", "cpdi")
NAMES = {"mpm": later("hat")}  # where the picture has another name than the method


def weights(method: str) -> tuple[np.ndarray, np.ndarray]:
    """Places (S,) in cells from a node, and the weight (S,) there of a particle of a method. CPDI takes the hat at the
    corners of its domain, the other methods that average do so over the whole of it."""
    at = np.linspace(-REACH, REACH, POINTS)
    half = np.full_like(at, STRETCHED if method in FOLLOWS else HALF_WIDTH)
    if method == "cpdi":
        return at, 0.5 * (_weight("mpm", at - half, half) + _weight("mpm", at + half, half))
    return at, _weight(method, at, half)


def _weight(method: str, at: np.ndarray, half_width: np.ndarray) -> np.ndarray:
    """Of the node at 0."""
    first, values, _ = stencil(method.removesuffix("-v"), at, half_width)
    here = np.clip(-first, 0, 2)
    return np.where((first <= 0) & (first > -3), values[np.arange(len(at)), here], 0.0)


def pictures(methods: tuple[str, ...], chosen: str) -> str:
    """Html of a picture for each method, the ``chosen`` one marked. For pointers only: who hears the page, or has keys,
    takes the dropdown above, which says the same."""
    return "<div class='lab-methods' aria-hidden='true'>" + "".join(
        f"<span class='lab-method{' lab-chosen' * (method == chosen)}' data-method='{escape(method)}' "
        f"title='{escape(str(METHODS.get(method) or Method(method)))}'>{_curve(method)}{escape(_name(method))}</span>"
        for method in methods) + "</div>"


def _name(method: str) -> str:
    return tr(NAMES[method]) if method in NAMES else (METHODS[method].name if method in METHODS else method)


def _curve(method: str) -> str:
    if method not in (*METHODS,):
        return ""
    at, weight = weights(method)
    points = " ".join(f"{(x / REACH + 1) / 2 * WIDTH:.1f},{HEIGHT - 3 - (HEIGHT - 6) * w:.1f}"
                      for x, w in zip(at, weight, strict=True))
    nodes = "".join(f"<circle cx='{(x / REACH + 1) / 2 * WIDTH:.1f}' cy='{HEIGHT - 3:.0f}' r='1.5'/>"
                    for x in (-1, 0, 1))
    return f"<svg viewBox='0 0 {WIDTH:.0f} {HEIGHT:.0f}'><polyline points='{points}'/>{nodes}</svg>"
