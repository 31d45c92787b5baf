"""How the vortex is shown, beside its stage and its pictures: regions, the reach of its sliders, words about it, and
what it asks."""

from typing import Any

import numpy as np

from app.frame.slow.planar import PlanarSlowStage
from app.language.spoken import later, tr
from app.problems.interface import ProblemView, Reach, Regions
from app.problems.spark import Answer, NotNow, Offer, Ran, Spark, asked, breaking, work
from app.problems.vortex.stage import VortexStage
from app.state import State
from app.words import factor
from solvers.problems.vortex.scene import INNER, MOST_AMPLITUDE, OUTER

FEWEST_CELLS = 24


def _widen(state: State) -> Offer:
    if state.scene.cells < 2 * FEWEST_CELLS:
        raise NotNow(tr("{fewest} cells are the fewest here", fewest=FEWEST_CELLS))
    return Offer(tr("Double the cells' width"), tr("the textbook: 4 times as wrong"),
                 asked(state, {"cells": state.scene.cells // 2}))


def _widened(ran: Ran) -> Answer:
    return tr("It errs {factor} times as much; second order says 4.", factor=factor(ran.ratio)), \
        tr("It takes {factor} of the particle steps: fewer particles, and fewer steps.", factor=factor(work(ran)))


def _staircase(state: State) -> Offer:
    if getattr(state.scene, "layout", "") == "cartesian":
        return Offer(tr("Rims that are round"), tr("particles along circles"), asked(state, {"layout": "polar"}))
    return Offer(tr("Rims like a staircase"), tr("particles along the grid"),
                 asked(state, {"layout": "cartesian"}))


def _stepped(ran: Ran) -> Answer:
    return tr("It errs {factor} times as much.", factor=factor(ran.ratio)), \
        tr("Only where particles begin differs: see the rims.")


SPARKS = (Spark("widen", "halve", later("Double the cells' width"), _widen, _widened, 0.2),
          Spark("staircase", "stairs", later("Rims like a staircase"), _staircase, _stepped, 0.2),
          breaking(later("Break it"), later("hat functions bear no shear"), {"method": "mpm"}, 0.4))


def sparks(_: State) -> tuple[Spark, ...]:
    """The same three of every vortex."""
    return SPARKS


ANGLES = 8
#: Regions: 45 degrees each.
FIFTHS = (later("innermost fifth, {low}–{high}°"), later("inner fifth, {low}–{high}°"),
          later("middle fifth, {low}–{high}°"), later("outer fifth, {low}–{high}°"),
          later("outermost fifth, {low}–{high}°"))


def regions(X: np.ndarray) -> Regions:
    share = (np.hypot(X[:, 0], X[:, 1]) - INNER) / (OUTER - INNER)
    fifth = np.clip((share * len(FIFTHS)).astype(int), 0, len(FIFTHS) - 1)
    turns = np.arctan2(X[:, 1], X[:, 0]) / (2 * np.pi) % 1
    angle = np.clip((turns * ANGLES).astype(int), 0, ANGLES - 1)
    step = 360 // ANGLES
    names = tuple(tr(fifth, low=k * step, high=(k + 1) * step) for fifth in FIFTHS for k in range(ANGLES))
    return Regions(names, fifth * ANGLES + angle)


def draw(*places: Any) -> None:
    from app.problems.vortex import pictures

    pictures.draw(*places)


VORTEX = ProblemView(
    "vortex", VortexStage, PlanarSlowStage, draw, regions,
    later("the ring into 8 angles from the x axis on and 5 fifths of the wall"),
    picture=(15.0, 1.3), speed=0.1,
    reach=Reach((12, 96, 2), (1, 3), (0.01, MOST_AMPLITUDE), (100.0, 10_000.0), (1e-2, 2.0)),
    amplitude_hint=later("angle in radians by which the middle circle turns against the rims, which rest; the largest "
                         "shear is seven times as much"),
    prices={"transport": 0.07, "recovered": 0.24, "companion": 0.05},
    details={"layout": later("where particles begin: Cartesian rims are staircases"),
             "body_force": later("which force acts"), "velocity": later("the velocity that moves the particles")},
    modulus_hint=later("Young's modulus: the body force sees to it that the motion stays the same, the errors do not"),
    material={"poisson_ratio": (later("Poisson's ratio ν"), -0.5, 0.49, 0.01,
                                later("resistance to a change of volume: not in the exact motion, which has none, but "
                                      "in the errors and, with the speed of waves, in the time step"))},
    sparks=sparks, estimators=("companion", "transport"))  # transport alone would show only an estimate that fails
