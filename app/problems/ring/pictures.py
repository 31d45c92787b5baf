"""The ring's own panels: its particles, estimate on the left half and truth on the right, and a profile over R."""

from typing import cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec

from app.problems.ring.stage import RingStage
from app.renderers.picture import drawable, robust_size
from app.renderers.plane import draw_halves, draw_profile
from solvers.problems.ring import exact
from solvers.problems.ring.scene import RingScene
from solvers.running.result import Result

POINTS_PER_METRE = 400  # of the picture of the ring, roughly
_ANGLES = np.linspace(0, 0.5 * np.pi, 181)


def draw(figure: Figure, space: Axes, particles: SubplotSpec, result: Result) -> None:
    scene, shown = cast(RingScene, result.scene), result.shown
    rims = [R * np.stack([np.cos(_ANGLES), np.sin(_ANGLES)], axis=1) for R in (exact.INNER, exact.OUTER)]
    moved = [rim + exact.displacement(scene, rim, shown.time) for rim in rims]
    outer = exact.OUTER + abs(float(exact.displacement(scene, np.array([[exact.OUTER, 0.0]]), shown.time)[0, 0]))
    reach = float(np.clip(robust_size(np.hypot(*drawable(shown.position).T)), outer, 2 * outer)) * 1.06
    draw_profile(space, result, RingStage)
    draw_halves(figure, particles, result, RingStage, reach, [rim * (side, 1) for rim in moved for side in (-1, 1)],
                "exact surfaces", POINTS_PER_METRE)
