"""The points of a landscape: which values of a parameter, in which order, at which price.

Five numbers of a scene have a landscape: its cells, particles per cell, amplitude, modulus and CFL number. The present
value is always a point: it is the run on the stage.
"""

import functools
import math
from collections.abc import Hashable, Sequence
from dataclasses import fields, replace
from itertools import pairwise
from typing import Any

import numpy as np

from solvers.problems import PROBLEMS
from solvers.scene.scene import AUTO, Scene
from solvers.scene.validation import SceneError
from solvers.solver.soundness import BROKEN, OK

PARAMETERS = ("amplitude", "cells", "ppc", "cfl", "modulus")
WHOLE = ("cells", "ppc")
POINTS, POINTS_IN_PLANE = 18, 12  # of a geometric sequence
DIGITS = 3  # of values, as on sliders
TOO_CLOSE = 0.005  # of a value: a distance at which a second point shows nothing
NEAR_CROSSING = (0.98, 1.05, 1.15)  # of the amplitude of the first crossing, where the stress of hat functions jumps
STRIDES = (4, 2, 1)  # of points, coarse to fine
INSTANTS = 8  # of a period at which the exact motion is looked at
MOST_ITERATIONS, CLOSE = 6, 1e-3  # of the amplitude of the first crossing, for motions that do not scale with it
END_RUN = ("t_end", "periods", "sample_every")  # fields that do not change the motion of a run


def parameters_of(scene: Scene) -> tuple[str, ...]:
    """Returns the parameters that have a landscape in a scene."""
    return tuple(name for name in PARAMETERS if name != "amplitude" or name in scene.motion_fields)


def present_value(scene: Scene, parameter: str) -> float:
    """Returns a parameter's value in a scene."""
    return scene.courant_number if parameter == "cfl" else getattr(scene, parameter)


def has_fixed_step(scene: Scene) -> bool:
    """Returns whether the time step is given in seconds."""
    return scene.dt not in (None, AUTO)


@functools.lru_cache(maxsize=1024)  # a valid scene takes as long to make as a short run
def varied_scene(scene: Scene, parameter: str, value: float) -> Scene:
    """Returns the scene with another value of a parameter, the scene itself for the value that it has. Raises
    :class:`SceneError` for an invalid one."""
    if value == present_value(scene, parameter):
        return scene
    return replace(scene, **_changes(parameter, value))


def _changes(parameter: str, value: float) -> dict[str, Any]:
    return {parameter: value, "dt": None} if parameter == "cfl" else {parameter: value}


def history_key(scene: Scene, parameter: str, value: float) -> Hashable:
    """Returns the key of the history of :func:`varied_scene`, with the estimators that are active in the scene itself:
    equal keys have equal runs, whichever parameter was varied."""
    changes: dict[str, Any] = {"estimators": scene.active_estimators}
    if scene.dt is None:
        changes["cfl"] = scene.courant_number
    if value != present_value(scene, parameter):
        changes |= _changes(parameter, value)
    return tuple(changes.get(f.name, getattr(scene, f.name)) for f in fields(scene) if f.name not in END_RUN)


@functools.lru_cache(maxsize=256)
def has_effect(scene: Scene, parameter: str) -> bool:
    """Returns whether errors over their sizes, at equal phase, depend on a parameter. The modulus only changes the
    units where time step and motion are as fast as the waves."""
    typed = bool(getattr(scene, "displacement", ""))
    if parameter != "modulus" or has_fixed_step(scene) or typed or not scene.swings:
        return True
    stiffer = varied_scene(scene, "modulus", 4 * scene.modulus)
    return not math.isclose(stiffer.angular_frequency, 2 * scene.angular_frequency)


def particle_steps(scene: Scene, parameter: str, value: float, until: float) -> float:
    """Returns about how many particle-steps a run with another value of a parameter has until a time in periods."""
    ratio, D = value / present_value(scene, parameter), scene.DIMENSIONS
    fixed = has_fixed_step(scene)
    power = {"cells": D + (not fixed), "ppc": D, "cfl": -1, "modulus": -0.5 * fixed}.get(parameter, 0)
    return ratio**power * scene.particles * max(1.0, until * scene.period / scene.time_step)


def choose_values(scene: Scene, parameter: str, reach: tuple[float, float, float], until: float) -> tuple[float, ...]:
    """Returns the values of a parameter, ascending, for a slider from low to high with steps, ``reach`` (step 0: a
    logarithmic slider), and times until a time in periods."""
    present = present_value(scene, parameter)
    low, high, step = min(reach[0], present), max(reach[1], present), reach[2]
    if not has_effect(scene, parameter):
        return (present,)
    count = POINTS if scene.DIMENSIONS == 1 else POINTS_IN_PLANE
    spread = np.geomspace(low, high, count)
    if parameter == "ppc":
        values = set(np.arange(low, high + 0.5 * step, step).tolist())
    elif parameter == "cells":
        stops = np.arange(low, high + 1, step)
        values = {stops[np.argmin(np.abs(stops - value))] for value in spread} | _cells_beside_crossing(scene, until)
    else:
        values = {float(f"{value:.{DIGITS}g}") for value in spread}
        first = first_crossing(scene, until) if parameter == "amplitude" else None
        values |= {float(f"{first * share:.{DIGITS}g}") for share in NEAR_CROSSING} if first else set()
    kind = int if step and step % 1 == 0 else float
    inside = [kind(value) for value in sorted(values) if low <= value <= high and abs(value / present - 1) > TOO_CLOSE]
    inside = [value for before, value in pairwise([0, *inside]) if value > (1 + TOO_CLOSE) * before]
    if parameter != "cfl" and scene.dt == AUTO:  # each has a bound of its own, which takes longer than its run
        inside = inside[::STRIDES[0]]
    return tuple(sorted([*inside, present]))


