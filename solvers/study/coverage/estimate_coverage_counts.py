"""Counts of how often the estimates of random runs were right.

``is_within`` counts runs in which the estimate is within a factor of the true error: 1/f <= index <= f, an index being
estimated over true error, in norms summed over the run. Only runs that ended as "ok" count, and of an estimator only
those in which it did not refuse.

Beside estimators stand the grid convergence index and its successors, which say how uncertain a number is from the same
number on coarser grids, and mean to hold the truth in 95 of 100 cases: P. J. Roache, "Perspective: a method for uniform
reporting of grid refinement studies", J. Fluids Eng. 116 (1994) 405; I. B. Celik and others, "Procedure for estimation
and reporting of uncertainty due to discretization in CFD applications", J. Fluids Eng. 130 (2008) 078001; T. Xing and
F. Stern, "Factors of safety for Richardson extrapolation", J. Fluids Eng. 132 (2010) 061403."""

import functools
import math
import statistics
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from solvers.running.quantities_of_interest import SAFETY
from solvers.solver.soundness import OK
from solvers.study.coverage.random_runs import AFTER, BEFORE, COARSEST, IMPOSSIBLE, QUANTITIES

SCHEMA = "mpm-lab/coverage/1"
FACTORS = (1.1, 1.5, 2.0)
NEEDLESS = 1.5  # a refusal was needless where the estimate would have been within such a factor of x, v and sigma
SAFETIES = (1.0, SAFETY, 3.0)
CENTRAL = 0.8  # the share of runs between whose ratios an estimator may bet; as many lie below as above
HELD_SHARE = 0.95  # of cases, that a bar means to hold
MOST_DECADES = 6.0  # that a bar may be too long or too short in its score
ORDERS = {"1.5 to 2.5": (1.5, 2.5), "another": (-math.inf, math.inf)}  # observed; the first that fits
NO_ORDER = "none"
COARSEST_CELLS = {"under 8 cells": 8, "8 to 15 cells": 16, "16 or more": math.inf}  # the first above
IN_CELL, ONE_CELL, SEVERAL_CELLS = "within their cells", "up to a cell", "several cells"
REGIMES = (IN_CELL, ONE_CELL, SEVERAL_CELLS)
NORMAL = 1.96  # standard deviations, for 95 %

FORMAL_ORDER = 2.0  # of the method, in h with dt in proportion to h
RATIO = 2.0  # from each grid to the next coarser one
TWO_GRIDS, THREE_GRIDS = 3.0, 1.25  # Roache's factors of safety
MOST_ORDER = 2.0  # of three grids: an observed order above the formal one is taken for that, as is recommended


def motion_regime(moved: float, ppc: float) -> str:
    """Returns whether particles stay in their cells, pass into the next or cross several, if they move by ``moved``
    cells: with ``ppc`` per cell, those next to an edge stay in theirs up to 1/(2 ppc)."""
    return IN_CELL if moved <= 0.5 / ppc else ONE_CELL if moved <= 1 else SEVERAL_CELLS


def row_motion_regime(row: Mapping) -> str:
    """Returns the :func:`motion_regime` of a stored run."""
    return motion_regime(row["moved"], row["scene"]["ppc"])


def wilson_interval(count: int, total: int) -> tuple[float, float]:
    """Returns the 95 % confidence interval of a share, 0 to 1, for ``count`` of ``total`` (E. B. Wilson, 1927)."""
    share, z = count / total, NORMAL**2 / total
    middle, half = share + z / 2, NORMAL * math.sqrt(share * (1 - share) / total + z / (4 * total))
    return max(0.0, (middle - half) / (1 + z)), min(1.0, (middle + half) / (1 + z))


def tally(problem: str, seed: int, rows: Sequence[dict]) -> dict:
    """Returns counts of a problem's random runs (rows of ``random_runs.measure``) as a dict for JSON: runs by status,
    and how often each estimator, and each bar around a goal, was right; the same for all runs that are ok "by truth"
    alone, also where an estimator called them lost."""
    usable = [row for row in rows if row["status"] == OK]
    names = list(dict.fromkeys(name for row in usable for name in row["estimators"]))
    goals = list(dict.fromkeys(kind for row in usable for kind in row["goals"]))
    return {"schema": SCHEMA, "problem": problem, "seed": seed, "runs": len(rows),
            "status": count_statuses(rows),
            "estimators": {name: _count_by_group(usable, functools.partial(_count_within_factors, name=name))
                           for name in names}, "refusals": {name: _count_refusals(usable, name) for name in names},
            "goals": {kind: _count_by_group(usable, functools.partial(_count_bars, kind=kind, names=names))
                      for kind in goals},
            "grids": {name: count_grid_index(usable, name) for name in INTERVALS},
            "by truth": _count_by_truth([row for row in rows if row.get("by_truth") == OK], names, goals)}


