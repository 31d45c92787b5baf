"""The stage of the bar: two lanes of particles, the estimate above the truth, and the field plot below."""

import math
from collections.abc import Iterator

import numpy as np

from app.frame.field_plot import ROOM, FieldPlot, FieldPlotDefinition
from app.frame.layout import HALVES, ComparedRunSlot
from app.frame.primitives import Anchor, Dots, Label, Lines, Mark, Tone, fade_colours, in_plane, join_points
from app.frame.stage import TOUCH, Stage, StageLabels, WorstRegionMark
from app.language.translation import lazy, tr
from app.names_and_units import short_reason
from app.problems.bar.layout import BarLayout, make_bar_layout
from solvers.engine.shared_frames import FrameArrays
from solvers.problems.bar import exact_solution
from solvers.problems.bar.scene import BarScene

LONGEST, WIDEST_LINE = 0.96, 90  # most width of text in a lane, as a share and in letters
LANE_POINTS = 2000  # most points in a lane
WIDEST, STRETCHED = 0.016, 1.25  # largest point; width of a particle's points over that at rest
NONE = np.empty((0, 3), np.float32)
TIGHT = 1.02  # factor on the size of points, to close gaps from half precision
CROSSING = 9.0  # pixels across
BRACKET, NEAR = 7.0, 0.1  # height in pixels; greatest distance from the middle of a region


def exact_positions(scene: BarScene, X: np.ndarray, t: float) -> np.ndarray:
    """Returns the exact positions (n,) in m, at the time t in s, of the bar's material at X (n,) in m at rest."""
    return X + exact_solution.displacement(scene, X, t)


class BarStage(Stage[BarScene]):
    """Stage of the bar: a lane of particles for the estimate and one for the truth, and the field plot."""

    PLOT = FieldPlotDefinition(0.0, 1.0, ("x = 0", "1 m"), exact_solution.field_as_sampled, where=exact_positions)
    MOST_MARKED, HALVES = 200, lazy("Lanes")
    layout = staticmethod(make_bar_layout)

    @classmethod
    def labels(cls, words: StageLabels, places: BarLayout) -> Iterator[Label]:
        for name, silence, lane in zip(HALVES, words.silences, (places.estimate, places.truth), strict=True):
            text, width = places.stage_metrics.first_fitting_text((silence, short_reason(silence)), LONGEST,
                                                                  places.lane)
            yield Label(f"{name}-silence", text, 0.5, lane, "center-center", "silence", width=min(width, WIDEST_LINE))
        yield from (_single_run_labels if places.slot == ComparedRunSlot.ALONE else _paired_run_labels)(words, places)

    def particles_in(self, low: tuple[float, float], high: tuple[float, float], arrays: FrameArrays) -> np.ndarray:
        """Returns which particles lie between the x of ``low`` and of ``high`` on the stage, at any height, (P,)."""
        x = self._stage_x(arrays)
        return (x >= low[0]) & (x <= high[0])

    def nearest_particle(self, point: tuple[float, float], arrays: FrameArrays) -> int | None:
        """Returns the index of the particle nearest to a stage point, in lanes by x, elsewhere by dot; None if far."""
        (x, y), places = point, self._layout
        if abs(y - 0.5 * (places.truth + places.estimate)) < 0.5 * (places.estimate - places.truth) + places.lane:
            return int(np.argmin(np.abs(self._stage_x(arrays) - x))) if -TOUCH < x < 1 + TOUCH else None
        return super().nearest_particle(point, arrays)

    def drawn_particle_points(self, arrays: FrameArrays, particles: slice) -> np.ndarray:
        x = self._stage_x(arrays)[particles]
        lanes = [in_plane(x, lane) for lane in (self._layout.estimate, self._layout.truth)]
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
                    shades: np.ndarray, t: float, crossed: np.ndarray) -> Iterator[Mark]:
        return self._plot.draw(self._layout, scene, self.plotted, self.magnified, self._now, arrays.plotted, t, crossed,
                               shades)

    def _static_marks(self, scene: BarScene, particles: int, at_rest: np.ndarray | None) -> Iterator[Mark]:
        edges, places = np.arange(scene.cells + 1) * scene.spacing, self._layout
        colours = places.stage_metrics.palette
        box, over = places.field, 6 * places.stage_metrics.pixel
        for name, low, high, colour, depth in (
                ("cells", places.truth - 0.5 * places.lane - over, places.estimate + 0.5 * places.lane + over,
                 colours.cell, -0.01),
                ("cells-below", box.middle - ROOM * box.half, box.middle + ROOM * box.half, colours.grid, -0.02)):
            yield Lines(name, join_points(*(in_plane(edges, y, depth) for y in (low, high))), colour, 1.0)
        self._lanes = _LanePointTiling(particles, places)

    def _moving_marks(self, scene: BarScene, arrays: FrameArrays, estimated: np.ndarray, true: np.ndarray, t: float,
                      crossed: np.ndarray, age: np.ndarray) -> Iterator[Mark]:
        self._now = x = self._stage_x(arrays)
        metrics, between = self._layout.stage_metrics, self._layout.crossings
        yield self._lanes.dots(x, estimated, true)
        if between is None:
            yield Dots("crossings", NONE, NONE, 1.0)
        else:
            yield Dots("crossings", in_plane(x[crossed], between, 0.02), fade_colours(age, metrics.palette),
                       CROSSING * metrics.pixel)

    def _worst_region_marks(self, worst: tuple[WorstRegionMark | None, WorstRegionMark | None],
                            arrays: FrameArrays) -> Iterator[Mark]:
        """Yields a bracket with a label above the estimate's lane and below the truth's, around the worst region, if it
        is known and labels leave space; and the hint that both lanes look alike."""
        places, segments = self._layout, [np.empty((0, 2, 3), np.float32)]
        metrics, wanted = places.stage_metrics, places.stage_metrics.gutter > 0 and places.slot == ComparedRunSlot.ALONE
        for found, name, lane, up in zip(worst, HALVES, (places.estimate, places.truth), (1, -1), strict=True):
            at = self._stage_x(arrays)[found.particles] if found and wanted else np.empty(0)
            at = at[(at >= 0) & (at <= 1)]
            at = at[np.abs(at - np.median(at)) < NEAR] if len(at) else at  # without those at the other end, or lost
            text, x, y = "", 0.5, lane
            if found and len(at):
                y = lane + up * (0.5 * places.lane + 4 * metrics.pixel)
                ends, high = np.array([at.min(), at.max()]), y + up * BRACKET * metrics.pixel
                corners = in_plane(ends[[0, 0, 1, 1]], np.array([y, high, high, y]), 0.02)
                segments.append(join_points(corners[:-1], corners[1:]))
                text, y = tr("worst: {size}", size=found.size), high + up * 2 * metrics.pixel
                beside = 1.1 * metrics.text_extent(text)[0]
                x = float(np.clip(ends.mean(), 0.5 * beside, 1 - 0.5 * beside))
            yield Label(f"{name}-worst", text, x, y, "bottom-center" if up > 0 else "top-center", "note", bold=True)
            taken = (x - 0.5 * beside, x + 0.5 * beside) if text else (0.0, 0.0)
        if places.slot == ComparedRunSlot.ALONE:
            yield _equal_lanes_label(self._labels.alike, places, taken)  # where the truth's bracket leaves space
        yield Lines("worst", np.concatenate(segments), metrics.palette.dot, 1.5)


