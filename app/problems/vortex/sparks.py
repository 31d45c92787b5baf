"""What the vortex asks: what wider cells cost, what a staircase of a rim does, and which functions bear the shear."""

from app.problems.spark import Answer, NotNow, Offer, Ran, Spark, asked, breaking, work
from app.state import State
from app.words import factor

FEWEST_CELLS = 24


def _widen(state: State) -> Offer:
    if state.scene.cells < 2 * FEWEST_CELLS:
        raise NotNow(f"{FEWEST_CELLS} cells are the fewest here")
    return Offer("Double the cells' width", "the textbook: 4 times as wrong",
                 asked(state, {"cells": state.scene.cells // 2}))


def _widened(ran: Ran) -> Answer:
    return f"It errs {factor(ran.ratio)} times as much; second order says 4.", \
        f"It takes {factor(work(ran))} of the particle steps: fewer particles, and fewer steps."


def _staircase(state: State) -> Offer:
    if getattr(state.scene, "layout", "") == "cartesian":
        return Offer("Rims that are round", "particles along circles", asked(state, {"layout": "polar"}))
    return Offer("Rims like a staircase", "particles along the grid",
                 asked(state, {"layout": "cartesian"}))


def _stepped(ran: Ran) -> Answer:
    return f"It errs {factor(ran.ratio)} times as much.", "Only where particles begin differs: see the rims."


SPARKS = (Spark("widen", "halve", "Double the cells' width", _widen, _widened, 0.2),
          Spark("staircase", "stairs", "Rims like a staircase", _staircase, _stepped, 0.2),
          breaking("Break it", "hat functions bear no shear", {"method": "mpm"}, 0.4))


def sparks(_: State) -> tuple[Spark, ...]:
    """The same three of every vortex."""
    return SPARKS
