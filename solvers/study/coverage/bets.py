"""What each judge bets on the error at the end of a run: two sizes between which it is to lie, in 80 of 100 runs.

An estimator bets by its track record: between those multiples of its estimate between which 80 of 100 true errors of
the thousand runs in ``assets/coverage`` lay, of its problem and quantity. So it knows how far off it usually is, and
nothing of the run beyond its own number. Where it is not valid it does not bet.

The grid convergence index bets by its own word: 3 times what two grids say the error is holds the truth in 95 of 100
cases. If errors are normal that is 1.96 standard deviations, and their sizes lie between 0.13 and 1.64 of these in 80
of 100. It is asked of every run, as it is in practice; what two grids say is what ``two-grid`` reads, valid or not.
"""

from __future__ import annotations

import math
from dataclasses import replace
from statistics import NormalDist

from solvers.scene.scene import Scene
from solvers.study.coverage import track_record
from solvers.study.coverage.grid_convergence import TWO_GRIDS
from solvers.study.coverage.measured import QUANTITIES, heard, refused
from solvers.study.coverage.tally import MIDDLE, NORMAL

GCI, RICHARDSON = "GCI", "two-grid"
ESTIMATORS = ("companion", "recovered", RICHARDSON, "transport")
JUDGES = (*ESTIMATORS, GCI)
LEVEL = MIDDLE
EFFECTS = ("truth", "estimate", "soundness")
Ends = tuple[float, float]


def bets(scene: Scene) -> dict[str, dict[str, Ends | None]]:
    """By quantity (x in m, v in m/s, sigma in Pa) and judge, the ends of the bet on the RMS error over the particles
    at the end of the run; None where the judge does not bet. Runs the scene, with all estimators of its problem."""
    from solvers.running.run import run  # here: what a judge is called can be known without Taichi

    asked = replace(scene, estimators=scene.choices("estimators"), effects=EFFECTS)
    result = run(heard(asked), mid_run=False, prices=False)

    def said(name: str, quantity: str) -> float | None:
        """What an estimator says, refused or not; None where it is no size."""
        series = result.series.get(f"{name}/estimate_{quantity}")
        found = math.nan if series is None else float(series[-1])
        return found if math.isfinite(found) and found > 0 else None

    found: dict[str, dict[str, Ends | None]] = {}
    for q in QUANTITIES:
        by_record = {name: by_the_record(scene.problem, name, q, said(name, q))
                     if name in asked.estimators and not refused(name, asked, result) else None for name in ESTIMATORS}
        found[q] = {**by_record, GCI: by_its_word(said(RICHARDSON, q))}
    return found


def by_the_record(problem: str, estimator: str, quantity: str, said: float | None) -> Ends | None:
    """The bet of an estimator that has ``said`` a size; None without one, or without a record."""
    ratios = track_record.middle(problem, estimator, quantity)
    return None if said is None or ratios is None else (said / ratios[1], said / ratios[0])


def by_its_word(said: float | None) -> Ends | None:
    """The bet of the index where two grids have ``said`` a size: errors are normal, and it is 1.96 of their deviations.
    """
    if said is None:
        return None
    deviation = TWO_GRIDS * said / NORMAL
    # The sizes of normal errors have the quantile q where the errors themselves have (1 + q)/2.
    low, high = (NormalDist().inv_cdf((1 + q) / 2) for q in ((1 - LEVEL) / 2, (1 + LEVEL) / 2))
    return low * deviation, high * deviation
