"""Strangers who say nothing, or come again and again: they take no place that others want."""

import asyncio
import socket
from contextlib import ExitStack, closing, suppress
from time import monotonic
from types import SimpleNamespace

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus

from app.access.network_limits import PendingConnections, TokenBucket, TokenBuckets, network_of
from app.viewer import browser_connection, upload, web_server
from tests.app.page.features.test_upload import Sender
from tests.support.page_server import start_server
from tests.support.processes import measure_starvation, wait_until
from tests.support.raw_client import RawClient

STRANGER, OTHER = ("127.0.0.66", 0), ("127.0.0.77", 0)  # each is a network of its own on this machine
WITHIN = 3.0  # seconds in which others come in


@pytest.mark.parametrize(("address", "network"), [
    ("10.1.2.3", "10.1.2.0/24"), ("10.1.2.250", "10.1.2.0/24"), ("10.1.3.3", "10.1.3.0/24"),
    ("2001:db8:0:1::5", "2001:db8:0:1::/64"), ("2001:db8:0:1:ffff::", "2001:db8:0:1::/64"),
    ("fe80::1%eth0", "fe80::/64"), ("::ffff:10.1.2.3", "10.1.2.0/24"), ("127.0.0.9", "127.0.0.9"),
    ("::1", "::1"), ("somewhere", "somewhere"), ("", "")])
def test_networks(address, network):
    assert network_of(address) == network


def test_a_bucket_for_each_network_and_only_for_the_latest():
    buckets = TokenBuckets(lambda: TokenBucket(1, 0.1), remembered=3)
    for network in "abc":
        buckets.get(network).debit()
    assert buckets.get("a").delay() > 9 and buckets.get("d").delay() == 0 and len(buckets) == 3
    assert buckets.get("a").delay() > 9 and buckets.get("b").delay() == 0  # b had not been met for longest


def test_whoever_has_waited_longest_makes_room_in_his_own_network():
    room = PendingConnections[str](of_one=2, of_all=5)
    assert [room.add(who, who[0]) for who in ("a1", "a2", "b1", "a3")] == [None, None, None, "a1"]
    room.discard("a2")
    room.discard("a2")
    assert [room.add(who, who[0]) for who in ("a4", "c1", "b2")] == [None, None, None] and len(room) == 5
    assert room.add("d1", "d") == "a3"  # all places are taken: one of a network that has most
    assert room.add("b3", "b") == "b1" and len(room) == 5


@pytest.fixture(scope="module")
def address():
    with start_server() as (_, address), RawClient(address) as first:
        first.find("Download CSV")  # the first page takes a moment more
        yield address


def comes_in(address):
    """Seconds that it takes a newcomer from elsewhere to have all of the page's controls, others' work not counted."""
    begun = monotonic()
    with measure_starvation() as starved, RawClient(address, source_address=OTHER) as newcomer:
        newcomer.find("Download CSV")
        return monotonic() - begun - starved()


def half_open(address, count):
    host, port = address.removeprefix("http://").split(":")
    return [socket.create_connection((host, int(port)), 10, STRANGER) for _ in range(count)]


def test_half_open_lines_take_nobodys_place(address):
    """Neither ones that say nothing nor ones that never end their request; the oldest of them are cut."""
    with ExitStack() as stack:
        lines = [stack.enter_context(closing(one)) for one in half_open(address, 300)]
        for one in lines[150:]:
            with suppress(OSError):
                one.sendall(b"GET / HTTP/1.1\r\nHost: ")
        assert comes_in(address) < WITHIN
        lines[0].settimeout(10)
        with suppress(ConnectionResetError):
            assert lines[0].recv(1) == b""  # cut
        lines[-1].settimeout(browser_connection.HEADS_WITHIN + 5)
        with suppress(ConnectionResetError):
            assert lines[-1].recv(1) == b""  # and the others after a while


def test_request_without_end_is_cut(address):
    """Before it fills the memory."""
    with closing(half_open(address, 1)[0]) as one, pytest.raises(OSError):
        for _ in range(100):
            one.sendall(b"X: " + b"x" * 4000 + b"\r\n")
            one.settimeout(0.02)
            with suppress(TimeoutError):
                if one.recv(1) == b"":
                    raise ConnectionResetError


