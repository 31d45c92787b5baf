"""The doors: who is let in, by addresses, origins and names."""

import socket

import pytest
from websockets.datastructures import Headers

from app.access.allowed_hosts import Addresses
from app.access.rate_limited_log import RefusalLog
from app.viewer.send_queue import PROTOCOL
from tests.support.page_server import http_get
from tests.support.processes import wait_until

UPGRADE = {"Connection": "Upgrade", "Upgrade": "websocket", "Sec-WebSocket-Version": "13",
           "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==", "Sec-WebSocket-Protocol": PROTOCOL}


@pytest.mark.parametrize(("headers", "allowed"), [
    ({}, True), ({"Origin": "own"}, True), ({"Host": "localhost:80"}, True), ({"Host": "lab.localhost"}, True),
    ({"Host": "[::1]:8080"}, True), ({"Host": "127.8.8.8:1"}, True),
    ({"Origin": "http://evil.example"}, False), ({"Origin": "null"}, False), ({"Origin": "http://localhost:1"}, False),
    ({"Origin": "file://"}, False), ({"Host": "evil.example"}, False), ({"Host": ""}, False),
    ({"Host": "127.0.0.1.evil.example"}, False), ({"Host": "evil@localhost"}, False), ({"Host": "192.168.0.7"}, False),
    ({"Host": "evil.example", "Origin": "http://evil.example"}, False),
    ({"Host": "localhost", "Origin": "https://localhost:80"}, False)])
def test_foreign_pages_and_hosts_are_refused(here, headers, allowed):
    """A websocket and every page, in a sentence."""
    address = here[1]
    headers = {name: address if value == "own" else value for name, value in headers.items()}
    for path in ("/", "/index.html", "/assets/none.js", "/../x", "/enter"):
        status, body = http_get(address, path, headers)
        assert (status != 403) == allowed, body
        assert allowed or (body.decode().strip().endswith(".") and b"<" not in body)
    upgraded = http_get(address, "/", {**headers, **UPGRADE})
    assert upgraded[0] == (101 if allowed else 403)


@pytest.mark.parametrize(("host", "names", "asked", "origin", "allowed"), [
    ("0.0.0.0", (), "192.168.0.7:8080", "http://192.168.0.7:8080", True),
    ("0.0.0.0", (), "lab.example", "https://lab.example", True), ("0.0.0.0", (), "lab.example", None, True),
    ("0.0.0.0", (), "lab.example:443", "https://lab.example", True),
    ("0.0.0.0", (), "lab.example", "https://evil.example", False),
    ("0.0.0.0", (), "lab.example:8080", "http://lab.example", False),
    ("127.0.0.1", ("lab.example",), "lab.example", "https://lab.example", True),
    ("127.0.0.1", ("lab.example",), "127.0.0.1:8080", "https://lab.example", True),
    ("127.0.0.1", ("lab.example",), "evil.example", None, False),
    ("127.0.0.1", ("lab.example:444",), "127.0.0.1:8080", "https://lab.example:444", True),
    ("127.0.0.1", ("lab.example:444",), "127.0.0.1:8080", "https://lab.example", False)])
def test_names_of_a_lab_that_others_reach(host, names, asked, origin, allowed):
    headers = Headers({"Host": asked, **({"Origin": origin} if origin else {})})
    assert (Addresses(host, names).refusal(headers) is None) == allowed
    assert not Addresses(host, names).is_local_only and Addresses("localhost").is_local_only


def raw(address, *lines):
    """The status of an answer to a request, line for line as it is."""
    host, port = address.removeprefix("http://").split(":")
    with socket.create_connection((host, int(port)), timeout=20) as line:
        line.sendall("\r\n".join(["GET / HTTP/1.1", *lines, "", ""]).encode("latin1"))
        return int(line.recv(4000).split()[1])


@pytest.mark.parametrize("host", ["", " ", ".", ":80", "a..b", "127.0.0.1 ", "127.0.0.1\t", "\t127.0.0.1", "127.0.0.1:",
                                  "127.0.0.1:x", "127.0.0.1,b", "127.0.0.1/", "[::1", "\xe4"])
def test_host_must_be_one(here, host):
    assert raw(here[1], f"Host: {host}") == 403
    for listens in ("127.0.0.1", "0.0.0.0"):
        assert Addresses(listens).refusal(Headers({"Host": host}))


@pytest.mark.parametrize("origin", ["http://{}\t", "http://{} ", "\thttp://{}", "  http://{}", "http:// {}", "http://{}/",
                                    " ", "", "http://", "//{}", "http://x@{}", "http://{}, http://{}"])
