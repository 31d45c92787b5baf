"""What the vortex asks: what wider cells cost, what a staircase of a rim does, and which functions bear the shear."""

from app.language.spoken import later, tr
from app.problems.spark import Answer, NotNow, Offer, Ran, Spark, asked, breaking, work
from app.state import State
from app.words import factor

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
