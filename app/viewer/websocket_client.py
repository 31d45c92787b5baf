"""The browser's end of the page's websocket, for clients without a browser."""

from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from typing import Any

import msgspec
import websockets.asyncio.client as client
import zstandard

from app.viewer.send_queue import PROTOCOL

LARGEST = 50 * 2**20  # bytes of a message
PATIENCE = 60.0  # timeout of the opening handshake in s


class WebsocketConnection:
    """Open websocket to the page: messages are sent one by one, and received in groups by ``async for``."""

    def __init__(self, socket: client.ClientConnection):
        self._socket = socket

    async def send(self, message: dict[str, Any]) -> None:
        await self._socket.send(pack_message(message))

    async def __aiter__(self) -> AsyncIterator[list[dict[str, Any]]]:
        async for raw in self._socket:
            assert isinstance(raw, bytes)
            yield unpack_messages(raw)


@asynccontextmanager
async def connect_to_page(address: str, headers: Mapping[str, str] | None = None) -> AsyncIterator[WebsocketConnection]:
    """Context manager: an open websocket to the page at ``address`` (host:port), requested with further ``headers``."""
    async with client.connect(f"ws://{address}", max_size=LARGEST, compression=None, open_timeout=PATIENCE,
                              additional_headers=headers, subprotocols=[client.Subprotocol(PROTOCOL)]) as socket:
        yield WebsocketConnection(socket)


def pack_message(message: dict[str, Any]) -> bytes:
    """Encodes a message, a dict with its "type", as a browser does, in MessagePack."""
    return msgspec.msgpack.encode(message)


def unpack_messages(raw: bytes) -> list[dict[str, Any]]:
    """Decodes a group of messages from the server into dicts, without their arrays (see ``pack_messages``)."""
    size, length = (int.from_bytes(raw[k:k + 8], "little") for k in (0, 8))  # unpacked and packed
    words = zstandard.ZstdDecompressor().decompress(raw[16:16 + length], max_output_size=size)
    return msgspec.msgpack.decode(words)["messages"]
