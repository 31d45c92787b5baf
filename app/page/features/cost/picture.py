"""Error against seconds, one dot a run, as a drawing in SVG: dots that can be clicked and have a number.

The viewer's charts report no clicks and mark no single points; a drawing of our own does, and each dot is a button for
the keyboard too. What is clicked is named by ``data-run`` (see ``app.page.features.cost.panel``).
"""

import html
import json
import math
from collections.abc import Iterable, Sequence

from app.colours import METHOD_COLOURS, METHOD_MARKS
from app.page.features.cost.runs import LIVE, SWEEP, NumberedRun
from app.page.features.cost.words import sentence
from app.words import METHODS, power_text
from solvers.solver.soundness import BROKEN

WIDTH, HEIGHT = 330, 226
LEFT, RIGHT, TOP, BOTTOM = 46, 318, 20, 192
MOST_NUMBERS = 40  # dots that have their number beside them; of more it is in their title only
ROOM = 0.15  # decades around the dots
FEW = 1.7  # decades below which 2 and 5 have a tick as well
#: Marks of radius about 4 around (0, 0); the circle is a path too, so that all are drawn alike.
SHAPES = {"o": "M-4 0a4 4 0 1 0 8 0a4 4 0 1 0 -8 0z", "s": "M-3.6 -3.6h7.2v7.2h-7.2z", "^": "M0 -4.6L4.4 3.4H-4.4z",
          "D": "M0 -4.8L4.6 0L0 4.8L-4.6 0z", "v": "M0 4.6L4.4 -3.4H-4.4z"}
CROSS = "M-4 -4L4 4M-4 4L4 -4"


class LogAxis:
    """A logarithmic axis from the decade ``low`` to ``high``, drawn from pixel ``start`` to ``end``."""

    def __init__(self, values: Iterable[float], start: float, end: float):
        logs = [math.log10(value) for value in values] or [0.0]
        middle, half = 0.5 * (min(logs) + max(logs)), max(0.5 * (max(logs) - min(logs)) + ROOM, 0.5)
        self.low, self.high, self._start, self._end = middle - half, middle + half, start, end

    def at(self, value: float) -> float:
        part = (math.log10(value) - self.low) / (self.high - self.low)
        return round(self._start + part * (self._end - self._start), 1)

    def ticks(self) -> list[tuple[float, str]]:
        """Values and labels: powers of ten, and where those are few 2 and 5 times them."""
        factors = (1, 2, 5) if self.high - self.low < FEW else (1,)
        found = [(factor * 10.0**power, _label(factor, power))
                 for power in range(math.floor(self.low), math.ceil(self.high) + 1) for factor in factors]
        return [(value, label) for value, label in found if self.low <= math.log10(value) <= self.high]


def picture(runs: Sequence[NumberedRun]) -> str:
    """The drawing of those of the runs that have both an error and a time; "" if there are none."""
    dots = [run for run in runs if run.drawable]
    if not dots:
        return ""
    across = LogAxis((dot.seconds for dot in dots), LEFT, RIGHT)
    # From broken runs no scale is taken: their error may be anything.
    up = LogAxis((dot.size for dot in dots if not dot.broken), BOTTOM, TOP)
    numbered = len(dots) <= MOST_NUMBERS
    inside = "".join([_frame(across, up), _lines(dots, across, up), *(_dot(dot, across, up, numbered) for dot in dots)])
    return (f"<svg viewBox='0 0 {WIDTH} {HEIGHT}' width='100%' role='group' aria-label='error against seconds'>{inside}"
            f"</svg>{_legend(dots)}")


def _frame(across: LogAxis, up: LogAxis) -> str:
    """Grid, ticks and what the axes are."""
    parts = []
    for value, label in across.ticks():
        x = across.at(value)
        parts.append(f"<path d='M{x} {TOP}V{BOTTOM}' class='lab-grid'/>"
                     f"<text x='{x}' y='{BOTTOM + 13}' text-anchor='middle'>{label}</text>")
    for value, label in up.ticks():
        y = up.at(value)
        parts.append(f"<path d='M{LEFT} {y}H{RIGHT}' class='lab-grid'/>"
                     f"<text x='{LEFT - 4}' y='{y + 3.5}' text-anchor='end'>{label}</text>")
    parts.append(f"<path d='M{LEFT} {TOP}V{BOTTOM}H{RIGHT}' class='lab-axis'/>"
                 f"<text x='{(LEFT + RIGHT) / 2}' y='{HEIGHT - 6}' text-anchor='middle'>seconds for one run</text>"
                 f"<text x='4' y='{TOP - 8}'>error of x / A</text>")  # above the axis, where no tick is
    return "".join(parts)


def _lines(dots: Sequence[NumberedRun], across: LogAxis, up: LogAxis) -> str:
    """Runs of sweeps that differ in their cells alone are joined."""
    groups: dict[str, list[NumberedRun]] = {}
    for dot in dots:
        if dot.source == SWEEP and not dot.broken:
            groups.setdefault(json.dumps({**dot.row["asked"], "cells": 0}, sort_keys=True), []).append(dot)
    drawn = []
    for group in groups.values():
        group.sort(key=lambda dot: dot.row["scene"]["cells"])
        points = " ".join(f"{across.at(dot.seconds)},{up.at(dot.size)}" for dot in group)
        drawn.append(f"<polyline points='{points}' class='lab-line' stroke='{METHOD_COLOURS[group[0].method]}'/>")
    return "".join(drawn)


def _dot(run: NumberedRun, across: LogAxis, up: LogAxis, numbered: bool) -> str:
    colour = METHOD_COLOURS[run.method]
    x, y = across.at(run.seconds), TOP + 5 if run.broken else up.at(run.size)
    shape = CROSS if run.broken else SHAPES[METHOD_MARKS[run.method]]
    fill = "none" if run.broken else "#fff" if run.source == LIVE else colour
    words = html.escape(sentence(run), quote=True)
    number = f"<text x='5.5' y='-3.5' class='lab-number'>{run.number}</text>" if numbered else ""
    return (f"<g class='lab-dot' data-run='{run.number}' tabindex='0' role='button' aria-label='load {words}' "
            f"transform='translate({x} {y})'><title>{words} Click to load.</title><circle r='8' fill='transparent'/>"
            f"<path d='{shape}' fill='{fill}' stroke='{colour}' stroke-width='1.8'/>{number}</g>")


def _legend(dots: Sequence[NumberedRun]) -> str:
    """The methods that occur, and what hollow marks and crosses are if there are any."""
    present = {dot.method for dot in dots}
    entries = [(SHAPES[METHOD_MARKS[code]], METHOD_COLOURS[code], METHOD_COLOURS[code], method.name)
               for code, method in METHODS.items() if code in present]
    if any(dot.source == LIVE for dot in dots):
        entries.append((SHAPES["o"], "#fff", "#6b7480", "as timed on the stage"))
    if any(dot.broken for dot in dots):
        found = {dot.status for dot in dots}
        entries.append((CROSS, "none", "#6b7480", " or ".join(status for status in BROKEN if status in found)))
    return "<div class='lab-legend'>" + "".join(
        f"<span><svg width='12' height='12' viewBox='-6 -6 12 12'><path d='{shape}' fill='{fill}' stroke='{stroke}' "
        f"stroke-width='1.6'/></svg> {words}</span>" for shape, fill, stroke, words in entries) + "</div>"


def _label(factor: int, power: int) -> str:
    if -3 <= power <= 3:
        return f"{factor * 10.0**power:g}"
    return f"{factor}·" * (factor > 1) + power_text(power).strip()