def values_at_cliff(values: Sequence[float], statuses: Sequence[str]) -> tuple[float, ...]:
    """Returns a value between the first two neighbours of which one run is sound and the other broken; nothing if there
    are none, or if they are close. ``values`` are ascending; others' statuses are of no use."""
    for (low, before), (high, after) in pairwise(zip(values, statuses, strict=True)):
        if {before, after} & set(BROKEN) and OK in (before, after):
            middle = float(f"{math.sqrt(low * high):.{DIGITS}g}")
            return (middle,) if low < middle < high else ()
    return ()


def point_levels(values: Sequence[float], present: float) -> list[int]:
    """Returns the level of each of the ascending values, 0 for coarse: the present one, the ends and every fourth, then
    every second, then the others."""
    levels = {values.index(present): 0, len(values) - 1: 0}
    for level, stride in enumerate(STRIDES):
        levels = dict.fromkeys(range(0, len(values), stride), level) | levels
    return [levels[k] for k in range(len(values))]


def crossing_share(scene: Scene, until: float) -> float:
    """Returns the smallest factor of the exact displacements, until a time in periods, with which a particle reaches
    the border of its cell; infinite where none moves."""
    times = {until, *(k / INSTANTS for k in range(1, INSTANTS + 1) if k / INSTANTS < until)}
    return min(_crossing_share_at(scene, time) for time in times)


@functools.lru_cache(maxsize=2048)  # while a run plays, only the last of the instants is another one
def _crossing_share_at(scene: Scene, time: float) -> float:
    """Returns the factor of :func:`crossing_share` at one time in periods."""
    reference = PROBLEMS[scene.problem].reference
    X, h = reference.start(scene).material_position, scene.spacing
    place = (X - reference.grid_corner(scene)) / h
    below = place - np.floor(place)
    with np.errstate(divide="ignore", invalid="ignore"):
        moved = reference.displacement(scene, X, time * scene.period) / h
        shares = np.where(moved > 0, (1 - below) / moved, below / -moved)
        return float(np.nanmin(np.where(moved == 0, math.inf, shares)))


@functools.lru_cache(maxsize=256)
def first_crossing(scene: Scene, until: float) -> float | None:
    """Returns the smallest amplitude with which, in the exact motion, a particle changes its cell until a time in
    periods; None where there is none, or the motion is not known or does not scale with the amplitude."""
    if not scene.solution_known or "amplitude" not in scene.motion_fields:
        return None
    there = scene
    for _ in range(MOST_ITERATIONS):
        share = crossing_share(there, until)
        try:
            there = replace(there, amplitude=share * there.amplitude)
        except SceneError:
            return None
        if abs(share - 1) < CLOSE:
            return there.amplitude
    return None


def first_crossing_value(scene: Scene, parameter: str, values: Sequence[float], until: float) -> float | None:
    """Returns the smallest of the ascending values of the amplitude (here: of all), the cells or the particles per cell
    with which a particle changes its cell until a time in periods; None if there is none."""
    if parameter == "amplitude":
        return first_crossing(scene, until)
    if parameter not in WHOLE or not scene.solution_known:
        return None
    low, high = 0, len(values)
    while low < high:
        middle = (low + high) // 2
        try:
            crosses = crossing_share(varied_scene(scene, parameter, values[middle]), until) <= 1
        except SceneError:
            crosses = True
        low, high = (low, middle) if crosses else (middle + 1, high)
    return values[low] if low < len(values) else None


def _cells_beside_crossing(scene: Scene, until: float) -> set[int]:
    """Returns, in one dimension, the two numbers of cells beside the one with which the first particle changes its
    cell: the error falls up to there."""
    share = crossing_share(scene, until) if scene.DIMENSIONS == 1 and scene.solution_known else math.inf
    return {math.floor(scene.cells * share), math.ceil(scene.cells * share)} if share < math.inf else set()


def stability_bound(scene: Scene, parameter: str) -> float | None:
    """Returns the CFL number, or with a fixed time step the modulus in Pa, from which on linear theory expects an
    unstable run; None for other parameters."""
    if parameter == "cfl":
        return scene.step_bound * scene.wave_speed / scene.spacing
    if parameter == "modulus" and has_fixed_step(scene):
        return scene.modulus * (scene.step_bound / scene.time_step) ** 2
    return None
