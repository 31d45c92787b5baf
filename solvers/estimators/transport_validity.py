"""Shared part of the paper's estimators of all problems: when not to trust them."""

import numpy as np

from solvers.translatable_message import Message

NOTHING = 1e-9  # of the acceleration: rounding of second differences, which a real estimate is far above
#: Of the acceleration. Transport takes slopes and curvature of the stress from the computed acceleration a + E, where
#: it means a: so its estimate may be (a + E)/a = 1/(1 - share) times the error, which from a third on is 1.5 and more.
MOST = 1 / 3


def why_not_trusted(squares: np.ndarray) -> str | None:
    """Returns why not to trust transport's estimate, as a sentence, or None. ``squares`` (2,) are sums over nodes, by
    mass, and over its steps so far, of the squares of its error of a and of the internal part of a, in SI; both are
    zero before it has begun."""
    if squares[1] == 0:
        return None
    with np.errstate(invalid="ignore"):  # both may be infinite, of an unstable run
        share = float(np.sqrt(squares[0] / squares[1]))
    if share < NOTHING:
        return Message("not valid here: the terms of transport vanish for this mapping, so that its estimate is zero")
    if not share < MOST:  # true for NaN too
        return Message("not valid here: transport takes the computed acceleration for the exact one, and by its own "
                       "estimate that is off by {share:.2g} times its size; it holds up to a third", share)
    return None
