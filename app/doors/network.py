"""Networks: what is counted of strangers, each of whom may have many addresses."""

import ipaddress
from collections.abc import Callable

from app.doors.bucket import Bucket

SHARED = {4: 24, 6: 64}  # bits that the addresses of one house or one hoster have in common
REMEMBERED = 1000  # networks


def network_of(who: str) -> str:
    """The network of an IP address: what of it its owner cannot change at will. This machine's own addresses are one
    each, and what is no address stays as it is."""
    try:
        address = ipaddress.ip_address(who.partition("%")[0])
    except ValueError:
        return who
    address = getattr(address, "ipv4_mapped", None) or address
    if address.is_loopback:
        return str(address)
    return str(ipaddress.ip_network((address, SHARED[address.version]), strict=False))


class Buckets:
    """A bucket for each network. Of those that have not been met for longest none is kept: it would be full again."""

    def __init__(self, make: Callable[[], Bucket], remembered: int = REMEMBERED):
        self._make, self._remembered = make, remembered
        self._of: dict[str, Bucket] = {}

    def __len__(self) -> int:
        return len(self._of)

    def of(self, network: str) -> Bucket:
        """The bucket of a network, which is the latest now."""
        bucket = self._of.pop(network, None) or self._make()
        self._of[network] = bucket
        while len(self._of) > self._remembered:
            del self._of[next(iter(self._of))]
        return bucket
