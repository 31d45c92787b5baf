"""Limits by network, because a stranger may have many addresses: messages, bytes on disk, silent connections."""

import ipaddress
import threading
from collections import Counter
from collections.abc import Callable
from time import monotonic
from typing import Generic, TypeVar

SHARED = {4: 24, 6: 64}  # bits that the addresses of one house or one hoster have in common
REMEMBERED = 1000  # networks
Who = TypeVar("Who")


class TokenBucket:
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


def network_of(who: str) -> str:
    """Returns the network of an IP address; a loopback address, and text that is no address, stay as they are."""
    try:
        address = ipaddress.ip_address(who.partition("%")[0])
    except ValueError:
        return who
    address = getattr(address, "ipv4_mapped", None) or address
    if address.is_loopback:
        return str(address)
    return str(ipaddress.ip_network((address, SHARED[address.version]), strict=False))


class TokenBuckets:
    """A bucket for each network. Of those that have not been met for longest none is kept: it would be full again."""

    def __init__(self, make: Callable[[], TokenBucket], remembered: int = REMEMBERED):
        self._make, self._remembered = make, remembered
        self._of: dict[str, TokenBucket] = {}

    def __len__(self) -> int:
        return len(self._of)

    def of(self, network: str) -> TokenBucket:
        """The bucket of a network, which is the latest now."""
        bucket = self._of.pop(network, None) or self._make()
        self._of[network] = bucket
        while len(self._of) > self._remembered:
            del self._of[next(iter(self._of))]
        return bucket


class DiskQuota:
    """Bytes on disk, limited ``of_one`` network and ``of_all``. Any thread may call."""

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


class PendingConnections(Generic[Who]):
    """Places for so many ``of_one`` network and ``of_all`` that have come and said nothing yet.

    None is refused to a newcomer: one too many takes the place of the one who has been silent for longest, of the same
    network, or, where all places are taken, of that which has most. Who means to come in says so within a moment, and
    is out again.
    """

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
