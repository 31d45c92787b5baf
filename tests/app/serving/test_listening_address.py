"""Where the lab listens: addresses of both kinds and names, free or taken; and what it answers from the start."""

import json
import os
import socket
from contextlib import suppress

import pytest

from app.page.listening_address import ServeError, authority, network_address, require_free
from solvers.workers.worker_process import free_port
from tests.support.page_server import http_get, start_server
from tests.support.raw_client import RawClient

SIX = "this machine has no IPv6, without which its addresses cannot be tried"


def listen(host):
    """A socket that takes a port at an address."""
    with suppress(OSError):
        return socket.create_server((host, 0), family=socket.AF_INET6 if ":" in host else socket.AF_INET)
    return (pytest.fail if os.environ.get("CI") else pytest.skip)(SIX)


@pytest.mark.parametrize("host", ["::1", "::", "localhost"])
def test_page_and_websocket_come_from_each_address(host):
    listen("::1").close()
    with start_server(host) as (_, address):
        assert http_get(address)[0] == 200
        with RawClient(address, {"Origin": address}) as visitor:
            visitor.find("Problem")


@pytest.mark.parametrize("taken, host, named", [
    ("127.0.0.1", "127.0.0.1", "127.0.0.1"), ("127.0.0.1", "0.0.0.0", "0.0.0.0"),
    ("127.0.0.1", "localhost", "localhost"), ("::1", "::1", "[::1]"), ("::1", "::", "[::]")])
def test_a_port_that_is_taken_is_not_left_for_another(taken, host, named):
    with listen(taken) as door:
        port = door.getsockname()[1]
        with pytest.raises(ServeError) as refused:
            require_free(host, port)
    assert str(refused.value).startswith(f"cannot listen on {named}:{port} (address already in use); choose")
    require_free(host, port)


@pytest.mark.parametrize("host", ["192.0.2.1", "2001:db8::1", "nowhere.example"])
def test_a_host_that_is_not_this_machine_is_refused(host, monkeypatch):
    known = socket.getaddrinfo
    monkeypatch.setattr(socket, "getaddrinfo",  # without asking the network for names
                        lambda name, *rest: known(name, *rest[:4], socket.AI_NUMERICHOST))
    with pytest.raises(ServeError) as refused:
        require_free(host, 8080)
    assert str(refused.value).startswith(f"cannot listen on {authority(host, 8080)} (")


def test_an_address_for_other_machines_is_known(monkeypatch):
    assert network_address("lab.example") == "lab.example" and network_address("::") not in ("::", "127.0.0.1")
    monkeypatch.setattr(socket.socket, "connect", lambda *_: (_ for _ in ()).throw(OSError("no route")))
    assert [network_address(host) for host in ("0.0.0.0", "::")] == ["127.0.0.1", "::1"]


def test_health_is_told_from_the_first_moment(monkeypatch):
    """A server is not ready before it has pages to give, nor before its engines are."""
    port, told = free_port(), []
    monkeypatch.setattr("tests.support.page_server.free_port", lambda: port)
    monkeypatch.setattr("app.page.panels.page_header.set_up_theme",
                        lambda _: told.append(http_get(f"http://127.0.0.1:{port}", "/health")))
    with start_server() as (_, address):
        monkeypatch.setattr("tests.support.page_server.SilentPool.wait_ready", lambda *_: False)
        told.append(http_get(address, "/health"))
        assert "Retry-After: 1" in http_get.head
        monkeypatch.undo()
        told.append(http_get(address, "/health"))
    assert [(status, json.loads(body)["ready"]) for status, body in told] == [(503, False), (503, False), (200, True)]
