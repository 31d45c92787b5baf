"""The wire: what many threads say to a browser leaves in order and together, once, by its loop. No web server."""

from __future__ import annotations

import asyncio
import threading
from time import monotonic, sleep

import pytest
from viser._messages import ReplayDoneMessage, SceneNodeUpdateMessage, SetCameraFovMessage

from app.viewer.wire import Buffer
from tests.listening import PATIENCE
from tests.processes import until


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
    """What leaves a buffer: a list of windows, each with the time at which it came, and the end of it."""
    windows = []

    async def take():
        async for window in buffer.window_generator(1, marker):
            windows.append((monotonic(), window))

    return windows, asyncio.run_coroutine_threadsafe(take(), loop)


def moved(name, step):
    return SceneNodeUpdateMessage(name, {"step": step})


def test_what_wakes_the_sender_is_touched_by_its_loop_only(loop):
    """Another thread that sets the viewer's event while the loop waits for it would meet the loop in its midst."""
    started, buffer = threading.Event(), Buffer(loop, persistent_messages=False)
    woken = asyncio.run_coroutine_threadsafe(buffer.message_event.wait(), loop)
    loop.call_soon_threadsafe(started.set)
    assert started.wait(PATIENCE)
    buffer.message_event.set()
    assert not buffer.message_event.is_set() and not woken.done()
    buffer.push(SetCameraFovMessage(1.0))
    assert woken.result(PATIENCE)


def test_a_frame_leaves_whole_and_at_once(loop):
    """However slowly it is put together, it is one window, and does not wait for others once it is flushed."""
    buffer = Buffer(loop, persistent_messages=False, window_duration_sec=PATIENCE)
    windows, end = listen(loop, buffer)
    for step in range(20):
        buffer.atomic_start()
        for name in "abc":
            buffer.push(moved(name, step))
            sleep(0.001)
        buffer.flush()
        buffer.atomic_end()
        until = monotonic() + PATIENCE
        while len(windows) <= step and monotonic() < until:
            sleep(0.001)
        assert [(message.name, message.updates["step"]) for message in windows[step][1]] == \
            [(name, step) for name in "abc"]
    buffer.set_done()
    end.result(PATIENCE)
    assert len(windows) == 20 and not buffer.generator_cursors


def test_other_words_wait_for_company_and_only_the_last_counts(loop):
    """What is said again before it has left leaves once; too much for one window leaves in several, in order."""
    buffer = Buffer(loop, persistent_messages=False, window_duration_sec=0.2)
    windows, end = listen(loop, buffer)
    until(lambda: buffer.generator_cursors, "somebody who listens")
    sleep(0.05)  # what is there when it begins to listen leaves at once
    said = monotonic()
    for step in range(50):
        buffer.push(moved("a", step))
    for number in range(buffer.max_window_size):
        buffer.push(moved(f"b{number}", 0))
    sleep(0.6)
    buffer.set_done()
    end.result(PATIENCE)
    messages = [message for _, window in windows for message in window]
    assert windows[0][0] - said >= 0.2 and len(messages) == 1 + buffer.max_window_size
    assert [message.name for message in messages] == ["a", *(f"b{k}" for k in range(buffer.max_window_size))]
    assert messages[0].updates == {"step": 49}


def test_a_newcomer_hears_what_was_said_before_and_where_that_ends(loop):
    buffer = Buffer(loop, persistent_messages=True)
    for number in range(200):
        buffer.push(moved(f"a{number}", 0))
    windows, end = listen(loop, buffer, ReplayDoneMessage())
    until = monotonic() + PATIENCE
    while sum(len(window) for _, window in windows) < 201 and monotonic() < until:
        sleep(0.001)
    buffer.push(moved("later", 0))
    sleep(0.2)
    buffer.set_done()
    end.result(PATIENCE)
    messages = [message for _, window in windows for message in window]
    assert len(messages) == 202 and isinstance(messages[200], ReplayDoneMessage) and messages[201].name == "later"


def test_all_is_sent_when_the_last_window_has_gone(loop):
    """Not when it has been taken out: a browser that takes nothing holds it up."""
    buffer, go = Buffer(loop, persistent_messages=False), asyncio.Event()

    async def send():
        async for _ in buffer.window_generator(1, None):
            await go.wait()

    sending = asyncio.run_coroutine_threadsafe(send(), loop)
    assert buffer.all_sent
    buffer.push(moved("/bar", 1))
    buffer.flush()
    until(lambda: buffer.generator_cursors.get(1) == 0, "the message taken")
    assert not buffer.all_sent
    until(lambda: buffer.stands_still > 0.05, "it is seen that nothing is taken")
    loop.call_soon_threadsafe(go.set)
    until(lambda: buffer.all_sent, "the message gone")
    assert buffer.stands_still == 0
    buffer.set_done()
    sending.result(PATIENCE)
