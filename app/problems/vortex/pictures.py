"""The vortex's own panels: its particles, estimate on the left half and truth on the right, and a profile over R."""

from typing import cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec

from app.problems.vortex.stage import SPOKES, VortexStage
from app.renderers.plane import draw_halves, draw_profile
from solvers.problems.vortex.exact import INNER, OUTER
from solvers.problems.vortex.scene import VortexScene
from solvers.running.result import Result

POINTS_PER_METRE = 160  # of the picture, roughly
_ANGLES = np.linspace(0, 2 * np.pi, 361)


def draw(figure: Figure, space: Axes, particles: SubplotSpec, result: Result) -> None:
    scene = cast(VortexScene, result.scene)
    lines = VortexStage.exact_lines(scene, result.shown.time, SPOKES * scene.solution_known)
    rims = [R * np.stack([np.cos(_ANGLES), np.sin(_ANGLES)], axis=1) for R in (INNER, OUTER)]  # circles that stay
    draw_profile(space, result, VortexStage)
    draw_halves(figure, particles, result, VortexStage, 1.06 * OUTER, [*lines, *rims],
                "rims and material lines of the exact solution", POINTS_PER_METRE)
