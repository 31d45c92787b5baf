"""A browser's line from the moment it is there: before it has said what it wants, and before its websocket has spoken.

Nothing is made for a line that says nothing, and it holds no place that another network could want
(:mod:`app.access.network_limits`).
"""

import asyncio
from contextlib import suppress
from time import monotonic
from typing import Any, cast
from weakref import WeakSet

from websockets.asyncio.server import ServerConnection
from websockets.exceptions import ConnectionClosed

from app.access.allowed_hosts import is_ip, is_loopback
from app.access.network_limits import PendingConnections, network_of
from app.viewer.send_queue import SendBuffer

# Lines of one network and of all that have not asked for anything yet: a class may be behind one address, and browsers
# open some lines that they may need. Websockets that have not spoken yet: each is that of a page that is just opened.
LINES, SOCKETS = (64, 256), (64, 256)
HEADS_WITHIN = 5.0  # seconds in which a line has to ask for something
LONGEST_HEAD = 32_000  # bytes of what it asks; browsers send some hundred
GOING = 1.0  # seconds that one who is sent away has to say goodbye
BEAT = 1.0  # seconds between an answer to a ping and the next one


class BrowserConnections:
    """All lines of one server: those that have not asked for anything yet are ``new``, and those whose websocket has
    not spoken ``silent``. A proxy on this machine opens a line when it has the whole of a request: where there is one,
    those lines are of nobody's network yet."""

    def __init__(self, trusts_proxy: bool):
        self.trusts_proxy = trusts_proxy
        self.new, self.silent = (PendingConnections["BrowserConnection"](*LINES),
                                 PendingConnections["BrowserConnection"](*SOCKETS))
        self.there = WeakSet["BrowserConnection"]()

    def come(self, line: "BrowserConnection", remote: object) -> None:
        """A line is there, from this address and port."""
        who = str(remote[0]) if isinstance(remote, tuple) else "somewhere"
        self.there.add(line)
        if gone := self.new.enter(line, str(remote) if self.trusts_proxy and is_loopback(who) else network_of(who)):
            gone.transport.abort()

    def cut(self) -> None:
        """All of them, whatever their other ends do."""
        for line in list(self.there):
            line.transport.abort()


class BrowserConnection(ServerConnection):
    """One browser's. ``head`` is its request as it has come, until that has been answered."""

    def __init__(self, lines: BrowserConnections, *args: Any, **options: Any):
        super().__init__(*args, **options)
        self._lines, self.head = lines, b""
        self.asked_at: float | None = None  # when it was asked for an answer that has not come yet

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        super().connection_made(transport)
        self._lines.come(self, transport.get_extra_info("peername"))

    def data_received(self, data: bytes) -> None:
        if self.request is None:
            self.head += data
            if len(self.head) > LONGEST_HEAD:
                self.transport.abort()
                return
        super().data_received(data)

    def answered(self) -> None:
        """It has asked, and gets an answer: its place is free."""
        self._lines.new.leave(self)
        self.head = b""

    def connection_lost(self, exc: Exception | None) -> None:
        self._lines.new.leave(self)
        super().connection_lost(exc)


def address_of(connection: Any, trusts_proxy: bool) -> str:
    """The IP address of whoever is at the other end, or that for which a proxy on this machine asks."""
    remote = connection.remote_address
    who = str(remote[0]) if isinstance(remote, tuple) else "somewhere"
    told = connection.request.headers.get_all("X-Real-IP") if trusts_proxy and is_loopback(who) else []
    return told[0] if len(told) == 1 and is_ip(told[0]) else who


async def send_away(connection: Any, why: str) -> None:
    """Close a websocket, also one whose other end does not listen."""
    with suppress(asyncio.TimeoutError):
        await asyncio.wait_for(connection.close(1008, why), GOING)
    connection.transport.abort()
    await connection.wait_closed()


async def ping_until_closed(line: BrowserConnection) -> None:
    """Pings a browser until its websocket is closed: it answers when it has read all that was sent before."""
    with suppress(ConnectionClosed):
        while True:
            line.asked_at = monotonic()
            await (await line.ping())
            line.asked_at = None
            await asyncio.sleep(BEAT)


def stands_still(client: Any) -> float:
    """Seconds for which a visitor's browser has taken nothing of what is sent to it."""
    buffer = cast(SendBuffer, client._websock_connection.get_message_buffer())
    line = client._viser_server._websock_server._live_connections.get(client.client_id)
    asked_at = line.asked_at if isinstance(line, BrowserConnection) else None
    return max(buffer.stands_still, 0.0 if asked_at is None else monotonic() - asked_at)
