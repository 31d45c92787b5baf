"""A stage as data for a renderer in another language: what is the same in every frame, ready for JSON."""

from dataclasses import asdict
from typing import Any

from app.frame import field
from app.frame.stage import Seat, Stage, Words


def as_data(stage: type[Stage]) -> dict[str, Any]:
    """The rectangle of all that is drawn, images of the body, seconds that a crossing is marked, the field plot and all
    labels but the scale's.

    A label's text is "" where it comes with a run or a frame; x and y are on the stage (``marks``), where the
    ``anchors`` are known places: lanes, or the middle of the body and how far it reaches.
    """
    plot, words = asdict(stage.PLOT), Words(crossings=stage.MARKED)
    labels = [*stage.labels(words, Seat.ALONE), *field.labels(stage.PLOT, 0.0, "", "", "")]
    return {"rectangle": stage.RECTANGLE, "mirrors": stage.MIRRORS, "outlined": stage.OUTLINED,
            "mark_seconds": stage.MARK_SECONDS, "lines": stage.LINES, "anchors": stage.ANCHORS,
            "plot": {name: plot[name] for name in ("middle", "height", "start", "end")},
            "labels": [asdict(label) for label in labels]}
