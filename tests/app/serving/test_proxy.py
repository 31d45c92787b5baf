"""The lab behind nginx with TLS, set up as ``assets/nginx.conf.example`` says: page, code and websocket come through.
"""

import http.client
import re
import selectors
import socket
import ssl
import threading

import pytest
from websockets.exceptions import InvalidStatus

from tests.support.page_server import start_server
from tests.support.processes import HANG
from tests.support.proxy import CODE, NAME, start_proxy
from tests.support.raw_client import RawClient

FROM = "127.0.0.9"  # where the visitor comes from: another address than nginx's own


@pytest.fixture(scope="module")
def proxied(tmp_path_factory):
    """Ports of nginx, for http and https, and a context that trusts its certificate."""
    room = tmp_path_factory.mktemp("nginx")
    with start_server(names=(NAME,), code=CODE) as (_, address), start_proxy(room, address) as (plain, secure):
        yield plain, secure, ssl.create_default_context(cafile=room / "certificate")


class Line(http.client.HTTPSConnection):
    """To nginx on this machine, by the lab's public name."""

    def connect(self):
        line = socket.create_connection(("127.0.0.1", self.port), source_address=(FROM, 0))
        self.sock = self._context.wrap_socket(line, server_hostname=NAME)


def ask(proxied, path="/", **headers):
    _, secure, context = proxied
    line = Line(NAME, secure, context=context, timeout=20)
    line.request("GET", path, headers={name.replace("_", "-"): value for name, value in headers.items()})
    answer = line.getresponse()
    body = answer.read()
    line.close()
    return answer, body


def visit(proxied, **headers):
    """A visitor who comes through nginx, from a page of ours unless ``headers`` say otherwise."""
    _, secure, context = proxied
    line = context.wrap_socket(socket.create_connection(("127.0.0.1", secure), HANG), server_hostname=NAME)
    with socket.create_server(("127.0.0.1", 0)) as door:
        ours, (theirs, _) = socket.create_connection(door.getsockname()), door.accept()
    threading.Thread(target=carry, args=(line, theirs), daemon=True).start()
    return RawClient(f"http://{NAME}:{secure}", {"Origin": f"https://{NAME}:{secure}"} | headers, sock=ours)


def carry(line, inner):
    """Carry bytes between a TLS line and a plain one until either ends, on one thread: in Python 3.11 a TLS line that
    one thread reads while another writes can seem to have ended (once in 1,500 handshakes; OpenSSL has no lock)."""
    with line, inner, selectors.DefaultSelector() as waiting:
        for end in (line, inner):
            waiting.register(end, selectors.EVENT_READ)
        try:
            while True:
                ready = {key.fileobj for key, _ in waiting.select()}
                if inner in ready:
                    if not (data := inner.recv(65536)):
                        return
                    line.sendall(data)
                if line in ready:
                    inner.sendall(heard(line))
        except (EOFError, OSError):
            return  # either side has gone; the other sees its line closed


def heard(line):
    """What has come on a TLS line, maybe nothing (a record of TLS's own). Raises EOFError at its end."""
    data = b""
    line.settimeout(0)
    try:
        while more := line.recv(65536):
            data += more
        if not data:
            raise EOFError
    except ssl.SSLWantReadError:
        pass
    finally:
        line.settimeout(HANG)
    return data


def test_page_and_websocket_come_through(proxied):
    """The door first; with the code a cookie that goes over TLS only, and with that the page and its controls."""
    assert b"class code" in ask(proxied)[1]
    with pytest.raises(InvalidStatus):
        visit(proxied)
    assert ask(proxied, "/enter", X_Class_Code="wrong-one")[0].status == 403
    answer, _ = ask(proxied, "/enter", X_Class_Code=CODE)
    cookie = answer.headers["Set-Cookie"]
    assert answer.status == 200 and {"Secure", "HttpOnly", "SameSite=Strict"} <= set(re.split("; ?", cookie))
    cookie = cookie.partition(";")[0]
    answer, body = ask(proxied, Cookie=cookie)
    assert answer.status == 200 and b"lab-ground" in body
    with visit(proxied, Cookie=cookie) as visitor:
        visitor.set(visitor.find("Problem"), "expanding ring")
        visitor.find("grid cells across 1.2 m")


def test_foreign_page_is_refused_behind_the_proxy_too(proxied):
    cookie = ask(proxied, "/enter", X_Class_Code=CODE)[0].headers["Set-Cookie"].partition(";")[0]
    with pytest.raises(InvalidStatus) as refused:
        visit(proxied, Cookie=cookie, Origin="https://evil.example")
    assert refused.value.response.status_code == 403
    assert ask(proxied, Host="evil.example", Cookie=cookie)[0].status == 403


def test_wrong_codes_are_counted_by_the_visitors_address(proxied, caplog):
    """Which nginx tells; what a visitor says of it is overwritten."""
    for k in range(3):
        ask(proxied, "/enter", X_Class_Code="wrong-one", X_Real_IP=f"10.0.0.{k}")
    assert f"from {FROM}:" in caplog.text and "10.0.0" not in caplog.text


def test_http_leads_to_https(proxied):
    line = http.client.HTTPConnection("127.0.0.1", proxied[0], timeout=20)
    line.request("GET", "/", headers={"Host": NAME})
    answer = line.getresponse()
    assert answer.status == 301 and answer.headers["Location"] == f"https://{NAME}/"
    line.close()
