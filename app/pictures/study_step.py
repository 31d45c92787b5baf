"""Error against the time step at fixed h: where more steps stop buying anything."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from app.pictures import study_parts as parts
from app.pictures.series import DRAWN
from app.renderers.picture import Look
from solvers.solver.soundness import OK
from solvers.study.fit import balance
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
    balanced = "time error = space error: shorter steps gain at most half"
    star = Line2D([], [], color="0.7", label=balanced, **BALANCE_LOOK)
    fit = Line2D([], [], color="0.4", linewidth=1, linestyle="-", label="fit: space + c dt^p")
    parts.legend_below(figure, lines, [fit, star])
    return figure


def _panel(axes: Axes, lines: Sequence[tuple[Series, dict]], quantity: str) -> None:
    parts.draw_errors(axes, lines, quantity, lambda row: row["scene"]["dt"], joined=False)
    notes = []
    for line, look in lines:
        points = [(row["scene"]["dt"], error) for row in line.rows
                  if row["status"] == OK and (error := error_of(row, quantity))]
        found = balance([dt for dt, _ in points], [error for _, error in points])
        if found is None or found.misfit > MOST_MISFIT:
            notes += [NEITHER] * (found is not None)
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
    return "".join(f"\n{note}" + ("" if number == lines else f" ({number} of {lines} series)")
                   for note in (SPACE, TIME, NEITHER) if (number := notes.count(note)))
