"""The scale that estimate and truth share, at the top of the stage, with its numbers."""

import numpy as np

from app.frame.marks import Dots, Label, Sheet, in_plane
from app.frame.scale import MOST_TICKS, ColourScale
from app.words import power_text

MIDDLE, HEIGHT = 1.015, 0.024
TICK_GAP = 0.024  # labels have a white ground, which must stay clear of the colours


class ColourBar:
    """Draws the scale on a sheet of its own, in square points: they alone show a colour as it is."""

    def __init__(self, sheet: Sheet, scale: ColourScale):
        self.sheet, self._scale = sheet, scale
        self._drawn: tuple[str, str, float, bool, bool] | None = None
        ends = HEIGHT / 2
        sheet.show(Dots("bar", in_plane(np.linspace(ends, 1 - ends, 256), MIDDLE), scale.gradient(256), HEIGHT,
                        "square"))

    def draw(self, measures: str, unit: str) -> None:
        """Show the scale as it is now, with what it measures."""
        scale = self._scale
        if (now := (measures, unit, scale.top, scale.logarithmic, scale.exceeded)) == self._drawn:
            return
        self._drawn = now
        ticks = scale.ticks() + [(0.0, "")] * MOST_TICKS
        self.sheet.show(
            Label("title", f"{measures} / {power_text(scale.power)}{unit}", 0.0, MIDDLE + TICK_GAP, "bottom-left",
                  "caption"),
            *(Label(f"tick{k}", text, at, MIDDLE - TICK_GAP, "top-center", "number", 0.85)
              for k, (at, text) in enumerate(ticks[:MOST_TICKS])))
