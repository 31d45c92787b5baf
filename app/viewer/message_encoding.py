"""What goes to a browser together, as the bytes of one message of its websocket.

In the viewer's own format, and with less work than the viewer makes it: what moves on the stage is ready to go as it
is, where the viewer looks at each value of each message by its annotation; and what is short is not compressed, which
took longer than all else of a frame and saved it some hundred bytes of twenty thousand.
"""

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

SHORT = 4096  # bytes of words and numbers, of which those of a frame that says nothing new are less than a thousand
ALIGNED = 8  # bytes at multiples of which arrays begin
#: A frame of Zstandard (RFC 8878) that holds its bytes as they are: what comes before their number, in four bytes, and
#: the three bytes of a block that is the last.
STORED, LAST_BLOCK = b"\x28\xb5\x2f\xfd\xa0", 1


class ChangedArrays(SceneNodeUpdateMessage, include_in_scene_serialization=True):
    """Arrays of a thing on the stage are others now. Whoever says so writes to them no more."""

    def redundancy_key(self) -> str:
        return _key(self.name, tuple(self.updates))

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
def _key(name: str, props: tuple[str, ...]) -> str:
    """What the viewer calls an update of these properties, of which only the last counts."""
    return SceneNodeUpdateMessage(name, dict.fromkeys(props)).redundancy_key()


def pack_messages(window: Sequence[Message], compressor: zstandard.ZstdCompressor) -> bytes:
    """Messages as a browser gets them: two lengths, words and numbers, and arrays after them."""
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
    """A frame of Zstandard that holds bytes, 128 kB at most, as they are."""
    return b"".join((STORED, len(words).to_bytes(4, "little"), (LAST_BLOCK | len(words) << 3).to_bytes(3, "little"),
                     words))


async def send(websocket: Any, buffer: AsyncMessageBuffer, client_id: int,
               backlog_done_message: Message | None = None) -> None:
    """Send what a buffer has for a browser, until that is over."""
    compressor = zstandard.ZstdCompressor(level=1)
    async with aclosing(buffer.window_generator(client_id, backlog_done_message)) as windows:
        async for window in windows:
            await websocket.send(pack_messages(window, compressor))
