"""The class code: without it no page, no frame and no scene; with it a cookie, and all of them."""

from __future__ import annotations

import hmac
import re
from functools import partial
from pathlib import Path

import pytest
import viser
from websockets.datastructures import Headers
from websockets.exceptions import InvalidStatus

from app.doors import code
from app.doors.bucket import Bucket
from app.doors.code import ALL, LETTERS, ONE, ClassCode, made_up
from tests.browser.conftest import serving
from tests.doors import get, lab
from tests.processes import until
from tests.raw import Raw

CODE = "wave-4711"
BUILD = Path(viser.__file__).parent / "client" / "build"
DOOR = b"<title>mpm-lab: class code</title>"


@pytest.fixture(scope="module")
def locked():
    """A server in this process that asks for a code."""
    with lab(code=CODE) as (_, address):
        yield address


def enter(address, guess):
    """Status, sentence and the cookie if there is one."""
    status, body = get(address, "/enter", {"X-Class-Code": guess})
    cookie = re.search(r"Set-Cookie: ([^;\r]+)(.*)", get.head)
    return status, body.decode().strip(), cookie


def test_no_path_gives_anything_without_the_code(locked):
    """Every file of the viewer, and paths that lead there in other ways, with queries and made-up cookies."""
    port = locked.rpartition(":")[2]
    files = [f"/{path.relative_to(BUILD).as_posix()}" for path in BUILD.rglob("*") if path.is_file()]
    assert files
    others = ["/", "//", "/?code=" + CODE, f"/index.html?{CODE}", "/%69ndex.html", "/.", "/./index.html", "/entering",
              "/a/enter/../index.html", "/enter/", "/INDEX.HTML", "*", "/index.html#enter"]
    cookies = ["", f"mpm-lab-{port}=", f"mpm-lab-{port}={CODE}", f"mpm-lab-{port}", "mpm-lab=1; x=2", "=", ";;;"]
    for path in files + others:
        for cookie in cookies if path in ("/", "/index.html") else cookies[:3]:
            status, body = get(locked, path, {"Cookie": cookie})
            assert DOOR in body and status == (200 if path.partition("?")[0] in ("/", "/index.html") else 403), path
            assert "Set-Cookie" not in get.head and "no-store" in get.head
    for path in ("/enter", "/enter?code=" + CODE, "/x/enter"):
        assert get(locked, path)[0] == 403 and "Set-Cookie" not in get.head


def test_no_websocket_opens_without_the_code(locked):
    """So that nothing of any scene is sent: not with the code in the address, in a cookie, or in its own header."""
    port = locked.rpartition(":")[2]
    for path, headers in [("", {}), ("/enter", {}), (f"/?code={CODE}", {}), ("", {"Cookie": f"mpm-lab-{port}={CODE}"}),
                          ("", {"X-Class-Code": CODE}), ("/enter", {"X-Class-Code": CODE}),
                          ("", {"Cookie": f"mpm-lab-{port}=x; mpm-lab-{port}=y"}), ("", {"Upgrade": "WebSocket"})]:
        with pytest.raises(InvalidStatus) as refused:
            Raw(locked + path, headers)
        assert refused.value.response.status_code == 403
        assert b"class code is missing" in refused.value.response.body or "Upgrade" in headers


def test_the_code_opens_page_and_websocket(locked):
    """However it is written; the cookie is for this server alone and no script reads it."""
    for guess in (CODE, "WAVE 4711", "%20wave4711"):
        status, sentence, cookie = enter(locked, guess)
        assert (status, sentence) == (200, "") and len(cookie[1].partition("=")[2]) >= 40
        assert {part.strip() for part in cookie[2].split(";")} >= {"HttpOnly", "SameSite=Strict", "Path=/"}
    status, body = get(locked, "/", {"Cookie": f"a=b; {cookie[1]}"})
    assert status == 200 and DOOR not in body and b"lab-ground" in body
    with Raw(locked, {"Cookie": cookie[1]}) as visitor:
        visitor.find("Problem")
    assert get(locked, "/", {"Cookie": cookie[1], "Origin": "http://evil.example"})[0] == 403