def test_silent_websockets_take_nobodys_place(address, monkeypatch):
    """Of one network so many may be silent at once; nothing is made for them, and others come in beside them."""
    with ExitStack() as stack:
        silent = []
        for _ in range(browser_connection.SOCKETS[0] + 20):
            with suppress(InvalidStatus):
                silent.append(stack.enter_context(RawClient(address, arrive=False, source_address=STRANGER)))
        assert len(silent) > browser_connection.SOCKETS[0]
        assert comes_in(address) < WITHIN
        gone = len(silent) - browser_connection.SOCKETS[0]
        wait_until(lambda: sum(one.closed == 1008 for one in silent) == gone, "the oldest sent away")
        assert silent[0].closed == 1008 and silent[0].socket.close_reason == web_server.CROWDED
        assert silent[-1].closed is None


def test_who_takes_nothing_that_is_sent_keeps_no_place(monkeypatch):
    """No ping is answered by whoever does not read what was sent before it."""
    monkeypatch.setattr(browser_connection, "DEAF", 0.05)

    async def serve():
        ended = []

        async def ping():
            return asyncio.Future()

        line = SimpleNamespace(ping=ping, transport=SimpleNamespace(abort=lambda: ended.append(True)))
        await asyncio.wait_for(browser_connection.BrowserConnection.ping_until_closed(line), 10)
        return ended

    assert asyncio.run(serve()) == [True]


def test_who_comes_and_goes_keeps_only_its_own_network_out(address, monkeypatch):
    """Websockets opened and closed again, more than it may: then its network has to wait, and no other."""
    monkeypatch.setattr(web_server, "HANDSHAKES", 8)
    monkeypatch.setattr(web_server, "HANDSHAKES_A_SECOND", 0.01)  # however slowly a busy machine opens them
    refused = 0
    for _ in range(20):
        try:
            RawClient(address, arrive=False, source_address=("127.0.0.88", 0)).close()
        except InvalidStatus as status:
            refused += status.response.status_code == 503 and int(status.response.headers["Retry-After"]) >= 1
            if refused > 3:
                break
    assert refused > 3 and comes_in(address) < WITHIN


@pytest.mark.parametrize(("source", "what"), [
    ("127.0.0.99", "values"), pytest.param("127.0.7.7", "parts of a file", marks=pytest.mark.slow)])
def test_who_sends_far_too_much_is_sent_away_and_must_wait(address, source, what):
    """Others stay; from its address no websocket opens for some seconds."""
    with RawClient(address, source_address=OTHER) as other:
        flood = RawClient(address, source_address=(source, 0))
        slider, sender = flood.find("Cells"), Sender(flood)
        with pytest.raises(ConnectionClosed):
            while True:
                flood.set(slider, 1.5) if what == "values" else sender.part(0, bytes(upload.PART_BYTES))
        wait_until(lambda: flood.closed in (1008, 1006), "it is sent away")
        with pytest.raises(InvalidStatus) as refused:
            RawClient(address, source_address=(source, 0))
        assert refused.value.response.status_code == 503 and refused.value.response.headers["Retry-After"]
        assert other.closed is None


def test_large_message_closes_its_own_websocket_only(address):
    with RawClient(address, source_address=OTHER) as other, RawClient(address, source_address=("127.0.0.78", 0)) as one:
        with pytest.raises(ConnectionClosed):
            one.send(b"\x00" * 49_000_000)
            wait_until(lambda: one.closed, "it is closed")
            one.send("more")
        assert one.closed in (1009, 1006) and other.closed is None


def test_a_bucket_fills_at_its_rate_up_to_its_brim():
    """However long nobody came: who waits has no more tries than who begins."""
    now = [0.0]
    bucket = TokenBucket(3, 0.5, clock=lambda: now[0])
    bucket.debit(4)
    assert bucket.delay() == pytest.approx(4.0)  # until one is there, of one that is missing
    now[0] = 3.0
    assert bucket.tokens == pytest.approx(0.5)
    now[0] = 1000.0
    assert bucket.tokens == 3
