"""How the ring is shown, beside its stage and its pictures: regions, the reach of its sliders, words about it, and
what it asks."""

from dataclasses import replace
from typing import Any

import numpy as np

from app.frame.slow.planar import PlanarSlowStage
from app.language.heard import heard
from app.language.spoken import later, tr
from app.problems.interface import ProblemView, Reach, Regions
from app.problems.ring.stage import RingStage
from app.problems.spark import Answer, NotNow, Offer, Ran, Spark, asked, breaking, halving
from app.state import State
from app.words import per_cent, ratio
from solvers.problems.ring.exact import INNER, OUTER

MOST_CELLS = 96
BREAKING = 0.25  # m, of A: hat functions lose it in the second period


def _ask_transport(state: State) -> Offer:
    judges = state.scene.estimators
    if (state.estimator or next(iter(judges), None)) == "transport":
        raise NotNow(tr("it is on the stage"))
    changed = asked(state, {"estimators": (*judges, *({"transport"} - set(judges)))}, pinned=False)
    return Offer(tr("Ask transport, too"), tr("the method's own equations"), replace(changed, estimator="transport"))


def _says(ran: Ran) -> Answer:
    if "transport" in ran.not_valid:
        return tr("Transport says: {reason}.", reason=heard(ran.not_valid["transport"])), \
            tr("It does not hold here, and says so.")
    index, companion = ran.index("transport"), ran.index("companion")
    if index != index:
        return tr("Transport does not estimate the {noun}.", noun=ran.noun), tr("It says so in place of a number.")
    said = tr("Transport says {times} times what the error is.", times=ratio(index)) if index >= 1 else \
        tr("Transport says {share} of what the error is.", share=per_cent(index))
    if companion == companion:
        return said, tr("Companion says {times} times. Which of them would you believe without the truth?",
                        times=ratio(companion))
    return said, tr("Which of them would you believe without the truth?")


SPARKS = (halving(MOST_CELLS), Spark("transport", "judge", later("Ask transport, too"), _ask_transport, _says, 0.5),
          breaking(later("Break it"), later("hat functions, A = 250 mm"),
                   {"method": "mpm", "amplitude": BREAKING}, 1.2))


def sparks(_: State) -> tuple[Spark, ...]:
    """The same three of every ring."""
    return SPARKS


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
