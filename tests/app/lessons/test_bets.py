"""Intervals as bets: what they cost, that honesty costs least, whose are laid side by side, and lesson 10's runs."""

import itertools
from concurrent.futures import Future
from contextlib import closing

import numpy as np
import pytest

from app import shareable_state
from app.lessons import catalogue
from app.lessons.answer_marking import bettors_of_step, right_answer
from app.lessons.claims import ClaimError, check_claim, decide_claim
from app.lessons.interval_bet_chart import make_bet_chart
from app.lessons.interval_bets import BY_ROUND, JUDGES, YOURS, Bettor, IntervalBet, interval_score
from app.lessons.lesson import LessonError
from app.lessons.lesson_parser import parse_lesson
from app.lessons.lesson_runs import RunCache, run_in_worker
from solvers.study.coverage.random_runs import RandomRun

HEAD = """+++
title = "Bets"
goals = ["bet"]
+++
"""
BET = """
## Predict: Bet {name}

```question
kind = "interval"
expected = "{expected}"
level = 0.8
```
"""
ROUND = """
## Run: Look {name}

```run
{name} = "bar cells={cells} ppc=4 amplitude=0.001 periods=0.1"
```

## Explain: Why {name}

```bets
{bettors}
```
"""


def lesson_of(**bettors):
    """A lesson of a round for each name, whose bet is on a bar of so many cells, and which shows these bets."""
    rounds = [BET.format(name=name, expected=f"{name}.error.x.final")
              + ROUND.format(name=name, cells=8 + 4 * k, bettors=who) for k, (name, who) in enumerate(bettors.items())]
    return parse_lesson(HEAD + "".join(rounds), "99-bets")


class Here(RunCache):
    """Runs in this process, which others would take seconds to start for."""

    def _submit_run(self, text, judged=False):
        if (text, judged) not in self._runs:
            self._runs[text, judged] = Future()
            run_in_worker({"scene": text, "politeness": 0, "judged": judged}, self._runs[text, judged].set_result)
        return self._runs[text, judged]


def test_a_bet_costs_its_width_and_ten_times_what_it_misses_by():
    """In factors of ten, to rounding of the logarithms: 1e-12."""
    near = pytest.approx
    assert interval_score(1e-6, 1e-5, 3e-6, 0.8) == near(1, abs=1e-12)
    assert interval_score(2e-6, 2e-6, 2e-6, 0.8) == 0
    assert (
        interval_score(1e-6, 1e-5, 2e-5, 0.8)
        == interval_score(1e-6, 1e-5, 5e-7, 0.8)
        == near(1 + 10 * np.log10(2), abs=1e-12)
    )
    assert interval_score(1e-6, 1e-5, 2e-5, 0.9) == near(1 + 20 * np.log10(2), abs=1e-12)
    for unit in (1e-9, 1e6):  # a bet in other units costs the same
        assert interval_score(unit * 1e-6, unit * 1e-5, unit * 2e-5, 0.8) == near(interval_score(1e-6, 1e-5, 2e-5, 0.8),
                                                                                  abs=1e-12)
    assert interval_score(1e-300, 1e300, 1, 0.8) == near(600)


def test_who_does_not_bet_is_not_better_for_it():
    """The mean is that of the bets placed."""
    bet = IntervalBet(1.0, 10.0, 2.0)
    assert Bettor("companion", (bet, None, None)).score == Bettor("companion", (bet,)).score == pytest.approx(1)
    assert Bettor("companion", (None,)).score is None


@pytest.mark.parametrize("level", [0.5, 0.8, 0.9])
def test_nobody_scores_less_than_by_what_he_thinks(level):
    """Of a hundred and one truths, equally likely and lopsided, the mean score of all bets between two of them is least
    at their own quantiles."""
    truths = np.exp(0.5 + 2 * np.random.default_rng(3).gamma(2.0, size=101))
    truths.sort()
    pairs = list(itertools.combinations(range(101), 2))
    mean = {(low, high): np.mean([interval_score(truths[low], truths[high], truth, level) for truth in truths])
            for low, high in pairs if abs(low - 100 * (1 - level) / 2) < 8 and abs(high - 100 * (1 + level) / 2) < 8}
    assert min(mean, key=mean.get) == (round(50 * (1 - level)), round(50 * (1 + level)))


def test_bets_are_drawn_as_multiples_of_the_truth():
    """Factors of ten are equally wide; what goes on beyond ten thousand is cut."""
    yours = Bettor(YOURS, (IntervalBet(1, 100, 10), IntervalBet(20, 30, 10)))
    picture = make_bet_chart([yours, Bettor("GCI", (IntervalBet(9.99, 10.01, 10), None))])
    own, gci = picture.bettors
    assert picture.reach == 1 and [text for _, text in picture.ticks] == ["÷ 10", "truth", "× 10"]
    assert own.lines[0] == (0, 100, True)
    assert own.lines[1][:2] == pytest.approx((50 + 50 * np.log10(2), 50 + 50 * np.log10(3)))
    assert own.result == "1 of 2 contain the truth, mean score 2.59" and (own.name, own.own) == ("Your bets", True)
    assert gci.result == "1 of 1 contain the truth, 1 without a bet, mean score 0.00" and gci.lines[1] is None
    assert make_bet_chart([Bettor(YOURS, (IntervalBet(1e-12, 1e12, 1),))]).bettors[0].lines == ((0, 100, True),)
    assert make_bet_chart([Bettor("transport", (None,))]).bettors[0].result == "does not bet on these"


