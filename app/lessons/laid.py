"""Bets side by side: a student's, and those of judges on the same runs."""

from collections.abc import Mapping, Sequence

from app.lessons.bets import BY_ROUND, OWN, PATH, Bet, Bettor, Ends, asked_before
from app.lessons.lesson import EXPLAIN, Lesson, Numbers, Step, filled
from app.lessons.marks import right
from app.lessons.outcomes import Outcomes

Intervals = Sequence[float]


def laid(lesson: Lesson, step: Step, given: Mapping[str, Intervals], numbers: Numbers, outcomes: Outcomes) -> \
        list[Bettor]:
    """Whose bets a step shows, on what was ``given`` an answer before it, by the questions' keys. Runs what it needs,
    and raises as :func:`app.lessons.marks.mark`."""
    steps = [other for other in asked_before(lesson, step) if other.key in given]
    truths = [float(right(lesson, other, numbers, outcomes).value) for other in steps]
    found = []
    for name in step.bets if steps else ():
        ends = [given[other.key] if name in OWN else judge_ends(lesson, other, name, numbers, outcomes)
                for other in steps]
        bets = [None if pair is None else Bet(float(pair[0]), float(pair[1]), truth, other.asked.level)
                for other, truth, pair in zip(steps, truths, ends, strict=True)]
        found += _by_round(lesson, steps, bets) if name == BY_ROUND else [Bettor(name, tuple(bets))]
    return found


def _by_round(lesson: Lesson, steps: Sequence[Step], bets: Sequence[Bet | None]) -> list[Bettor]:
    """A student's bets apart by rounds, each of which ends where something is explained."""
    explained = [sum(other.kind == EXPLAIN for other in lesson.steps[:lesson.steps.index(step)]) for step in steps]
    rounds = [tuple(bet for bet, before in zip(bets, explained, strict=True) if before == one)
              for one in sorted(set(explained))]
    return [Bettor(BY_ROUND, bets, number) for number, bets in enumerate(rounds, 1)]


def judge_ends(lesson: Lesson, step: Step, judge: str, numbers: Numbers, outcomes: Outcomes) -> Ends | None:
    """What a judge bets on what a step asks; None where it does not bet."""
    found = PATH.fullmatch(step.asked.expected)
    assert found is not None  # has been checked
    run = lesson.runs[found["run"] or lesson.main_run(step)]
    return outcomes.bets(filled(run.texts[0], numbers))[found["quantity"]][judge]
