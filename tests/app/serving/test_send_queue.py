"""The wire: what many threads say to a browser leaves in order and together, once, by its loop. No web server."""

import asyncio
import threading
from time import sleep

import msgspec
import numpy as np
import pytest
import zstandard
from viser._messages import GuiUpdateMessage, ReplayDoneMessage, SceneNodeUpdateMessage, SetCameraFovMessage
from viser.infra import _infra

from app.viewer.message_batch_encoding import SHORT, ChangedArrays, send_messages
from app.viewer.send_queue import SendBuffer, batch_messages
from tests.support.processes import wait_until
from tests.support.session_listener import PATIENCE


@pytest.fixture
def loop():
    """A loop that runs in a thread of its own."""
    loop = asyncio.new_event_loop()
    thread = threading.Thread(target=loop.run_forever)
    thread.start()
    yield loop
    loop.call_soon_threadsafe(loop.stop)
    thread.join()
    loop.close()


def listen(loop, buffer, marker=None):
    """What leaves a buffer: a list of windows, and the end of it."""
    windows = []

    async def take():
        async for window in buffer.window_generator(1, marker):
            windows.append(window)

    return windows, asyncio.run_coroutine_threadsafe(take(), loop)


def moved(name, step):
    return SceneNodeUpdateMessage(name, {"step": step})


def test_what_wakes_the_sender_is_touched_by_its_loop_only(loop):
    """Another thread that sets the viewer's event while the loop waits for it would meet the loop in its midst."""
    started, buffer = threading.Event(), SendBuffer(loop, persistent_messages=False)
    woken = asyncio.run_coroutine_threadsafe(buffer.message_event.wait(), loop)
    loop.call_soon_threadsafe(started.set)
    assert started.wait(PATIENCE)
    buffer.message_event.set()
    assert not buffer.message_event.is_set() and not woken.done()
    buffer.push(SetCameraFovMessage(1.0))
    assert woken.result(PATIENCE)


def test_a_frame_leaves_whole_and_at_once(loop):
    """However slowly it is put together, it is one window, and does not wait for others once it is flushed."""
    buffer = SendBuffer(loop, persistent_messages=False, window_duration_sec=PATIENCE)
    windows, end = listen(loop, buffer)
    for step in range(20):
        buffer.atomic_start()
        for name in "abc":
            buffer.push(moved(name, step))
            sleep(0.001)
        buffer.flush()
        buffer.atomic_end()
        wait_until(lambda: len(windows) > step, "a frame", pause=0.001)  # noqa: B023
        assert [(message.name, message.updates["step"]) for message in windows[step]] == \
            [(name, step) for name in "abc"]
    buffer.set_done()
    end.result(PATIENCE)
    assert len(windows) == 20 and not buffer.generator_cursors


def test_frames_of_many_that_come_together_wake_the_sender_once(loop, monkeypatch):
    """They leave when all have been told; what another thread says meanwhile leaves at once."""
    woken, soon = [], loop.call_soon_threadsafe
    monkeypatch.setattr(loop, "call_soon_threadsafe", lambda *args: woken.append(args) or soon(*args))
    buffers = [SendBuffer(loop, persistent_messages=False, window_duration_sec=PATIENCE) for _ in range(4)]
    heard = [listen(loop, buffer) for buffer in buffers]
    wait_until(lambda: all(buffer.generator_cursors for buffer in buffers), "those who listen")

    def tell(buffer, step):
        buffer.atomic_start()
        buffer.push_all([moved(name, step) for name in "abc"])
        buffer.flush()
        buffer.atomic_end()

    woken.clear()
    with batch_messages():
        for buffer in buffers[:3]:
            tell(buffer, 1)
        assert not woken
        thread = threading.Thread(target=tell, args=(buffers[3], 1))
        thread.start()
        thread.join()
        assert len(woken) == 1
    wait_until(lambda: all(windows for windows, _ in heard), "a frame for each")
    assert len(woken) <= 2
    assert all([message.name for message in windows[0]] == ["a", "b", "c"] for windows, _ in heard)
    for buffer, (_, end) in zip(buffers, heard, strict=True):
        buffer.set_done()
        end.result(PATIENCE)


