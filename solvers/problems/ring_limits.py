"""Where an estimator of the ring is known, before anything has run, not to hold.

What only a run can show is the business of the estimator's own ``verdict``. A scene is a ``RingScene``, whose file
imports this one.
"""

import math
from collections.abc import Callable
from typing import Any

from solvers.estimators.phase_lag import out_of_step
from solvers.problems.planar.limits import off_lattice, too_few_across, transport
from solvers.scene.registry import REMEDIES_REASON
from solvers.scene.remedies import FILTER

FEWEST_CELLS = {"material": 12, "none": 48, "two-tone": 48}  # two move in waves across it; with 24 x is .7
COMPANION_LIMIT = 0.25  # amplitude: the index of the stress is 1.05 there (CPDI, 48 cells, one period), 5.7 at 0.3
RECOVERED_LIMIT = 0.22  # amplitude: x, v and sigma good in 8 of 10 rings of .2 to .22, 4 for a; nothing at 0.25
RECOVERED_TIME = 0.6  # periods until which both are good beyond: in the second half of one the ring is compressed
COMPRESSED = 0.2  # amplitude from which on two-grid's x may be .4 to .7 once the ring has been compressed
FEWEST_FILTERED = 15  # cells of a run with the filter; with 12 and 13 v is 1.2 and 1.5
FEWEST_WITH_GAPS, MOST_WITH_GAPS = 15, 8  # cells of a cpGIMP ring for two-grid, the second for each particle in a cell
MOST_GROWTH = 4.0  # two-grid, of a disturbance after the first period: measured at 7.7, .68 of the error of x
WIDTH = 0.2  # of the ring, in metres: the half wavelength of the longest wave across it


