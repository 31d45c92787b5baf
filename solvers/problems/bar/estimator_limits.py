"""Where an estimator of the bar is known not to hold: a row for each limit (see ``solvers.scene.estimator_limits``)."""

import math
from typing import Any

from solvers.estimators.two_grid_phase_lag import phase_lag_limit
from solvers.scene.error_causes import NOTHING
from solvers.scene.estimator_limits import Limit
from solvers.scene.estimator_registry import HALF_REASON, MOVING_WEIGHTS, REMEDIES_REASON
from solvers.scene.stabilisations import CENTRED, COUPLED, FILTER

#: Two-grid: the error of a mapping or a force that is off by the displacement is a share of the motion, whatever the
#: grid; from this many h^2 (per unit length) on it outweighs the error that falls like h^2. Measured: with uGIMP the
#: index of x is .95 at 2, .85 at 40, .65 at 160; with the force at nodes .98 at 2, .80 at 6, .52 at 40.
MOST_MOTION = 5.0
#: Two-grid: how far particles may move, in cells, until crossing from one cell to the next fills the acceleration with
#: noise. The force on a particle kinks there with hats (however wide a domain sees them) and is smooth with B-splines.
#: Measured distances of a: .3 below, .3-1.1 beyond.
QUIET, QUIET_HATS = {"bspline": 1.0}, 0.25
#: Two-grid: cells that particles may move until what the coupling of F does to a motion, and the second run does
#: without, outweighs the error; x .9 to 1.1 on 8 of 9 bars below, on 3 of 20 beyond.
MOST_COUPLED = 0.02

#: Recovered: H c/h from which on its equation of motion is unstable, by linear theory; its steps are no shorter than
#: the run's.
MOST_WAVE_CFL = 0.944

FEW_PARTICLES = ("with {scene.ppc} per cell, particles that move {value:.2g} cells cause an error that differs between "
                 "the two grids; give 3 or more")
CROSSING = "with hat functions the error of particles that cross cells does not fall with the cell size"
NOT_FOLLOWING = ("the domains do not follow the material, which leaves an error that does not fall with the cell size; "
                 "switch linearity preservation on")


def displacement_per_cell_squared(scene: Any) -> float:
    """Returns the largest displacement of a bar's exact motion over the square of its cell size, A/h^2 in 1/m."""
    return scene.motion_amplitude / scene.spacing**2


def noise_removing_remedies(scene: Any) -> tuple[str, ...]:
    """Returns the remedies that only remove noise, so that two-grid holds beside them: the null-space filter, and where
    particles move little the coupling of F."""
    return (FILTER, COUPLED) if scene.motion_amplitude / scene.spacing < MOST_COUPLED else (FILTER,)


def is_too_noisy_for_two_grid(scene: Any) -> bool:
    """Returns whether two-grid cannot estimate a: crossing particles fill it with noise, which differs by grid."""
    return scene.motion_amplitude > QUIET.get(scene.method, QUIET_HATS) * scene.spacing


