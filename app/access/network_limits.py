"""Limits per network, as one client may have many addresses: messages, bytes on disk, silent connections."""

import ipaddress
import threading
from collections import Counter
from collections.abc import Callable
from time import monotonic
from typing import Generic, TypeVar

SHARED = {4: 24, 6: 64}  # bits common to the addresses of one household or hoster
REMEMBERED = 1000  # networks
Connection = TypeVar("Connection")


class TokenBucket:
    """Token bucket of at most ``most`` tokens, full at first, refilled by ``a_second`` each second of ``clock``."""

    def __init__(self, most: float, a_second: float, clock: Callable[[], float] = monotonic):
        self.most, self._a_second, self._clock = most, a_second, clock
        self._left, self._at = most, clock()

    @property
    def tokens(self) -> float:
        """Tokens left; below zero they are owed."""
        now = self._clock()
        self._left = min(self.most, self._left + (now - self._at) * self._a_second)
        self._at = now
        return self._left

    def debit(self, tokens: float = 1.0) -> None:
        """Takes so many tokens out, even if fewer are left."""
        self._left = self.tokens - tokens

    def delay(self, tokens: float = 1.0) -> float:
        """Returns the seconds until so many tokens are there, 0 if they are; takes none."""
        return max(0.0, (tokens - self.tokens) / self._a_second)


def network_of(address: str) -> str:
    """Returns the network of an IP address, "10.0.0.0/24"; of a loopback address, or text that is none, itself."""
    try:
        number = ipaddress.ip_address(address.partition("%")[0])
    except ValueError:
        return address
    number = getattr(number, "ipv4_mapped", None) or number
    if number.is_loopback:
        return str(number)
    return str(ipaddress.ip_network((number, SHARED[number.version]), strict=False))


class TokenBuckets:
    """Token buckets from ``make``, one per network; of more than ``remembered`` the longest unused are dropped."""

    def __init__(self, make: Callable[[], TokenBucket], remembered: int = REMEMBERED):
        self._make, self._remembered = make, remembered
        self._buckets: dict[str, TokenBucket] = {}

    def __len__(self) -> int:
        return len(self._buckets)

    def get(self, network: str) -> TokenBucket:
        """Returns the bucket of a network (:func:`network_of`), new if there is none, and marks it as the last used."""
        bucket = self._buckets.pop(network, None) or self._make()
        self._buckets[network] = bucket
        while len(self._buckets) > self._remembered:
            del self._buckets[next(iter(self._buckets))]
        return bucket


class DiskQuota:
    """Thread-safe quota of bytes on disk: at most ``of_one`` for a network, and ``of_all`` together."""

    def __init__(self, of_one: int, of_all: int):
        self._of_one, self._of_all = of_one, of_all
        self._lock, self._used = threading.Lock(), Counter[str]()

    @property
    def used(self) -> int:
        """Bytes in use, of all networks."""
        with self._lock:
            return self._used.total()

    def reserve(self, address: str, count: int) -> bool:
        """Reserves so many bytes for an IP address; returns False if its network's quota, or all, would be exceeded."""
        network = network_of(address)
        with self._lock:
            if self._used[network] + count > self._of_one or self._used.total() + count > self._of_all:
                return False
            self._used[network] += count
            return True

    def release(self, address: str, count: int) -> None:
        """Releases so many reserved bytes of an IP address."""
        with self._lock:
            self._used -= Counter({network_of(address): count})  # drops a network without any


class PendingConnections(Generic[Connection]):
    """Connections that have sent nothing yet, at most ``of_one`` of a network and ``of_all`` together.

    A newcomer is never refused: beyond the limit it replaces the one that has been silent for longest, of the same
    network or, if ``of_all`` is reached, of that with most. Legitimate clients soon send something."""

    def __init__(self, of_one: int, of_all: int):
        self._of_one, self._of_all = of_one, of_all
        self._network: dict[Connection, str] = {}
        self._waiting: dict[str, dict[Connection, None]] = {}  # by network, in order of arrival

    def __len__(self) -> int:
        return len(self._network)

    def add(self, connection: Connection, network: str) -> Connection | None:
        """Adds a connection; returns the one that has to be closed in its place, already removed here, or None."""
        gone = None
        if len(self._waiting.get(network, ())) >= self._of_one:
            gone = next(iter(self._waiting[network]))
        elif len(self._network) >= self._of_all:
            largest = max(self._waiting, key=lambda other: len(self._waiting[other]))
            gone = next(iter(self._waiting[largest]))
        if gone is not None:
            self.discard(gone)
        self._network[connection] = network
        self._waiting.setdefault(network, {})[connection] = None
        return gone

    def discard(self, connection: Connection) -> None:
        """Removes a connection that has sent something or is closed; a second call does nothing."""
        network = self._network.pop(connection, None)
        if network is not None:
            del self._waiting[network][connection]
            if not self._waiting[network]:
                del self._waiting[network]
