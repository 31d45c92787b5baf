"""The scale that estimate and truth share, at the top of the stage, with its numbers."""

from collections.abc import Iterator

import numpy as np

from app.frame.layout import Top, top
from app.frame.marks import Dots, Label, Room, Sheet, in_plane
from app.frame.scale import MOST_TICKS, ColourScale
from app.language.spoken import tr
from app.words import QUANTITIES

POINTS = 256


class ColourBar:
    """Draws the scale on a sheet of its own, in square points: they alone show a colour as it is."""

    def __init__(self, sheet: Sheet, scale: ColourScale):
        self.sheet, self._scale = sheet, scale
        self._drawn: tuple[Room, float, str, float, bool, bool] | None = None

    def draw(self, quantity: str, high: float) -> None:
        """Show the scale as it is now, with the key of the quantity whose error it measures, on a stage so ``high``."""
        scale, room = self._scale, self.sheet.room
        now = (room, high, quantity, scale.top, scale.logarithmic, scale.exceeded)
        if now == self._drawn:
            return
        if self._drawn is None or now[:2] != self._drawn[:2]:
            place = top(room.settled(), high)
            ends = place.high / 2
            self.sheet.show(Dots("bar", in_plane(np.linspace(ends, 1 - ends, POINTS), place.middle),
                                 scale.gradient(POINTS), place.high, "square"))
        self._drawn = now
        place, unit = top(room.settled(), high), QUANTITIES[quantity].unit
        self.sheet.show(*labels(place, room.gutter > 0, quantity, scale.ticks(unit)))


def labels(place: Top, gutter: bool, quantity: str, ticks: list[tuple[float, str]]) -> Iterator[Label]:
    """What the bar measures, beside it in a ``gutter`` or above it, and its numbers."""
    for name, text, (x, y, anchor) in (("title", tr("Error of"), place.title),
                                       ("quantity", str(QUANTITIES[quantity]), place.quantity)):
        yield Label(name, text, x, y, anchor, "gutter" if gutter else "caption", bold=True)
    for k, (at, text) in enumerate(ticks + [(0.5, "")] * (MOST_TICKS - len(ticks))):
        anchor = "top-left" if at == 0 else "top-right" if at == 1 else "top-center"
        yield Label(f"tick{k}", text, at, place.numbers, anchor, "number")