def test_bets_are_laid_beside_those_of_judges():
    """By rounds where that is asked for; a judge that is not valid does not bet, and claims know what it bets."""
    lesson = lesson_of(first=YOURS, second="\n".join((BY_ROUND, *JUDGES)))
    with closing(Here()) as outcomes:
        truths = [outcomes.result(lesson.runs[name].texts[0])["error"]["x"]["final"] for name in ("first", "second")]
        given = {"bet-first": [truths[0] / 2, truths[0] * 2], "bet-second": [truths[1] * 2, truths[1] * 3]}
        [yours] = bettors_of_step(lesson, lesson.steps[2], given, {}, outcomes)
        assert yours == Bettor(YOURS, (IntervalBet(truths[0] / 2, truths[0] * 2, truths[0]),))
        one, two, companion, *others = bettors_of_step(lesson, lesson.steps[-1], given, {}, outcomes)
        assert [(bettor.round, bettor.hits, len(bettor.placed_bets)) for bettor in (one, two)] == [(1, 1, 1), (2, 0, 1)]
        assert companion.score < 0.01  # it may miss by as little: the grids are coarser than any that was drawn
        assert [bettor.name for bettor in others] == [*JUDGES[1:]] and others[-1].placed_bets
        assert bettors_of_step(lesson, lesson.steps[-1], {}, {}, outcomes) == []
        scope = outcomes.scope(lesson, lesson.steps[-1], {}, ["first.bet.companion.x.score"])
        said = scope.outcomes["first"].results[0]["bet"]["companion"]["x"]
        assert said["low"] <= truths[0] * (1 + 1e-3) and said["score"] == pytest.approx(companion.bets[0].score)
        assert decide_claim("first.bet.companion.x.score < 0.01", scope).holds
        below = parse_lesson(HEAD + BET.format(name="z", expected="-1 * first.error.x.final") + ROUND.format(
            name="first", cells=8, bettors=YOURS), "99-below")
        with pytest.raises(ClaimError, match="intervals are bets on a size; ask for one above 0"):
            right_answer(below, below.steps[0], {}, outcomes)


@pytest.mark.parametrize("old, new, said", [
    ("level = 0.8", "level = 80", "level = 80: give a chance above 0 and below 1, such as 0.8"),
    ("level = 0.8", 'level = "high"', "level = high: give a chance"),
    (f"\n{YOURS}\n", "\nmine\n", "'mine' does not bet; give yours, yours by round, companion, "),
    (f"\n{YOURS}\n", "\n\n", "nobody bets here"),
    ("level = 0.8", "level = 0.9", ""),
    ("first.error.x.final", "1e6 * first.error.x.final", ""),
    ("level = 0.8", "tolerance = 0.1", "tolerance means nothing for a interval; give expected, unit, level")])
def test_mistakes_of_bets_are_told(old, new, said):
    """Of those that mean something to a student and nothing to a judge, only where judges bet."""
    bet = BET.format(name="a", expected="first.error.x.final")
    text = HEAD + bet + ROUND.format(name="first", cells=8, bettors=YOURS)
    assert old in text
    changed = text.replace(old, new, 1)
    if not said:
        parse_lesson(changed, "99-bets")
        changed, said = changed.replace(YOURS, "GCI"), "judges bet on errors at the end, at a level of 0.8; give exp"
    with pytest.raises(LessonError, match=said):
        parse_lesson(changed, "99-bets")


def test_bets_without_an_interval_are_told():
    with pytest.raises(LessonError, match="bets are shown, and no interval is asked before"):
        parse_lesson(HEAD + ROUND.format(name="first", cells=8, bettors=YOURS), "99-bets")


def test_claims_about_bets_are_read():
    check_claim("hat.bet.two_grid.v.low < 1", {"hat": None}, "")
    for wrong in ("hat.bet.me.v.low < 1", "hat.bet.gci.a.low < 1", "hat.bet.gci.x.width < 1"):
        with pytest.raises(ClaimError, match="give one of"):
            check_claim(wrong, {"hat": None}, "")


def test_the_eight_runs_of_lesson_ten_are_those_that_were_drawn():
    """With the seed 10, the first five bars and three rings, rounded to two digits, but for the bar that came first,
    which goes unstable, as the lesson claims."""
    def rounded(scene):
        sizes = (f"{size:.2g}" for size in (scene.amplitude, scene.courant_number, scene.periods))
        return (scene.problem, scene.method, scene.cells, scene.ppc, *map(float, sizes), scene.body_force,
                scene.linearity_preserving, scene.velocity)

    lesson = catalogue.load_lesson("10-how-sure-are-you")
    questions = [step.asked_question for step in lesson.questions.values()]
    bets = [question.expected.split(".")[0] for question in questions if question.kind == "interval"]
    runs = {rounded(shareable_state.parse_state(lesson.runs[name].texts[0]).scene) for name in bets}
    assert rounded(shareable_state.parse_state(lesson.runs["broken"].texts[0]).scene) == rounded(
        RandomRun("bar", 10, 0).scene()
    )
    drawn_runs = [RandomRun(problem, 10, number).scene() for problem,
                  numbers in (("bar", range(1, 6)), ("ring", range(3)))
                  for number in numbers]
    assert len(bets) == len(runs) == 8 and runs == set(map(rounded, drawn_runs))
