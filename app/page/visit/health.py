"""How the server does, for whoever watches it."""

import threading
from time import monotonic


class Tally:
    """Counts what happens, from any thread, and knows how often it happened in the last whole second."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._second, self._count, self._last = int(monotonic()), 0, 0

    def add(self) -> None:
        with self._lock:
            self._turn()
            self._count += 1

    @property
    def a_second(self) -> int:
        with self._lock:
            self._turn()
            return self._last

    def _turn(self) -> None:
        """Begin a new second, if it is time."""
        now = int(monotonic())
        if now != self._second:
            self._last = self._count if now == self._second + 1 else 0
            self._second, self._count = now, 0
