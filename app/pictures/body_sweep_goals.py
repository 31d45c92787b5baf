"""Picture of a body's sweep: its goals with their bars over the width of a cell."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from app.colour_palette import LINE2, METHOD_COLOURS, METHOD_MARKS
from app.pictures.study_parts import empty_figure, make_panel_grid, method_handles
from app.renderers.picture_style import UnitPrefixTickFormatter

TITLE = "Goals with their bars, which should overlap: the true value should lie within each"
PANEL, HEIGHT = 4.5, 4.6  # inches
OFFSETS = np.linspace(0.98, 1.02, 5)  # of h, so that bars at one place are seen beside each other


def body_goals_figure(rows: Sequence[dict]) -> Figure:
    """Returns a panel for each goal with its value and bar in each row; ``rows`` are those of
    ``solvers.study.body_sweep``."""
    shown = [row for row in rows if any(goal["value"] is not None for goal in row.get("goals", {}).values())]
    names = list(dict.fromkeys(name for row in shown for name in row["goals"]))
    if not names:
        return empty_figure(TITLE, "no row has a goal's value")
    figure, axes = make_panel_grid(TITLE, 1, len(names), (PANEL * max(2, len(names)), HEIGHT))
    for panel, name in zip(axes[0], names, strict=True):
        for k, row in enumerate(shown):
            found, method = row["goals"].get(name), row["scene"]["method"]
            if found and found["value"] is not None:
                panel.errorbar([row["h"] * OFFSETS[k % len(OFFSETS)]], [found["value"]], yerr=[found["bar"] or 0],
                               color=METHOD_COLOURS[method], marker=METHOD_MARKS[method], markersize=5, capsize=4)
        panel.set(title=name, xlabel="width of a cell, h")
        panel.xaxis.set_major_formatter(UnitPrefixTickFormatter("m"))
        panel.yaxis.set_major_formatter(UnitPrefixTickFormatter(found["unit"] if found else ""))
        panel.set_xlim(0, 1.15 * max(row["h"] for row in shown))
        panel.grid(axis="both", color=LINE2)
    handles = method_handles(shown)
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles), frameon=False)
    return figure
