"""View of a body that fills a square: with its mirror images, and the field along a row of particles."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from app.frame.error_plot import ErrorPlotDefinition
from app.frame.planar_layout import AROUND, GAP, NAMES
from app.frame.planar_stage import PlanarStage
from app.frame.primitives import Label, join_points
from app.language.translation import lazy, tr
from app.problems.interface import BodyRegions, PlanarBodyKindView
from solvers.problems.planar.box_scene import BoxScene

REGIONS = 4  # a side
HEIGHT = 0.3  # height of the plotted row of particles over that of the square
CORNER = 0.3  # length of the marks in the corners of a worst region, over that of its shorter side
POINTS_PER_METRE = 240  # of the picture, roughly


def plotted_row(scene: BoxScene) -> float:
    """Returns the height Y at rest, in m, of the row of particles whose field is plotted."""
    across = scene.cells * scene.ppc
    return (int(HEIGHT * across) + 0.5) / across * scene.SIDE


class BoxStage(PlanarStage[BoxScene]):
    """Stage of the square, drawn with its mirror images; plots the field along a row of particles."""

    PLOT = ErrorPlotDefinition(0.0, 1.0, ("X = 0", "1 m"), lazy("Error along a row"))

    @staticmethod
    def max_radius(scene: BoxScene) -> float:
        return scene.SIDE

    @staticmethod
    def max_stretch(scene: BoxScene) -> float:
        return 1 + 0.5 * scene.STRAIN_PER_AMPLITUDE * scene.amplitude

    @staticmethod
    def plot_axis_positions(scene: BoxScene, X: np.ndarray) -> np.ndarray:
        return np.where(np.abs(X[:, 1] - plotted_row(scene)) < 0.5 * scene.spacing / scene.ppc, X[:, 0], np.nan)

    def _wall_heights(self, x: np.ndarray) -> list[tuple[float, float]]:
        end = self._layout.radius / self._per_metre
        return [(-end, end)]

    def _region_outline(self, x: np.ndarray, region: np.ndarray) -> np.ndarray:
        """Returns the corners of the region's rectangle."""
        low, high = np.percentile(region, (2, 98), axis=0)
        at = np.array([low, (high[0], low[1]), high, (low[0], high[1])])
        inwards = CORNER * (high - low).min() * np.sign(at.mean(axis=0) - at)
        return np.concatenate([join_points(at, at + inwards * along) for along in ((1, 0), (0, 1))])

    def _worst_labels(self, sizes: str, x: np.ndarray) -> Iterator[Label]:
        """Yields the label of the worst regions' errors right of the body, below the source of the truth."""
        (middle, y), metrics = self._layout.middle, self._layout.stage_metrics
        yield Label("worst-name", tr("worst: {size}", size=sizes) if sizes and metrics.gutter else "",
                    middle + AROUND * self._layout.radius + GAP * metrics.pixel, y - 1.9 * metrics.line_height,
                    "top-left", "note", width=metrics.letters_per_line(NAMES * metrics.pixel), bold=True)


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
