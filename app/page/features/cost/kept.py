"""What searches on this server have measured, for later ones that ask about the same motion, whoever's they are.

Same input, same bits: errors and ends of runs hold for as long as the server runs. Times do not: they are kept for an
hour, and those taken beside other work apart from those taken alone, for a search is to compare like with like.
"""

import threading
import time
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field

MOST_QUESTIONS, MOST_POINTS = 64, 500  # of which the least lately asked, or the oldest, goes: some 10 MB in all
HOLDS = 3600.0  # seconds for which a time is believed


@dataclass
class _Point:
    """What is known of one run: as ``solvers.study.found.told`` says it, and its rates with the moments at which they
    were taken, by whether nothing disturbed them."""

    told: dict
    rates: dict[bool, tuple[float | None, float]] = field(default_factory=dict)

    def as_taken(self, quiet: bool, since: float) -> dict:
        """With the rate that was taken so and later than that, if there is one."""
        rate, taken = self.rates.get(quiet, (None, since))
        return self.told | ({"rate": rate} if taken > since else {})


class KeptPoints:
    """Points by question (what a search is about, as text) and by key of their rows. Safe from any thread."""

    def __init__(self, now: Callable[[], float] = time.monotonic):
        self._lock, self._now = threading.Lock(), now
        self._questions: OrderedDict[str, dict[str, _Point]] = OrderedDict()

    def keep(self, question: str, key: str, told: dict, quiet: bool) -> None:
        """Take in what a search has said of a run, and whether nothing disturbed its time."""
        with self._lock:
            points = self._questions.setdefault(question, {})
            self._questions.move_to_end(question)
            point = points.setdefault(key, _Point({name: told[name] for name in ("error", "status", "reason")}))
            point.rates[quiet] = told["rate"], self._now()
            if len(points) > MOST_POINTS:
                del points[next(iter(points))]
            if len(self._questions) > MOST_QUESTIONS:
                self._questions.popitem(last=False)

    def known(self, question: str, quiet: bool) -> dict[str, dict]:
        """The points of a question, for a search that nothing disturbs, or that runs beside other work: with rates that
        were taken alike, and not too long ago; else without."""
        with self._lock:
            since = self._now() - HOLDS
            return {key: point.as_taken(quiet, since) for key, point in self._questions.get(question, {}).items()}


KEPT = KeptPoints()
