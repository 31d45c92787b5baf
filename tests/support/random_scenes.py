"""Scenes drawn at random over all their inputs, cheap enough to run hundreds of them.

What is compiled takes seconds, so switches come from a short list, each with the problem it belongs to, and numbers are
drawn freely within it. ``MPM_LAB_RANDOM_SCENES=10000`` asks for so many scenes with fresh seeds; switches are then
drawn at random too, a new set for every hundred scenes.
"""

from __future__ import annotations

import math
import os
import random
from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from hypothesis import strategies as st

from solvers.problems import PROBLEMS
from solvers.scene.scene import Scene
from solvers.scene.stabilisations import CENTRED, COUPLED, FILTER, FROZEN
from solvers.scene.validation import SceneError

#: Scenes asked for, with fresh seeds; None for those of every run of the tests, always the same.
ASKED = int(os.environ["MPM_LAB_RANDOM_SCENES"]) if "MPM_LAB_RANDOM_SCENES" in os.environ else None
SCENES = 120  # unless told otherwise
SCENES_A_SET = 100  # of switches that were drawn at random
MOST_WORK = 2e5  # of a scene: particles and nodes times steps
MOST_STEPS = 5000  # of a scene: a step costs something however few particles there are
MOST_PARALLEL_STEPS = 100  # each is a launch of its own
MOST_SAMPLES = 200

Inputs = dict[str, Any]
#: Switches of each problem, with one method, plan, estimator and remedy or another; and others, for the slow set, so
#: that between them they have every method, force, velocity, effect, estimator and remedy.
OFTEN: tuple[Inputs, ...] = (
    {"problem": "bar"},
    {"problem": "bar", "method": "mpm", "estimators": (), "effects": ("truth",)},
    {"problem": "bar", "method": "mpm", "motion": "patch", "estimators": ("companion",)},
    {"problem": "ring", "method": "mpm", "estimators": (), "velocity": "particle", "effects": ("truth", "margin")},
    {"problem": "ring", "method": "cpgimp", "remedies": (FROZEN,), "estimators": (), "effects": ("truth",),
     "plan": "parallel", "threads": 2},
    {"problem": "vortex", "method": "cpgimp-v", "velocity": "particle", "remedies": (FILTER,),
     "body_force": "two-tone", "estimators": ("companion",)},
    {"problem": "vortex", "method": "mpm", "estimators": (), "remedies": (FROZEN,), "effects": ("truth", "spin")},
    {"problem": "square", "method": "cpgimp", "estimators": ("companion", "transport"), "remedies": (FILTER,)},
)
RARE: tuple[Inputs, ...] = (
    {"problem": "bar", "linearity_preserving": True, "remedies": (FILTER, COUPLED, CENTRED), "body_force": "node",
     "estimators": ("recovered",)},
    {"problem": "bar", "method": "bspline", "body_force": "none", "velocity": "particle", "estimators": ("companion",)},
    {"problem": "bar", "method": "cpgimp", "velocity": "corners", "estimators": ("two-grid",)},
    {"problem": "bar", "method": "mpm", "remedies": (FROZEN,), "body_force": "two-tone"},
    {"problem": "ring"},
    {"problem": "ring", "method": "ugimp", "remedies": (FILTER, COUPLED), "estimators": (), "body_force": "none",
     "effects": ("soundness", "energy", "crossings")},
    {"problem": "vortex"},
    {"problem": "vortex", "method": "ugimp", "body_force": "none", "estimators": (), "effects": ("spin", "soundness"),
     "plan": "parallel", "threads": 2},
    {"problem": "square", "method": "mpm", "estimators": (), "remedies": (FROZEN,), "velocity": "particle"},
    {"problem": "square", "body_force": "none", "plan": "parallel", "threads": 2, "effects": ("soundness", "energy")},
)
SETS = OFTEN + RARE
LARGEST = {"bar": 0.159, "ring": 0.385, "vortex": 1.57, "square": 0.15}  # amplitudes
#: What no input may be, or none of most kinds.
ODD = (math.nan, math.inf, -math.inf, -1, 0, -0.0, 5e-324, 1e308, 10**400, 2**31, True, None, "", "auto", "10", "\n",
       "Ω", (), ("",), ("auto", "auto"), [1], {}, b"x", 1j)


def switch_sets() -> tuple[Inputs, ...]:
    """The switches to try: the short list, and as many more as the scenes asked for need."""
    extra = 0 if ASKED is None else ASKED // SCENES_A_SET
    return SETS + tuple(_draw_set(random.SystemRandom()) for _ in range(extra))


def scenes_a_set() -> int:
    return math.ceil((ASKED or SCENES) / len(switch_sets()))


def _draw_set(chance: random.Random) -> Inputs:
    """Switches that go together, whatever the numbers."""
    problem = chance.choice(list(PROBLEMS))
    kind = PROBLEMS[problem].scene
    while True:
        drawn: Inputs = {name: chance.choice(kind.choices(name)) for name in ("method", "body_force", "velocity")}
        drawn |= {name: tuple(word for word in kind.choices(name) if chance.random() < share)
                  for name, share in (("estimators", 0.3), ("effects", 0.8), ("remedies", 0.3))}
        drawn |= {"problem": problem, "linearity_preserving": chance.random() < 0.3}
        try:
            kind(**drawn)
        except SceneError:
            continue
        return drawn


