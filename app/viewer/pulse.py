"""Whether a browser takes what is sent to it.

What it does not read can wait on its way for minutes, in the buffers of both systems, and nobody is told. But it
answers a ping when it has read all that was sent before.
"""

import asyncio
from contextlib import suppress
from time import monotonic
from typing import Any, cast

from websockets.exceptions import ConnectionClosed

from app.viewer.line import Line
from app.viewer.wire import Buffer

BEAT = 1.0  # seconds between an answer and the next ping


async def feel(line: Line) -> None:
    """Ping a browser now and then until its websocket is closed."""
    with suppress(ConnectionClosed):
        while True:
            line.asked_at = monotonic()
            await (await line.ping())
            line.asked_at = None
            await asyncio.sleep(BEAT)


def stands_still(client: Any) -> float:
    """Seconds for which a visitor's browser has taken nothing of what is sent to it."""
    buffer = cast(Buffer, client._websock_connection.get_message_buffer())
    line = client._viser_server._websock_server._live_connections.get(client.client_id)
    asked_at = line.asked_at if isinstance(line, Line) else None
    return max(buffer.stands_still, 0.0 if asked_at is None else monotonic() - asked_at)