def two_grid(scene: Any) -> str | None:
    """Richardson's argument needs an error that falls like h^2; only CPDI's domains tile the lattice on all grids."""
    if others := [name for name in scene.remedies if name != FILTER]:  # which only takes noise away
        return REMEDIES_REASON.format(names=" and ".join(others))
    needed = max(FEWEST_CELLS[scene.body_force], FEWEST_FILTERED if scene.remedies else 0)
    if scene.layout == "cartesian":
        return "the staircase of the cartesian layout is another one on each grid, so their errors are not comparable"
    # What the boxes of cpGIMP leave open is less, the more particles there are: x .9 to 1.0 on 12 of 12 rings on which
    # that is less than the error of the cells, on 7 of 50 others.
    gaps_are_small = scene.method == "cpgimp" and scene.ppc >= 3 \
        and FEWEST_WITH_GAPS <= scene.cells <= MOST_WITH_GAPS * scene.ppc
    if scene.method != "cpdi" and not gaps_are_small:
        return "the boxes of this method do not tile the ring, so its error does not fall with the cell size; use CPDI"
    if scene.cells < needed:
        return f"the second run has half the cells, and half of {scene.cells} is too few; give {needed} or more"
    if scene.amplitude >= 0.6 - 2 * 1.2 / (scene.cells // 2):  # radius 0.6; two rows of cells lie below zero
        return "so large a motion would leave the grid of the second run; give more cells or a smaller amplitude"
    if scene.ppc == 1:
        return ("one particle per cell is so coarse a rule of quadrature that its error, of a cell's length, drowns "
                "what the two grids have in common; give two or more")
    if scene.amplitude > COMPRESSED and scene.end_time > RECOVERED_TIME * scene.period:
        return (f"at an amplitude above {COMPRESSED:g} the compressed ring is so unstable that the two runs part; end "
                f"within {RECOVERED_TIME:g} periods or take a smaller one")
    growth = scene.growth ** (scene.end_time / scene.period - 1)
    if growth > MOST_GROWTH:
        return (f"so large a motion is unstable: after the first period disturbances grow {growth:.2g}-fold or more, "
                "on each grid at another rate; end earlier or take a smaller amplitude")
    # The manufactured force moves the ring as a whole; the others send waves across it.
    return None if scene.body_force == "material" else out_of_step(scene, math.pi / WIDTH)


def companion(scene: Any) -> str | None:
    """Both solves must follow the same motion."""
    if scene.amplitude > COMPANION_LIMIT:
        return (f"at an amplitude above {COMPANION_LIMIT:g} the ring's motion is so unstable that a second solve of "
                "it leaves the first for reasons of its own")
    return None


def recovered(scene: Any) -> str | None:
    """The fits need a polar lattice with enough particles, and a motion that is not unstable."""
    if reason := off_lattice(scene):
        return reason
    if scene.amplitude > RECOVERED_LIMIT and scene.end_time > RECOVERED_TIME * scene.period:
        return (f"at an amplitude above {RECOVERED_LIMIT:g} the compressed ring is so unstable that recovered's own "
                f"equation of motion breaks down after {RECOVERED_TIME:g} periods; end earlier or take a smaller one")
    if scene.ppc == 1 and scene.velocity == "particle":
        return ("single particles per cell that move with their own velocity stand so unevenly that recovered's fits "
                "follow them; give two or more per cell, or the velocity grid")
    return too_few_across(scene)


RULES: dict[str, Callable[[Any], str | None]] = {
    "companion": companion, "recovered": recovered, "transport": transport, "two-grid": two_grid}


RESONANCE = 0.115  # amplitude from which on the ring's own motion is unstable: a disturbance grows with every period
WRINKLING = 0.198  # amplitude at which the surface of the compressed ring wrinkles (Biot)
#: A small disturbance of the exact motion in the mode n = 2 grows, computed, 1.44 times a period at A = 0.12, 1.84 at
#: 0.13, 2.20 at 0.14 and 2.57 at 0.15: exp(GROWTH sqrt(A^2 - ONSET^2)) to that accuracy. Of larger A no more is known.
GROWTH, ONSET, KNOWN = 9.69, 0.1139, 0.15
FIRST_ERROR = 1e-3  # relative error in that mode after one period, as CPDI leaves it on 24 cells; 48 leave a sixth
LARGE_ERROR = 0.1  # and the one that is called the end


def growth(amplitude: float) -> float:
    """How many times a period a disturbance of the exact motion grows in the mode n = 2, above ``KNOWN`` at least; 1
    where the motion is stable."""
    A = min(amplitude, KNOWN)
    return math.exp(GROWTH * math.sqrt(A * A - ONSET * ONSET)) if amplitude >= RESONANCE else 1.0


def expected_life(amplitude: float, first_error: float = FIRST_ERROR) -> float:
    """Periods until a relative error in the mode n = 2 of ``first_error`` after one has grown to a tenth."""
    rate = growth(amplitude)
    return 1 + math.log(LARGE_ERROR / first_error) / math.log(rate) if rate > 1 else math.inf


def warnings(scene: Any) -> list[str]:
    """Sentences about what a scene will surprise with."""
    sentences = [_resonance(scene.amplitude)] if scene.amplitude >= RESONANCE and scene.solution_known else []
    if "two-grid" in scene.active_estimators:
        sentences.append("two-grid says nothing of a on the ring: its error is noise of a cell's length, which "
                         "each of the two grids has in other places")
    return sentences


def _resonance(amplitude: float) -> str:
    """What becomes of a large motion, in one sentence."""
    beyond = amplitude > KNOWN
    wrinkles = f"; above {WRINKLING} its surface wrinkles as well" * (amplitude > WRINKLING)
    return (f"amplitude {amplitude:g}: from {RESONANCE} on the ring's own motion is unstable by parametric "
            f"resonance, which nothing cures; an error in the mode n = 2 grows {growth(amplitude):.2f}-fold a period"
            f"{' or faster' * beyond}, from {FIRST_ERROR:.1%} of the amplitude after the first to a tenth after "
            f"{'at most' if beyond else 'about'} {expected_life(amplitude):.2g}, from less of it later{wrinkles}")


def other_advice(scene: Any) -> str:
    """What else to do about a run that went bad, as an imperative."""
    if scene.amplitude >= RESONANCE:
        return (f"from A = {RESONANCE} on the ring's own motion is unstable (parametric resonance) and no remedy "
                "helps: choose a smaller amplitude or fewer periods")
    if scene.method == "mpm" and not scene.frozen:
        return f"hat functions hold only with the remedy {FROZEN}; or choose CPDI"
    if scene.method != "cpdi" and not scene.remedies:
        return f"call for the remedies {FILTER},{COUPLED}, or choose CPDI"
    return "choose more particles per cell, a smaller amplitude or fewer periods"
