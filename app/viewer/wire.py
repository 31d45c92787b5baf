"""What the page says to a browser is put in by any thread and sent by one.

The viewer 1.1 wakes that one twice for a frame, has it wait again with a timer after each, and tells it by setting an
``asyncio.Event`` from the thread that speaks, which such an event is not made for: now and then the two meet, and what
was being said, a frame perhaps, ends in an exception. Here a frame is one call to it.
"""

import asyncio
from collections.abc import AsyncGenerator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from time import monotonic

import viser
from viser.infra import Message, _infra
from viser.infra._async_message_buffer import AsyncMessageBuffer

PROTOCOL = f"viser-v{viser.__version__}"  # by which page and server know that they are of one version


class Bell(asyncio.Event):
    """Wakes those who wait on a loop, and nobody who comes later. Any thread may :meth:`ring`; the viewer sets it, too,
    from the thread that has spoken, which does nothing, and then from the loop."""

    def __init__(self) -> None:
        super().__init__()
        self._rung = False  # and not heard yet

    def set(self) -> None:
        with suppress(RuntimeError):  # no loop runs in this thread
            asyncio.get_running_loop()
            self._rung = False
            super().set()
            self.clear()

    def ring(self, loop: asyncio.AbstractEventLoop) -> None:
        """Once for all who do until it is heard."""
        if not self._rung:
            self._rung = True
            with suppress(RuntimeError):  # the loop is closed: nobody waits
                loop.call_soon_threadsafe(self.set)

    async def heard(self, seconds: float | None = None) -> None:
        """Until it rings, or for so many seconds."""
        timer = None if seconds is None else asyncio.get_running_loop().call_later(seconds, self.set)
        await self.wait()
        if timer:
            timer.cancel()


@dataclass
class Buffer(AsyncMessageBuffer):
    """A browser's messages on their way: in the order in which they were put in, those of an atomic block together.
    They wait a little for others to go with, but for a flush, at which all that are there go."""

    message_event: Bell = field(default_factory=Bell)
    _flushed: bool = False
    _given: float | None = None  # since when messages are on their way to a browser that has not taken them all yet
    _sent: int = -1  # the number of the last message that has gone, of those that only this browser gets

    @property
    def all_sent(self) -> bool:
        """Whether all that has been put in has gone, or nobody is there any more."""
        return self.done or self._sent >= self.message_counter - 1

    @property
    def stands_still(self) -> float:
        """Seconds for which the browser has taken nothing, though there was something to take."""
        return 0.0 if (given := self._given) is None else monotonic() - given

    def atomic_end(self) -> None:
        with self.buffer_lock:
            self.atomic_counter -= 1
        self._ring()

    def flush(self) -> None:
        self._flushed = True
        self._ring()

    async def _window_loop(self, client_id: int, backlog_last_id: int,
                           backlog_done_message: Message | None) -> AsyncGenerator[Sequence[Message], None]:
        """What goes to a browser together, again and again. ``backlog_done_message`` comes once, after what was there
        before the browser: up to the message with the number ``backlog_last_id``."""
        marker, last = backlog_done_message, -1
        self.generator_cursors[client_id] = last
        try:
            while not self.done:
                newest = self.message_counter - 1
                if self.atomic_counter:
                    newest = last
                window, last = self._taken(last, newest if marker is None else min(newest, backlog_last_id), client_id)
                self.generator_cursors[client_id] = last
                if marker is not None and last >= backlog_last_id and not self.atomic_counter:
                    window, marker = [*window, marker], None
                if window:
                    self._given = monotonic()
                    yield window  # and it goes on when that has gone
                    self._given = None
                self._sent = last
                if self.message_counter - 1 == last or self.atomic_counter:
                    await self._more(last)
        finally:
            self.generator_cursors.pop(client_id, None)

    def _ring(self) -> None:
        if not self.atomic_counter:  # else the end of the block does
            self.message_event.ring(self.event_loop)

    def _taken(self, last: int, newest: int, client_id: int) -> tuple[list[Message], int]:
        """Messages for a browser after number ``last`` and up to ``newest``, not too many, and the number of the last
        that was looked at. What only this browser gets is taken out."""
        window: list[Message] = []
        while last < newest and len(window) < self.max_window_size:
            last += 1
            if self.persistent_messages:
                message = self.message_from_id.get(last)
            else:
                with self.buffer_lock:
                    message = self.pop_message_locked(last)
            if message is not None and message.excluded_self_client != client_id:
                window.append(message)
        return window, last

    async def _more(self, last: int) -> None:
        """Until there are messages after number ``last``, and then until they are flushed or have waited enough."""
        while not self.done and (self.message_counter - 1 == last or self.atomic_counter):
            await self.message_event.heard()
        loop = asyncio.get_running_loop()
        end = loop.time() + self.window_duration_sec
        while not (self.done or self._flushed) and (left := end - loop.time()) > 0:
            await self.message_event.heard(left)
        self._flushed = False


def mend() -> None:
    """Have servers that start from now on use the buffer above."""
    _infra.AsyncMessageBuffer = Buffer  # type: ignore[assignment, misc]
