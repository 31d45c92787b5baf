"""Where an estimator of the ring is known not to hold: a row for each limit (see ``solvers.scene.limits``)."""

import math

from solvers.estimators.phase_lag import in_step
from solvers.problems.planar.limits import POLAR, THREE_ACROSS
from solvers.scene.limits import Limit
from solvers.scene.registry import HALF_REASON, MOVING_WEIGHTS, REMEDIES_REASON
from solvers.scene.remedies import FILTER

#: Forces that send waves across the ring, whose longest half is as long as the ring is wide, in metres; the
#: manufactured one moves it as a whole.
WAVES, WIDTH = ("none", "two-tone"), 0.2
GAPS = "the boxes of this method do not tile the ring, so its error does not fall with the cell size; use CPDI"

LIMITS = (
    MOVING_WEIGHTS,
    # Companion: both solves must follow the same motion. At this limit the index of the stress is 1.05 (CPDI, 48 cells,
    # one period), 5.7 at 0.3.
    Limit("companion", "amplitude", most=0.25, why="at an amplitude above {most:g} the ring's motion is so unstable "
          "that a second solve of it leaves the first for reasons of its own"),
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
    Limit("two-grid", "layout", allowed=("polar",), why="the staircase of the cartesian layout is another one on each "
          "grid, so their errors are not comparable"),
    # Only CPDI's domains tile the lattice on all grids. What the boxes of cpGIMP leave open is less, the more particles
    # there are: x .9 to 1.0 on 12 of 12 rings on which that is less than the error of the cells, on 7 of 50 others.
    Limit("two-grid", "method", allowed=("cpdi", "cpgimp"), why=GAPS),
    Limit("two-grid", "ppc", least=3, where={"method": "cpgimp"}, why=GAPS),
    Limit("two-grid", "cells", least=15, where={"method": "cpgimp"}, why=GAPS),
    Limit("two-grid", "cells", most=8, of="ppc", where={"method": "cpgimp"}, why=GAPS),
    # Where waves cross the ring, x is .7 with 24 cells; with the filter v is 1.2 and 1.5 with 12 and 13.
    Limit("two-grid", "cells", least=48, where={"body_force": WAVES}, why=HALF_REASON),
    Limit("two-grid", "cells", least=15, where={"remedies": ((FILTER,),)}, why=HALF_REASON),
    Limit("two-grid", "cells", least=12, why=HALF_REASON),
    # Two rows of cells lie below zero.
    Limit("two-grid", "amplitude", below=lambda scene: scene.OUTER - 2 * scene.SIDE / (scene.cells // 2),
          why="so large a motion would leave the grid of the second run; give more cells or a smaller amplitude"),
    Limit("two-grid", "ppc", least=2, why="one particle per cell is so coarse a rule of quadrature that its error, of "
          "a cell's length, drowns what the two grids have in common; give two or more"),
    # Once the ring has been compressed, x may be .4 to .7.
    Limit("two-grid", "end_time", most=0.6, of="period", above=("amplitude", 0.2), why="at an amplitude above "
          "{above:g} the compressed ring is so unstable that the two runs part; end within {most:g} periods or take a "
          "smaller one"),
    # Measured at 7.7, .68 of the error of x.
    Limit("two-grid", lambda scene: scene.growth ** (scene.end_time / scene.period - 1), most=4.0, why="so large a "
          "motion is unstable: after the first period disturbances grow {value:.2g}-fold or more, on each grid at "
          "another rate; end earlier or take a smaller amplitude"),
    in_step(math.pi / WIDTH, body_force=WAVES))
