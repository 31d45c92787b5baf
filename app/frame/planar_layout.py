"""Layout of a plane problem: the body on the left, the error plot on the right; a second run beside it."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from app.frame.error_plot import HEADING, ErrorPlotBox
from app.frame.layout import HALVES, ComparedRunSlot, StageLayout, colour_bar_box, drawing_rectangle
from app.frame.primitives import Anchor, Label, StageMetrics
from app.frame.stage import StageLabels, fit_spans, title_labels
from app.language.translation import tr
from app.names_and_units import short_reason

AROUND = 1.05  # extent of the cells drawn over that of the body
PAIRED = 0.31, 0.48  # greatest width of the cells of one of two runs: beside the plots, and without any
PLOT = 0.22  # least width of the plot
LEAST, SMALLER = 0.3, 0.75  # least width of the cells with labels beside them; and, beside a plot, over that without
#: In pixels: gap beside the body, from x = 0 to a body whose name is left of it, names at its right, numbers of the
#: plot with its colour bar, and space below the plot.
GAP, INDENT, NAMES, NUMBERS, BELOW = 10.0, 30.0, 88.0, 58.0, 20.0
TITLE = 22.0  # height in pixels of the run's title


@dataclass(frozen=True)
class PlanarLayout(StageLayout):
    """Layout of a plane problem, in stage coordinates: ``middle`` and largest ``radius`` of the body, the height
    ``end`` below the colour bar and the run's title, above which nothing is drawn, and the box of the error ``plot``;
    None where there is no room for it."""

    middle: tuple[float, float]
    radius: float
    end: float
    plot: ErrorPlotBox | None


def make_planar_layout(metrics: StageMetrics, slot: ComparedRunSlot) -> PlanarLayout:
    """Returns the layout of the run in a slot of a stage with these (rounded) metrics."""
    pixel = metrics.pixel
    if 1 - (INDENT + GAP + NAMES) * pixel < LEAST:  # large letters in a narrow window: names are above
        metrics = replace(metrics, gutter=0.0)
    if slot != ComparedRunSlot.ALONE:
        return _paired_run_layout(metrics, slot)
    end = colour_bar_box(metrics, metrics.high).end - TITLE * pixel
    if not metrics.gutter:
        low, high = 1.3 * metrics.line_height, end - 1.3 * metrics.line_height
        wide = min(high - low - 4 * pixel, 1.0)
        return PlanarLayout(metrics, slot, drawing_rectangle(metrics.high), (0.5, 0.5 * (low + high)),
                            0.5 * wide / AROUND, end, None)
    free, beside = end - 4 * pixel, 1 - (INDENT + GAP + NAMES) * pixel
    wide = min(free, beside - NUMBERS * pixel - PLOT)
    plotted = wide >= LEAST and wide >= SMALLER * min(free, beside)
    wide = wide if plotted else min(free, beside)
    box = ErrorPlotBox((INDENT + GAP + NAMES + NUMBERS) * pixel + wide, 1.0, BELOW * pixel, end - HEADING * pixel)
    return PlanarLayout(metrics, slot, drawing_rectangle(metrics.high),
                        (INDENT * pixel + 0.5 * wide, 2 * pixel + 0.5 * free), 0.5 * wide / AROUND, end,
                        box if plotted else None)


def _paired_run_layout(metrics: StageMetrics, slot: ComparedRunSlot) -> PlanarLayout:
    """Returns the layout of one of two bodies beside each other, with the two plots, one above the other, at the right
    if the stage has a gutter."""
    pixel, line, second = metrics.pixel, metrics.line_height, slot == ComparedRunSlot.SECOND
    end, under = colour_bar_box(metrics, metrics.high).end, 0.0 if metrics.gutter else 1.3 * line
    free = end - 2.4 * line - under - 4 * pixel  # between the run's name with its facts and the legend
    wide = min(free, PAIRED[0 if metrics.gutter else 1])
    next_one = wide + GAP * pixel
    middle = 0.5 * wide + next_one * second, under + 2 * pixel + 0.5 * free
    share = 0.5 * (end - BELOW * pixel)
    low = BELOW * pixel + share * (not second)
    box = ErrorPlotBox(2 * wide + (2 * GAP + NUMBERS) * pixel, 1.0, low, low + share - HEADING * pixel, not second,
                       second)
    return PlanarLayout(metrics, slot, drawing_rectangle(metrics.high), middle, 0.5 * wide / AROUND, end,
                        box if metrics.gutter else None)


def planar_labels(words: StageLabels, places: PlanarLayout) -> Iterator[Label]:
    """Yields the labels of halves, run and marks, with texts from ``words``, at their places in a layout; not the texts
    of the colour bar and the error plot, nor annotations."""
    if places.slot != ComparedRunSlot.ALONE:
        return _paired_run_labels(words, places)
    return _labels_beside_body(words, places) if places.stage_metrics.gutter else _labels_above_body(words, places)


def _labels_beside_body(words: StageLabels, places: PlanarLayout) -> Iterator[Label]:
    """Yields labels for a stage with a gutter: the estimate's left of the body, the truth's right of it."""
    metrics, (x, y) = places.stage_metrics, places.middle
    away = AROUND * places.radius + GAP * metrics.pixel
    widths = (metrics.letters_per_line(metrics.gutter + x - away), metrics.letters_per_line(NAMES * metrics.pixel))
    sides: tuple[tuple[Anchor, Anchor, float], ...] = (("bottom-right", "top-right", x - away),
                                                      ("bottom-left", "top-left", x + away))
    for name, title, by, silence, width, (over, under, at) in zip(HALVES, words.titles, words.by, words.silences,
                                                                  widths, sides, strict=True):
        yield Label(f"{name}-title", title, at, y + 0.1 * metrics.line_height, over, "title", 1.1, tone=name, bold=True)
        yield Label(f"{name}-by", by, at, y - 0.1 * metrics.line_height, under, "note")
        yield Label(f"{name}-silence", short_reason(silence), at, y - 1.9 * metrics.line_height, under, "title",
                    width=width, tone="faint")
    yield Label("size-note", words.note, -metrics.gutter, 3.3 * metrics.line_height, "top-left", "gutter",
                width=metrics.letters_per_line(metrics.gutter), tone="faint")
    yield Label.of_spans("compared", words.compared, -metrics.gutter, 3.6 * metrics.line_height, "bottom-left",
                         "gutter")
    yield from title_labels(words, metrics, places.end + 0.5 * TITLE * metrics.pixel)
    yield _crossing_label(words, places)


def _labels_above_body(words: StageLabels, places: PlanarLayout) -> Iterator[Label]:
    """Yields labels for a stage without a gutter: titles in the corners above the body."""
    metrics = places.stage_metrics
    up = places.end - 2 * metrics.pixel
    corners: tuple[tuple[Anchor, float], ...] = ("top-left", 0.0), ("top-right", 1.0)
    for name, title, (anchor, at) in zip(HALVES, words.titles, corners, strict=True):
        yield Label(f"{name}-title", title, at, up, anchor, "title", tone=name, bold=True)
    by = 1.25 * metrics.text_width(words.titles[0]) + 6 * metrics.pixel
    yield Label("estimate-by", words.by[0], by, up, "top-left", "note")
    yield Label("truth-by", "", 1.0, up, "top-right", "note")
    yield from _empty_half_labels(words, places)
    yield Label("size-note", "", 0.0, up, "bottom-left", "note")
    yield from title_labels(words, metrics, places.end + 0.5 * TITLE * metrics.pixel)
    yield _crossing_label(words, places)


def _paired_run_labels(words: StageLabels, places: PlanarLayout) -> Iterator[Label]:
    """Yields labels for one of two runs: its name above the body, the halves' titles in the corners of its square."""
    metrics, (x, y), reach = places.stage_metrics, places.middle, AROUND * places.radius
    first = places.slot == ComparedRunSlot.FIRST
    corners: tuple[tuple[Anchor, float], ...] = ("top-left", x - reach), ("top-right", x + reach)
    for name, title, (anchor, at) in zip(HALVES, (tr("estimate"), tr("truth")), corners, strict=True):
        yield Label(f"{name}-title", title, at, y + reach, anchor, "title", 0.9, tone=name)
    by, gutter = words.by[0] if first else "", metrics.gutter > 0
    yield Label("estimate-by", by, -metrics.gutter if gutter else 0.6, y if gutter else 0.0,
                "center-left" if gutter else "bottom-center", "gutter" if gutter else "note")
    yield Label("truth-by", "", x, y, "bottom-left", "note")
    yield from _empty_half_labels(words, places)
    up = y + reach + 2 * metrics.pixel
    (run_name,), (facts,) = (fit_spans((spans,), metrics, 2 * reach) for spans in (words.name, words.facts))
    yield Label.of_spans("name", run_name, x - reach, up + metrics.line_height, "bottom-left", "name")
    yield Label.of_spans("facts", facts, x - reach, up, "bottom-left", "note")
    yield Label("size-note", "", x, y, "bottom-left", "note")
    yield _crossing_label(words, places)


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
                     width=max(1, metrics.letters_per_line(metrics.gutter) - 2), tone="crossing", sign="ring")
    return Label("crossings-note", note, 0.0, 0.0, "bottom-left", "note", tone="crossing", sign="ring")
