"""What the page says to a browser is put in by any thread and sent by one. The viewer 1.1 tells that one so by setting
an ``asyncio.Event`` from the thread that speaks, which such an event is not made for: now and then the two meet, and
what was being said, a frame perhaps, ends in an exception."""

import asyncio
from contextlib import suppress
from dataclasses import dataclass, field

import viser
from viser.infra import _infra
from viser.infra._async_message_buffer import AsyncMessageBuffer

PROTOCOL = f"viser-v{viser.__version__}"  # by which page and server know that they are of one version


class LoopsEvent(asyncio.Event):
    """An event that only its loop sets. The viewer asks the loop to, too, whenever another thread has spoken."""

    def set(self) -> None:
        with suppress(RuntimeError):  # no loop runs in this thread
            asyncio.get_running_loop()
            super().set()


@dataclass
class Buffer(AsyncMessageBuffer):
    """A browser's messages on their way."""

    message_event: asyncio.Event = field(default_factory=LoopsEvent)


def mend() -> None:
    """Have servers that start from now on use the buffer above."""
    _infra.AsyncMessageBuffer = Buffer  # type: ignore[misc]
