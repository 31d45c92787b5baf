"""Where an estimator of the ring is known not to hold, a row for each limit (see ``solvers.scene.estimator_limits``);
and where its own motion is unstable."""

import math
from typing import Any

from solvers.estimators.two_grid_phase_lag import phase_lag_limit
from solvers.problems.planar.recovered_limits import POLAR, THREE_ACROSS
from solvers.scene.estimator_limits import Limit
from solvers.scene.estimator_registry import HALF_REASON, MOVING_WEIGHTS, REMEDIES_REASON
from solvers.scene.stabilisations import FILTER
from solvers.translatable_message import Message

RESONANCE = 0.115  # amplitude from which on the ring's own motion is unstable: a disturbance grows with every period
WRINKLING = 0.198  # amplitude at which the surface of the compressed ring wrinkles (Biot)
#: A small disturbance of the exact motion in the mode n = 2 grows, computed, 1.44 times a period at A = 0.12, 1.84 at
#: 0.13, 2.20 at 0.14 and 2.57 at 0.15: exp(GROWTH sqrt(A^2 - ONSET^2)) to that accuracy. Of larger A no more is known.
GROWTH, ONSET, KNOWN = 9.69, 0.1139, 0.15
FIRST_ERROR = 1e-3  # relative error in that mode after one period, as CPDI leaves it on 24 cells; 48 leave a sixth
LARGE_ERROR = 0.1  # and the one at the end of a run's life
#: Forces that send waves across the ring, whose longest half is as long as the ring is wide, in metres; the
#: manufactured one moves it as a whole.
WAVES, WIDTH = ("none", "two-tone"), 0.2
GAPS_REASON = "the boxes of this method do not tile the ring, so its error does not fall with the cell size; use CPDI"

