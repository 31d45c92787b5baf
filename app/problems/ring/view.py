"""How the ring is shown, beside its stage and its pictures: regions, the reach of its sliders, words about it."""

from typing import Any

import numpy as np

from app.frame.slow.planar import PlanarSlowStage
from app.problems.interface import ProblemView, Reach, Regions
from app.problems.ring.sparks import sparks
from app.problems.ring.stage import RingStage
from solvers.problems.ring.exact import INNER, OUTER
from solvers.problems.ring.scene import INVERSION, RESONANCE, WRINKLING

ANGLES, THIRDS = 6, ("inner", "middle", "outer")  # regions of the quarter: 15 degrees each, from the x axis on


def regions(X: np.ndarray) -> Regions:
    share = (np.hypot(X[:, 0], X[:, 1]) - INNER) / (OUTER - INNER)
    third = np.clip((share * len(THIRDS)).astype(int), 0, len(THIRDS) - 1)
    angle = np.clip((np.arctan2(X[:, 1], X[:, 0]) / (0.5 * np.pi) * ANGLES).astype(int), 0, ANGLES - 1)
    step = 90 // ANGLES
    names = tuple(f"{third} third, {k * step}–{(k + 1) * step}°" for third in THIRDS for k in range(ANGLES))
    return Regions(names, third * ANGLES + angle)


def draw(*places: Any) -> None:
    from app.problems.ring import pictures

    pictures.draw(*places)


RING = ProblemView(
    "ring", RingStage, PlanarSlowStage, draw, regions,
    f"the quarter ring into {ANGLES} angles from the x axis on and {len(THIRDS)} thirds of the wall",
    picture=(13.5, 0.85), speed=0.2, reach=Reach((12, 96, 6), (1, 6), (1e-3, 0.4), (1e5, 1e8), (1e-2, 10.0)),
    amplitude_hint=f"largest displacement of the outer rim; from {RESONANCE} m on the motion itself is unstable, above "
                   f"{WRINKLING} m a real ring wrinkles, from {INVERSION} m on the exact one turns inside out",
    prices={"transport": 0.06, "recovered": 0.11, "companion": 0.06, "two-grid": 0.08},
    details={"layout": "where particles begin: the Cartesian rim is a staircase",
             "body_force": "where the force is evaluated", "velocity": "the velocity that moves the particles"},
    estimators=("companion",), sparks=sparks)  # transport says three to twelve times the error here
