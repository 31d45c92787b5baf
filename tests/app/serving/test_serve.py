"""What must not end the service: early leavers, pages, sessions and engines that fail. No web server."""

import operator
import os
import threading
from time import monotonic
from types import SimpleNamespace

import numpy as np
import pytest

from app.page.page_server import OVER, Visitors, _engine_count
from solvers.engine import engine_process
from solvers.engine.engine_pool import EnginePool
from solvers.engine.engine_process import CANNOT_START
from tests.support.processes import wait_until
from tests.support.session_listener import PATIENCE, SCENE, Listener


class Link:
    """A session's line that knows whether it was closed."""

    closed = False

    def close(self):
        self.closed = True


class Pool:
    """Opens lines and keeps them."""

    def __init__(self):
        self.links = []

    def open_session(self, listener, beside=None):
        self.links.append(Link())
        return self.links[-1]


class Page:
    """Opens one session, as the real one."""

    def __init__(self, client, pool):
        self.link = pool.open(None)

    def close(self):
        self.link.close()


class House:
    """Visitors with two places, and what they were shown."""

    def __init__(self, make_page=Page):
        self.pool, self.shown = Pool(), []
        self.visitors = Visitors(self.pool, 2, make_page, lambda client, text: self.shown.append(text))

    def come(self, number):
        self.visitors.connect(SimpleNamespace(client_id=number))

    def leave(self, number):
        self.visitors.disconnect(SimpleNamespace(client_id=number))

    @property
    def open_links(self):
        return sum(not link.closed for link in self.pool.links)

    @property
    def empty(self):
        visitors = self.visitors
        return not (visitors._pages or visitors._pageless or visitors._left)


def test_places_are_taken_and_freed():
    """The third of two is refused in words; who leaves makes room; nothing is remembered of those gone."""
    house = House()
    for number in (1, 2, 3):
        house.come(number)
    assert house.open_links == 2 and "place on this server is taken" in house.shown[0]
    house.leave(3)
    house.leave(1)
    assert house.open_links == 1
    house.come(4)
    assert house.open_links == 2 and len(house.shown) == 1
    house.leave(2)
    house.leave(4)
    assert house.open_links == 0 and house.empty


def test_many_at_once_get_no_more_than_the_places():
    """The count and the taking of a place are one: pages slow to make do not let others in."""
    release = threading.Event()

    house = House(lambda client, pool: release.wait(5) and Page(client, pool))
    threads = [threading.Thread(target=house.come, args=(number,)) for number in range(8)]
    for thread in threads:
        thread.start()
    release.set()
    for thread in threads:
        thread.join()
    assert len(house.pool.links) == 2 and len(house.shown) == 6


@pytest.mark.parametrize("first", ["leave", "stay"])
def test_goodbye_while_the_page_is_made_closes_it(first):
    """Also where its visitor has left by then; and nobody is let in afterwards, but told."""
    def ending(client, pool):
        if first == "leave":
            house.leave(client.client_id)
        house.visitors.close_all_pages()
        assert not house.visitors.has_no_pending_page()
        return Page(client, pool)

    house = House(ending)
    house.come(1)
    assert house.visitors.has_no_pending_page()
    house.come(2)
    assert len(house.pool.links) == 1 and house.open_links == 0 and not house.visitors._pages
    assert house.shown == [OVER] * (2 if first == "stay" else 1)


def test_leaving_before_being_let_in_makes_no_page():
    """The web server's threads may call in either order."""
    house = House()
    house.leave(1)
    house.come(1)
    assert not house.pool.links and not house.shown and house.empty


def test_leaving_while_the_page_is_made_closes_it():
    house = House(lambda client, pool: house.leave(client.client_id) or Page(client, pool))
    house.come(1)
    assert len(house.pool.links) == 1 and house.open_links == 0 and house.empty


@pytest.mark.parametrize("leaves", [False, True])
def test_page_that_fails_leaves_nothing_behind(leaves, caplog):
    """Its session is closed, its place is free, the reason is logged, and a visitor still here is told."""
    def failing(client, pool):
        Page(client, pool)
        if leaves:
            house.leave(client.client_id)
        raise ValueError("no such panel")

    house = House(failing)
    for number in (1, 2, 3):
        house.come(number)
    assert len(house.pool.links) == 3 and house.open_links == 0
    assert "no such panel" in caplog.text
    assert len(house.shown) == (0 if leaves else 3) and all("could not be made" in text for text in house.shown)
    if not leaves:
        for number in (1, 2, 3):
            house.leave(number)
    assert house.empty


@pytest.mark.parametrize("processors, engines", [(1, 1), (2, 1), (4, 3), (64, 4)])
def test_engines_follow_the_processors_that_may_be_used(monkeypatch, processors, engines):
    monkeypatch.setattr(os, "cpu_count", lambda: 128)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(processors)), raising=False)
    assert _engine_count() == engines


@pytest.fixture
def starts(monkeypatch):
    """Engines that end at once; the times at which they were started."""
    times, start = [], engine_process.EngineProcess._start
    monkeypatch.setattr(engine_process, "run_engine_process",
                        operator.is_)  # any function that takes two arguments and returns
    monkeypatch.setattr(engine_process.EngineProcess, "_start", lambda self: (times.append(monotonic()), start(self)))
    return times


def test_engine_that_cannot_start_is_given_up(starts, monkeypatch):
    """Pauses double up to the longest; after six failures every session hears why, and again when it asks."""
    monkeypatch.setattr(engine_process, "FIRST_PAUSE", 0.1)
    monkeypatch.setattr(engine_process, "LONGEST_PAUSE", 0.4)
    asked, restart = threading.Event(), engine_process.EngineProcess._restart
    monkeypatch.setattr(engine_process.EngineProcess, "_restart", lambda self: asked.wait(PATIENCE) and restart(self))
    pool, listener = EnginePool(SCENE), Listener()
    try:
        link = pool.open_session(listener)
        link.ask(SCENE)
        asked.set()  # no engine was lost before somebody was there to hear of it
        listener.wait(lambda: listener.troubles)
        assert listener.troubles == [CANNOT_START]
        link.ask(SCENE)
        assert listener.troubles == [CANNOT_START] * 2
        assert len(starts) == 6 and listener.losses == 5
        assert all(gap >= pause for gap, pause in zip(np.diff(starts), (0.1, 0.2, 0.4, 0.4, 0.4), strict=True))
        link.close()
    finally:
        pool.close()


def test_no_engine_is_started_after_closing(starts, monkeypatch):
    """Closing in the pause before a restart ends the pause and the restarts."""
    for pause in ("FIRST_PAUSE", "LONGEST_PAUSE"):
        monkeypatch.setattr(engine_process, pause, 600.0)  # nothing but closing ends it
    before = set(threading.enumerate())
    pool = EnginePool(SCENE)
    threads = set(threading.enumerate()) - before
    wait_until(lambda: pool._engines[0]._failures == 1, "its reader has noticed")
    pool.close()
    for thread in threads:
        thread.join(PATIENCE)
        assert not thread.is_alive()
    assert len(starts) == 1