def test_wrong_code_is_told_in_words(locked):
    status, sentence, cookie = enter(locked, "wave-4712")
    assert status == 403 and sentence == code.WRONG and cookie is None


def test_codes_and_cookies_are_compared_in_constant_time(monkeypatch):
    """By the function made for it, and with digests of one length, however long the guess."""
    compared = []
    real = hmac.compare_digest
    monkeypatch.setattr(hmac, "compare_digest", lambda a, b: compared.append((len(a), len(b))) or real(a, b))
    door = ClassCode(CODE, 8080)
    for guess in ("", "w", CODE, "x" * 1000, "\ud800"):
        assert door.enter(guess, "::1").opens == (guess == CODE)
    assert door.knows(Headers({"Cookie": door.cookie.partition(";")[0]}))
    assert not door.knows(Headers({"Cookie": "mpm-lab-8080=x"})) and not door.knows(Headers())
    assert compared == [(32, 32)] * 7


def test_wrong_guesses_are_limited_for_one_and_for_all(monkeypatch):
    """After so many not even the right code is looked at, for so long as is said; others go on until all are."""
    now = [0.0]
    monkeypatch.setattr(code, "Bucket", partial(Bucket, clock=lambda: now[0]))
    door = ClassCode(CODE, 8080)
    most, all_of_them = int(ONE[0]), int(ALL[0])
    for k in range(most):
        assert door.enter(f"wrong{k}", "10.0.0.1").sentence == code.WRONG
    limited = door.enter(CODE, "10.0.0.1")
    assert not limited.opens and limited.wait == 6 and "Wait 6 s" in limited.sentence
    assert door.enter(CODE, "10.0.0.2").opens
    now[0] += limited.wait
    assert door.enter(CODE, "10.0.0.1").opens
    made = sum(door.enter("wrong", f"10.1.{k // 250}.{k % 250}").sentence == code.WRONG for k in range(500))
    assert made <= all_of_them - most + 6 * ALL[1] + 1
    assert not door.enter(CODE, "10.9.9.9").opens  # all together had too many
    assert len(door._of) <= code.MOST_ADDRESSES
    now[0] += 1000
    same = [door.enter("wrong", f"2001:db8::{k:x}").wait for k in range(1, most + 2)]
    assert same[:-1] == [0] * most and same[-1] > 0  # one house of IPv6 is one address


def test_limit_reaches_the_page(monkeypatch):
    monkeypatch.setattr(code, "ONE", (2, 0.1))
    with lab(code=CODE) as (_, address):
        assert [enter(address, guess)[0] for guess in ("a", "b", "c", CODE)] == [403, 403, 429, 429]
        assert re.search(r"Retry-After: \d+", get.head)


def test_made_up_codes_are_long_and_plain():
    codes = {made_up() for _ in range(200)}
    assert len(codes) == 200 and all(re.fullmatch(f"[{LETTERS}]{{4}}-[{LETTERS}]{{4}}", one) for one in codes)
    assert not set("0o1il") & set(LETTERS) and len(LETTERS) ** 8 > 2**39


def test_lab_that_others_reach_makes_up_a_code_and_prints_it():
    """On any address but this machine's own, and with a public name; with it there are frames, without it nothing."""
    with serving(arguments=("--host", "0.0.0.0"), coded=True) as (address, _, line):
        printed = re.search(r"class code is (\S+); (http://\S+)/#code=(\S+)", line)
        assert printed[1] == printed[3] and "0.0.0.0" not in address + printed[2]
        assert get(printed[2])[0] == get(address)[0] == 200  # under this machine's own name for itself, and for others
        with pytest.raises(InvalidStatus):
            Raw(address)
        assert enter(address, "wrong-code")[0] == 403 and DOOR in get(address)[1]
        cookie = enter(address, printed[1])[2][1]
        with Raw(address, {"Cookie": cookie}) as visitor:
            until(lambda: visitor.frames > 3, "frames")
