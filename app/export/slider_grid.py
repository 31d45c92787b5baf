"""Which runs go into a file: a lattice around a scene, so that sliders stay alive where nothing is run."""

import itertools
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

from app import state
from app.language.translation import tr
from app.lessons.markdown_html import FIELDS, SENTENCES
from app.problems.views import VIEWS
from app.words import METHODS as NAMES
from solvers.scene.scene import Scene
from solvers.scene.validation import SceneError

#: Times the scene's own: tried in this order until there are enough that the problem can be.
CELLS = (1.0, 0.5, 2.0, 4.0, 0.25, 1.5, 3.0)
AMPLITUDES = (1.0, 0.1, 2.0, 4.0, 0.5, 0.25)
RING_CELLS = (1.0, 0.5, 1.5, 0.75, 1.25, 2.0)  # in two dimensions twice as many cells are four times the particles
METHODS = ("cpdi", "ugimp", "mpm", "bspline", "cpgimp")  # in the order in which they are worth seeing
FULL = {"cells": 5, "amplitude": 4, "method": 3}  # how many of each: sixty runs
#: How a lesson's text names a control, and the field that it is.
CONTROLS = {name: field for name, field in FIELDS.items() if field != "body_force"}
MOST_WORK = 1.5e8  # particle-steps of a run that is recorded only so that a slider goes further
LONGEST_RUN = 2e9  # and of one that is asked for: a minute or two


@dataclass(frozen=True)
class SliderAxis:
    """One slider: a field of the scene and its values, of which number ``start`` is the scene's own."""

    field: str
    values: tuple[Any, ...]
    start: int


def within_reach(scene: Scene) -> str | None:
    """Why a run takes too long to record; None where it does not."""
    if (work := scene.particles * scene.steps) <= LONGEST_RUN:
        return None
    return f"would take {work:.2g} particle-steps, too long to record; give fewer cells, periods or a larger cfl, " \
           f"up to {LONGEST_RUN:.0e}"


def axes_around(scene: Scene, counts: Mapping[str, int]) -> list[SliderAxis]:
    """Axes through a scene with so many values of each field; none of a field that can be nothing else."""
    axes = [axis_through(scene, field, _candidates(scene, field), most) for field, most in counts.items()]
    return [axis for axis in axes if len(axis.values) > 1]


def axis_through(scene: Scene, field: str, candidates: Sequence[Any], most: int) -> SliderAxis:
    """An axis of the scene's own value and the first candidates that the problem can be, in their order of size."""
    own = getattr(scene, field) if field != "cfl" else scene.courant_number
    values = [own]
    for value in candidates:
        if value not in values and len(values) < most:
            with suppress(SceneError):
                if count_particle_steps(_changed(scene, {field: value})) <= max(MOST_WORK, count_particle_steps(scene)):
                    values.append(value)
    order = values if field == "method" else sorted(values)
    return SliderAxis(field, tuple(order), order.index(own))


def axes_named_in(scene: Scene, text: str) -> list[SliderAxis]:
    """Finds the axes of what a lesson's text has one set or choose, such as "Set **Cells** to `80`"."""
    found: dict[str, list[Any]] = {}
    called = {tr(name): field for name, field in CONTROLS.items()}
    between = "|".join(re.escape(tr(SENTENCES[verb]).partition("{name}")[2].partition("{value}")[0])
                       for verb in ("Set", "Choose"))
    for act in re.finditer(rf"\*\*(?P<control>[^*]+)\*\*(?:{between})`(?P<value>[^`]+)`", text):
        field = called.get(act["control"])
        if field and (value := _value(scene, field, act["value"])) is not None:
            found.setdefault(field, []).append(value)
    return [made for field, values in found.items()
            if len((made := axis_through(scene, field, values, len(values) + 1)).values) > 1]


def count_runs(axes: Sequence[SliderAxis]) -> int:
    """How many runs a lattice has."""
    return math.prod(len(axis.values) for axis in axes)


def scene_texts(scene: Scene, axes: Sequence[SliderAxis]) -> Iterator[str]:
    """The states' texts of all runs of a lattice, the last axis fastest; or, after a ``!``, why there is none."""
    for values in itertools.product(*(axis.values for axis in axes)):
        changes = dict(zip((axis.field for axis in axes), values, strict=True))
        try:
            yield state.write_state(state.State(_changed(scene, changes)))
        except SceneError as error:
            yield f"!{error.sentence}"


def _changed(scene: Scene, changes: Mapping[str, Any]) -> Scene:
    """Another scene; a Courant number stands instead of a step."""
    step: dict[str, Any] = {"dt": None} if "cfl" in changes else {}
    return replace(scene, **changes, **step)


def _candidates(scene: Scene, field: str) -> Sequence[Any]:
    if field == "method":
        return [method for method in METHODS if method in scene.choices("method")]
    if field == "cells":
        low, high, _ = VIEWS[scene.problem].reach.cells
        factors = CELLS if scene.DIMENSIONS == 1 else RING_CELLS
        return [count for factor in factors if low <= (count := round(factor * scene.cells)) <= high]
    return [float(f"{factor * getattr(scene, field):.3g}") for factor in AMPLITUDES]


def count_particle_steps(scene: Scene) -> float:
    """Particle-steps of a run: some tens of millions take a second."""
    return float(scene.particles) * scene.steps


def _value(scene: Scene, field: str, text: str) -> Any:
    """What a text between backquotes means for a field; None where it means nothing."""
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