LIMITS = (
    MOVING_WEIGHTS,
    # Companion: both solves must follow the same motion. At this limit the index of the stress is 1.05 (CPDI, 48 cells,
    # one period), 5.7 at 0.3.
    Limit("companion", "amplitude", most=0.25, why="at an amplitude above {most:g} the ring's motion is so unstable "
          "that a second solution departs from the first for other reasons"),
    # Recovered: the fits need a polar lattice with enough particles, and a motion that is not unstable. x, v and sigma
    # are good in 8 of 10 rings of .2 to .22, 4 for a; nothing at 0.25. In the second half of a period the ring is
    # compressed; until then both are good beyond.
    POLAR,
    Limit("recovered", "end_time", most=0.6, of="period", above=("amplitude", 0.22), why="at an amplitude above "
          "{above:g} the compressed ring is so unstable that recovered's own equation of motion breaks down after "
          "{most:g} periods; end earlier or take a smaller one"),
    Limit("recovered", "ppc", least=2, where={"velocity": "particle"}, why="single particles per cell that move with "
          "their own velocity stand so unevenly that recovered's fits follow them; give two or more per cell, or the "
          "velocity grid"),
    THREE_ACROSS,
    # Two-grid: Richardson's argument needs an error that falls like h^2. The filter only takes noise away.
    Limit("two-grid", "remedies", allowed=(FILTER,), why=REMEDIES_REASON),
    Limit("two-grid", "layout", allowed=("polar",), impossible=True, why="the staircase of the cartesian layout "
          "differs between the two grids, so their errors are not comparable"),
    # Only CPDI's domains tile the lattice on all grids. What the boxes of cpGIMP leave open is less, the more particles
    # there are: x .9 to 1.0 on 12 of 12 rings on which that is less than the error of the cells, on 7 of 50 others.
    Limit("two-grid", "method", allowed=("cpdi", "cpgimp"), why=GAPS_REASON),
    Limit("two-grid", "ppc", least=3, where={"method": "cpgimp"}, why=GAPS_REASON),
    Limit("two-grid", "cells", least=15, where={"method": "cpgimp"}, why=GAPS_REASON),
    Limit("two-grid", "cells", most=8, of="ppc", where={"method": "cpgimp"}, why=GAPS_REASON),
    # Where waves cross the ring, x is .7 with 24 cells; with the filter v is 1.2 and 1.5 with 12 and 13.
    Limit("two-grid", "cells", least=48, where={"body_force": WAVES}, why=HALF_REASON),
    Limit("two-grid", "cells", least=15, where={"remedies": ((FILTER,),)}, why=HALF_REASON),
    Limit("two-grid", "cells", least=12, why=HALF_REASON),
    # Two rows of cells lie below zero.
    Limit("two-grid", "amplitude", below=lambda scene: scene.OUTER - 2 * scene.SIDE / (scene.cells // 2),
          why="so large a motion would leave the grid of the second run; give more cells or a smaller amplitude"),
    Limit("two-grid", "ppc", least=2, why="one particle per cell is too coarse a quadrature: its error, of a cell's "
          "length, hides the common part of the two grids; give two or more"),
    # Once the ring has been compressed, x may be .4 to .7.
    Limit("two-grid", "end_time", most=0.6, of="period", above=("amplitude", 0.2), why="at an amplitude above "
          "{above:g} the compressed ring is so unstable that the two runs part; end within {most:g} periods or take a "
          "smaller one"),
    # Measured at 7.7, .68 of the error of x.
    Limit("two-grid", lambda scene: scene.disturbance_growth ** (scene.end_time / scene.period - 1), most=4.0,
          why="so large a "
          "motion is unstable: after the first period disturbances grow {value:.2g}-fold or more, on each grid at "
          "another rate; end earlier or take a smaller amplitude"),
    phase_lag_limit(math.pi / WIDTH, body_force=WAVES))


def disturbance_growth(scene: Any) -> float:
    """Returns the factor per period by which a disturbance of the ring's exact motion in the mode n = 2 grows: 1 where
    the motion is stable, a lower bound at amplitudes above ``KNOWN`` m."""
    A = min(scene.amplitude, KNOWN)
    return math.exp(GROWTH * math.sqrt(A * A - ONSET * ONSET)) if scene.amplitude >= RESONANCE else 1.0


def expected_life(scene: Any, first_error: float = FIRST_ERROR) -> float:
    """Returns the periods until a relative error in mode n = 2, ``first_error`` after one, is a tenth (inf: never)."""
    rate = disturbance_growth(scene)
    return 1 + math.log(LARGE_ERROR / first_error) / math.log(rate) if rate > 1 else math.inf


def warnings(scene: Any) -> list[str]:
    """Returns sentences about an unstable motion of the ring in this scene; an empty list where it is stable."""
    if scene.amplitude < RESONANCE or not scene.solution_known:
        return []
    amplitude, rate, life = scene.amplitude, disturbance_growth(scene), expected_life(scene)
    beyond = amplitude > KNOWN
    wrinkles = Message("; above {wrinkling} its surface wrinkles as well", WRINKLING)
    return [Message("amplitude {amplitude:g}: above {resonance} the ring's own motion is unstable (parametric "
                    "resonance), and no remedy helps; an error in the mode n = 2 grows {rate:.2f}-fold a "
                    "period{or_faster}, from {first_error:.1%} of the amplitude after the first to a tenth after "
                    "{about} {life:.2g}, a smaller error reaches it later{wrinkles}", amplitude, RESONANCE, rate,
                    Message(" or faster") * beyond, FIRST_ERROR, Message("at most") if beyond else Message("about"),
                    life, wrinkles * (amplitude > WRINKLING))]


def known_weakness(scene: Any) -> str:
    """Returns what is known to break runs of the ring, as part of a sentence; "" where its motion is stable."""
    return Message("from A = {resonance} on the ring's own motion is unstable (parametric resonance) and no remedy "
                   "helps", RESONANCE) if scene.amplitude >= RESONANCE else ""
