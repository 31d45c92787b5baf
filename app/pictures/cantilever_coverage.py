"""Picture of random cantilevers: true errors over their bars, and the index of x over delta."""

from collections.abc import Mapping, Sequence

from matplotlib.figure import Figure

from app.colour_palette import INK, LINE2, METHOD_COLOURS, METHOD_MARKS
from app.pictures.study_parts import make_panel_grid, method_handles
from solvers.bodies.estimate import SURE, UNSURE
from solvers.solver.soundness import OK
from solvers.study.coverage.cantilever_counts import error_over_bar

SPREAD = 0.6  # of a row that its markers fill
DASHED = (0, (4, 3))


def cantilever_coverage_figure(rows: Sequence[Mapping]) -> Figure:
    """Returns, left, the true error of each goal over its bar in each run, up to 1 where the bar holds; right, the
    index of x over its delta. ``rows`` are those of ``random_cantilevers.measure``."""
    usable = [row for row in rows if row["status"] == OK]
    figure, axes = make_panel_grid(f"Do the bars hold? {len(rows):,} random cantilevers", 1, 2, (13.5, 4.8))
    left, right = axes[0]
    names = list(dict.fromkeys(name for row in usable for name in row["goals"]))
    looks = [{"color": METHOD_COLOURS[method], "marker": METHOD_MARKS[method], "markersize": 5, "linestyle": "none",
              "fillstyle": "none"} for method in (row["cantilever"]["method"] for row in usable)]
    for k, (row, look) in enumerate(zip(usable, looks, strict=True)):
        for at, name in enumerate(names):
            if (off := error_over_bar(row["goals"][name])) is not None:
                left.plot([off], [at + SPREAD * ((k + 0.5) / len(usable) - 0.5)], **look)
        if one := row["estimates"].get("x"):
            right.plot([one["delta"]], [one["index"]], **look)
    left.axvline(1, color=INK, linewidth=1, linestyle=DASHED)
    left.set(xlabel="true error over bar; left of the dashed line the bar holds", yticks=range(len(names)),
             yticklabels=names, ylim=(len(names) - 0.5, -0.5))
    left.set_xlim(0, max(1.1, left.get_xlim()[1]))
    for edge in (SURE, UNSURE):
        right.axvline(edge, color=INK, linewidth=1, linestyle=DASHED)
    right.axhline(1, color=LINE2, linewidth=1)
    right.set(xlabel="delta of x; dashed: ± 30 % beyond the first line, no number beyond the second",
              title="Estimated over true error of x")
    right.set_xlim(0, max(UNSURE + 0.1, right.get_xlim()[1]))
    for panel in (left, right):
        panel.grid(axis="both", color=LINE2)
    handles = method_handles([{"scene": row["cantilever"]} for row in usable])
    figure.legend(handles=handles, loc="outside lower center", ncols=max(1, len(handles)), frameon=False)
    return figure
