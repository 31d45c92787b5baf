"""Allowed host names and origins of requests.

A browser sends the requested name (``Host``) and, for a websocket, the origin of the page (``Origin``). A page of
another site has another origin; with DNS rebinding it requests a foreign host. A browser without ``Origin`` sends the
relation of its page to the lab (``Sec-Fetch-Site``): another site may only link to the lab's page."""

import ipaddress
import re
from dataclasses import dataclass
from typing import NamedTuple, Protocol

_NAME = r"(\[[0-9a-f:.]+\]|[a-z0-9_-]{1,63}(?:\.[a-z0-9_-]{1,63})*\.?)(?::([0-9]{1,5}))?"
_PORTS = {"http": "80", "https": "443"}  # default ports, which browsers leave out

NO_HOST = "The request does not say which host it is for."
FOREIGN_HOST = ("This lab answers on its own machine only, as localhost or 127.0.0.1. "
                "Whoever runs it can allow another name with --name.")
FOREIGN_PAGE = "A page of another site may not use this lab."


class Headers(Protocol):
    """The headers of a request; ``get_all`` returns the values of all with a name, [] for none."""

    def get_all(self, key: str) -> list[str]: ...


class Address(NamedTuple):
    """Host in lower case, a name or an IP address, and its port in digits, None if not given."""

    host: str
    port: str | None

    def matches(self, other: "Address", scheme: str) -> bool:
        """Whether both addresses are equal; a missing port is the default one of ``scheme``, "http" or "https"."""
        return (self.host, self.port or _PORTS[scheme]) == (other.host, other.port or _PORTS[scheme])


def is_host_name(text: str) -> bool:
    """Whether a text is a valid host name or IP address, with or without a port: lab.example:8080."""
    return _parse_address(text) is not None


def is_loopback(host: str) -> bool:
    """Whether a host, a name or an IP address without a port, is only this machine itself: localhost, 127.0.0.1."""
    host = host.strip("[]").rstrip(".").lower()
    local = host == "localhost" or host.endswith(".localhost")
    return local or (is_ip(host) and ipaddress.ip_address(host).is_loopback)


def is_ip(text: str) -> bool:
    """Whether a text is an IP address in digits."""
    try:
        ipaddress.ip_address(text)
    except ValueError:
        return False
    return True


@dataclass(frozen=True)
class Addresses:
    """The ``host`` that the lab listens on, and its public ``names``, as of a proxy, each with or without a port."""

    host: str
    names: tuple[str, ...] = ()

    @property
    def is_local_only(self) -> bool:
        """Whether only users of this machine can connect."""
        return is_loopback(self.host) and not self.names

    def refusal(self, headers: Headers, opens_socket: bool = False) -> str | None:
        """Returns a sentence why a request, for a websocket if ``opens_socket``, else a page, is refused, or None."""
        hosts, origins = headers.get_all("Host"), headers.get_all("Origin")
        host = _parse_address(hosts[0]) if len(hosts) == 1 else None
        if host is None:
            return NO_HOST
        if is_loopback(self.host) and not (is_loopback(host.host) or self._is_public_name(host)):
            return FOREIGN_HOST
        if origins and not (len(origins) == 1 and self._is_same_origin(origins[0], host)):
            return FOREIGN_PAGE
        if not origins and _is_cross_site(headers, opens_socket):
            return FOREIGN_PAGE
        return None

    def _is_same_origin(self, origin: str, host: Address) -> bool:
        scheme, found, rest = origin.lower().partition("://")
        page = _parse_address(rest) if found and scheme in _PORTS else None
        return page is not None and (page.matches(host, scheme) or self._is_public_name(page))

    def _is_public_name(self, address: Address) -> bool:
        """Whether an address has a public name of the lab; a name without a port matches every port."""
        own = map(_parse_address, self.names)
        return any(name and name.host == address.host and name.port in (None, address.port) for name in own)


def has_invalid_host_characters(head: bytes) -> bool:
    """Whether Host or Origin in the raw header lines ``head`` has characters invalid in names, or white space."""
    lines = (line.partition(b":") for line in head.split(b"\r\n"))
    return any(name.lower() in (b"host", b"origin") and re.fullmatch(rb" ?[\x21-\x7e]*", value) is None
               for name, _, value in lines)


def _is_cross_site(headers: Headers, opens_socket: bool) -> bool:
    """Whether a page of another site sends a request, other than by a link, which cannot open a websocket."""
    asked = {value.strip().lower() for value in headers.get_all("Sec-Fetch-Site")}
    if not asked or asked <= {"same-origin", "none"}:
        return False
    led = [headers.get_all(f"Sec-Fetch-{name}") for name in ("Mode", "Dest")]
    return opens_socket or led != [["navigate"], ["document"]]


def _parse_address(text: str) -> Address | None:
    found = re.fullmatch(_NAME, text.lower(), re.ASCII)
    return Address(found[1].rstrip("."), found[2]) if found else None
