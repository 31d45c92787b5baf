"""ErrorHistory: the largest errors of one run until each time, and when it broke."""

from collections import OrderedDict
from collections.abc import Callable, Hashable, Iterable
from dataclasses import dataclass, field
from threading import Lock

import numpy as np

from solvers.solver.samples import QUANTITIES
from solvers.solver.soundness import OK, UNSTABLE

REFUSED = "refused"  # the status of a scene that is not valid
TRUTH = "truth"
MOST_HISTORIES = 10_000  # of 1 kB to 5 kB


@dataclass(frozen=True, eq=False)
class ErrorHistory:
    """History of a run until ``until``, in periods. ``phase`` (T,) are some 20 to 40 times a period, and the end, in
    periods; ``errors`` the largest RMS errors (4, T) of x, v, sigma and a in all samples until then, in SI units, by
    source: "truth" and the estimators that are valid; ``sizes`` (4,) are the scales of these errors. ``status`` is that
    of the run at its end, or "refused", ``broken_at`` the time in periods since when, if it is not ok. ``rate`` is the
    number of particle-steps per s with which it was computed."""

    until: float
    phase: np.ndarray = field(default_factory=lambda: np.zeros(0))
    errors: dict[str, np.ndarray] = field(default_factory=dict)
    sizes: np.ndarray = field(default_factory=lambda: np.ones(len(QUANTITIES)))
    status: str = OK
    broken_at: float = np.inf
    rate: float = np.nan

    def largest_error(self, source: str, quantity: str, until: float) -> float:
        """Returns the largest error of a quantity until a time in periods over its size, interpolated between samples;
        NaN if the source is not there, or the run is unstable by then."""
        if source not in self.errors or self.status_at(until) == UNSTABLE:
            return np.nan
        row = QUANTITIES.index(quantity)
        return float(np.interp(until, self.phase, self.errors[source][row]) / self.sizes[row])

    def status_at(self, until: float) -> str:
        """Returns the status of the run at a time in periods."""
        return self.status if self.status == REFUSED or until >= self.broken_at else OK


class HistoryCache:
    """Histories by keys, those that were used last; thread-safe. Each of the ``listeners`` is called after new ones."""

    def __init__(self) -> None:
        self._lock, self._histories = Lock(), OrderedDict[Hashable, ErrorHistory]()
        self.listeners: set[Callable[[], None]] = set()

    def get(self, key: Hashable) -> ErrorHistory | None:
        """Returns the history with a key, if it is known."""
        with self._lock:
            if key in self._histories:
                self._histories.move_to_end(key)
            return self._histories.get(key)

    def put(self, histories: Iterable[tuple[Hashable, ErrorHistory]]) -> None:
        """Stores histories with their keys, unless longer ones are known."""
        with self._lock:
            for key, history in histories:
                known = self._histories.get(key)
                if known is None or known.until < history.until:
                    self._histories[key] = history
                if len(self._histories) > MOST_HISTORIES:
                    self._histories.popitem(last=False)
        for listener in tuple(self.listeners):
            listener()
