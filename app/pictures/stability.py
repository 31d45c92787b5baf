"""The stability map as a picture: life over amplitude and time step, a panel for each method and what it calls for."""

from collections.abc import Sequence

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from app.colours import INK, INK3
from app.pictures import study_parts as parts
from app.renderers.look import in_sizes, sheet
from app.words import method_name, unit_of, with_unit
from solvers.problems import PROBLEMS
from solvers.study.fit import measured
from solvers.study.stability import TREATMENTS, held, survived, treatment_of

PANEL = (2.5, 2.0)  # inches
SHORTEST = 0.1  # periods, at the dark end of the scale


def stability_figure(rows: Sequence[dict]) -> Figure:
    """Bright held long, dark broke soon; a tick marks what held to the end."""
    shown = measured(rows)
    if not shown:
        return parts.nothing("Stability", "no run was possible")
    kind = PROBLEMS[shown[0]["problem"]].scene
    methods = [name for name in kind.choices("method") if any(row["scene"]["method"] == name for row in shown)]
    treatments = [name for name in TREATMENTS if any(treatment_of(row) == name for row in shown)]
    amplitudes, steps = (sorted({row["scene"][name] for row in shown}) for name in ("amplitude", "cfl"))
    longest = max(row["scene"]["periods"] for row in shown)
    unit = unit_of(kind, "amplitude")
    size = (1.6 + PANEL[0] * len(treatments), 1.6 + PANEL[1] * len(methods))
    figure = sheet(*size, f"{kind.TITLE.capitalize()}: periods until x is off by A/10 or the run breaks, of "
                          f"{longest:g} (✓: held to the end)")
    axes = figure.subplots(len(methods), len(treatments), squeeze=False, sharex=True, sharey=True)
    for line, method in zip(axes, methods, strict=True):
        for panel, treatment in zip(line, treatments, strict=True):
            own = [row for row in shown if row["scene"]["method"] == method and treatment_of(row) == treatment]
            lives = np.full((len(steps), len(amplitudes)), np.nan)
            for row in own:
                at = steps.index(row["scene"]["cfl"]), amplitudes.index(row["scene"]["amplitude"])
                lives[at] = max(survived(row), SHORTEST)
                text = "✓" if held(row) else f"{survived(row):.2g}"
                dark = lives[at] < np.sqrt(SHORTEST * longest)
                panel.text(at[1], at[0], text, ha="center", va="center", fontsize=10, color="w" if dark else INK)
            panel.imshow(lives, origin="lower", aspect="auto", norm=LogNorm(SHORTEST, longest), cmap="cividis")
            panel.grid(visible=False)
            panel.spines["bottom"].set_visible(False)
            panel.set(xticks=range(len(amplitudes)), xticklabels=[with_unit(A, unit) for A in amplitudes],
                      yticks=range(len(steps)), yticklabels=[f"{cfl:g}" for cfl in steps])
            if not own:
                panel.text(0.5, 0.5, "not offered", transform=panel.transAxes, ha="center", va="center", color=INK3)
    for panel, treatment in zip(axes[0], treatments, strict=True):
        panel.set_title(treatment)
    for panel, method in zip(axes[:, 0], methods, strict=True):
        panel.set_ylabel(f"{method_name(method)}\ncfl")
    for panel in axes[-1]:
        panel.set_xlabel("amplitude A")
    bar = figure.colorbar(axes[0, 0].images[0], ax=list(axes.ravel()), location="bottom", aspect=100, pad=0.02,
                          label="periods")
    bar.outline.set_visible(False)
    in_sizes(bar.ax.xaxis, "")
    return figure
