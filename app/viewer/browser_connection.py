"""A browser's connection from its start: before its request, and before the first message of its websocket.

A silent connection has nothing allocated, and no place that others need (:mod:`app.access.network_limits`)."""

import asyncio
import re
from contextlib import suppress
from http import HTTPStatus
from time import monotonic
from typing import Any, cast
from weakref import WeakSet

from websockets.asyncio.server import ServerConnection
from websockets.exceptions import ConnectionClosed

from app.access.allowed_hosts import is_ip, is_loopback
from app.access.network_limits import PendingConnections, network_of
from app.viewer.index_page import make_response, with_security_headers
from app.viewer.send_queue import SendBuffer

# Connections of one network and of all without a request yet: a class may be behind one address, and browsers
# open some in advance. Websockets without a message yet: each belongs to a page that is just being opened.
LINES, SOCKETS = (64, 256), (64, 256)
HEADS_WITHIN = 5.0  # timeout of a connection without a request, in s
LONGEST_HEAD = 32_000  # bytes of a request; browsers send some hundred
GOING = 1.0  # timeout of the closing handshake in s
BEAT = 1.0  # seconds between an answer to a ping and the next one
OTHER_METHOD = re.compile(rb"(?!GET )[A-Z]+ /[^\r\n]* HTTP/1\.1\r\n")  # of a request
DEAF = 60.0  # seconds without an answer after which a websocket is closed


def _method_refusal() -> bytes:
    """Returns the response to a request by another method than GET, which no page makes, but monitors do (HEAD)."""
    response = with_security_headers(None, None, make_response(HTTPStatus.METHOD_NOT_ALLOWED, ""))
    response.headers["Allow"] = "GET"
    return response.serialize()


_ONLY_GET = _method_refusal()


class BrowserConnections:
    """All connections of one server: ``new`` ones have sent no request, those of ``silent`` websockets no message.
    ``trusts_proxy``: behind a proxy on this machine, a connection's network is unknown until it sends a request."""

    def __init__(self, trusts_proxy: bool):
        self.trusts_proxy = trusts_proxy
        self.new, self.silent = (PendingConnections["BrowserConnection"](*LINES),
                                 PendingConnections["BrowserConnection"](*SOCKETS))
        self.open_ones = WeakSet["BrowserConnection"]()

    def register(self, connection: "BrowserConnection", remote: object) -> None:
        """Adds a new connection from (address, port); aborts another of a network with too many."""
        who = str(remote[0]) if isinstance(remote, tuple) else "somewhere"
        network = str(remote) if self.trusts_proxy and is_loopback(who) else network_of(who)
        self.open_ones.add(connection)
        if gone := self.new.add(connection, network):
            gone.transport.abort()

    def abort_all(self) -> None:
        """Aborts all connections without a handshake."""
        for line in list(self.open_ones):
            line.transport.abort()


class BrowserConnection(ServerConnection):
    """Connection of one browser. ``head`` holds the bytes of its request until that is answered."""

    def __init__(self, lines: BrowserConnections, *args: Any, **options: Any):
        super().__init__(*args, **options)
        self._lines, self.head = lines, b""
        self.asked_at: float | None = None  # when the unanswered ping was sent

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        super().connection_made(transport)
        self._lines.register(self, transport.get_extra_info("peername"))

    def data_received(self, data: bytes) -> None:
        if self.request is None:
            self.head += data
            if len(self.head) > LONGEST_HEAD:
                self.transport.abort()
                return
            if OTHER_METHOD.match(self.head):
                self.transport.write(_ONLY_GET)
                self.transport.close()
                return
        super().data_received(data)

    def on_answered(self) -> None:
        """Releases the connection's place among the new ones, and ``head``: its request is answered."""
        self._lines.new.discard(self)
        self.head = b""

    def connection_lost(self, exc: Exception | None) -> None:
        self._lines.new.discard(self)
        super().connection_lost(exc)

    async def ping_until_closed(self) -> None:
        """Pings the browser until the websocket closes; it answers after reading all sent before. One that has not
        answered for ``DEAF`` seconds is closed: its place may be needed."""
        async def hear() -> None:
            await (await self.ping())

        with suppress(ConnectionClosed):
            while True:
                self.asked_at = monotonic()
                try:
                    await asyncio.wait_for(hear(), DEAF)
                except asyncio.TimeoutError:
                    return self.transport.abort()
                self.asked_at = None
                await asyncio.sleep(BEAT)


def address_of(connection: Any, trusts_proxy: bool) -> str:
    """Returns the IP address of a websocket's browser, or that named by a trusted proxy on this machine."""
    remote = connection.remote_address
    who = str(remote[0]) if isinstance(remote, tuple) else "somewhere"
    told = connection.request.headers.get_all("X-Real-IP") if trusts_proxy and is_loopback(who) else []
    return told[0] if len(told) == 1 and is_ip(told[0]) else who


async def close_websocket(connection: Any, why: str) -> None:
    """Closes a websocket with the reason ``why`` (code 1008), also one whose other end does not respond."""
    with suppress(asyncio.TimeoutError):
        await asyncio.wait_for(connection.close(1008, why), GOING)
    connection.transport.abort()
    await connection.wait_closed()


def stalled_seconds(client: Any) -> float:
    """Returns the seconds for which the browser of a viewer's ``client`` has received nothing that was sent to it."""
    buffer = cast(SendBuffer, client._websock_connection.get_message_buffer())
    line = client._viser_server._websock_server._live_connections.get(client.client_id)
    asked_at = line.asked_at if isinstance(line, BrowserConnection) else None
    return max(buffer.stalled_seconds, 0.0 if asked_at is None else monotonic() - asked_at)
