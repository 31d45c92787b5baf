"""Patch test of the bar: evenly stretched and moving at constant speed, so that nothing should change.

A bar of rest length 1/F0 is stretched by F0 until it fills the periodic metre, and moves at v0: the stress stays
E (F0 - 1), the acceleration zero, whatever the grid. Particles are evenly spaced, with any number per cell: with a
whole number each cell always contains equally many, and errors of a method at cell boundaries cancel.

The reference configuration of solver and exact solution is the stretched bar, in which X is the start of a particle:
with the deformation G = F/F0 since then, the stress is E F0 (G - 1/F0), the density rho/F0, and all else as in a bar at
rest. So a scene has the solver's modulus, density and deformation at rest; F0 = 1 for a vibrating bar.

Source: Bardenhagen & Kober (2004) for hats and GIMP; Steffen, Kirby & Berzins (2008) for B-splines.
"""

import functools
import math
from typing import Any

import numpy as np

from solvers.scene.derived_quantities import MOST_PER_CELL
from solvers.scene.scene import Scene
from solvers.scene.stabilisations import PIECES
from solvers.scene.validation import SceneError, require_number
from solvers.translatable_message import Message, join_messages

VIBRATE, PATCH = "vibrate", "patch"
STRETCH, VELOCITY = 1.02, 1.0  # defaults of F0, and v0 in m/s
STRETCHES = (0.1, 10.0)
LEAST_STRAIN = 1e-6  # below it round-off is not small beside the stress
MOST_VELOCITY = 1000.0  # m/s
COUNT_TOLERANCE = 1e-6  # of a particle, by which their number may miss a whole one: 2.3333333 is 7/3
NOTHING_TO_SEARCH = Message("a search makes no sense for a patch test: its error is round-off, or does not fall with "
                            "the cells; compare methods with mpm-lab sweep bar --motion patch")
EDGE_TOLERANCE = 1e-10  # cells
MOST_EDGE_STEPS = 10_000  # that are searched ahead
FAILED_FROM = 0.1  # of the stress: an error beyond which a patch test counts as failed


def normalise_inputs(cells: object, ppc: object, body_force: object) -> dict[str, Any]:
    """Returns by field name those inputs of a patch test that its normal form changes: body_force is "none" for the
    default; a float ppc is a fraction with a whole total (2.3333333 in each of 30 cells: 70/30), or an int (4.0: 4)."""
    meant: dict[str, Any] = {"body_force": "none"} if body_force == "material" else {}
    if isinstance(ppc, float) and math.isfinite(ppc) and type(cells) is int and cells > 0:
        count = round(cells * ppc)
        if abs(cells * ppc - count) <= COUNT_TOLERANCE:
            meant["ppc"] = count // cells if count % cells == 0 else count / cells
    return meant


def check_particles_per_cell(cells: int, ppc: object) -> None:
    """Raises :class:`SceneError` unless ``ppc`` is from 1 to 64, perhaps a fraction, and ``cells`` times it whole."""
    allowed = Message("give a number from 1 to {most}", MOST_PER_CELL)
    require_number("ppc", ppc, 0, math.inf, allowed)
    assert isinstance(ppc, (int, float))
    if not 1 <= ppc <= MOST_PER_CELL:
        raise SceneError("ppc", ppc, allowed)
    count = cells * ppc
    if abs(count - round(count)) > COUNT_TOLERANCE:
        below, above = math.floor(count), math.ceil(count)
        nearest = [f"{number / cells:.7g} ({number})" for number in (below, above)
                   if cells <= number <= MOST_PER_CELL * cells]
        raise SceneError("ppc", ppc, "{cells} cells would hold {count:.7g} particles, and they must be a whole number; "
                         "give {nearest}, or other cells", cells, count, join_messages(" or ", nearest))


def check_stretch_and_velocity(stretch: float, velocity: float) -> None:
    """Raises :class:`SceneError` for a stretch (no unit) or a velocity in m/s that no patch test can have."""
    least, most = STRETCHES
    allowed = Message("give a number from {least:g} to {most:g}, but not 1", least, most)
    require_number("stretch", stretch, 0, math.inf, allowed)
    if not least <= stretch <= most:
        raise SceneError("stretch", stretch, allowed)
    if abs(stretch - 1) < LEAST_STRAIN:
        raise SceneError("stretch", stretch, "leaves the bar without stress, so that the test could not fail; "
                         "{allowed}", allowed)
    require_number("initial_velocity", velocity, -math.inf, math.inf,
                   allowed := Message("give a number from {least:g} to {most:g}", -MOST_VELOCITY, MOST_VELOCITY))
    if abs(velocity) > MOST_VELOCITY:
        raise SceneError("initial_velocity", velocity, allowed)


def check_inputs_fit_motion(scene: Any) -> None:
    """Raises :class:`SceneError` for inputs of a bar's scene without meaning in its motion, patch test or vibration."""
    names: tuple[str, ...] = ("stretch", "initial_velocity")
    why = Message("is for the patch test; give motion patch, or leave it out")
    if scene.is_patch:
        names = ("amplitude", "body_force", "displacement")
        why = Message("means nothing in a patch test (motion patch), in which nothing vibrates and no force acts; "
                      "leave it out")
    for name in names:
        if getattr(scene, name) != ("none" if name == "body_force" else getattr(type(scene), name)):
            raise SceneError(name, getattr(scene, name), why)


def repeating_unit(scene: Scene) -> tuple[int, int]:
    """Returns the smallest number of cells after which the pattern of particles repeats, and the particles in them."""
    times = math.gcd(scene.cells, scene.particles)
    return scene.cells // times, scene.particles // times


@functools.lru_cache(maxsize=64)  # used by the page repeatedly
def first_edge_step(scene: Scene, velocity: float) -> int | None:
    """Returns the first step after which a particle moving at ``velocity`` in m/s lies on a cell boundary up to
    rounding, which then decides its cell: with hat functions its force may count twice or not at all. None if never."""
    a_step = velocity * scene.time_step / scene.spacing  # in cells
    places = repeating_unit(scene)[1]  # in a cell, at which particles begin
    held = scene.linearity_preserving or scene.frozen or PIECES in scene.remedies
    if scene.method != "mpm" or held or not a_step or places > MOST_PER_CELL:
        return None
    starts = (np.arange(places) + 0.5) / scene.ppc % 1
    after = starts + a_step * np.arange(1, min(scene.steps, MOST_EDGE_STEPS) + 1)[:, None]
    on_edge = (np.abs(after - np.round(after)) < EDGE_TOLERANCE).any(axis=1)
    return int(np.argmax(on_edge)) + 1 if on_edge.any() else None
