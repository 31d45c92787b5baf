"""Bucket: so many at once, and so many a second in the long run."""

from collections.abc import Callable
from time import monotonic


class Bucket:
    """Tokens, ``most`` at first and at most, that come back ``a_second``."""

    def __init__(self, most: float, a_second: float, clock: Callable[[], float] = monotonic):
        self.most, self._a_second, self._clock = most, a_second, clock
        self._left, self._at = most, clock()

    @property
    def left(self) -> float:
        """Tokens that are there; below zero they are owed."""
        now = self._clock()
        self._left = min(self.most, self._left + (now - self._at) * self._a_second)
        self._at = now
        return self._left

    def pay(self, tokens: float = 1.0) -> None:
        """Take so many, there or not."""
        self._left = self.left - tokens

    def wait(self, tokens: float = 1.0) -> float:
        """Seconds until there are so many, without taking them."""
        return max(0.0, (tokens - self.left) / self._a_second)