def _equal_lanes_label(text: str, places: BarLayout, taken: tuple[float, float] = (0.0, 0.0)) -> Label:
    """Returns the hint about equal lanes, below and right or, if ``taken`` (from x to x), left; "" without room."""
    metrics, below = places.stage_metrics, places.truth - 0.5 * places.lane - 8 * places.stage_metrics.pixel
    wide = metrics.text_extent(text + "  ")[0]
    right = taken[1] < 1 - wide
    fits = metrics.gutter > 0 and (right or taken[0] > wide)
    x: float = 1.0 if right else 0.0
    anchor: Anchor = "top-right" if right else "top-left"
    return Label("alike", text if fits else "", x, below, anchor, "note", tone="faint")


def _single_run_labels(words: StageLabels, places: BarLayout) -> Iterator[Label]:
    """Yields the labels of a bar that is alone: titles in the gutter beside the lanes, or above and below them."""
    metrics, half = places.stage_metrics, 0.5 * places.lane
    below = places.truth - half - 8 * metrics.pixel
    if metrics.gutter:
        left = -metrics.gutter
        for name, title, by, y in _lane_titles(words, places):
            yield Label(f"{name}-title", title, left, y + 0.1 * metrics.line_height, "bottom-left", "gutter", 1.1,
                        tone=name, bold=True)
            yield Label(f"{name}-by", by, left, y - 0.1 * metrics.line_height, "top-left", "gutter")
        note, _ = metrics.first_fitting_text((words.crossings, words.crossings.partition(" ")[0]),
                                             metrics.gutter - metrics.text_extent("key")[0], metrics.line_height)
        yield Label("crossings-note", note, left, places.crossings or 0.0, "center-left", "gutter", tone="crossing",
                    sign="dot")
    else:
        off = half + 4 * metrics.pixel
        sides: tuple[tuple[float, Anchor], ...] = (off, "bottom-left"), (-off, "top-left")
        for (name, title, by, y), (up, anchor) in zip(_lane_titles(words, places), sides, strict=True):
            yield Label(f"{name}-title", title, 0.0, y + up, anchor, "title", tone=name, bold=True)
            x = 1.25 * metrics.text_extent(title)[0] + 6 * metrics.pixel
            yield Label(f"{name}-by", by, x, y + up, anchor, "note")
        yield Label("crossings-note", words.crossings, 1.0, below + 4 * metrics.pixel, "top-right", "note",
                    tone="crossing", sign="dot")
    yield _equal_lanes_label(words.alike, places)
    yield Label("run", "", 0.0, places.heading, "bottom-left", "name")


