"""Encoding of the messages that go to a browser together, as one websocket message in the viewer's format.

It avoids two costs of the viewer's own encoder: checking every value against its annotation, and compressing short
text, which took longer than the rest of a frame and saved some hundred of twenty thousand bytes."""

from collections.abc import Sequence
from contextlib import aclosing
from functools import lru_cache
from time import perf_counter
from typing import Any

import msgspec
import zstandard
from viser._messages import SceneNodeUpdateMessage
from viser.infra import Message
from viser.infra._async_message_buffer import AsyncMessageBuffer

SHORT = 4096  # bytes of text and numbers; a usual frame has less than a thousand
ALIGNED = 8  # arrays begin at multiples of so many bytes
#: Uncompressed Zstandard frame (RFC 8878): the header before the four bytes of its size, and
#: the flag of the last block, in three bytes.
STORED, LAST_BLOCK = b"\x28\xb5\x2f\xfd\xa0", 1


class ChangedArrays(SceneNodeUpdateMessage, include_in_scene_serialization=True):
    """Message that replaces arrays of a scene node, ``updates`` by property. They must not be modified afterwards."""

    def redundancy_key(self) -> str:
        return _redundancy_key(self.name, tuple(self.updates))

    def entity_state_key(self) -> tuple[str, str]:
        return "scene", self.name

    def as_serializable_dict(self, binary_buffers: list[memoryview] | None = None) -> dict[str, Any]:
        if binary_buffers is None:
            return super().as_serializable_dict()
        updates = {}
        for name, values in self.updates.items():
            updates[name] = {"__binary_index": len(binary_buffers), "dtype": values.dtype.str}
            binary_buffers.append(values.data if values.flags.c_contiguous else values.copy().data)
        return {"name": self.name, "updates": updates, "owner": self.owner, "type": SceneNodeUpdateMessage.__name__}


@lru_cache(4096)
def _redundancy_key(name: str, props: tuple[str, ...]) -> str:
    """Returns the viewer's key of an update of a node's properties; of updates with equal keys only the last counts."""
    return SceneNodeUpdateMessage(name, dict.fromkeys(props)).redundancy_key()


def pack_messages(window: Sequence[Message], compressor: zstandard.ZstdCompressor) -> bytes:
    """Returns messages as one websocket message: the length of text and numbers in bytes, unpacked and packed (8 bytes
    each), these as a Zstandard frame of MessagePack, then the arrays, each padded."""
    arrays: list[memoryview] = []
    messages = [message.as_serializable_dict(arrays) for message in window]
    words = msgspec.msgpack.encode({"messages": messages, "timestampSec": perf_counter(),
                                    "binaryBufferLengths": [array.nbytes for array in arrays]})
    held = stored_frame(words) if len(words) <= SHORT else compressor.compress(words)
    parts: list[bytes | memoryview] = [len(words).to_bytes(8, "little"), len(held).to_bytes(8, "little"), held]
    length = 16 + len(held)
    for array in arrays:
        parts += bytes(-length % ALIGNED), array
        length += -length % ALIGNED + array.nbytes
    return b"".join(parts)


def stored_frame(words: bytes) -> bytes:
    """Returns bytes, at most 128 kB, as an uncompressed Zstandard frame."""
    return b"".join((STORED, len(words).to_bytes(4, "little"), (LAST_BLOCK | len(words) << 3).to_bytes(3, "little"),
                     words))


async def send_messages(websocket: Any, buffer: AsyncMessageBuffer, client_id: int,
                        backlog_done_message: Message | None = None) -> None:
    """Sends a buffer's messages to a client until it is closed; the last argument after those waiting at first."""
    compressor = zstandard.ZstdCompressor(level=1)
    async with aclosing(buffer.window_generator(client_id, backlog_done_message)) as windows:
        async for window in windows:
            await websocket.send(pack_messages(window, compressor))
