"""The axis of a plot whose values come and go: it ends at round numbers, holds all that is there and moves calmly."""

from app.frame.scale import round_up

STEPS = (1, 1.5, 2, 3, 4, 5, 6, 8)  # times a power of ten: what an axis may end at
ROOM = 1.1  # an axis goes on so far beyond its last number, and values with it
FADE = 0.985  # per frame: how slowly the axis follows when values shrink
SLACK = 0.4  # of its height that values must fall below before it does
SMALLEST = 1e-300


class Axis:
    """From -``top`` to ``top``; what is within ``ROOM`` times that is on it."""

    def __init__(self) -> None:
        self._peak, self.top = 0.0, 1.0

    def forget(self) -> None:
        """Begin anew with the next frame."""
        self._peak = 0.0

    def follow(self, largest: float, least: float) -> None:
        """Take in the ``largest`` size of a frame's values; never show less than up to ``least``."""
        begun, need = self._peak > 0, max(largest, least)
        self._peak = max(need, FADE * self._peak)
        if self._peak > SMALLEST and (not begun or need > ROOM * self.top or self._peak < SLACK * self.top):
            self.top, _ = round_up(self._peak / ROOM, STEPS)
