"""Whether an answer is right: derived from the runs each time, never kept."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from app.lessons.claims import Scope, judge, said, value
from app.lessons.lesson import CHOICE, DRAG, INTERVAL, NUMBER, TEXT, Lesson, Question, Step
from app.lessons.outcomes import Outcomes
from app.lessons.variants import Numbers, filled

LONGEST = 500  # characters of a text
MOST = 1e300
TOLD_AFTER = 3  # attempts, after which the right answer is shown


@dataclass(frozen=True)
class Mark:
    """``right`` is None for an answer that nobody marks; ``expected`` says what is right, in words."""

    right: bool | None
    expected: str


def mark(lesson: Lesson, step: Step, answer: Any, numbers: Numbers, outcomes: Outcomes) -> Mark:
    """The mark of an answer that fits the step's question; runs what it needs.

    Raises :class:`~app.lessons.outcomes.RunFailed` and :class:`~app.lessons.claims.ClaimError`.
    """
    asked = step.question
    assert asked is not None
    texts = [filled(text, numbers) for text in (*asked.holds, *([asked.expected] if asked.expected else []))]
    scope = outcomes.scope(lesson, step, numbers, texts)
    if asked.kind == TEXT:
        return Mark(None, "")
    if asked.kind == CHOICE:
        right = right_options(asked, texts, scope)
        return Mark(answer in right, " or ".join(filled(asked.options[k - 1], numbers) for k in right))
    expected = value(texts[-1], scope)
    told = f"{said(expected)} {asked.unit}".strip()
    if isinstance(expected, str):
        return Mark(answer == expected, told)
    if asked.kind == INTERVAL:
        low, high = answer
        return Mark(low <= expected <= high, told)
    return Mark(abs(answer - expected) <= asked.tolerance * abs(expected), f"{told} (± {100 * asked.tolerance:g} %)")


def right_options(asked: Question, claims: Sequence[str], scope: Scope) -> list[int]:
    """The options that are right, counted from 1: the stated one, or those whose claims hold."""
    if asked.correct is not None:
        return [asked.correct]
    return [k for k, claim in enumerate(claims, 1) if judge(claim, scope).holds]


def trouble(asked: Question, answer: Any) -> str:
    """Why something is no answer to a question, in words; "" where it is one."""
    if asked.kind == TEXT:
        fits = isinstance(answer, str) and 0 < len(answer.strip()) <= LONGEST
        return "" if fits else f"write one to {LONGEST} characters"
    if asked.kind == CHOICE:
        fits = isinstance(answer, int) and not isinstance(answer, bool) and 1 <= answer <= len(asked.options)
        return "" if fits else "choose one of the answers"
    if asked.kind == INTERVAL:
        if not (isinstance(answer, (list, tuple)) and len(answer) == 2 and all(map(_is_real, answer))):
            return "give two numbers, the least and the most"
        return "" if answer[0] <= answer[1] else "the first number must not be above the second"
    assert asked.kind in (NUMBER, DRAG)
    return "" if _is_real(answer) else "give a number"


def shown(asked: Question, answer: Any) -> str:
    """An answer in words; what a visitor wrote stays as it is and must be escaped."""
    if asked.kind == CHOICE:
        return asked.options[answer - 1]
    if asked.kind == INTERVAL:
        return f"{said(float(answer[0]))} to {said(float(answer[1]))} {asked.unit}".strip()
    return answer if asked.kind == TEXT else f"{said(float(answer))} {asked.unit}".strip()


def _is_real(number: Any) -> bool:
    return isinstance(number, (int, float)) and not isinstance(number, bool) and math.isfinite(number) \
        and abs(number) < MOST
