"""Picture of a body's run: what its goals are about over time, in the bands of their bars."""

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from app.colour_palette import ESTIMATE, INK
from app.pictures.study_parts import empty_figure, make_panel_grid
from app.renderers.picture_style import format_size_axis
from solvers.bodies.goal import Goal
from solvers.bodies.run import BodyResult

WIDTH, HEIGHT = 10.0, 3.4  # inches, of one goal's panel


def goals_figure(result: BodyResult, name: str) -> Figure:
    """Returns the picture of a run whose file is called ``name``: a panel for all goals about the same."""
    about: dict[str, list[str]] = {}
    for key, goal in result.body.goals.items():
        about.setdefault(goal_text(goal), []).append(key)
    if not about:
        return empty_figure(name, "the body has no goals")
    figure, panels = make_panel_grid(f"{name}: error bars without an exact solution", len(about), 1,
                                     (WIDTH, HEIGHT * len(about)))
    ended = f"; no estimate after t = {result.until:.4g} s" if result.until < result.time else ""
    for axes, (text, keys) in zip(panels[:, 0], about.items(), strict=True):
        _draw_goal(axes, result.body.goals[keys[0]], result.curves[keys[0]], result.time)
        axes.set_title(f"{', '.join(keys)}: {text}{ended}")
    axes.set_xlabel("time t in s")
    return figure


def goal_text(goal: Goal) -> str:
    """Returns what a goal is about, such as "y of the material point (4, 0.5)"."""
    what = f"stress {goal.parts[1]}" if goal.is_stress else goal.parts[1]
    return f"{what} of the material point ({goal.at[0]:g}, {goal.at[1]:g})"


def _draw_goal(axes: Axes, goal: Goal, curve: list[tuple[float, float | None]], end: float) -> None:
    """Draws a goal's ``curve`` (value and bar, None without one) up to the time ``end`` in s."""
    times = np.linspace(0, end, len(curve))
    values, bars = np.array([(value, math.nan if bar is None else bar) for value, bar in curve]).T
    axes.fill_between(times, values - bars, values + bars, color=ESTIMATE, alpha=0.45, linewidth=0, label="error bar")
    axes.plot(times, values, color=INK, linewidth=1.2, label="computed")
    axes.set_xlim(0, end)
    format_size_axis(axes.yaxis, "Pa" if goal.is_stress else "m", few=False)
    axes.legend(loc="best")
