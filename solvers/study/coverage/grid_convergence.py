"""The grid convergence index, and its successors: how uncertain a number is, from the same number on coarser grids.

P. J. Roache, "Perspective: a method for uniform reporting of grid refinement studies", J. Fluids Eng. 116 (1994) 405;
I. B. Celik and others, "Procedure for estimation and reporting of uncertainty due to discretization in CFD
applications", J. Fluids Eng. 130 (2008) 078001; T. Xing and F. Stern, "Factors of safety for Richardson extrapolation",
J. Fluids Eng. 132 (2010) 061403. All mean to hold the truth in 95 of 100 cases.
"""

import math
from collections.abc import Callable, Mapping, Sequence

FORMAL_ORDER = 2.0  # of the method, in h with dt in proportion to h
RATIO = 2.0  # from each grid to the next coarser one
TWO_GRIDS, THREE_GRIDS = 3.0, 1.25  # Roache's factors of safety
MOST_ORDER = 2.0  # of three grids: an observed order above the formal one is taken for that, as is recommended


def observed_order(values: Sequence[float]) -> float | None:
    """p by which the number converges on the grids h, 2h, 4h (fine to coarse); None where it does not do so from one
    side: 0 < (f2 - f1)/(f3 - f2) < 1."""
    fine, coarse = values[1] - values[0], values[2] - values[1]
    if not coarse or not 0 < fine / coarse < 1:
        return None
    return math.log(coarse / fine) / math.log(RATIO)


def two_grids(values: Sequence[float]) -> float | None:
    """Roache's index of two grids and the formal order: 3 |f2 - f1| / (r^p - 1)."""
    return TWO_GRIDS * abs(values[1] - values[0]) / (RATIO**FORMAL_ORDER - 1)


def three_grids(values: Sequence[float]) -> float | None:
    """Roache's index of three grids with the observed order, at most the formal one: 1.25 |f2 - f1| / (r^p - 1); None
    where no order is observed."""
    order = observed_order(values)
    return None if order is None else \
        THREE_GRIDS * abs(values[1] - values[0]) / (RATIO**min(order, MOST_ORDER) - 1)


def factor_of_safety(values: Sequence[float]) -> float | None:
    """Xing and Stern's: a factor that grows with the distance of the observed order from the formal one."""
    order = observed_order(values)
    if order is None:
        return None
    share = order / FORMAL_ORDER
    factor = 2.45 - 0.85 * share if share <= 1 else 16.4 * share - 14.8
    return factor * abs(values[1] - values[0]) / (RATIO**order - 1)


#: The half width of an interval around the number on the finest grid, by what it is called.
INTERVALS: Mapping[str, Callable[[Sequence[float]], float | None]] = {
    "GCI, 2 grids": two_grids, "GCI, 3 grids": three_grids, "Xing and Stern": factor_of_safety}
