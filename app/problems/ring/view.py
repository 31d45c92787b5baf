"""How the ring is shown, beside its stage and its pictures: regions, the reach of its sliders, words about it."""

from typing import Any

import numpy as np

from app.frame.slow.planar import PlanarSlowStage
from app.language.spoken import later, tr
from app.problems.interface import ProblemView, Reach, Regions
from app.problems.ring.sparks import sparks
from app.problems.ring.stage import RingStage
from solvers.problems.ring.exact import INNER, OUTER

ANGLES = 6
#: Regions of the quarter: 15 degrees each, from the x axis on.
THIRDS = (later("inner third, {low}–{high}°"), later("middle third, {low}–{high}°"),
          later("outer third, {low}–{high}°"))


def regions(X: np.ndarray) -> Regions:
    share = (np.hypot(X[:, 0], X[:, 1]) - INNER) / (OUTER - INNER)
    third = np.clip((share * len(THIRDS)).astype(int), 0, len(THIRDS) - 1)
    angle = np.clip((np.arctan2(X[:, 1], X[:, 0]) / (0.5 * np.pi) * ANGLES).astype(int), 0, ANGLES - 1)
    step = 90 // ANGLES
    names = tuple(tr(third, low=k * step, high=(k + 1) * step) for third in THIRDS for k in range(ANGLES))
    return Regions(names, third * ANGLES + angle)


def draw(*places: Any) -> None:
    from app.problems.ring import pictures

    pictures.draw(*places)


RING = ProblemView(
    "ring", RingStage, PlanarSlowStage, draw, regions,
    later("the quarter ring into 6 angles from the x axis on and 3 thirds of the wall"),
    picture=(13.5, 0.85), speed=0.2, reach=Reach((12, 96, 6), (1, 6), (1e-3, 0.4), (1e5, 1e8), (1e-2, 10.0)),
    amplitude_hint=later("largest displacement of the outer rim; from 0.115 m on the motion itself is unstable, above "
                         "0.198 m a real ring wrinkles, from 0.386 m on the exact one turns inside out"),
    prices={"transport": 0.06, "recovered": 0.11, "companion": 0.06, "two-grid": 0.08},
    details={"layout": later("where particles begin: the Cartesian rim is a staircase"),
             "body_force": later("where the force is evaluated"),
             "velocity": later("the velocity that moves the particles")},
    estimators=("companion",), sparks=sparks)  # transport says three to twelve times the error here