def test_origin_must_be_a_tidy_one(here, origin):
    """Also where the reader of headers would take white space away before anyone sees it."""
    here_is = here[1].removeprefix("http://")
    upgrade = [f"{name}: {value}" for name, value in UPGRADE.items()]
    origin = origin.format(here_is, here_is)
    assert raw(here[1], f"Host: {here_is}", f"Origin: {origin}", *upgrade) == 403
    assert raw(here[1], f"Host: {here_is}", f"oRIGIN:{origin}") == 403
    assert raw(here[1], f"Host: {here_is}", f"Origin: http://{here_is}", *upgrade) == 101


@pytest.mark.parametrize(("said", "page", "socket"), [
    ({"Site": "same-origin"}, True, True), ({"Site": "none", "Mode": "navigate", "Dest": "document"}, True, True),
    ({"Site": "cross-site", "Mode": "navigate", "Dest": "document"}, True, False),  # a link leads here
    ({"Site": "cross-site", "Mode": "navigate", "Dest": "iframe"}, False, False),
    ({"Site": "cross-site"}, False, False), ({"Site": "same-site"}, False, False),
    ({"Site": "Cross-Site"}, False, False),
    ({"Site": "cross-site", "Mode": "no-cors", "Dest": "image"}, False, False),
    ({"Site": "same-site", "Mode": "websocket", "Dest": "websocket"}, False, False),
    ({"Site": "anything"}, False, False)])
def test_page_of_another_site_may_lead_here_and_no_more(here, said, page, socket):
    """A browser that tells no origin says whether the page that asks is of another site."""
    headers = {f"Sec-Fetch-{name}": value for name, value in said.items()}
    assert (http_get(here[1], "/", headers)[0] == 200) == page
    assert (http_get(here[1], "/", {**headers, **UPGRADE})[0] == 101) == socket
    assert http_get(here[1], "/", {**headers, **UPGRADE, "Origin": here[1]})[0] == 101  # which decides where it is told


def test_every_answer_says_what_may_be_done_with_it(here):
    """In no frame, as nothing else than it says it is; pages run their own scripts, all else none."""
    for path, headers in [("/", {}), ("/", {"Accept-Encoding": "gzip"}), ("/none", {}), ("/health", {}),
                          ("/here/x", {}), ("/", {"Host": "evil.example"}), ("/", UPGRADE),
                          ("/", {**UPGRADE, "Origin": "null"}), ("/", {**UPGRADE, "Sec-WebSocket-Key": "none"})]:
        http_get(here[1], path, headers)
        found = dict(line.split(": ", 1) for line in http_get.head.split("\r\n")[1:])
        assert (found["X-Content-Type-Options"], found["X-Frame-Options"]) == ("nosniff", "DENY"), path
        assert found["Referrer-Policy"] == "same-origin"
        policy = found["Content-Security-Policy"].split("; ")
        assert {"default-src 'none'", "frame-ancestors 'none'", "base-uri 'none'"} <= set(policy)
        assert not any("unsafe-inline" in part or "unsafe-eval" in part.replace("wasm-unsafe-eval", "")
                       for part in policy if part.startswith("script-src"))


@pytest.mark.parametrize("method", ["HEAD", "POST", "OPTIONS", "TRACE"])
def test_another_method_than_get_is_told_so_and_nothing_else(here, method, caplog):
    host, port = here[1].removeprefix("http://").split(":")
    with socket.create_connection((host, int(port)), timeout=20) as line:
        line.sendall(f"{method} / HTTP/1.1\r\nHost: {host}:{port}\r\nContent-Length: 2\r\n\r\nab".encode())
        head, _, body = b"".join(iter(lambda: line.recv(4000), b"")).partition(b"\r\n\r\n")
    assert head.startswith(b"HTTP/1.1 405 ") and b"Allow: GET" in head and b"nosniff" in head and not body
    assert not caplog.records


def test_stale_page_is_told_and_fills_no_log(here, capfd, caplog):
    """One of another version of the viewer; the viewer itself would print a line for each."""
    from websockets.sync.client import connect
    for _ in range(30):
        with connect(here[1].replace("http", "ws"), subprotocols=["viser-v0.0.1"]) as old:
            with pytest.raises(Exception, match="Version mismatch"):
                old.recv(5)
    assert capfd.readouterr().out == "" and caplog.text.count("another version") <= 10


def test_log_has_few_lines_however_much_is_refused(caplog):
    """A line each, then one that says how many more; after a minute, here a moment, it begins anew."""
    refusals = RefusalLog(lines=3, seconds=0.2)
    for k in range(1000):
        refusals.record(f"a message {k % 2}", "10.0.0.1")
    wait_until(lambda: "more" in caplog.text, "the sum")
    assert [record.getMessage() for record in caplog.records[:2]] == [
        "refused from 10.0.0.1: a message 0", "refused from 10.0.0.1: a message 1"]
    assert len(caplog.records) == 4 and "refused 997 more" in caplog.records[3].getMessage()
    refusals.record("again")
    assert caplog.records[4].getMessage() == "refused: again"
