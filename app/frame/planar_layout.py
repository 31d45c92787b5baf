"""Layout of a plane problem: the body on the left, the field plot on the right; a pinned run beside it."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from app.frame.field_plot import ROOM
from app.frame.layout import HALVES, ComparedRunSlot, PlotBox, Spot, StageLayout, colour_bar_box, drawing_rectangle
from app.frame.primitives import Anchor, Label, Role, StageMetrics, Tone
from app.frame.stage import StageLabels
from app.language.translation import tr
from app.names_and_units import short_reason

AROUND = 1.05  # extent of the cells drawn over that of the body
#: Greatest width of the cells.
WIDEST = {ComparedRunSlot.ALONE: 0.5, ComparedRunSlot.FIRST: 0.31, ComparedRunSlot.SECOND: 0.31}
FIELD = 0.28  # least width of the plot
LEAST = 0.3  # least width of the cells with labels beside them
#: In pixels: gap beside the body, labels there, numbers of the plot, space above it for
#: its name, and width of the name with the factor of the error.
GAP, NAMES, NUMBERS, HEADING, NAME = 12.0, 112.0, 62.0, 42.0, 236.0


@dataclass(frozen=True)
class PlanarLayout(StageLayout):
    """Layout of a plane problem, in stage coordinates: ``middle`` and largest ``radius`` of the body, and the height
    ``end`` below the colour bar, above which nothing of the run is drawn."""

    middle: tuple[float, float]
    radius: float
    end: float


def make_planar_layout(metrics: StageMetrics, slot: ComparedRunSlot) -> PlanarLayout:
    """Returns the layout of the run in a slot of a stage with these (rounded) metrics."""
    pixel, line, alone = metrics.pixel, metrics.line_height, slot == ComparedRunSlot.ALONE
    end = colour_bar_box(metrics, metrics.high).end
    if 1 - FIELD - (NUMBERS + NAMES) * pixel < LEAST:  # large letters for a projector: names are above
        metrics = replace(metrics, gutter=0.0)
    beside = NUMBERS * pixel + (NAMES * pixel if alone and metrics.gutter else 0.0)
    above = 0.0 if alone and metrics.gutter else 1.3 * line  # labels above the body,
    under = 0.0 if metrics.gutter else 1.3 * line  # and below it
    free = end - above - under - 4 * pixel
    wide = min(free, WIDEST[slot], 1 - FIELD - beside)
    next_one = wide + GAP * pixel
    middle = 0.5 * wide + next_one * (slot == ComparedRunSlot.SECOND), under + 2 * pixel + 0.5 * free
    left = wide + next_one * (not alone) + beside + GAP * pixel
    low, high = (1.4 if metrics.gutter else 2.8) * line, end - (HEADING * pixel if metrics.gutter else 1.4 * line)
    name = (min(left - 40 * pixel, 1 - NAME * pixel), high + 1.2 * line)
    if not alone:
        share = 0.5 * (end - low)
        high = end - share * (slot == ComparedRunSlot.SECOND) - 1.6 * line
        low += share * (slot == ComparedRunSlot.FIRST)
        name = (left - 40 * pixel, high + 0.8 * line)
    half = 0.5 * (high - low) / ROOM
    below, named = None if slot == ComparedRunSlot.FIRST else low - 2 * pixel, metrics.gutter > 0
    magnified: Spot = (1.0, name[1], "center-right") if metrics.gutter else (1.0, 0.0, "bottom-right")
    box = PlotBox(left, 1.0, 0.5 * (high + low), half, below, None if slot == ComparedRunSlot.SECOND else magnified,
                  (1.0, high if metrics.gutter else end, "top-right"), name if named else None)
    return PlanarLayout(metrics, slot, drawing_rectangle(metrics.high), box, middle, 0.5 * wide / AROUND, end)


def planar_labels(words: StageLabels, places: PlanarLayout) -> Iterator[Label]:
    """Yields the labels of halves, run and marks, with texts from ``words``, at their places in a layout; not the texts
    of the colour bar and the field plot, nor annotations."""
    if places.slot != ComparedRunSlot.ALONE:
        return _paired_run_labels(words, places)
    return _labels_beside_body(words, places) if places.stage_metrics.gutter else _labels_above_body(words, places)


def _labels_beside_body(words: StageLabels, places: PlanarLayout) -> Iterator[Label]:
    """Yields labels for a stage with a gutter: the estimate's in the gutter, all others right of the body."""
    metrics, (x, y), left = places.stage_metrics, places.middle, -places.stage_metrics.gutter
    right = x + AROUND * places.radius + GAP * metrics.pixel
    width = metrics.letters_per_line(NAMES * metrics.pixel)
    for name, title, by, silence, at in zip(HALVES, words.titles, words.by, words.silences, (left, right), strict=True):
        role: Role = "gutter" if at < 0 else "title"
        yield Label(f"{name}-title", title, at, y + 0.1 * metrics.line_height, "bottom-left", role, 1.1, tone=name,
                    bold=True)
        yield Label(f"{name}-by", by, at, y - 0.1 * metrics.line_height, "top-left", "gutter" if at < 0 else "note")
        narrow = min(width, metrics.letters_per_line(metrics.gutter)) if at < 0 else width
        yield Label(f"{name}-silence", short_reason(silence), at, y - 1.9 * metrics.line_height, "top-left", role,
                    width=narrow, tone="faint")
    yield Label("alike", words.alike, right, y - 1.6 * metrics.line_height, "top-left", "note", width=width,
                tone="faint")
    yield Label("size-note", words.note, right, 2 * metrics.pixel, "bottom-left", "note", width=width, tone="faint")
    yield Label.of_spans("compared", words.compared, left, 4 * metrics.line_height, "bottom-left", "gutter")
    yield _crossing_label(words, places)


