"""What a class has said to a question, as html: bars of choices, dots of numbers, lines of intervals; and what came out
beside. Colour says nothing alone: what held or was right has a sign as well. The style is ``css/75-board.css``."""

from collections import Counter
from collections.abc import Sequence
from html import escape
from string import ascii_lowercase
from typing import Any

from app.language.spoken import tr
from app.lessons.lesson import CHOICE, INTERVAL, Numbers, Question, filled
from app.lessons.marks import Right, fits, in_unit
from app.page.features.board.axis import Axis, axis_for

COLUMNS = 36  # of dots, across the axis


def options(asked: Question, numbers: Numbers) -> str:
    """What there is to choose from, before anything is said of it."""
    rows = "".join(f"<li><b>{letter})</b> <span>{escape(filled(option, numbers))}</span></li>"
                   for letter, option in zip(ascii_lowercase, asked.options, strict=False))
    return f"<ol class='lab-bars'>{rows}</ol>" if rows else ""


def chart(asked: Question, answers: Sequence[Any], numbers: Numbers, found: Right | None) -> str:
    """The answers to a question that is no free text, and what is ``found`` to be right, once that may be seen."""
    if asked.kind == CHOICE:
        return _bars(asked, answers, numbers, found)
    if not answers and found is None:
        return ""
    low, high = _band(asked, found)
    ends = [float(end) for answer in answers for end in (answer if asked.kind == INTERVAL else (answer,))]
    axis = axis_for(ends or [low, high], [] if found is None else [low, high])
    drawn = _lines(asked, answers, axis, found) if asked.kind == INTERVAL else _dots(answers, axis)
    return f"<div class='lab-scale' role='img' aria-label='{escape(_in_words(asked, answers))}'>{drawn}" \
           f"{_truth(asked, axis, found)}{_ticks(asked, axis)}</div>{_beyond(ends, axis)}"


def right_among(asked: Question, answers: Sequence[Any], found: Right) -> int:
    """How many of the answers are right, or intervals hold what came out."""
    return sum(fits(asked, answer, found) for answer in answers)


def _bars(asked: Question, answers: Sequence[int], numbers: Numbers, found: Right | None) -> str:
    counts, rows, says = Counter(answers), [], tr("this came out")
    for k, (letter, option) in enumerate(zip(ascii_lowercase, asked.options, strict=False), 1):
        came = found is not None and k in found.options
        sign = f"<em>✓ {says}</em>" if came else ""
        rows.append(f"<li{' class=lab-came-out' * came}><b>{letter})</b> <span>{escape(filled(option, numbers))} {sign}"
                    f"</span><i style='--part: {counts[k] / max(1, len(answers)):.4f}'></i><b>{counts[k]}</b></li>")
    return f"<ol class='lab-bars lab-counted'>{''.join(rows)}</ol>"


def _dots(answers: Sequence[float], axis: Axis) -> str:
    """One above the other where they are nearly the same."""
    columns = Counter(min(COLUMNS - 1, int(COLUMNS * axis.place(answer))) for answer in answers)
    stacks = "".join(f"<div style='left: {100 * (k + 0.5) / COLUMNS:.2f}%'>{'<i></i>' * count}</div>"
                     for k, count in sorted(columns.items()))
    return f"<div class='lab-dots' style='--most: {max(columns.values(), default=1)}'>{stacks}</div>"


def _lines(asked: Question, answers: Sequence[Sequence[float]], axis: Axis, found: Right | None) -> str:
    rows = []
    for low, high in answers:
        left, right = 100 * axis.place(low), 100 * axis.place(high)
        kind = "" if found is None else " class='lab-holds'" if fits(asked, (low, high), found) else \
            " class='lab-misses'"
        rows.append(f"<i{kind} style='margin-left: {left:.2f}%; width: {right - left:.2f}%'></i>")
    return f"<div class='lab-lines' style='--most: {max(1, len(answers))}'>{''.join(rows)}</div>"


def _band(asked: Question, found: Right | None) -> tuple[float, float]:
    """From where to where an answer is right."""
    if found is None or isinstance(found.value, str):
        return 0.0, 0.0
    reach = 0.0 if asked.kind == INTERVAL else asked.tolerance * abs(found.value)
    return found.value - reach, found.value + reach


def _truth(asked: Question, axis: Axis, found: Right | None) -> str:
    if found is None or isinstance(found.value, str):
        return ""
    low, high = (100 * axis.place(end) for end in _band(asked, found))
    at, told = 100 * axis.place(found.value), tr("{value} came out", value=in_unit(asked, found.value))
    return f"<div class='lab-band' style='left: {low:.2f}%; width: {high - low:.2f}%'></div>" \
           f"<div class='lab-truth{' lab-leftwards' * (at > 50)}' style='left: {at:.2f}%'>" \
           f"<b>{escape(told)}</b></div>"


def _ticks(asked: Question, axis: Axis) -> str:
    return "".join(f"<span style='left: {100 * axis.place(tick):.2f}%'>{escape(in_unit(asked, tick))}</span>"
                   for tick in axis.ticks)


def _beyond(ends: Sequence[float], axis: Axis) -> str:
    """What has no place of its own on the axis."""
    sides = Counter(axis.beyond(end) for end in ends)
    low = tr("{count} further to the left", count=sides[-1])
    high = tr("{count} further to the right", count=sides[1])
    left = f"<span>◂ {low}</span>" if sides[-1] else ""
    right = f"<span class='lab-rightmost'>{high} ▸</span>" if sides[1] else ""
    return f"<p class='lab-beyond'>{left}{right}</p>" if left or right else ""


def _in_words(asked: Question, answers: Sequence[Any]) -> str:
    if asked.kind == INTERVAL:
        return "; ".join(tr("{low} to {high}", low=in_unit(asked, float(low)), high=in_unit(asked, float(high)))
                         for low, high in answers)
    return "; ".join(in_unit(asked, float(answer)) for answer in answers)