LIMITS = (
    # Transport and two-grid derive from the step what a run without one of its causes no longer has: of hats without
    # crossings transport's index of x is 24. Recovered and companion, which look at the motion, go on.
    *(Limit(name, lambda scene: scene.take_away if "budget" in scene.effects else NOTHING, allowed=(NOTHING,),
            why="a cause of error is taken out of the run, which only recovered and companion see; take one of them")
      for name in ("transport", "two-grid")),
    # Transport: its defects are those of weights that follow the particles; of B-splines they are next to nothing.
    # Measured with B-splines at 40 and 160 cells: indices .000-.006 for A = 2.5e-4, .005-.46 for .025, .08-.75 for .05.
    Limit("transport", "swings", allowed=(True,), why="transport estimates zero if a patch test passes, and thousands "
          "of times the error of x if it fails; take companion"),
    MOVING_WEIGHTS,
    # Measured: .3 to 1.7 times x and up to 1.6 times sigma on 21 bars; with the null-space filter 1.1 at most.
    Limit("transport", lambda scene: COUPLED in scene.remedies, allowed=(False,), why="displacement-coupled F takes "
          "errors out of F that transport goes on carrying; leave it out, or take recovered or companion"),
    Limit("transport", "remedies", allowed=(FILTER, CENTRED), why="the terms that transport carries are those "
          "of a particle's own weights, and forces of pieces have other ones; take recovered or companion"),
    Limit("transport", "method", allowed=("mpm", "ugimp", "cpgimp"), why="the terms of transport nearly vanish for "
          "B-splines, so that its estimate is almost zero; take recovered or companion"),
    # Measured under the exact force: an index of x above 1.2, up to 2.1, on 16 of 68 such bars, up to 1.3 on 5 of 147
    # with other methods or without linearity preservation.
    Limit("transport", "linearity_preserving", allowed=(False,), where={"method": "mpm"}, why="with linearity "
          "preservation only transport's quadratic term is left, and with hat functions that may be as large as the "
          "interpolation error of the velocity that it leaves out, with the other sign; take recovered or companion"),
    # Recovered: its tables repeat from cell to cell, and it fits what is smooth.
    Limit("recovered", "swings", allowed=(True,), why="recovered fits a smooth motion to whole numbers of particles "
          "per cell, and with these a patch test has no error but round-off; take companion"),
    Limit("recovered", "courant_number", most=MOST_WAVE_CFL, why="recovered has its own equation of motion, which is "
          "unstable with such steps; give a cfl of {most:.2g} or less"),
    # Two-grid: Richardson's argument needs an error that falls like h^2 on both grids.
    Limit("two-grid", "swings", allowed=(True,), why="the error of a patch test comes from round-off or from unequal "
          "numbers of particles in the cells and does not fall with the cell size; take companion"),
    Limit("two-grid", "remedies", allowed=noise_removing_remedies, why=REMEDIES_REASON),
    # A wave needs 16 cells; the second run has 8. With 12 the index of x is 1.2 and its distance 1.4. The second tone
    # has half the wavelength. Measured for far motion: index of x .42 with 40 cells, 1.06 with 80.
    Limit("two-grid", "cells", least=64, where={"body_force": "two-tone"},
          above=(displacement_per_cell_squared, MOST_MOTION), why=HALF_REASON),
    Limit("two-grid", "cells", least=lambda scene: 16 * scene.highest_harmonic, why=HALF_REASON),
    # One or two particles are a coarse rule of quadrature, whose error depends on where in the cell they stand.
    # Particles that move a good part of a cell make it another one on each grid, and no power of h; measured, with one
    # a cell: .61-.70 of the error of sigma at .09 to .54 cells, .8 to .9 at .03 to .07.
    Limit("two-grid", "motion_amplitude", most=1 / 16, of="spacing", where={"ppc": 1}, why=FEW_PARTICLES),
    Limit("two-grid", "motion_amplitude", most=1 / 4, of="spacing", where={"ppc": 2}, why=FEW_PARTICLES),
    # The noise stays in what the nodes do not see and grows with every period; after 16 of them the distance of x is
    # .64 with 80 cells and .79 with 160.
    Limit("two-grid", "end_time", most=6, of="period", where={is_too_noisy_for_two_grid: True},
          why="particles that cross cells cause noise that differs between the two grids and grows with every period; "
          "end within {most} or take a smaller amplitude"),
    Limit("two-grid", displacement_per_cell_squared, most=MOST_MOTION, where={"body_force": "node"},
          why="the force at the nodes is "
          "off by the displacement, an error that both grids share and none shows"),
    # With hats no particle may reach the next cell, and the error of quadrature grows with the motion as soon as
    # particles stand unevenly: x .9 to 1.1 on 6 of 7 bars below, .50 to .60 on 6 from .9 on.
    Limit("two-grid", "motion_amplitude", below=lambda scene: scene.spacing / (2 * scene.ppc), where={"method": "mpm"},
          why=CROSSING),
    Limit("two-grid", displacement_per_cell_squared, below=0.5, where={"method": "mpm", "linearity_preserving": False},
          why=CROSSING),
    Limit("two-grid", displacement_per_cell_squared, most=MOST_MOTION,
          where={"method": "ugimp", "linearity_preserving": False}, why=NOT_FOLLOWING),
    # The kinks of B-splines are weaker; measured: good on 6 bars between, .73 at 150.
    Limit("two-grid", displacement_per_cell_squared, most=30.0,
          where={"method": "bspline", "linearity_preserving": False}, why=NOT_FOLLOWING),
    phase_lag_limit(lambda scene: 2 * math.pi * scene.highest_harmonic))
