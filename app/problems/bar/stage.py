"""The stage of the bar: the field plot, and below it two lanes of particles, the estimate above the truth."""

import math
from collections.abc import Iterator

import numpy as np

from app.frame.error_view_captions import NONE_CHOSEN, StageHalfErrors
from app.frame.field_plot import ROOM, FieldPlot, FieldPlotDefinition
from app.frame.layout import HALVES
from app.frame.primitives import Anchor, Dots, Label, Lines, Mark, Role, Sign, StageMetrics, Tone, in_plane, join_points
from app.frame.stage import TOUCH, Stage, StageLabels, WorstRegionMark, title_labels
from app.language.translation import lazy, tr
from app.names_and_units import short_reason
from app.problems.bar.layout import BarLayout, make_bar_layout
from solvers.engine.shared_frames import FrameArrays
from solvers.problems.bar import exact_solution
from solvers.problems.bar.scene import BarScene

LONGEST, WIDEST_LINE = 0.96, 90  # most width of text in a lane, as a share and in letters
LANE_POINTS = 2000  # most points in a lane
WIDEST, STRETCHED = 0.016, 1.25  # largest point; width of a particle's points over that at rest
TIGHT = 1.02  # factor on the size of points, to close gaps from half precision
KEYS = {"line": 42.0, "dot": 28.0, "ring": 33.0}  # pixels of a key of the legend beside its text, by its sign
#: Where the name of a lane is, in a gutter and without one: x, anchor and role.
LANE_NAME: tuple[float, Anchor, Role] = (-0.01, "center-right", "number")
LANE_NAME_WITHIN: tuple[float, Anchor, Role] = (0.008, "center-left", "chip")


def exact_positions(scene: BarScene, X: np.ndarray, t: float) -> np.ndarray:
    """Returns the exact positions (n,) in m, at the time t in s, of the bar's material at X (n,) in m at rest."""
    return X + exact_solution.displacement(scene, X, t)


class BarStage(Stage[BarScene]):
    """Stage of the bar: a lane of particles for the estimate and one for the truth, and the field plot."""

    PLOT = FieldPlotDefinition(0.0, 1.0, ("x = 0", "1 m"), exact_solution.field_as_sampled, where=exact_positions)
    MOST_MARKED, HALVES = 200, lazy("Lanes")
    layout = staticmethod(make_bar_layout)
    _judged = True  # whether an estimator is chosen, and has a lane

    @classmethod
    def labels(cls, words: StageLabels, places: BarLayout) -> Iterator[Label]:
        metrics, gutter = places.stage_metrics, places.stage_metrics.gutter
        for name, silence, lane in zip(HALVES, words.silences, (places.estimate, places.truth), strict=True):
            there = lane in places.lanes
            texts = (silence, short_reason(silence)) if there else ("",)
            text, width = metrics.first_fitting_text(texts, LONGEST, places.lane)
            yield Label(f"{name}-silence", text, 0.5, lane, "center-center", "silence", width=min(width, WIDEST_LINE))
            x, anchor, role = LANE_NAME if gutter else LANE_NAME_WITHIN
            yield Label(f"{name}-title", tr(name) * there, x, lane, anchor, role, tone=name, bold=not gutter)
        yield from title_labels(words, metrics, places.heading)
        yield Label.of_spans("compared", words.compared if gutter else (), -gutter,
                             places.field.middle - 0.6 * places.field.half, "center-left", "gutter")
        yield from legend_labels(words.crossings, metrics, places.legend, words.before)

    def show_captions(self, estimate: StageHalfErrors, truth: StageHalfErrors) -> None:
        if self._judged != (judged := estimate.silence != tr(NONE_CHOSEN)):
            self._judged = judged
            self._lay_out()
        super().show_captions(estimate, truth)

    def _layout_for(self, metrics: StageMetrics) -> BarLayout:
        return make_bar_layout(metrics, self._slot, self._judged)

    def particles_in(self, low: tuple[float, float], high: tuple[float, float], arrays: FrameArrays) -> np.ndarray:
        """Returns which particles lie between the x of ``low`` and of ``high`` on the stage, at any height, (P,)."""
        x = self._stage_x(arrays)
        return (x >= low[0]) & (x <= high[0])

    def nearest_particle(self, point: tuple[float, float], arrays: FrameArrays) -> int | None:
        """Returns the index of the particle nearest to a stage point, in lanes by x, elsewhere by dot; None if far."""
        (x, y), places = point, self._layout
        lanes = places.lanes
        if min(lanes) - places.lane < y < max(lanes) + places.lane:
            return int(np.argmin(np.abs(self._stage_x(arrays) - x))) if -TOUCH < x < 1 + TOUCH else None
        return super().nearest_particle(point, arrays)

    def drawn_particle_points(self, arrays: FrameArrays, particles: slice) -> np.ndarray:
        x = self._stage_x(arrays)[particles]
        lanes = [in_plane(x, lane) for lane in self._layout.lanes]
        return np.stack([*lanes, self._plot.dot_positions(particles, len(x))])

    def _stage_x(self, arrays: FrameArrays) -> np.ndarray:
        """Returns particles' stage x (P,), as in m, within a periodic bar's period; -0.5 to 1.5 for a broken run."""
        x = arrays.position[:, 0]
        if self._drawn_scene is not None:
            x = self._drawn_scene.wrap_into_period(x)
        return np.fmin(np.fmax(x, -0.5), 1.5)  # fmax ignores NaN

    @staticmethod
    def plot_axis_positions(scene: BarScene, X: np.ndarray) -> np.ndarray:
        return X.ravel()

    def _make_plot(self, beside: "BarStage | None") -> FieldPlot:
        return FieldPlot(self.PLOT, beside._plot if beside else None)

    def _plot_marks(self, scene: BarScene, arrays: FrameArrays, sizes: tuple[np.ndarray | None, np.ndarray | None],
                    t: float, crossed: np.ndarray) -> Iterator[Mark]:
        yield from self._plot.draw(self._layout, scene, self.plotted, self.magnified, self._now, arrays.plotted, t,
                                   crossed)
        self._update_labels(before=tr("before") if self._plot.shows_before else "")

    def _static_marks(self, scene: BarScene, particles: int, at_rest: np.ndarray | None) -> Iterator[Mark]:
        edges, places = np.arange(scene.cells + 1) * scene.spacing, self._layout
        box = places.field
        low, high = (in_plane(edges, box.middle + side * ROOM * box.half, -0.02) for side in (-1, 1))
        yield Lines("cells", join_points(low, high), places.stage_metrics.palette.grid, 1.0)
        self._lanes = _LanePointTiling(particles, places)

    def _moving_marks(self, scene: BarScene, arrays: FrameArrays, estimated: np.ndarray, true: np.ndarray, t: float,
                      crossed: np.ndarray) -> Iterator[Mark]:
        self._now = x = self._stage_x(arrays)
        yield self._lanes.dots(x, *(estimated, true)[not self._judged:])

    def _worst_region_marks(self, worst: tuple[WorstRegionMark | None, WorstRegionMark | None],
                            arrays: FrameArrays) -> Iterator[Mark]:
        """Yields nothing: the lanes show where the error is largest."""
        yield from ()


