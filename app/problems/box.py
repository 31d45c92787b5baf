"""View of a body that fills a square: with its mirror images, and the field along a row of particles."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from app.frame.field_plot import FieldPlotDefinition
from app.frame.planar_stage import PlanarStage
from app.frame.primitives import Mark
from app.language.translation import lazy, tr
from app.problems.interface import BodyRegions, PlanarBodyKindView
from solvers.problems.planar.box_scene import BoxScene
from solvers.problems.planar.particle_layout import particle_layout

REGIONS = 4  # a side
HEIGHT = 0.3  # height of the plotted row of particles over that of the square
NO_BREAK = "\N{NO-BREAK SPACE}"
POINTS_PER_METRE = 240  # of the picture, roughly


def plotted_row(scene: BoxScene) -> float:
    """Returns the height Y at rest, in m, of the row of particles whose field is plotted."""
    across = scene.cells * scene.ppc
    return (int(HEIGHT * across) + 0.5) / across * scene.SIDE


class BoxStage(PlanarStage[BoxScene]):
    """Stage of the square, drawn with its mirror images; plots the field along a row of particles."""

    PLOT = FieldPlotDefinition(0.0, 1.0, ("X = 0", "1 m"), lambda scene, quantity, X, t: scene.exact_plotted_component(
        quantity, np.stack([X, np.full_like(X, plotted_row(scene))], axis=1), t))

    @staticmethod
    def max_radius(scene: BoxScene) -> float:
        return scene.SIDE

    @staticmethod
    def scale_note(scene: BoxScene) -> str:
        return tr("side {side}, h = {h}", side=f"{scene.SIDE:g}{NO_BREAK}m", h=f"{scene.spacing:.3g}{NO_BREAK}m")

    @staticmethod
    def max_stretch(scene: BoxScene) -> float:
        return 1 + 0.5 * scene.STRAIN_PER_AMPLITUDE * scene.amplitude

    def _static_marks(self, scene: BoxScene, particles: int, at_rest: np.ndarray | None) -> Iterator[Mark]:
        yield from super()._static_marks(scene, particles, at_rest)
        X = particle_layout(scene).position if at_rest is None else at_rest
        half = 0.5 * scene.spacing / scene.ppc
        self._radii = np.where(np.abs(X[:, 1] - plotted_row(scene)) < half, X[:, 0], np.nan)


def regions(X: np.ndarray) -> BodyRegions:
    """Returns the square's 16 regions for particles at X (P, 2) in m at rest."""
    cell = np.clip((X * REGIONS).astype(int), 0, REGIONS - 1)
    names = tuple(tr("column {column}, row {row} from below", column=i + 1, row=j + 1)
                  for j in range(REGIONS) for i in range(REGIONS))
    return BodyRegions(names, cell[:, 1] * REGIONS + cell[:, 0])


def draw_picture(figure: Any, space: Any, particles: Any, result: Any) -> None:
    """Draws a result into axes and subplot of a figure (:class:`~app.problems.interface.ProblemView`)."""
    from app.renderers.plane_panels import OVER_WIDTH, draw_estimate_and_truth_halves, draw_profile
    draw_profile(space, result, BoxStage, OVER_WIDTH)
    draw_estimate_and_truth_halves(figure, particles, result, BoxStage, 1.06 * result.scene.SIDE, [],
                                   "planes of symmetry", POINTS_PER_METRE)


BODY = PlanarBodyKindView(BoxStage, draw_picture, regions, lazy("the square into 16 squares"), (13.5, 0.85))