def _paired_run_labels(words: StageLabels, places: BarLayout) -> Iterator[Label]:
    """Yields the labels of one of two bars: a heading above the plot, and titles beside the strips."""
    metrics, first = places.stage_metrics, places.slot == ComparedRunSlot.FIRST
    for name, _, _, y in _lane_titles(words, places):
        yield Label(f"{name}-title", tr(name) if metrics.gutter else "", -0.01, y, "center-right", "number", tone=name)
        by = words.by[0] if first and name == "estimate" else ""
        if metrics.gutter:
            yield Label(f"{name}-by", by, -metrics.gutter, places.field.middle - 0.5 * places.field.half, "center-left",
                        "gutter")
        else:
            yield Label(f"{name}-by", by, 1.0, places.heading, "bottom-right", "note")
    parts = (words.run[:1].upper() + words.run[1:]).split(", ")
    beside = 0.0 if metrics.gutter else 1.3 * metrics.text_extent(words.by[0] + "  ")[0]
    run, _ = metrics.first_fitting_text((", ".join(parts[:k]) for k in range(len(parts), 0, -1)), (1 - beside) / 1.2,
                                        metrics.line_height)
    yield Label("run", run, 0.0, places.heading, "bottom-left", "name", 1.1, tone="plain" if first else "faint",
                bold=True)
    note = words.crossings if first else ""
    yield Label("crossings-note", note if metrics.gutter else "", 1.0, places.heading, "bottom-right", "note",
                tone="crossing", sign="dot")
    yield Label("alike", "", 1.0, places.heading, "bottom-right", "note", tone="faint")


def _lane_titles(words: StageLabels, places: BarLayout) -> Iterator[tuple[Tone, str, str, float]]:
    """Returns name, title, source and height on the stage of the lanes of estimate and truth."""
    return zip(HALVES, words.titles, words.by, (places.estimate, places.truth), strict=True)


class _LanePointTiling:
    """Tiling of the two lanes of P particles in a layout with square points of the stage size ``size``: in rows, and so
    many points across per particle that gaps show only under large stretch.

    A particle's points are wider than it is at rest. Neighbours overlap, the right one on top; a shift of all by a part
    of their width puts the visible part in place. Points are relative to the middle between the lanes, so that half
    precision, with half the bytes, is a tenth of a pixel."""

    def __init__(self, particles: int, places: BarLayout):
        column, middle = 1 / particles, 0.5 * (places.estimate + places.truth)
        self.origin = 0.5, middle
        rows = max(math.ceil(places.lane / WIDEST), min(int(places.lane / (1.5 * column)), LANE_POINTS // particles))
        self.size = places.lane / rows
        across = math.ceil(STRETCHED * column / self.size)
        wide = self.size if across == 1 else STRETCHED * column
        beside = np.linspace(-0.5, 0.5, across) * (wide - self.size) if across > 1 else np.zeros(1)
        self._beside = beside + (wide - column) / 2
        self._points = np.zeros((2, rows, particles, across, 3), np.float16)  # without their x
        up = (np.arange(rows) - (rows - 1) / 2) * self.size
        for lane, at in zip(self._points, (places.estimate, places.truth), strict=True):
            lane[..., 1] = (at - middle + up)[:, None, None]

    def dots(self, x: np.ndarray, *shades: np.ndarray) -> Dots:
        """Returns dots for particles at the stage x (P,), in colours (P, 3), uint8, of the lanes: estimate, truth."""
        points, colours = self._points.copy(), np.empty(self._points.shape, np.uint8)
        inside = np.minimum(np.maximum(x[:, None] + self._beside, self.size / 2), 1 - self.size / 2)
        points[..., 0] = (inside - self.origin[0]).astype(np.float16)
        rows, across = self._points.shape[1], self._points.shape[3]
        for lane, of_particles in zip(colours.reshape(2, rows, -1), shades, strict=True):
            lane[...] = np.repeat(of_particles, across, axis=0).reshape(-1)  # row by row: particle by particle is slow
        return Dots("lanes", points.reshape(-1, 3), colours.reshape(-1, 3), TIGHT * self.size, "square", self.origin)
