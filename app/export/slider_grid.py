"""The runs of a file: a grid of scenes around one, so that sliders work without a solver."""

import itertools
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

from app import shareable_state
from app.language.translation import tr
from app.lessons.markdown_html import FIELDS, SENTENCES
from app.names_and_units import METHODS as NAMES
from app.problems.views import VIEWS
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError

#: Factors on the scene's value, tried in this order until enough are valid.
CELLS = (1.0, 0.5, 2.0, 4.0, 0.25, 1.5, 3.0)
AMPLITUDES = (1.0, 0.1, 2.0, 4.0, 0.5, 0.25)
RING_CELLS = (1.0, 0.5, 1.5, 0.75, 1.25, 2.0)  # in 2D doubling the cells quadruples the particles
METHODS = ("cpdi", "ugimp", "mpm", "bspline", "cpgimp")  # in order of interest
FULL = {"cells": 5, "amplitude": 4, "method": 3}  # numbers of values: sixty runs
#: Names of controls in a lesson's text, with their fields.
CONTROLS = {name: field for name, field in FIELDS.items() if field != "body_force"}
MOST_WORK = 1.5e8  # particle-steps of an additional run on a slider
LONGEST_RUN = 2e9  # particle-steps of a requested run: a minute or two


@dataclass(frozen=True)
class SliderAxis:
    """Slider: the name of a scene's field and its values, SI units; that at the index ``start`` is the scene's own."""

    field: str
    values: tuple[Any, ...]
    start: int


def why_too_long_to_record(scene: Scene) -> str | None:
    """Returns why a scene's run takes too long to record (``LONGEST_RUN``), as the end of a sentence, or None."""
    if (work := scene.particles * scene.steps) <= LONGEST_RUN:
        return None
    return f"would take {work:.2g} particle-steps, too long to record; give fewer cells, periods or a larger cfl, " \
           f"up to {LONGEST_RUN:.0e}"


def axes_around(scene: Scene, counts: Mapping[str, int]) -> list[SliderAxis]:
    """Returns axes of more than one value around a scene's own; ``counts`` maps fields to the most values."""
    axes = [axis_through(scene, field, _axis_candidates(scene, field), most) for field, most in counts.items()]
    return [axis for axis in axes if len(axis.values) > 1]


def axis_through(scene: Scene, field: str, candidates: Sequence[Any], most: int) -> SliderAxis:
    """Returns the axis of a ``field``: the scene's own value and the first valid ``candidates`` that are not too long
    to run, together at most ``most`` values, sorted (methods: in this order)."""
    own = getattr(scene, field) if field != "cfl" else scene.courant_number
    values = [own]
    for value in candidates:
        if value not in values and len(values) < most:
            with suppress(SceneError):
                changed = _change_scene(scene, {field: value})
                if count_particle_steps(changed) <= max(MOST_WORK, count_particle_steps(scene)):
                    values.append(value)
    order = values if field == "method" else sorted(values)
    return SliderAxis(field, tuple(order), order.index(own))


def axes_for_instructions(scene: Scene, text: str) -> list[SliderAxis]:
    """Returns the axes that instructions in Markdown need, such as "Set **Cells** to `80`" in the current language: the
    scene's own value and those in the ``text``. Instructions for other controls are ignored."""
    found: dict[str, list[Any]] = {}
    called = {tr(name): field for name, field in CONTROLS.items()}
    between = "|".join(re.escape(tr(SENTENCES[verb]).partition("{name}")[2].partition("{value}")[0])
                       for verb in ("Set", "Choose"))
    for act in re.finditer(rf"\*\*(?P<control>[^*]+)\*\*(?:{between})`(?P<value>[^`]+)`", text):
        field = called.get(act["control"])
        if field and (value := _parse_axis_value(scene, field, act["value"])) is not None:
            found.setdefault(field, []).append(value)
    return [made for field, values in found.items()
            if len((made := axis_through(scene, field, values, len(values) + 1)).values) > 1]


def scene_texts(scene: Scene, axes: Sequence[SliderAxis]) -> Iterator[str]:
    """Yields a grid's scenes as texts of states, the last axis fastest; or ``!`` and the reason if one is invalid."""
    for values in itertools.product(*(axis.values for axis in axes)):
        changes = dict(zip((axis.field for axis in axes), values, strict=True))
        try:
            yield shareable_state.write_state(shareable_state.State(_change_scene(scene, changes)))
        except SceneError as error:
            yield f"!{error.sentence}"


def _change_scene(scene: Scene, changes: Mapping[str, Any]) -> Scene:
    """Returns the scene with new values of fields; a Courant number replaces the time step. Raises SceneError."""
    step: dict[str, Any] = {"dt": None} if "cfl" in changes else {}
    return replace(scene, **changes, **step)


def _axis_candidates(scene: Scene, field: str) -> Sequence[Any]:
    """Returns values that a slider may offer for a field: method, cells, or a number; the most useful first."""
    if field == "method":
        return [method for method in METHODS if method in scene.choices("method")]
    if field == "cells":
        low, high, _ = VIEWS[scene.problem].slider_ranges.cells
        factors = CELLS if scene.DIMENSIONS == 1 else RING_CELLS
        return [count for factor in factors if low <= (count := round(factor * scene.cells)) <= high]
    return [float(f"{factor * getattr(scene, field):.3g}") for factor in AMPLITUDES]


def count_particle_steps(scene: Scene) -> float:
    """Returns a scene's number of particles times its number of steps: some tens of millions take a second."""
    return float(scene.particles) * scene.steps


def _parse_axis_value(scene: Scene, field: str, text: str) -> Any:
    """Returns the value that an instruction's ``text`` means for a field: method, whole or other number; else None."""
    if field == "method":
        plain = text.lower()
        return next((code for code, method in NAMES.items()
                     if plain in (code, method.name.lower(), str(method).lower())), None)
    try:
        number = float(text.split()[0].replace(",", "."))
    except (ValueError, IndexError):
        return None
    if field in ("cells", "ppc") and number.is_integer():
        return int(number)
    return None if field == "cells" else number