def _labels_above_body(words: StageLabels, places: PlanarLayout) -> Iterator[Label]:
    """Yields labels for a stage without a gutter: titles above the body."""
    metrics, (x, y), reach = places.stage_metrics, places.middle, AROUND * places.radius
    up = y + reach + 2 * metrics.pixel
    for name, title, at, anchor in _corner_titles(words.titles, x, reach, True):
        yield Label(f"{name}-title", title, at, up, anchor, "title", tone=name, bold=True)
    by = x - reach + 1.25 * metrics.text_extent(words.titles[0])[0] + 6 * metrics.pixel
    free = x + reach - by - 1.25 * metrics.text_extent(words.titles[1])[0] - metrics.text_extent(" ")[0]  # between
    text, _ = metrics.first_fitting_text((words.by[0], words.by[0].rpartition(" ")[2]), free, metrics.line_height)
    yield Label("estimate-by", text, by, up, "bottom-left", "note")
    yield Label("truth-by", "", x, up, "bottom-left", "title")
    yield from _empty_half_labels(words, places)
    for other in ("alike", "size-note"):
        yield Label(other, "", x, up, "bottom-left", "note")
    yield _crossing_label(words, places)


def _paired_run_labels(words: StageLabels, places: PlanarLayout) -> Iterator[Label]:
    """Yields labels for one of two runs: its name above the body, the halves' titles in the corners of its square."""
    metrics, (x, y), reach = places.stage_metrics, places.middle, AROUND * places.radius
    first = places.slot == ComparedRunSlot.FIRST
    for name, title, at, anchor in _corner_titles((tr("estimate"), tr("truth")), x, reach, False):
        yield Label(f"{name}-title", title, at, y + reach, anchor, "title", 0.9, tone=name)
    by, gutter = words.by[0] if first else "", metrics.gutter > 0
    yield Label("estimate-by", by, -metrics.gutter if gutter else 0.6, y if gutter else 0.0,
                "center-left" if gutter else "bottom-center", "gutter" if gutter else "note")
    yield Label("truth-by", "", x, y, "bottom-left", "note")
    yield from _empty_half_labels(words, places)
    yield Label.of_spans("name", words.name, x - reach, y + reach + 2 * metrics.pixel, "bottom-left", "name")
    for other in ("alike", "size-note"):
        yield Label(other, "", x, y, "bottom-left", "note")
    yield _crossing_label(words, places)


def _corner_titles(titles: tuple[str, str], x: float, reach: float,
                   up: bool) -> Iterator[tuple[Tone, str, float, Anchor]]:
    """Returns name, title, x, anchor of estimate and truth at x ± ``reach``: above the body if ``up``, else inside."""
    anchors: tuple[Anchor, Anchor] = ("bottom-left", "bottom-right") if up else ("top-left", "top-right")
    return zip(HALVES, titles, (x - reach, x + reach), anchors, strict=True)


def _empty_half_labels(words: StageLabels, places: PlanarLayout) -> Iterator[Label]:
    """Yields the reasons for empty halves, or empty labels, at the middle of the body: in the hole of a ring."""
    metrics, (x, y) = places.stage_metrics, places.middle
    sides: tuple[Anchor, Anchor] = ("center-right", "center-left")
    for name, silence, anchor, apart in zip(HALVES, words.silences, sides, (-4, 4), strict=True):
        text, width = metrics.first_fitting_text((silence, short_reason(silence)), 0.55 * places.radius,
                                                 1.1 * places.radius)
        yield Label(f"{name}-silence", text, x + apart * metrics.pixel, y, anchor, "silence", width=width)


def _crossing_label(words: StageLabels, places: PlanarLayout) -> Label:
    """Returns the legend of the marks at cell crossings, in the gutter or below the body; empty for a second run."""
    metrics, note = places.stage_metrics, words.crossings if places.slot != ComparedRunSlot.SECOND else ""
    if metrics.gutter:
        return Label("crossings-note", note, -metrics.gutter, 2 * metrics.pixel, "bottom-left", "gutter",
                     width=max(1, metrics.letters_per_line(metrics.gutter) - 2), tone="crossing", sign="dot")
    return Label("crossings-note", note, 0.0, 0.0, "bottom-left", "note", tone="crossing", sign="dot")
