"""The anteroom: those who have come and not yet said who they are or what they want.

Whoever has opened a connection and says nothing holds a place. So places are counted by network, and none is refused to
a newcomer: one too many takes the place of the one who has been silent for longest, of the same network, or, where all
places are taken, of that which has most. Who means to come in says so within a moment, and is out again.
"""

from typing import Generic, TypeVar

Who = TypeVar("Who")


class Anteroom(Generic[Who]):
    """Places for so many ``of_one`` network and ``of_all``."""

    def __init__(self, of_one: int, of_all: int):
        self._of_one, self._of_all = of_one, of_all
        self._network: dict[Who, str] = {}
        self._waiting: dict[str, dict[Who, None]] = {}  # by network, in the order in which they came

    def __len__(self) -> int:
        return len(self._network)

    def enter(self, who: Who, network: str) -> Who | None:
        """Take a place. Who has to go for that, if anybody has; it has left already."""
        gone = None
        if len(self._waiting.get(network, ())) >= self._of_one:
            gone = next(iter(self._waiting[network]))
        elif len(self._network) >= self._of_all:
            largest = max(self._waiting, key=lambda other: len(self._waiting[other]))
            gone = next(iter(self._waiting[largest]))
        if gone is not None:
            self.leave(gone)
        self._network[who] = network
        self._waiting.setdefault(network, {})[who] = None
        return gone

    def leave(self, who: Who) -> None:
        """Give the place back; a second time does nothing."""
        network = self._network.pop(who, None)
        if network is not None:
            del self._waiting[network][who]
            if not self._waiting[network]:
                del self._waiting[network]
