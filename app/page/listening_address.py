"""The address on which the server listens: whether it is free, and how browsers reach it."""

import asyncio
import contextlib
import os
import socket

#: Hosts that stand for all addresses, and the address of this machine itself among them.
THIS_MACHINE = {"": "127.0.0.1", "0.0.0.0": "127.0.0.1", "::": "::1"}


class ServeError(Exception):
    """Raised if the page cannot be served; the message is the reason."""


def require_free(host: str, port: int) -> None:
    """Raises :class:`ServeError` if the port is taken; the web server would silently use the next one. It binds as that
    does, to all addresses that a name has."""
    async def bind() -> None:
        (await asyncio.get_running_loop().create_server(asyncio.Protocol, host, port, start_serving=False)).close()

    try:
        asyncio.run(bind())
    except OSError as error:
        code = error.errno or 0  # that of a name without an address is another's, and below 0
        why = os.strerror(code) if code > 0 else error.strerror or str(error)
        raise ServeError(f"cannot listen on {authority(host, port)} ({why.lower()}); "
                         "choose another with --port or --host") from error


def network_address(host: str) -> str:
    """Returns the host or IP address by which other machines reach this one; the loopback one if none is known."""
    if host not in THIS_MACHINE:
        return host
    # Unassigned (RFC 5737 and 3849): nothing is sent, only a route looked up.
    family, elsewhere = (socket.AF_INET6, "2001:db8::1") if host == "::" else (socket.AF_INET, "192.0.2.1")
    with contextlib.suppress(OSError), socket.socket(family, socket.SOCK_DGRAM) as trial:
        trial.connect((elsewhere, 9))
        return str(trial.getsockname()[0])
    return THIS_MACHINE[host]


def authority(host: str, port: int) -> str:
    """Returns host and port as a URL has them: the digits of IPv6 in brackets."""
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"
