"""Bets: intervals that should contain a result, their scores, and those of a class and of judges.

An interval from a to b that should contain the truth t with probability 1 - alpha has the interval score (R. L.
Winkler, J. Am. Stat. Assoc. 67 (1972) 187; T. Gneiting and A. E. Raftery, ibid. 102 (2007) 359): its width plus 2/alpha
times the distance by which it misses. Less is better; the expected score is least for one's own quantiles alpha/2 and
1 - alpha/2. Here it is computed from log10 of a, b and t, since errors span decades: in metres one bad run would decide
everything, and relative to the truth low bets would be rewarded. The logarithm is monotonic: the score stays proper."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass

from app.lessons.lesson import INTERVAL, Lesson, Step
from solvers.study.coverage.track_record_and_bets import JUDGES, LEVEL, Ends

YOURS, BY_ROUND = "yours", "yours by round"
OWN = (YOURS, BY_ROUND)  # the student's own bets, not a judge's
BETTORS = (YOURS, BY_ROUND, *JUDGES)
WORTHLESS = 2.0  # score of a bet without points: a factor of 100 wide, or, at level 0.8, off by a factor of 1.6
#: Path that judges can bet on: a run's final error, "fine.error.x.final".
PATH = re.compile(r"(?:(?P<run>[a-z][a-z0-9_]*)\.)?error\.(?P<quantity>x|v|sigma)\.final")
ABOUT_BETS = re.compile(r"\bbet\.")  # in a claim with a path to a judge's bet, "hat.bet.gci.x.score"


def interval_score(low: float, high: float, truth: float, level: float) -> float:
    """Returns the interval score, in powers of ten (0 is perfect, less is better), of a bet that the truth is from
    ``low`` to ``high`` with probability ``level``; all three are sizes above 0 in one unit."""
    least, most, true = math.log10(low), math.log10(high), math.log10(truth)
    return most - least + 2 / (1 - level) * max(least - true, true - most, 0.0)


@dataclass(frozen=True)
class IntervalBet:
    """Bet that a size is from ``low`` to ``high`` with probability ``level``; ``truth`` is the true one, same unit."""

    low: float
    high: float
    truth: float
    level: float = LEVEL

    @property
    def holds(self) -> bool:
        return self.low <= self.truth <= self.high

    @property
    def score(self) -> float:
        return interval_score(self.low, self.high, self.truth, self.level)

    @property
    def points(self) -> float:
        """Points of the bet: 1 for a score of 0, falling linearly to 0 for a score of 2 and more."""
        return max(0.0, 1 - self.score / WORTHLESS)


@dataclass(frozen=True)
class Bettor:
    """Bets of a student or judge, None for no bet; of a student perhaps those of one ``round``, counted from 1."""

    name: str
    bets: tuple[IntervalBet | None, ...]
    round: int = 0

    @property
    def placed_bets(self) -> list[IntervalBet]:
        return [bet for bet in self.bets if bet is not None]

    @property
    def hits(self) -> int:
        return sum(bet.holds for bet in self.placed_bets)

    @property
    def score(self) -> float | None:
        """The mean score of the bets placed (:func:`interval_score`); None without any."""
        return sum(bet.score for bet in self.placed_bets) / len(self.placed_bets) if self.placed_bets else None


def earlier_bet_steps(lesson: Lesson, step: Step) -> list[Step]:
    """Returns the steps of a lesson before ``step`` that ask for an interval, in order."""
    before = lesson.steps[:lesson.steps.index(step)]
    return [other for other in before if other.question and other.question.kind == INTERVAL]


def judge_name_in_claims(judge: str) -> str:
    """Returns the name in claims of a judge (an estimator that bets, or GCI): "two_grid" for "two-grid"."""
    return judge.replace("-", "_").lower()


def judge_bets_for_claims(ends: Mapping[str, Mapping[str, Ends | None]],
                          errors: Mapping[str, Mapping[str, float | None]]) -> dict:
    """Returns the judges' bets on a run by the judge's name in claims and quantity: low, high and score, or None.

    ``ends`` has (low, high) by quantity and judge, ``errors`` the norms of the true error by quantity, SI units."""
    found: dict[str, dict[str, dict[str, float] | None]] = {judge_name_in_claims(judge): {} for judge in JUDGES}
    for quantity, judged in ends.items():
        truth = errors[quantity]["final"]
        for judge, pair in judged.items():
            found[judge_name_in_claims(judge)][quantity] = None if pair is None or not truth else \
                {"low": pair[0], "high": pair[1], "score": interval_score(*pair, truth, LEVEL)}
    return found
