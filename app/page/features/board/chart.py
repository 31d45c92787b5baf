"""Chart of a class's answers to a question, as html: bars for choices, dots for numbers, lines for intervals, and the
result beside them. Right answers have a sign as well as a colour. The style is ``css/75-board.css``. The range of the
axis follows the majority of answers, so that one outlier does not compress the others."""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from string import ascii_lowercase
from typing import Any

from app.language.translation import tr
from app.lessons.answer_marking import RightAnswer, format_in_unit, is_right
from app.lessons.lesson import CHOICE, INTERVAL, Numbers, Question, fill_numbers

COLUMNS = 36  # of dots, along the axis
DECADES = 1.5  # span of most answers above which the axis is logarithmic
REACH = 1.0  # answers up to this times the span of most answers outside it are still on the axis
MOST = (0.1, 0.9)  # quantiles between which "most" answers lie
MARGIN = 0.04  # of the axis, at either end
TICKS = 5  # or fewer
SAME = 0.1  # half the axis over a number, if all answers are that number


@dataclass(frozen=True)
class Axis:
    """Axis from ``low`` to ``high`` in the values' unit, or in their decimal logarithms if it is ``logarithmic``."""

    low: float
    high: float
    logarithmic: bool = False

    def position(self, value: float) -> float:
        """Returns the position of a value, from 0 (left) to 1 (right); values outside are at the ends."""
        return min(1.0, max(0.0, (self._to_axis_scale(value) - self.low) / (self.high - self.low)))

    def beyond(self, value: float) -> int:
        """Returns -1 or 1 for a value outside the axis, at the left or at the right, else 0."""
        inner = self._to_axis_scale(value)
        return -1 if inner < self.low else 1 if inner > self.high else 0

    @property
    def ticks(self) -> list[float]:
        """Round values on the axis, few enough that their labels fit."""
        step = (self.high - self.low) / TICKS
        if self.logarithmic and step <= 1:  # decades are whole
            step = 1.0
        else:  # the next of 1, 2 and 5 times a power of ten
            power = 10.0 ** math.floor(math.log10(step))
            step = next(factor * power for factor in (1, 2, 5, 10) if factor * power >= step * (1 - 1e-9))
        first, last = math.ceil(self.low / step), math.floor(self.high / step)
        return [10.0 ** (k * step) if self.logarithmic else float(f"{k * step:.12g}") for k in range(first, last + 1)]

    def _to_axis_scale(self, value: float) -> float:
        if not self.logarithmic:
            return value
        return math.log10(value) if value > 0 else -math.inf


def axis_for(values: Sequence[float], always: Sequence[float] = ()) -> Axis:
    """Returns an axis for one or more ``values``; outliers may lie outside, but no value in ``always``."""
    ranked = sorted(values)
    few, many = (ranked[round(part * (len(ranked) - 1))] for part in MOST)
    # Logarithmic if most are above zero and far apart.
    logarithmic = few > 0 and math.log10(many) - math.log10(few) > DECADES and min(always, default=1.0) > 0
    inner = sorted(math.log10(value) if logarithmic else value for value in values if value > 0 or not logarithmic)
    fixed = [math.log10(value) if logarithmic else value for value in always]
    few, many = (inner[round(part * (len(inner) - 1))] for part in MOST)
    room = REACH * (many - few)
    low = min([max(inner[0], few - room), *fixed])
    high = max([min(inner[-1], many + room), *fixed])
    if high - low <= 1e-9 * max(abs(low), abs(high)):
        room = SAME if logarithmic else SAME * abs(low) or 1.0
        low, high = low - room, high + room
    margin = MARGIN * (high - low)
    return Axis(low - margin, high + margin, logarithmic)


def answer_options(asked: Question, numbers: Numbers) -> str:
    """Returns a choice's options as html without counts, "" if there are none; ``numbers`` fill their placeholders."""
    rows = "".join(f"<li><b>{letter})</b> <span>{escape(fill_numbers(option, numbers))}</span></li>"
                   for letter, option in zip(ascii_lowercase, asked.options, strict=False))
    return f"<ol class='lab-bars'>{rows}</ol>" if rows else ""