def _largest_amplitude(switches: Mapping[str, Any]) -> float:
    two_toned_bar = (switches["problem"], switches.get("body_force")) == ("bar", "two-tone")
    return 0.117 if two_toned_bar else LARGEST[switches["problem"]]


def logarithmic(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(math.log(low), math.log(high)).map(math.exp)


def whole_logarithmic(low: int, high: int) -> st.SearchStrategy[int]:
    return logarithmic(low, high).map(round)


@st.composite
def inputs(draw: st.DrawFn, switches: Mapping[str, Any]) -> Inputs:
    """The inputs of a valid scene with these switches, within ``MOST_WORK``."""
    kind = PROBLEMS[switches["problem"]].scene
    bar = switches["problem"] == "bar"
    drawn = {**switches, "cells": draw(whole_logarithmic(kind.FEWEST_CELLS, 300 if bar else 48)),
             "ppc": draw(whole_logarithmic(1, 16 if bar else 5)),
             "amplitude": draw(logarithmic(1e-11, _largest_amplitude(switches))),
             "modulus": draw(logarithmic(2e-6, 0.9e12)), "density": draw(logarithmic(2e-6, 0.9e12))}
    if switches.get("motion") == "patch":
        drawn |= draw(_patch(drawn["cells"]))
        del drawn["amplitude"]
    if "layout" in kind.__dataclass_fields__:
        drawn["layout"] = draw(st.sampled_from(kind.choices("layout")))
    short = {"periods": 1e-9}  # a whole period of a stiff vortex could have more steps than are allowed
    probe = kind(**drawn, **short, **draw(_step(kind(**drawn, **short))))  # says how long a step is
    most = MOST_PARALLEL_STEPS if switches.get("plan") == "parallel" else MOST_STEPS
    work = probe.particles + probe.cells**probe.DIMENSIONS
    steps = max(1.0, draw(logarithmic(1e-3, 1.0)) * min(MOST_WORK / work, most))
    end = steps * probe.time_step
    drawn |= {"dt": probe.dt, "cfl": probe.cfl}
    drawn |= draw(st.sampled_from([{"t_end": end}, {"periods": end / probe.period}]))
    if draw(st.booleans()):
        drawn["sample_every"] = draw(whole_logarithmic(max(1, int(steps / MOST_SAMPLES)), max(2, int(2 * steps))))
    return drawn


@st.composite
def typed_motions(draw: st.DrawFn) -> str:
    """A displacement of the square as formulas: zero at t = 0, and of the wave numbers that planes allow."""
    waves = st.tuples(st.integers(1, 3), st.integers(0, 2), st.integers(1, 3),
                      st.floats(-0.008, 0.008).filter(lambda a: abs(a) > 1e-4))
    parts = [(draw(st.lists(waves, min_size=least, max_size=2 + least)), *axes)
             for least, axes in ((1, ("X", "Y")), (0, ("Y", "X")))]
    return ", ".join("+".join(f"({a!r})*sin({k}*pi*{along})*cos({m}*pi*{across})*sin({n}*w*t)" for k, m, n, a in some)
                     or "0" for some, along, across in parts)


@st.composite
def typed_lines(draw: st.DrawFn) -> str:
    """One of the bar: zero at t = 0, and the same at both ends."""
    waves = st.tuples(st.floats(1e-4, 0.008), st.integers(1, 3), st.integers(0, 6), st.sampled_from(("sin", "-1+cos")))
    return "+".join(f"{a!r}*sin({2 * k}*pi*X+{phase})*({swing}({k}*w*t))"
                    for a, k, phase, swing in draw(st.lists(waves, min_size=1, max_size=3)))


@st.composite
def _patch(draw: st.DrawFn, cells: int) -> Inputs:
    """What only a patch test has, and particles per cell that are whole together."""
    sizes = st.one_of(st.floats(0.1, 1 - 1e-5), st.floats(1 + 1e-5, 10.0))
    return {"ppc": draw(st.integers(cells, 16 * cells)) / cells, "stretch": draw(sizes),
            "initial_velocity": draw(st.one_of(st.just(0.0), st.floats(-100.0, 100.0)))}


def _step(scene: Scene) -> st.SearchStrategy[Inputs]:
    """The step in each of the ways to say it; most are as long as a careful user's, some far too long."""
    numbers = st.one_of(logarithmic(1e-3, 0.7), logarithmic(1e-2, 9.9))
    return st.one_of(st.just({"dt": "auto"}), numbers.map(lambda cfl: {"cfl": cfl}),
                     numbers.map(lambda cfl: {"dt": cfl * scene.spacing / scene.wave_speed}))


@st.composite
def odd_inputs(draw: st.DrawFn, problem: str) -> Inputs:
    """Inputs of which some are what no input may be."""
    names = [field.name for field in fields(PROBLEMS[problem].scene)]
    return {name: draw(st.sampled_from(ODD)) for name in draw(st.lists(st.sampled_from(names), min_size=1, max_size=3,
                                                                       unique=True))}