@pytest.mark.parametrize("words", ["few", "many" * SHORT])
def test_messages_are_packed_as_the_viewer_packs_them(words, monkeypatch):
    """To the last byte of what a browser makes of them; only that what is short is not compressed."""
    points, colours = np.arange(15, dtype=np.float32).reshape(5, 3), np.arange(7, dtype=np.uint8)
    said = {"points": points.astype(np.float16), "colors": colours}
    usual, ours = ([kind("/bar/lanes", said, "3"), kind("/ring", {"points": points[::2]}, "3"),
                    GuiUpdateMessage("text", {"content": words})] for kind in (SceneNodeUpdateMessage, ChangedArrays))
    assert [message.redundancy_key() for message in ours] == [message.redundancy_key() for message in usual]
    assert [message.entity_state_key() for message in ours] == [message.entity_state_key() for message in usual]
    sent = []

    class Socket:
        async def send(self, packed):
            sent.append(packed)

    async def tell(producer, messages):
        buffer = SendBuffer(asyncio.get_running_loop(), persistent_messages=False)
        buffer.push_all(messages)
        sending = asyncio.create_task(producer(Socket(), buffer, 1, None))
        while not sent:
            await asyncio.sleep(0.001)
        buffer.set_done()
        await sending
        return sent.pop()

    read = []
    for producer, messages in ((_infra._message_producer, usual), (send_messages, ours)):
        packed = asyncio.run(tell(producer, messages))
        size, length = (int.from_bytes(packed[k:k + 8], "little") for k in (0, 8))
        inside = msgspec.msgpack.decode(zstandard.ZstdDecompressor().decompress(packed[16:16 + length]))
        assert inside.pop("timestampSec") > 0 and (size > SHORT) == (words != "few")
        read.append((inside, size - 16 - length, packed[16 + length:].lstrip(bytes(1))))
    (theirs, _, their_arrays), (same, _, arrays) = read
    assert same == theirs and arrays == their_arrays


def test_a_newcomer_hears_what_was_said_before_and_where_that_ends(loop):
    buffer = SendBuffer(loop, persistent_messages=True)
    for number in range(200):
        buffer.push(moved(f"a{number}", 0))
    windows, end = listen(loop, buffer, ReplayDoneMessage())
    wait_until(lambda: sum(map(len, windows)) >= 201, "all that was said before")
    buffer.push(moved("later", 0))
    wait_until(lambda: sum(map(len, windows)) >= 202, "what is said later")
    buffer.set_done()
    end.result(PATIENCE)
    messages = [message for window in windows for message in window]
    assert len(messages) == 202 and isinstance(messages[200], ReplayDoneMessage) and messages[201].name == "later"


@pytest.mark.parametrize("most", [1, 100], ids=["one by one", "all at once"])
def test_who_is_left_out_of_a_message_does_not_get_it(loop, most):
    """A browser that has moved a slider itself is not told where it is."""
    buffer = SendBuffer(loop, persistent_messages=False)
    buffer.max_window_size = most
    for number in range(4):
        message = moved(f"a{number}", 0)
        message.excluded_self_client = 1 if number % 2 else 2
        buffer.push(message)
    windows, end = listen(loop, buffer)
    wait_until(lambda: buffer.all_sent, "all that was said")
    buffer.set_done()
    end.result(PATIENCE)
    assert [message.name for window in windows for message in window] == ["a0", "a2"]


def test_all_is_sent_when_the_last_window_has_gone(loop):
    """Not when it has been taken out: a browser that takes nothing holds it up."""
    buffer, go = SendBuffer(loop, persistent_messages=False), asyncio.Event()

    async def send():
        async for _ in buffer.window_generator(1, None):
            await go.wait()

    sending = asyncio.run_coroutine_threadsafe(send(), loop)
    assert buffer.all_sent
    buffer.push(moved("/bar", 1))
    buffer.flush()
    wait_until(lambda: buffer.generator_cursors.get(1) == 0, "the message taken")
    assert not buffer.all_sent
    wait_until(lambda: buffer.stalled_seconds > 0.05, "it is seen that nothing is taken")
    loop.call_soon_threadsafe(go.set)
    wait_until(lambda: buffer.all_sent, "the message gone")
    assert buffer.stalled_seconds == 0
    buffer.set_done()
    sending.result(PATIENCE)
