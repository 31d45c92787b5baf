"""What the page says to a browser is put in by any thread and sent by one.

The viewer 1.1 wakes that one twice for a frame, has it wait again with a timer after each, and tells it by setting an
``asyncio.Event`` from the thread that speaks, which such an event is not made for: now and then the two meet, and what
was being said, a frame perhaps, ends in an exception. Here a frame is one call to it.
"""

import asyncio
import threading
from collections import deque
from collections.abc import AsyncGenerator, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from time import monotonic
from weakref import WeakKeyDictionary

import viser
from viser.infra import Message, _infra
from viser.infra._async_message_buffer import AsyncMessageBuffer

from app.viewer import message_encoding, viser_patches

PROTOCOL = f"viser-v{viser.__version__}"  # by which page and server know that they are of one version


class SendEvent(asyncio.Event):
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

    def ring(self, tower: "SendNotifier") -> None:
        """Once for all who do until it is heard."""
        if not self._rung:
            self._rung = True
            tower.ring(self)

    async def heard(self, seconds: float | None = None) -> None:
        """Until it rings, or for so many seconds."""
        timer = None if seconds is None else asyncio.get_running_loop().call_later(seconds, self.set)
        await self.wait()
        if timer:
            timer.cancel()


class _Here(threading.local):
    """What a thread that has several frames to tell has rung meanwhile."""

    rung: "set[SendNotifier] | None" = None


_here = _Here()


@contextmanager
def batch_messages() -> Iterator[None]:
    """Holds back what this thread says to several browsers, so that the loop is woken once."""
    rung = _here.rung = set()
    try:
        yield
    finally:
        _here.rung = None
        for tower in rung:
            tower.wake()


class SendNotifier:
    """The bells of one loop, which is woken once for all that ring until it hears them."""

    def __init__(self, loop: asyncio.AbstractEventLoop):
        self._soon = loop.call_soon_threadsafe
        self._ringing, self._woken = deque[SendEvent](), False

    def ring(self, bell: SendEvent) -> None:
        """From any thread. In this order nothing is missed: what :meth:`_hear` has not found wakes the loop again."""
        self._ringing.append(bell)
        if _here.rung is None:
            self.wake()
        else:
            _here.rung.add(self)

    def wake(self) -> None:
        """Have the loop hear what rings."""
        if not self._woken:
            self._woken = True
            with suppress(RuntimeError):  # the loop is closed: nobody waits
                self._soon(self._hear)

    def _hear(self) -> None:
        self._woken = False
        while self._ringing:
            self._ringing.popleft().set()


_TOWERS = WeakKeyDictionary[asyncio.AbstractEventLoop, SendNotifier]()


@dataclass
class SendBuffer(AsyncMessageBuffer):
    """A browser's messages on their way, in order; they wait a little for others, but not after a flush."""

    message_event: SendEvent = field(default_factory=SendEvent)
    _flushed: bool = False
    _given: float | None = None  # since when messages are on their way to a browser that has not taken them all yet
    _sent: int = -1  # the number of the last message that has gone, of those that only this browser gets

    def __post_init__(self) -> None:
        self._tower = _TOWERS.get(self.event_loop) or _TOWERS.setdefault(self.event_loop, SendNotifier(self.event_loop))

    @property
    def all_sent(self) -> bool:
        """Whether all that has been put in has gone, or nobody is there any more."""
        return self.done or self._sent >= self.message_counter - 1

    @property
    def stands_still(self) -> float:
        """Seconds for which the browser has taken nothing, though there was something to take."""
        return 0.0 if (given := self._given) is None else monotonic() - given

    def push(self, message: Message) -> None:
        """Adds a message and drops those that it makes redundant; removals go the viewer's own way."""
        if self.done or message.lifecycle_phase == "remove":
            super().push(message)
        else:
            self.push_all((message,))

    def push_all(self, messages: Sequence[Message]) -> None:
        """Put in messages that change something or make it, in this order."""
        if self.done:  # the viewer says so, once
            for message in messages:
                super().push(message)
            return
        with self.buffer_lock:
            for number, message in enumerate(messages, self.message_counter):
                redundant, entity = message.redundancy_key(), message.entity_state_key()
                if (before := self.id_from_redundancy_key.get(redundant)) is not None:
                    self.pop_message_locked(before)
                self.message_from_id[number] = message
                self.id_from_redundancy_key[redundant] = number
                if entity is not None:
                    self.ids_from_entity_state_key.setdefault(entity, set()).add(number)
            self.message_counter += len(messages)
        self._ring()

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
            self.message_event.ring(self._tower)

    def _taken(self, last: int, newest: int, client_id: int) -> tuple[list[Message], int]:
        """Returns messages after number ``last`` up to ``newest``, not too many, and the last number looked at."""
        window: list[Message] = []
        if not self.persistent_messages and newest - last <= self.max_window_size:
            with self.buffer_lock:
                if newest == self.message_counter - 1:  # all that there is, as with a frame
                    window = [message for message in self.message_from_id.values()
                              if message.excluded_self_client != client_id]
                    for held in (self.message_from_id, self.id_from_redundancy_key, self.ids_from_entity_state_key):
                        held.clear()
                    return window, newest
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


def patch_viser() -> None:
    """Lets new servers use this buffer, :mod:`app.viewer.message_encoding` and :mod:`app.viewer.viser_patches`."""
    viser_patches.mend_widgets()
    _infra.AsyncMessageBuffer = SendBuffer  # type: ignore[assignment, misc]
    _infra._message_producer = message_encoding.send
