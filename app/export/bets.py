"""What the player knows of bets: words and limits of their picture, and what judges bet, made before."""

from contextlib import closing
from typing import Any

from app.language.spoken import tr
from app.lessons import bet_lines
from app.lessons.bets import BY_ROUND, OWN, YOURS, asked_before
from app.lessons.lesson import Lesson
from app.lessons.marks import judge_ends
from app.lessons.outcomes import Outcomes


def bet_words() -> dict[str, Any]:
    """The picture's words, as ``app.lessons.bet_lines`` has them."""
    return {"yours": YOURS, "by_round": BY_ROUND, "your_bets": tr(bet_lines.YOUR_BETS), "round": tr(bet_lines.ROUND),
            "told": tr(bet_lines.TOLD), "some": tr(bet_lines.SOME), "none": tr(bet_lines.NONE),
            "scored": tr(bet_lines.SCORED), "said": tr(bet_lines.SAID), "truth": tr(bet_lines.TRUTH),
            "less": bet_lines.LESS, "more": bet_lines.MORE, "most": bet_lines.MOST}


def judged(lesson: Lesson, processes: int) -> dict[str, list[dict[str, dict[str, Any]]]]:
    """By the key of each step that shows judges, for each variant, their bets by judge and question."""
    steps = [step for step in lesson.steps if set(step.bets) - {*OWN}]
    with closing(Outcomes(processes)) as outcomes:
        return {step.key: [{judge: {other.key: judge_ends(lesson, other, judge, numbers, outcomes)
                                    for other in asked_before(lesson, step)}
                            for judge in step.bets if judge not in OWN} for numbers in lesson.variants]
                for step in steps}