def _count_by_truth(rows: Sequence[dict], names: Sequence[str], goals: Sequence[str]) -> dict:
    """Returns counts of ``rows`` as :func:`tally` has them of ok runs, for all methods and regimes together."""
    return {"runs": len(rows), "estimators": {name: _count_within_factors(rows, name) for name in names},
            "goals": {kind: _count_bars(rows, kind, names) for kind in goals}}


def count_grid_index(rows: Sequence[dict], name: str) -> dict:
    """Returns how often an interval of ``INTERVALS``, by its name, contained the truth, all goals together: by the
    order observed on the three grids, and by the cells of the coarsest."""
    found: dict[str, dict[str, list[int]]] = {"order": {key: [0, 0] for key in (*ORDERS, NO_ORDER)},
                                              "coarsest": {key: [0, 0] for key in COARSEST_CELLS}}
    for row in rows:
        coarsest = next(key for key, above in COARSEST_CELLS.items() if row["scene"]["cells"] // COARSEST < above)
        for goal in filter(_is_known, row["goals"].values()):
            bar = INTERVALS[name](goal["grids"]) if _has_grids(goal) else None
            if bar is None:
                continue
            order = observed_order(goal["grids"])
            group = NO_ORDER if order is None else next(key for key, (low, high) in ORDERS.items()
                                                        if low <= order <= high)
            for counts in (found["order"][group], found["coarsest"][coarsest]):
                counts[0] += abs(goal["true_error"]) <= bar
                counts[1] += 1
    return {split: {key: {"held": held, "runs": runs} for key, (held, runs) in groups.items()}
            for split, groups in found.items()}


def _is_known(goal: Mapping) -> bool:
    """Returns whether the true error of a stored goal is known and more than rounding."""
    return goal["true_error"] is not None and abs(goal["true_error"]) > (goal["rounding"] or 0.0)


def _has_grids(goal: Mapping) -> bool:
    return len(goal["grids"]) == 3 and None not in goal["grids"]


def _count_by_group(rows: Sequence[dict], count: Callable[[Sequence[dict]], dict]) -> dict:
    """Returns what ``count`` returns for all rows, by regime of motion, by method, and by both."""
    methods = sorted({row["scene"]["method"] for row in rows})
    return {"all": count(rows),
            "regime": {one: count([row for row in rows if row_motion_regime(row) == one]) for one in REGIMES},
            "method": {one: count([row for row in rows if row["scene"]["method"] == one]) for one in methods},
            "method and regime": {method: {one: count([row for row in rows if row_motion_regime(row) == one
                                                       and row["scene"]["method"] == method]) for one in REGIMES}
                                  for method in methods}}


def _count_within_factors(rows: Iterable[dict], name: str) -> dict:
    """Returns by quantity the number of runs with an estimate by ``name``, and in how many it is within each factor."""
    said = [row["estimators"][name] for row in rows if not row["estimators"][name]["refused"]]
    found = {}
    for q in QUANTITIES:
        indices = [one["index"][q] for one in said if one["index"][q] is not None]
        ends = [one["end"][q] for one in said if one["end"][q] is not None]
        middle = np.quantile(ends, [(1 - CENTRAL) / 2, (1 + CENTRAL) / 2]).tolist() if ends else None
        found[q] = {"runs": len(indices), "within": _count_by_factor(indices), "median": median_if_any(indices),
                    "at the end": {"runs": len(ends), "within": _count_by_factor(ends), "middle": middle}}
    return found


def _count_by_factor(indices: Sequence[float]) -> dict[str, int]:
    return {f"{factor:g}": sum(is_within(index, factor) for index in indices) for factor in FACTORS}


def is_within(index: float, factor: float) -> bool:
    """Returns whether ``index``, estimated over true error, is between 1/``factor`` and ``factor``."""
    return 1 / factor <= index <= factor


def _count_refusals(rows: Sequence[dict], name: str) -> dict:
    """Returns by kind of refusal how often an estimator (by name) was refused, and how often needlessly."""
    found: dict[str, Any] = {"runs": len(rows)}
    for kind in (BEFORE, AFTER, IMPOSSIBLE):
        refused = [row["estimators"][name]["index"] for row in rows if row["estimators"][name]["refused"] == kind]
        told = [known for index in refused if (known := [value for value in index.values() if value is not None])]
        found[kind] = {"runs": len(refused), "told": len(told),
                       "needless": sum(all(is_within(value, NEEDLESS) for value in known) for known in told)}
    return found


def _count_bars(rows: Sequence[dict], kind: str, names: Sequence[str]) -> dict:
    """Returns for a goal (``kind``) how often bars around the value contained the truth: multiples of the estimated
    error, and grid convergence indices. ``width`` is the median of the bar over the true error, ``score`` the mean of
    :func:`bar_score`."""
    found: dict[str, Any] = {}
    known = [goal for row in rows if _is_known(goal := row["goals"][kind])]
    for name in names:
        errors = [(abs(goal["estimated_error"][name]), abs(goal["true_error"])) for goal in known
                  if goal["estimated_error"].get(name) is not None]
        for times in SAFETIES:
            found[f"{times:g} x {name}"] = _bar_counts([(times * said, true) for said, true in errors], len(known))
    for name, bar in INTERVALS.items():
        bars = [(bar(goal["grids"]), abs(goal["true_error"])) for goal in known if _has_grids(goal)]
        found[name] = _bar_counts([(said, true) for said, true in bars if said is not None], len(known))
    return found


def _bar_counts(bars: Sequence[tuple[float, float]], total: int) -> dict:
    return {"of": total, "runs": len(bars), "held": sum(true <= said for said, true in bars),
            "width": median_if_any([said / true for said, true in bars]),
            "score": float(np.mean([bar_score(said, true) for said, true in bars])) if bars else None}


def bar_score(bar: float, true: float) -> float:
    """Returns the interval score of a ``bar`` that means to hold the size ``true`` of an error in 95 of 100 cases: the
    decades by which it is too long, or 19 times those by which it is too short. Its mean is least for the bar that
    holds just 95 %: neither wide bars nor narrow ones win (as in lesson 10, of the upper end alone)."""
    decades = MOST_DECADES if bar == 0 else min(abs(math.log10(bar / true)), MOST_DECADES)
    return decades if bar >= true else decades * HELD_SHARE / (1 - HELD_SHARE)


def count_statuses(rows: Sequence[Mapping]) -> dict[str, int]:
    """Returns the number of rows by status, in the order in which they come first."""
    return dict(Counter(row["status"] for row in rows))


def median_if_any(values: Sequence[float]) -> float | None:
    """Returns the median of ``values``, None without any."""
    return float(statistics.median(values)) if values else None


def observed_order(values: Sequence[float]) -> float | None:
    """Returns the order p at which a number converges, from its ``values`` on the grids h, 2h, 4h; None without
    monotonic convergence, 0 < (f2 - f1)/(f3 - f2) < 1."""
    fine, coarse = values[1] - values[0], values[2] - values[1]
    if not coarse or not 0 < fine / coarse < 1:
        return None
    return math.log(coarse / fine) / math.log(RATIO)


def two_grid_gci(values: Sequence[float]) -> float | None:
    """Returns Roache's index 3 |f2 - f1| / (r^p - 1) with the formal order p, from the values on the grids h and 2h."""
    return TWO_GRIDS * abs(values[1] - values[0]) / (RATIO**FORMAL_ORDER - 1)


def three_grid_gci(values: Sequence[float]) -> float | None:
    """Returns Roache's index, 1.25 |f2 - f1| / (r^p - 1) with the observed order, at most the formal one, from values
    on h, 2h and 4h; None where no order is observed."""
    order = observed_order(values)
    return None if order is None else THREE_GRIDS * abs(values[1] - values[0]) / (RATIO**min(order, MOST_ORDER) - 1)


def xing_stern_grid_uncertainty(values: Sequence[float]) -> float | None:
    """Returns Xing and Stern's uncertainty from values on h, 2h and 4h; None where no order is observed. Its factor
    grows with the order's deviation from the formal one."""
    order = observed_order(values)
    if order is None:
        return None
    share = order / FORMAL_ORDER
    factor = 2.45 - 0.85 * share if share <= 1 else 16.4 * share - 14.8
    return factor * abs(values[1] - values[0]) / (RATIO**order - 1)


#: The half width of an interval around the number on the finest grid, by what it is called.
INTERVALS: Mapping[str, Callable[[Sequence[float]], float | None]] = {
    "GCI, 2 grids": two_grid_gci, "GCI, 3 grids": three_grid_gci, "Xing and Stern": xing_stern_grid_uncertainty}
