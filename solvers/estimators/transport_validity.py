"""Shared part of the paper's estimators of all problems: when not to trust them."""

from solvers.translatable_message import Message

NOTHING = 1e-9  # of the motion's acceleration: rounding of second differences, which a real estimate is far above
MOST = 100.0  # of the motion's acceleration, at the worst node; up to 60 were seen where the index was still below 2


def why_not_trusted(error: float, begun: bool, size: float) -> str | None:
    """Returns why not to trust transport's estimate, as a sentence, or None. ``error`` is the largest estimated error
    of a at the nodes, ``size`` the motion's own acceleration, in m/s^2; None before the run has ``begun``."""
    if begun and error < NOTHING * size:
        return Message("not valid here: the terms of transport vanish for this mapping, so that its estimate is zero")
    if begun and not error < MOST * size:  # true for NaN too
        return Message("not valid here: transport's error of the acceleration is more than {most:g} times the "
                       "acceleration itself; it amplifies itself", MOST)
    return None
