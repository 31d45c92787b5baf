"""Error against the time step at fixed h: where more steps stop buying anything."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from app.figures import Look
from app.pictures import study_parts as parts
from app.pictures.series import DRAWN
from solvers.study.fit import Balance, balance
from solvers.study.row import OK, UNSTABLE
from solvers.study.series import Series, error_of

MOST_MISFIT = 0.15  # relative; beyond, the two parts do not describe the points
SPACE = "space error rules: shorter steps gain little"
TIME = "time error rules: shorter steps pay"
NEITHER = "not a sum of space and time error"
BALANCE_LOOK: Look = {"marker": "*", "markersize": 15, "markeredgecolor": "black", "linestyle": "none"}


def error_step_figure(rows: Sequence[dict]) -> Figure:
    """Error against dt, one line for each method and h, with the dt at which time error and space error are equal."""
    title = "Time step: where the error of time and the error of space balance"
    lines = [entry for entry in parts.lined(rows, "dt") if len({row["scene"]["dt"] for row in entry[0].rows}) > 1]
    if not lines:
        return parts.nothing(title, "no grid was run with several time steps; give --dt or --cfl several values")
    shown = parts.known(rows, DRAWN)
    if not shown:
        return parts.nothing(title, "no row has a true error")
    figure, axes = parts.frame(title, 1, len(shown), (13.5, 6.0))
    for panel, quantity in zip(axes[0], shown, strict=True):
        _panel(panel, lines, quantity)
    star = Line2D([], [], color="0.7", label="time error = space error: shorter steps gain at most half",
                  **BALANCE_LOOK)
    fit = Line2D([], [], color="0.4", linewidth=1, linestyle="-", label="fit: space + c dt^p")
    parts.legend_below(figure, lines, [fit, star],
                       any(row["status"] == UNSTABLE for line, _ in lines for row in line.rows))
    return figure


def line_balance(line: Series, quantity: str) -> Balance | None:
    """The two parts of the error along one series of steps."""
    rows = [row for row in line.rows if row["status"] == OK]
    return balance([row["scene"]["dt"] for row in rows], [error_of(row, quantity) or 0 for row in rows])


def _panel(axes: Axes, lines: Sequence[tuple[Series, dict]], quantity: str) -> None:
    parts.draw_errors(axes, lines, quantity, lambda row: row["scene"]["dt"], joined=False)
    notes = []
    for line, look in lines:
        found = line_balance(line, quantity)
        if found is None or found.misfit > MOST_MISFIT:
            notes += [NEITHER] * (found is not None)
            points = [(row["scene"]["dt"], error) for row in line.rows
                      if row["status"] != UNSTABLE and (error := error_of(row, quantity))]
            if points:
                axes.plot(*zip(*points, strict=True), color=look["color"], linestyle=look["linestyle"], linewidth=1)
            continue
        fine = np.geomspace(found.least, found.most, 60)
        axes.plot(fine, found.at(fine), color=look["color"], linestyle=look["linestyle"], linewidth=1, zorder=2)
        if found.dt:
            axes.plot([found.dt], found.at(np.array([found.dt])), color=look["color"], zorder=4, **BALANCE_LOOK)
        else:
            notes.append(SPACE if found.space_rules else TIME)
    axes.set_title(axes.get_title() + _said(notes, len(lines)), fontsize=10)
    axes.set_xlabel("time step dt (s)")
    parts.logarithmic(axes)


def _said(notes: Sequence[str], lines: int) -> str:
    """In words, what can be said of the series that have no balance within their steps."""
    counts = {note: notes.count(note) for note in (SPACE, TIME, NEITHER)}
    return "".join(f"\n{note}" + ("" if number == lines else f" ({number} of {lines} series)")
                   for note, number in counts.items() if number)
