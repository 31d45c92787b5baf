"""Under which names the lab may be asked for, and from pages of which sites.

A browser tells a server which name it asked for (``Host``) and, for a websocket, whose page asks (``Origin``). A page
of another site has another origin; one that has its own name lead to this machine (DNS rebinding) asks for a foreign
host. A browser that says no ``Origin`` says how its pages stand to the lab (``Sec-Fetch-Site``): those of another site
may lead to the lab's page, and no more.
"""

import ipaddress
import re
from dataclasses import dataclass
from typing import NamedTuple, Protocol

_NAME = r"(\[[0-9a-f:.]+\]|[a-z0-9_-]+(?:\.[a-z0-9_-]+)*\.?)(?::([0-9]{1,5}))?"
_PORTS = {"http": "80", "https": "443"}  # that a browser leaves out

NO_HOST = "The request does not say which host it is for."
FOREIGN_HOST = ("This lab answers on its own machine only, as localhost or 127.0.0.1. "
                "Whoever runs it can allow another name with --name.")
FOREIGN_PAGE = "A page of another site may not use this lab."


class Headers(Protocol):
    """Of a request."""

    def get_all(self, key: str) -> list[str]: ...


class Address(NamedTuple):
    """A host, and the port as far as it is given."""

    host: str
    port: str | None

    def meets(self, other: "Address", scheme: str) -> bool:
        """Whether both are the same place, with the port that goes without saying."""
        return (self.host, self.port or _PORTS[scheme]) == (other.host, other.port or _PORTS[scheme])


def is_name(text: str) -> bool:
    """Whether this can be the name of a host, with a port or without."""
    return _address(text) is not None


def is_loopback(host: str) -> bool:
    """Whether only this machine itself can mean this host."""
    host = host.strip("[]").rstrip(".").lower()
    local = host == "localhost" or host.endswith(".localhost")
    return local or (is_ip(host) and ipaddress.ip_address(host).is_loopback)


def is_ip(text: str) -> bool:
    """Whether this is an IP address in digits."""
    try:
        ipaddress.ip_address(text)
    except ValueError:
        return False
    return True


@dataclass(frozen=True)
class Addresses:
    """The ``host`` that the lab listens on, and the public ``names`` it has beside: those of a proxy before it."""

    host: str
    names: tuple[str, ...] = ()

    @property
    def private(self) -> bool:
        """Whether nobody but this machine's own users is meant to come in."""
        return is_loopback(self.host) and not self.names

    def refusal(self, headers: Headers, opens_socket: bool = False) -> str | None:
        """Why a request with these headers, for a websocket or a page, is refused; None where it is not."""
        hosts, origins = headers.get_all("Host"), headers.get_all("Origin")
        host = _address(hosts[0]) if len(hosts) == 1 else None
        if host is None:
            return NO_HOST
        if is_loopback(self.host) and not (is_loopback(host.host) or self._is_own(host)):
            return FOREIGN_HOST
        if origins and not (len(origins) == 1 and self._same(origins[0], host)):
            return FOREIGN_PAGE
        if not origins and _asked_by_another(headers, opens_socket):
            return FOREIGN_PAGE
        return None

    def _same(self, origin: str, host: Address) -> bool:
        scheme, found, rest = origin.lower().partition("://")
        page = _address(rest) if found and scheme in _PORTS else None
        return page is not None and (page.meets(host, scheme) or self._is_own(page))

    def _is_own(self, address: Address) -> bool:
        """Whether it has a public name of the lab; one given without a port holds for every port."""
        own = map(_address, self.names)
        return any(name and name.host == address.host and name.port in (None, address.port) for name in own)


def has_stray_whitespace(head: bytes) -> bool:
    """Whether a host or an origin has white space or letters that no name has, which no browser sends."""
    lines = (line.partition(b":") for line in head.split(b"\r\n"))
    return any(name.lower() in (b"host", b"origin") and re.fullmatch(rb" ?[\x21-\x7e]*", value) is None
               for name, _, value in lines)


def _asked_by_another(headers: Headers, opens_socket: bool) -> bool:
    """Whether a browser says that a page of another site asks, and not just that one leads here."""
    asked = {value.strip().lower() for value in headers.get_all("Sec-Fetch-Site")}
    if not asked or asked <= {"same-origin", "none"}:
        return False
    led = [headers.get_all(f"Sec-Fetch-{name}") for name in ("Mode", "Dest")]
    return opens_socket or led != [["navigate"], ["document"]]


def _address(text: str) -> Address | None:
    found = re.fullmatch(_NAME, text.lower(), re.ASCII)
    return Address(found[1].rstrip("."), found[2]) if found else None
