"""Room on the disk for what visitors send: each network has a part, so that none takes that of the others."""

import threading
from collections import Counter

from app.doors.network import network_of


class Room:
    """Bytes, so many ``of_one`` network and ``of_all``. Any thread may call."""

    def __init__(self, of_one: int, of_all: int):
        self._of_one, self._of_all = of_one, of_all
        self._lock, self._taken = threading.Lock(), Counter[str]()

    @property
    def taken(self) -> int:
        """Bytes that are taken, of all."""
        with self._lock:
            return self._taken.total()

    def take(self, who: str, count: int) -> bool:
        """Take so many bytes for an IP address, if there are so many."""
        network = network_of(who)
        with self._lock:
            if self._taken[network] + count > self._of_one or self._taken.total() + count > self._of_all:
                return False
            self._taken[network] += count
            return True

    def give_back(self, who: str, count: int) -> None:
        """The same bytes of the same address."""
        network = network_of(who)
        with self._lock:
            self._taken[network] -= count
            if not self._taken[network]:
                del self._taken[network]
