"""The chart of bets as data: per bettor a sentence and a line per bet, on a logarithmic scale around the truth."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from app.language.translation import lazy, tr
from app.lessons.answer_marking import AnswerMark
from app.lessons.interval_bets import OWN, YOURS, Bettor, IntervalBet

MOST = 4  # powers of ten to either side; longer lines are clipped
YOUR_BETS, ROUND = lazy("Your bets"), lazy("Your round {number}")  # judges keep their names
TOLD = lazy("{held} of {made} contain the truth, mean score {score}")
SOME = lazy("{held} of {made} contain the truth, {left} without a bet, mean score {score}")
NONE = lazy("does not bet on these")
SCORED = lazy("{told}; score {score}")  # the result, and the score of one bet
SAID = lazy("Bets in order, as multiples of the true value (middle line). {share} of 100 should contain it.")
TRUTH, LESS, MORE = lazy("truth"), "÷ {factor}", "× {factor}"


@dataclass(frozen=True)
class BettorIntervalLines:
    """A bettor's bets as lines: each the start and end in per cent of the chart's width and whether the bet contains
    the truth, None for no bet. ``result`` is a sentence on all, ``own`` whether they are the student's."""

    name: str
    result: str
    own: bool
    lines: tuple[tuple[float, float, bool] | None, ...]


@dataclass(frozen=True)
class IntervalBetChart:
    """Chart of bets on a logarithmic axis, the truth in the middle: ``reach`` powers of ten to either side."""

    reach: int
    description: str
    bettors: tuple[BettorIntervalLines, ...]

    @property
    def ticks(self) -> list[tuple[float, str]]:
        """Positions in per cent of the width, and labels, of both ends and the middle of the axis."""
        factor = f"{10**self.reach:,}"
        return [(0.0, LESS.format(factor=factor)), (50.0, tr(TRUTH)), (100.0, MORE.format(factor=factor))]


def make_bet_chart(bettors: Sequence[Bettor]) -> IntervalBetChart:
    """Returns the chart of bettors who bet on the same questions, in their order."""
    every = [bet for bettor in bettors for bet in bettor.placed_bets]
    farthest = max((abs(decades_above_truth(end, bet)) for bet in every for end in (bet.low, bet.high)), default=0.0)
    reach = min(max(math.ceil(farthest), 1), MOST)
    share = sum(bet.level for bet in every) / max(1, len(every))
    return IntervalBetChart(reach, tr(SAID, share=f"{100 * share:.0f}"),
                            tuple(_bettor_lines(bettor, reach) for bettor in bettors))


def decades_above_truth(end: float, bet: IntervalBet) -> float:
    """Returns log10 of an end of a bet over its true value."""
    return math.log10(end) - math.log10(bet.truth)


def expected_answer_text(mark: AnswerMark) -> str:
    """Returns the right answer in a mark as text; after a bet with the bet's score, "1.2 mm; score 0.50"."""
    return tr(SCORED, told=mark.expected, score=format_bet_score(mark.bet.score)) if mark.bet else mark.expected


def format_bet_score(score: float) -> str:
    return f"{score:.2f}"


def _bettor_lines(bettor: Bettor, reach: int) -> BettorIntervalLines:
    def place(end: float, bet: IntervalBet) -> float:
        return min(max(50 + 50 * decades_above_truth(end, bet) / reach, 0.0), 100.0)

    made, left, score = len(bettor.placed_bets), len(bettor.bets) - len(bettor.placed_bets), bettor.score
    told = tr(NONE) if score is None else tr(SOME if left else TOLD, held=bettor.hits, made=made, left=left,
                                             score=format_bet_score(score))
    name = tr(ROUND, number=bettor.round) if bettor.round else tr(YOUR_BETS) if bettor.name == YOURS else bettor.name
    return BettorIntervalLines(name, told, bettor.name in OWN, tuple(
        None if bet is None else (place(bet.low, bet), place(bet.high, bet), bet.holds) for bet in bettor.bets))
