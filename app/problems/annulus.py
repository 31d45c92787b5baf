"""View of a body between two radii: a quarter of a ring and its mirror images, or a ring with exact material lines."""

from collections.abc import Iterator
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from app.frame.error_plot import ErrorPlotDefinition
from app.frame.planar_stage import AWAY, WHOLE, PlanarStage
from app.frame.primitives import Label, Lines, Mark, join_points
from app.language.translation import lazy, tr
from app.problems.interface import BodyRegions, PlanarBodyKindView
from solvers.engine.shared_frames import FrameArrays
from solvers.problems.planar.circular_scene import CircularScene

SPOKES, SPOKE_POINTS, RIM_POINTS = 12, 41, 361
FULL = 2 * np.pi
ARC, ARC_POINTS = 0.44, 13  # length in rad of the mark of a worst region


class AnnulusViewSettings(NamedTuple):
    """Settings of the view of a quarter or whole ring: its regions, in so many ``angles`` from the x axis on and in
    ``shells`` from the inside, whose names have places for the angles {low} and {high} in degrees, their ``division``
    in words, and the height in inches and ratio of rows of a ``picture``, in which the outer radius is about ``points``
    long and dark ``lines`` are exact."""

    angles: int
    shells: tuple[str, ...]
    division: str
    picture: tuple[float, float]
    points: float
    lines: str


LOOKS = {
    "quarter": AnnulusViewSettings(
        6, (lazy("inner third, {low}–{high}°"), lazy("middle third, {low}–{high}°"),
            lazy("outer third, {low}–{high}°")),
        lazy("the quarter ring into 6 angles from the x axis on and 3 thirds of the wall"),
        (13.5, 0.85), 240.0, "exact surfaces"),
    "whole": AnnulusViewSettings(
        8, (lazy("innermost fifth, {low}–{high}°"), lazy("inner fifth, {low}–{high}°"),
            lazy("middle fifth, {low}–{high}°"), lazy("outer fifth, {low}–{high}°"),
            lazy("outermost fifth, {low}–{high}°")),
        lazy("the ring into 8 angles from the x axis on and 5 fifths of the wall"),
        (15.0, 1.3), 200.0, "rims and material lines of the exact solution")}


class QuarterAnnulusStage(PlanarStage[CircularScene]):
    """Stage of a quarter ring, drawn with its mirror images."""

    @staticmethod
    def max_radius(scene: CircularScene) -> float:
        return scene.OUTER + _outer_rim_displacement(scene)

    @staticmethod
    def plot_axis_positions(scene: CircularScene, X: np.ndarray) -> np.ndarray:
        return np.linalg.norm(X, axis=1)

    @staticmethod
    def max_stretch(scene: CircularScene) -> float:
        return 1 + 0.5 * _outer_rim_displacement(scene) / scene.OUTER

    def _wall_heights(self, x: np.ndarray) -> list[tuple[float, float]]:
        low, high = self._wall_radii(x)
        return [(-high, -low), (low, high)]

    def _wall_radii(self, x: np.ndarray) -> tuple[float, float]:
        """Returns the inner and the outer radius, in m, of the body with particles at x (P, 2) in m; the outer one at
        most that of everything drawn."""
        radii, half = np.hypot(*x.T), 0.5 * self._width / self._per_metre
        farthest = self._layout.radius / self._per_metre
        return max(0.0, float(radii.min()) - half), min(float(radii.max()) + half, farthest)

    def _worst_labels(self, sizes: str, x: np.ndarray) -> Iterator[Label]:
        """Yields two lines within the hole, as far as they fit."""
        (x_middle, y), metrics, name = self._layout.middle, self._layout.stage_metrics, tr("worst, at the arcs:")
        hole = 1.8 * self._wall_radii(x)[0] * self._per_metre if not any(self._labels.silences) else 0.0
        named, sized = (metrics.text_width(text) < hole for text in (name, sizes))
        yield Label("worst-name", name if sizes and named else "", x_middle, y, "bottom-center", "note")
        yield Label("worst-size", sizes if sized else "", x_middle, y, "top-center", "note", 1.1, bold=True)

    def _region_outline(self, x: np.ndarray, region: np.ndarray) -> np.ndarray:
        """Returns an arc, on the free side of the nearer rim."""
        (inner, outer), (across, up) = self._wall_radii(x), region.mean(axis=0)
        gap = AWAY * self._layout.stage_metrics.pixel / self._per_metre
        near = np.hypot(*region.T).mean() < 0.5 * (inner + outer)
        angles = np.arctan2(up, across) + np.linspace(-0.5, 0.5, ARC_POINTS) * ARC
        arc = (max(0.0, inner - gap) if near else outer + gap) * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        return join_points(arc[:-1], arc[1:])


