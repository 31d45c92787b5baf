"""The picture of ``mpm-lab check``: the particles, how far each is from its neighbours, and those that were named."""

from collections.abc import Callable

import numpy as np
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from app.colours import COLOUR_MAP, ESTIMATE
from app.renderers import picture
from app.renderers.look import in_sizes
from app.renderers.picture import thinned
from solvers.judging.check import Checked
from solvers.judging.findings.neighbours import departures


def places_figure(checked: Checked) -> Figure | None:
    """The particles at the moment of the first contradiction, else the last: displacements along a line, or places in
    the first two directions. None where nobody has neighbours."""
    motion = checked.motion.part
    if motion.near is None:
        return None
    named = [one for one in checked.wrong if one.time is not None and one.particle is not None]
    moment = int(np.argmin(np.abs(motion.times - named[0].time))) if named else len(motion.times) - 1
    with np.errstate(all="ignore"):
        far = np.nan_to_num(departures(motion.near, motion.x[moment] - motion.reference), posinf=0.0)
    few = thinned(len(far))
    figure = Figure(figsize=(10, 4.5) if motion.dimensions == 1 else (10, 8), layout="constrained")
    axes = figure.subplots()
    axes.set_title(f"Particles at t = {motion.times[moment]:.4g} s, verdict: {checked.verdict}")
    x = motion.x[moment]
    along, across = (motion.reference[:, 0], x[:, 0] - motion.reference[:, 0]) if motion.dimensions == 1 else (
        x[:, 0], x[:, 1])
    points = axes.scatter(along[few], across[few], c=far[few], cmap=COLOUR_MAP, linewidths=0,
                          norm=Normalize(0.0, float(far.max()) or 1.0), s=float(np.clip(40_000 / len(few), 2, 40)))
    axes.set(xlabel="X" if motion.dimensions == 1 else "x", ylabel="x - X" if motion.dimensions == 1 else "y")
    if motion.dimensions > 1:
        axes.set_aspect("equal")
    who = np.flatnonzero(np.isin(motion.number, np.array([one.particle for one in named], dtype=float)))
    if len(who):
        axes.scatter(along[who], across[who], s=80, facecolors="none", edgecolors=ESTIMATE, label="named in the report")
        axes.legend(loc="upper right")
    axes.grid(axis="both")
    in_sizes(axes.xaxis, "m", few=False)
    in_sizes(axes.yaxis, "m", few=False)
    picture.colour_bar(figure, points, axes, "from a plane through the neighbours", "m", aspect=60)
    return figure


FIGURES: dict[str, Callable[[Checked], Figure | None]] = {"places": places_figure}
