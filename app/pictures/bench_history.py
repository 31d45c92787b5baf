"""The history of a bench as a picture: each case's rate over the limit's, entry by entry."""

from collections.abc import Sequence

from matplotlib.figure import Figure

from app.colours import INK3, METHOD_COLOURS, METHOD_MARKS
from app.renderers.look import sheet
from app.words import method_name
from solvers.bench.limit.history import busy
from solvers.problems import PROBLEMS

HEIGHT, LEAST_WIDTH, ENTRY = 3.4, 8.0, 0.5  # inches: of a panel, of all, of an entry
MOST_NAMED = 12  # entries with their date and commit on the axis


def history_figure(entries: Sequence[dict]) -> Figure:
    """A panel for each problem, a line for each method with the quartiles over the turns; hollow where the machine had
    other work, and new words on the axis for each entry: its day and its commit, or the version."""
    problems = [name for name in PROBLEMS if any(case["problem"] == name for e in entries for case in e["cases"])]
    figure = sheet(max(LEAST_WIDTH, ENTRY * len(entries)), 0.8 + HEIGHT * len(problems),
                   "Rate over that of hand-written C++ (hollow: a busy machine)")
    panels = figure.subplots(len(problems), 1, squeeze=False, sharex=True)[:, 0]
    for axes, problem in zip(panels, problems, strict=True):
        axes.set_title(PROBLEMS[problem].scene.TITLE.capitalize())
        axes.axhline(1.0, color=INK3, linewidth=1)
        for method in PROBLEMS[problem].scene.choices("method"):
            points = [(place, case, busy(entry)) for place, entry in enumerate(entries) for case in entry["cases"]
                      if (case["problem"], case["method"]) == (problem, method)]
            if points:
                _line(axes, method, points)
        axes.set_ylim(0, None)
        axes.legend(loc="lower left", bbox_to_anchor=(1.0, 0.0))
    every = -(-len(entries) // MOST_NAMED)
    panels[-1].set_xticks(range(0, len(entries), every), [_name(entry) for entry in entries[::every]])
    panels[-1].set_xlim(-0.5, len(entries) - 0.5)
    return figure


def _line(axes, method: str, points: list[tuple[int, dict, bool]]) -> None:
    colour, mark = METHOD_COLOURS[method], METHOD_MARKS[method]
    axes.plot([place for place, _, _ in points], [case["ratio"] for _, case, _ in points], color=colour, marker=mark,
              linewidth=1.3, label=method_name(method))
    axes.vlines([place for place, _, _ in points], [case["low"] for _, case, _ in points],
                [case["high"] for _, case, _ in points], color=colour, linewidth=1)
    hollow = [(place, case["ratio"]) for place, case, loaded in points if loaded]
    if hollow:
        axes.plot(*zip(*hollow, strict=True), color=colour, marker=mark, markerfacecolor="white", linestyle="none")


def _name(entry: dict) -> str:
    return f"{entry['date'][:10]}\n{(entry['commit'] or entry['version'])[:12]}"