def answer_chart(asked: Question, answers: Sequence[Any], numbers: Numbers, result: RightAnswer | None) -> str:
    """Returns a chart as html of the answers to a question, not free text; ``result`` is None until it is revealed."""
    if asked.kind == CHOICE:
        return _choice_bars_html(asked, answers, numbers, result)
    if not answers and result is None:
        return ""
    low, high = _accepted_range(asked, result)
    ends = [float(end) for answer in answers for end in (answer if asked.kind == INTERVAL else (answer,))]
    axis = axis_for(ends or [low, high], [] if result is None else [low, high])
    if asked.kind == INTERVAL:
        drawn = _interval_lines_html(asked, answers, axis, result)
        words = [tr("{low} to {high}", low=format_in_unit(asked, float(low)), high=format_in_unit(asked, float(high)))
                 for low, high in answers]
    else:  # dots, one above the other where they are nearly the same
        columns = Counter(min(COLUMNS - 1, int(COLUMNS * axis.position(answer))) for answer in answers)
        stacks = "".join(f"<div style='left: {100 * (k + 0.5) / COLUMNS:.2f}%'>{'<i></i>' * count}</div>"
                         for k, count in sorted(columns.items()))
        drawn = f"<div class='lab-dots' style='--most: {max(columns.values(), default=1)}'>{stacks}</div>"
        words = [format_in_unit(asked, float(answer)) for answer in answers]
    ticks = "".join(f"<span style='left: {100 * axis.position(tick):.2f}%'>{escape(format_in_unit(asked, tick))}</span>"
                    for tick in axis.ticks)
    return f"<div class='lab-scale' role='img' aria-label='{escape('; '.join(words))}'>{drawn}" \
           f"{_right_answer_mark_html(asked, axis, result)}{ticks}</div>{_outside_counts_html(ends, axis)}"


def count_right_answers(asked: Question, answers: Sequence[Any], result: RightAnswer) -> int:
    """Returns the number of ``answers`` that are right, or of intervals that contain the result."""
    return sum(is_right(asked, answer, result) for answer in answers)


def _choice_bars_html(asked: Question, answers: Sequence[int], numbers: Numbers, result: RightAnswer | None) -> str:
    """Returns bars of the counts of each option (``answers`` from 1), the right ones marked."""
    counts, rows, says = Counter(answers), [], tr("this came out")
    for k, (letter, option) in enumerate(zip(ascii_lowercase, asked.options, strict=False), 1):
        came = result is not None and k in result.options
        sign = f"<em>✓ {says}</em>" if came else ""
        rows.append(f"<li{' class=lab-came-out' * came}><b>{letter})</b> <span>"
                    f"{escape(fill_numbers(option, numbers))} {sign}</span>"
                    f"<i style='--part: {counts[k] / max(1, len(answers)):.4f}'></i><b>{counts[k]}</b></li>")
    return f"<ol class='lab-bars lab-counted'>{''.join(rows)}</ol>"


def _interval_lines_html(asked: Question, answers: Sequence[Sequence[float]], axis: Axis,
                         result: RightAnswer | None) -> str:
    """Returns a line for each interval (low, high), marked by whether it contains the result."""
    rows = []
    for low, high in answers:
        left, right = 100 * axis.position(low), 100 * axis.position(high)
        kind = "" if result is None else " class='lab-holds'" if is_right(asked, (low, high), result) else \
            " class='lab-misses'"
        rows.append(f"<i{kind} style='margin-left: {left:.2f}%; width: {right - left:.2f}%'></i>")
    return f"<div class='lab-lines' style='--most: {max(1, len(answers))}'>{''.join(rows)}</div>"


def _accepted_range(asked: Question, result: RightAnswer | None) -> tuple[float, float]:
    """Returns the least and largest right answer; (0, 0) before the result is revealed or if it is no number."""
    if result is None or isinstance(result.value, str):
        return 0.0, 0.0
    reach = 0.0 if asked.kind == INTERVAL else asked.tolerance * abs(result.value)
    return result.value - reach, result.value + reach


def _right_answer_mark_html(asked: Question, axis: Axis, result: RightAnswer | None) -> str:
    """Returns a mark at the result, and a band of accepted answers; "" before it is revealed."""
    if result is None or isinstance(result.value, str):
        return ""
    low, high = (100 * axis.position(end) for end in _accepted_range(asked, result))
    at, told = 100 * axis.position(result.value), tr("{value} came out", value=format_in_unit(asked, result.value))
    return f"<div class='lab-band' style='left: {low:.2f}%; width: {high - low:.2f}%'></div>" \
           f"<div class='lab-truth{' lab-leftwards' * (at > 50)}' style='left: {at:.2f}%'>" \
           f"<b>{escape(told)}</b></div>"


def _outside_counts_html(ends: Sequence[float], axis: Axis) -> str:
    """Returns how many of the values ``ends`` lie outside the axis, left and right, as html; "" if none does."""
    sides = Counter(axis.beyond(end) for end in ends)
    low = tr("{count} further to the left", count=sides[-1])
    high = tr("{count} further to the right", count=sides[1])
    left = f"<span>◂ {low}</span>" if sides[-1] else ""
    right = f"<span class='lab-rightmost'>{high} ▸</span>" if sides[1] else ""
    return f"<p class='lab-beyond'>{left}{right}</p>" if left or right else ""
