"""How often estimates are right, drawn: shares of runs with their 95 % intervals, by how far particles move."""

from collections.abc import Callable, Mapping, Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from app.colours import INK, INK3, LINE2
from app.pictures import study_parts as parts
from solvers.running.goals import SAFETY
from solvers.scene.registry import ESTIMATORS
from solvers.study.coverage.tally import FACTORS, INTERVALS, REGIMES, interval

PROMISED = 95.0  # per cent, by those who made the grid convergence index
SYMBOLS = ("o", "s", "^")  # one for each regime
SPREAD = 0.22  # between those of one row


def coverage_figure(counted: Sequence[Mapping]) -> Figure:
    """Left, of how many runs the estimate of x is within the smallest factor; right, how many bars held the truth."""
    [one] = counted
    title = f"How often is it right? {one['runs']:,} runs of the {one['problem']}, drawn at random"
    figure, axes = parts.frame(title, 1, 2, (13.5, 5.2))
    names = list(one["estimators"])
    left, right = axes[0]

    def right_of(name: str, regime: str) -> tuple[int, int]:
        found = one["estimators"][name]["regime"][regime]["x"]
        return found["within"][f"{FACTORS[0]:g}"], found["runs"]

    def held_of(name: str, regime: str) -> tuple[int, int]:  # of all goals together
        found = [split["regime"][regime][bars[name]] for split in one["goals"].values()]
        return sum(goal["held"] for goal in found), sum(goal["runs"] for goal in found)

    _rows(left, names, right_of)
    left.set_xlabel(f"runs with the estimate of x within a factor of {FACTORS[0]:g} of the truth, %")
    bars = {f"{SAFETY:g} × {name}": f"{SAFETY:g} x {name}" for name in names} | {name: name for name in INTERVALS}
    _rows(right, list(bars), held_of)
    right.axvline(PROMISED, color=INK, linewidth=1, linestyle=(0, (4, 3)))
    right.set_xlabel("bars around a number that hold the truth, %; dashed: the GCI's promise")
    handles = [left.plot([], [], symbol, color=INK3, label=f"particles move {regime}")[0]
               for symbol, regime in zip(SYMBOLS, REGIMES, strict=True)]
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles), frameon=False)
    return figure


def _rows(axes: Axes, names: Sequence[str], counts: Callable[[str, str], tuple[int, int]]) -> None:
    """A row for each name, and in it a mark for each regime with its interval; none where there was no run."""
    for row, name in enumerate(names):
        known = [key for key in ESTIMATORS if name.endswith(key)]
        colour = ESTIMATORS[known[0]].colour if known else INK3
        for k, (symbol, regime) in enumerate(zip(SYMBOLS, REGIMES, strict=True)):
            held, of = counts(name, regime)
            if of:
                low, high = interval(held, of)
                y = row + (k - 1) * SPREAD
                axes.plot([100 * low, 100 * high], [y, y], color=colour, linewidth=1.5)
                axes.plot([100 * held / of], [y], symbol, color=colour, markersize=6)
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.5, -0.5)
    axes.set_xlim(-2, 102)
    axes.grid(axis="x", color=LINE2)