def legend_labels(crossings: str, metrics: StageMetrics, y: float | None, before: str = "") -> Iterator[Label]:
    """Yields the legend of a bar's field plot, a label for each key, centred below the height y; empty ones for None.
    ``crossings`` explains the rings, ``before`` the curve before a change, if there is one."""
    keys: tuple[tuple[str, str, Tone, Sign], ...] = (
        ("exact", tr("exact"), "truth", "line"), ("particle", tr("particle"), "plain", "dot"),
        ("crossings-note", crossings, "crossing", "ring"), ("before", before, "before", "line"))
    widths = [metrics.text_width(text) + KEYS[sign] * metrics.pixel if text else 0.0 for _, text, _, sign in keys]
    x = 0.5 * (1 - sum(widths))
    for (name, text, tone, sign), width in zip(keys, widths, strict=True):
        yield Label(name, "" if y is None else text, x, y or 0.0, "top-left", "note", tone=tone, sign=sign)
        x += width


class _LanePointTiling:
    """Tiling of the lanes of P particles in a layout with square points of the stage size ``size``: in rows, and so
    many points across per particle that gaps show only under large stretch.

    A particle's points are wider than it is at rest. Neighbours overlap, the right one on top; a shift of all by a part
    of their width puts the visible part in place. Points are relative to the middle between the lanes, so that half
    precision, with half the bytes, is a tenth of a pixel."""

    def __init__(self, particles: int, places: BarLayout):
        lanes = places.lanes
        column, middle = 1 / particles, 0.5 * (min(lanes) + max(lanes))
        self.origin = 0.5, middle
        rows = max(math.ceil(places.lane / WIDEST), min(int(places.lane / (1.5 * column)), LANE_POINTS // particles))
        self.size = places.lane / rows
        across = math.ceil(STRETCHED * column / self.size)
        wide = self.size if across == 1 else STRETCHED * column
        beside = np.linspace(-0.5, 0.5, across) * (wide - self.size) if across > 1 else np.zeros(1)
        self._beside = beside + (wide - column) / 2
        self._points = np.zeros((len(lanes), rows, particles, across, 3), np.float16)  # without their x
        up = (np.arange(rows) - (rows - 1) / 2) * self.size
        for lane, at in zip(self._points, lanes, strict=True):
            lane[..., 1] = (at - middle + up)[:, None, None]

    def dots(self, x: np.ndarray, *shades: np.ndarray) -> Dots:
        """Returns dots for particles at the stage x (P,), in colours (P, 3), uint8, of each lane, the truth's last."""
        points, colours = self._points.copy(), np.empty(self._points.shape, np.uint8)
        inside = np.minimum(np.maximum(x[:, None] + self._beside, self.size / 2), 1 - self.size / 2)
        points[..., 0] = (inside - self.origin[0]).astype(np.float16)
        rows, across = self._points.shape[1], self._points.shape[3]
        for lane, of_particles in zip(colours.reshape(len(shades), rows, -1), shades, strict=True):
            lane[...] = np.repeat(of_particles, across, axis=0).reshape(-1)  # row by row: particle by particle is slow
        return Dots("lanes", points.reshape(-1, 3), colours.reshape(-1, 3), TIGHT * self.size, "square", self.origin)
