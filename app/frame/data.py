"""A stage as data for a renderer in another language: what is the same in every frame, ready for JSON."""

from dataclasses import asdict
from typing import Any

from app.frame.stage import Seat, Stage, Words


def as_data(stage: type[Stage]) -> dict[str, Any]:
    """The images of the body, seconds that a crossing is marked, the field plot and all labels by their names.

    A label's text is "" where it comes with a run (:func:`words`); x and y are on the stage (``marks``), where the
    ``anchors`` are known places: lanes, or the middle of the body and how far it reaches.
    """
    plot = stage.PLOT
    return {"mirrors": stage.MIRRORS, "mark_seconds": stage.MARK_SECONDS, "lines": stage.LINES,
            "anchors": stage.ANCHORS,
            "plot": {"start": plot.start, "end": plot.end, "ends": plot.ends, "component": plot.component},
            "labels": {label.name: asdict(label) for label in stage.labels(Words(crossings=stage.MARKED), Seat.ALONE)}}