class WholeAnnulusStage(QuarterAnnulusStage):
    """Stage of a whole ring. Its quarters are alike, so half of it is enough for each of estimate and truth."""

    MIRRORS = OUTLINED = WHOLE
    LINES = SPOKES

    @staticmethod
    def scale_note(scene: CircularScene) -> str:
        return tr("blue: exact lines") if scene.solution_known else ""

    @staticmethod
    def exact_material_lines(scene: CircularScene, t: float, count: int) -> np.ndarray:
        angles, R = FULL * np.arange(count)[:, None] / SPOKES, np.linspace(scene.INNER, scene.OUTER, SPOKE_POINTS)
        X = np.stack([R * np.cos(angles), R * np.sin(angles)], axis=2)
        return scene.EXACT.position(scene, X.reshape(-1, 2), t).reshape(X.shape)

    def _moving_marks(self, scene: CircularScene, arrays: FrameArrays, estimated: np.ndarray, true: np.ndarray,
                      t: float, crossed: np.ndarray) -> Iterator[Mark]:
        yield from super()._moving_marks(scene, arrays, estimated, true, t, crossed)
        lines = self.exact_material_lines(scene, t, SPOKES * scene.solution_known)
        x = self._to_stage(lines.reshape(-1, 2), 0.015).reshape(-1, SPOKE_POINTS, 3)
        yield Lines("spokes", join_points(x[:, :-1].reshape(-1, 3), x[:, 1:].reshape(-1, 3)),
                    self._layout.stage_metrics.palette.exact, 1.5)


def annulus_body_view(kind: type[Any]) -> PlanarBodyKindView:
    """Returns the view of the body of a class of circular scenes: a quarter or whole ring by its ``ANGLE``."""
    whole = kind.ANGLE >= FULL
    look = LOOKS["whole" if whole else "quarter"]
    base: type[QuarterAnnulusStage] = WholeAnnulusStage if whole else QuarterAnnulusStage
    plotted = ErrorPlotDefinition(kind.INNER, kind.OUTER, (f"R = {kind.INNER:g} m", f"{kind.OUTER:g} m"),
                                  lazy("Error across the wall"))
    stage = type(base.__name__, (base,), {"PLOT": plotted})
    return PlanarBodyKindView(stage, partial(_draw_picture, stage, look), partial(_regions, kind, look), look.division,
                              look.picture)


def _outer_rim_displacement(scene: CircularScene) -> float:
    """Returns how far, in m, the outer rim of the ring moves outwards at most."""
    return scene.amplitude if scene.DIRECTION == "radial" else 0.0


def _regions(kind: type[Any], look: AnnulusViewSettings, X: np.ndarray) -> BodyRegions:
    shells, angles = len(look.shells), look.angles
    share = (np.hypot(X[:, 0], X[:, 1]) - kind.INNER) / (kind.OUTER - kind.INNER)
    shell = np.clip((share * shells).astype(int), 0, shells - 1)
    turn = np.arctan2(X[:, 1], X[:, 0]) / kind.ANGLE
    angle = np.clip(((turn % 1 if kind.ANGLE >= FULL else turn) * angles).astype(int), 0, angles - 1)
    step = round(np.degrees(kind.ANGLE)) // angles
    names = tuple(tr(name, low=k * step, high=(k + 1) * step) for name in look.shells for k in range(angles))
    return BodyRegions(names, shell * angles + angle)


def _draw_picture(stage: type[QuarterAnnulusStage], look: AnnulusViewSettings, figure: Any, space: Any, particles: Any,
                  result: Any) -> None:
    from app.renderers.picture_panel_style import drawable_or_gap, robust_size
    from app.renderers.plane_panels import draw_estimate_and_truth_halves, draw_profile
    scene, shown, mirrored = result.scene, result.picture_snapshot, stage.MIRRORS != WHOLE
    angles = np.linspace(0, scene.ANGLE, RIM_POINTS)
    rims = [R * np.stack([np.cos(angles), np.sin(angles)], axis=1) for R in (scene.INNER, scene.OUTER)]
    moved = [rim + scene.EXACT.displacement(scene, rim, shown.time) for rim in rims]
    outer = scene.OUTER + abs(float(moved[1][0, 0]) - scene.OUTER)
    farthest = robust_size(np.hypot(*drawable_or_gap(shown.position).T)) if mirrored else outer
    lines = [rim * (side, 1) for rim in moved for side in ((-1, 1) if mirrored else (1,))]
    draw_profile(space, result, stage)
    draw_estimate_and_truth_halves(figure, particles, result, stage, 1.06 * float(np.clip(farthest, outer, 2 * outer)),
                                   [*stage.exact_material_lines(scene, shown.time, stage.LINES * scene.solution_known),
                                    *lines], look.lines, look.points / scene.OUTER)
