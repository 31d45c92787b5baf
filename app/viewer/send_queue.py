"""The outgoing queue of a websocket: any thread adds messages, one event loop sends them.

Viewer 1.1 wakes the loop twice per frame, adds a timer, and sets an ``asyncio.Event`` from another thread, which is not
thread-safe: occasionally a message is lost in an exception. Here a frame needs one call to the loop."""

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

from app.viewer import message_batch_encoding, viser_patches

PROTOCOL = f"viser-v{viser.__version__}"  # ensures that page and server have the same version


class SendEvent(asyncio.Event):
    """Event that wakes those who wait now, not later ones. Any thread may call :meth:`notify`; :meth:`set` works on the
    event loop, and does nothing in other threads, from which the viewer calls it too."""

    def __init__(self) -> None:
        super().__init__()
        self._is_pending = False  # set and not handled yet

    def set(self) -> None:
        with suppress(RuntimeError):  # no loop runs in this thread
            asyncio.get_running_loop()
            self._is_pending = False
            super().set()
            self.clear()

    def notify(self, notifier: "EventLoopNotifier") -> None:
        """Schedules one wake-up on the loop of ``notifier`` for all calls until it is handled."""
        if not self._is_pending:
            self._is_pending = True
            notifier.notify(self)

    async def wait_for(self, seconds: float | None = None) -> None:
        """Waits for the event, at most so many seconds (None: for ever)."""
        timer = None if seconds is None else asyncio.get_running_loop().call_later(seconds, self.set)
        await self.wait()
        if timer:
            timer.cancel()


class _ThreadNotifiers(threading.local):
    """Thread-local set of notifiers to wake at the end of a batch."""

    notifiers: "set[EventLoopNotifier] | None" = None


_batch = _ThreadNotifiers()


@contextmanager
def batch_messages() -> Iterator[None]:
    """Context manager: delays this thread's messages to all browsers to its end, so that each loop is woken once."""
    notifiers = _batch.notifiers = set()
    try:
        yield
    finally:
        _batch.notifiers = None
        for notifier in notifiers:
            notifier.wake()


class EventLoopNotifier:
    """The pending events of one loop, which is woken once for all of them."""

    def __init__(self, loop: asyncio.AbstractEventLoop):
        self._soon = loop.call_soon_threadsafe
        self._events, self._is_awake = deque[SendEvent](), False

    def notify(self, event: SendEvent) -> None:
        """Adds an event to be set on the loop; any thread may call this."""
        self._events.append(event)  # first: an event that ``_set_pending_events`` misses wakes the loop again
        if _batch.notifiers is None:
            self.wake()
        else:
            _batch.notifiers.add(self)

    def wake(self) -> None:
        """Wakes the loop to set the pending events, once until that is done."""
        if not self._is_awake:
            self._is_awake = True
            with suppress(RuntimeError):  # the loop is closed: nobody waits
                self._soon(self._set_pending_events)

    def _set_pending_events(self) -> None:
        self._is_awake = False
        while self._events:
            self._events.popleft().set()


_NOTIFIERS = WeakKeyDictionary[asyncio.AbstractEventLoop, EventLoopNotifier]()


@dataclass
class SendBuffer(AsyncMessageBuffer):
    """Outgoing messages of one browser, in order; they wait briefly to be sent together, but not after a flush."""

    message_event: SendEvent = field(default_factory=SendEvent)
    _flushed: bool = False
    _given: float | None = None  # since when messages have been sent that the browser has not received yet
    _sent: int = -1  # the number of the last message sent to this browser alone

    def __post_init__(self) -> None:
        loop = self.event_loop
        self._notifier = _NOTIFIERS.get(loop) or _NOTIFIERS.setdefault(loop, EventLoopNotifier(loop))

    @property
    def all_sent(self) -> bool:
        """Whether all messages have been sent, or the browser has disconnected."""
        return self.done or self._sent >= self.message_counter - 1

    @property
    def stalled_seconds(self) -> float:
        """Seconds for which the browser has received nothing of what was sent."""
        return 0.0 if (given := self._given) is None else monotonic() - given

    def push(self, message: Message) -> None:
        """Adds a message, and drops a waiting one that the message makes redundant."""
        if self.done or message.lifecycle_phase == "remove":
            super().push(message)
        else:
            self.push_all((message,))

    def push_all(self, messages: Sequence[Message]) -> None:
        """Adds messages that create or change something, in this order, and drops those made redundant."""
        if self.done:  # the viewer warns, once
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
        self._notify()

    def atomic_end(self) -> None:
        with self.buffer_lock:
            self.atomic_counter -= 1
        self._notify()

    def flush(self) -> None:
        self._flushed = True
        self._notify()

    async def _window_loop(self, client_id: int, backlog_last_id: int,
                           backlog_done_message: Message | None) -> AsyncGenerator[Sequence[Message], None]:
        """Yields messages to send together, and the last argument once, after number ``backlog_last_id``."""
        marker, last = backlog_done_message, -1
        self.generator_cursors[client_id] = last
        try:
            while not self.done:
                newest = last if self.atomic_counter else self.message_counter - 1
                window, last = self._next_window(last, newest if marker is None else min(newest, backlog_last_id),
                                                 client_id)
                self.generator_cursors[client_id] = last
                if marker is not None and last >= backlog_last_id and not self.atomic_counter:
                    window, marker = [*window, marker], None
                if window:
                    self._given = monotonic()
                    yield window  # resumes when it is sent
                    self._given = None
                self._sent = last
                if self.message_counter - 1 == last or self.atomic_counter:
                    await self._wait_for_more(last)
        finally:
            self.generator_cursors.pop(client_id, None)

    def _notify(self) -> None:
        if not self.atomic_counter:  # otherwise at the end of the block
            self.message_event.notify(self._notifier)

    def _next_window(self, last: int, newest: int, client_id: int) -> tuple[list[Message], int]:
        """Returns messages for a client after number ``last`` to ``newest``, and the last number seen."""
        window: list[Message] = []
        if not self.persistent_messages and newest - last <= self.max_window_size:
            with self.buffer_lock:
                if newest == self.message_counter - 1:  # all messages, as with a frame
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

    async def _wait_for_more(self, last: int) -> None:
        """Waits for messages after number ``last``, and then until a flush or the end of the window's duration."""
        while not self.done and (self.message_counter - 1 == last or self.atomic_counter):
            await self.message_event.wait_for()
        loop = asyncio.get_running_loop()
        end = loop.time() + self.window_duration_sec
        while not (self.done or self._flushed) and (left := end - loop.time()) > 0:
            await self.message_event.wait_for(left)
        self._flushed = False


def patch_viser() -> None:
    """Makes new servers of this process use :class:`SendBuffer` and other faster parts of ``app.viewer``."""
    viser_patches.speed_up_widgets()
    _infra.AsyncMessageBuffer = SendBuffer  # type: ignore[assignment, misc]
    _infra._message_producer = message_batch_encoding.send_messages
