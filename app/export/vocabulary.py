"""What the player shares with the live page, as data: forms of numbers, scales, colours, names of what is looked at."""

import base64
from collections.abc import Iterable
from dataclasses import asdict
from typing import Any

from app import words
from app.colours import PINNED, TRUTH, colour_table
from app.export import quantise
from app.frame import colour_bar, field, marks, scale, sentence, silences
from app.frame.captions import DIFFERENCE, SIDE_BY_SIDE, counting
from app.frame.stage import Seat, Stage, Words
from app.problems.views import VIEWS
from solvers.scene.registry import ESTIMATORS


def vocabulary(problems: Iterable[str]) -> dict[str, Any]:
    """All of it as a JSON object, with the stages of some problems."""
    return {"formats": formats(), "codes": quantise.CODES,
            "scale": {"tops": list(scale.TOPS.items()), "decades": scale.DECADES, "beyond": scale.BEYOND,
                      "memory": scale.MEMORY, "smallest": scale.SMALLEST,
                      "bar": {"middle": colour_bar.MIDDLE, "height": colour_bar.HEIGHT, "gap": colour_bar.TICK_GAP}},
            "axis": {"steps": field.STEPS, "room": field.ROOM},
            "colours": _colours(), "flash_seconds": marks.FLASH_SECONDS,
            "quantities": {key: vars(quantity) for key, quantity in words.QUANTITIES.items()},
            "compare": (SIDE_BY_SIDE, DIFFERENCE), "unknown": counting("{caption}", "{unknown}"),
            "sentences": {"unstable": sentence.UNSTABLE, "last": sentence.LAST, "lost": sentence.LOST,
                          "now": sentence.NOW, "paused": sentence.PAUSED, "less": sentence.LESS,
                          "more": sentence.MORE, "all": sentence.ALL_OF_IT, "not_counted": silences.NOT_COUNTED},
            "magnifications": words.MAGNIFICATIONS,
            "estimators": {name: {"colour": one.colour, "dashes": one.dashes} for name, one in ESTIMATORS.items()},
            "problems": {name: stage_data(VIEWS[name].stage) for name in sorted(problems)}}


def stage_data(stage: type[Stage]) -> dict[str, Any]:
    """What of a stage is the same in every frame: the rectangle of all that is drawn, images of the body, seconds that
    a crossing is marked, the field plot and all labels but the scale's.

    A label's text is "" where it comes with a run or a frame; x and y are on the stage (``marks``), where the
    ``anchors`` are known places: lanes, or the middle of the body and how far it reaches.
    """
    plot, said = asdict(stage.PLOT), Words(crossings=stage.MARKED)
    labels = [*stage.labels(said, Seat.ALONE), *field.labels(stage.PLOT, 0.0, "", "", "")]
    return {"rectangle": stage.RECTANGLE, "mirrors": stage.MIRRORS, "outlined": stage.OUTLINED,
            "mark_seconds": stage.MARK_SECONDS, "lines": stage.LINES, "anchors": stage.ANCHORS,
            "plot": {name: plot[name] for name in ("middle", "height", "start", "end")},
            "labels": [asdict(label) for label in labels]}


def formats() -> dict[str, Any]:
    """What the player's ``words.js`` needs for the forms of numbers."""
    return {"prefixes": words.PREFIXES, "superscripts": words.SUPERSCRIPTS, "ratios": words.PLAIN_RATIOS,
            "percents": (*words.PLAIN_PERCENT, words.WHOLE_PERCENT), "powers": words.PLAIN_POWERS,
            "nothing": words.NOTHING}


def _colours() -> dict[str, Any]:
    """The map as bytes, and the colours that have a meaning."""
    greys = {"dot": marks.DOT, "faint": marks.FAINT, "cell": marks.CELL, "unknown": (marks.UNKNOWN,) * 3}
    return {"map": base64.b64encode(colour_table().tobytes()).decode(), "truth": TRUTH, "pinned": PINNED,
            "flash": marks.FLASH, **{name: f"rgb{grey}" for name, grey in greys.items()}}
