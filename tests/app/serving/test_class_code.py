"""The class code: without it no page, no frame and no scene; with it a cookie, and all of them."""

import hmac
import json
import re
from contextlib import suppress
from functools import partial

import pytest
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed, InvalidStatus

from app.access import code_login
from app.access.code_login import ALL, CLASS, LETTERS, ONE, CodeLogin, generate_code
from app.access.network_limits import REMEMBERED, TokenBucket
from app.classroom.class_context import LessonContext
from app.lessons import catalogue
from app.viewer import web_server
from tests.browser.conftest import serving
from tests.support.page_server import http_get, start_server
from tests.support.processes import wait_until
from tests.support.raw_client import RawClient

CODE, NOTES, BOARD = "wave-4711", "tide-0815", "surf-2323"
DOOR = b"<title>mpm-lab: class code</title>"


@pytest.fixture(scope="module")
def locked():
    """A server in this process that asks for a code."""
    with start_server(code=CODE) as (_, address):
        yield address


def enter(address, guess):
    """Status, sentence and the cookie if there is one."""
    status, body = http_get(address, "/enter", {"X-Class-Code": guess})
    cookie = re.search(r"Set-Cookie: ([^;\r]+)(.*)", http_get.head)
    return status, body.decode().strip(), cookie


def test_no_path_gives_anything_without_the_code(locked):
    """The viewer's only file, and paths that lead there in other ways, with queries and made-up cookies."""
    port = locked.rpartition(":")[2]
    paths = ["/", "/index.html", "//", "/?code=" + CODE, f"/index.html?{CODE}", "/%69ndex.html", "/.", "/./index.html",
             "/entering", "/a/enter/../index.html", "/enter/", "/INDEX.HTML", "*", "/index.html#enter"]
    cookies = ["", f"mpm-lab-{port}=", f"mpm-lab-{port}={CODE}", f"mpm-lab-{port}", "mpm-lab=1; x=2", "=", ";;;"]
    for path in paths:
        for cookie in cookies if path in ("/", "/index.html") else cookies[:3]:
            status, body = http_get(locked, path, {"Cookie": cookie})
            assert DOOR in body and status == (200 if path.partition("?")[0] in ("/", "/index.html") else 403), path
            assert "Set-Cookie" not in http_get.head and "no-store" in http_get.head
    for path in ("/enter", "/enter?code=" + CODE, "/x/enter"):
        assert http_get(locked, path)[0] == 403 and "Set-Cookie" not in http_get.head


def test_no_websocket_opens_without_the_code(locked):
    """So that nothing of any scene is sent: not with the code in the address, in a cookie, or in its own header."""
    port = locked.rpartition(":")[2]
    for path, headers in [("", {}), ("/enter", {}), (f"/?code={CODE}", {}), ("", {"Cookie": f"mpm-lab-{port}={CODE}"}),
                          ("", {"X-Class-Code": CODE}), ("/enter", {"X-Class-Code": CODE}),
                          ("", {"Cookie": f"mpm-lab-{port}=x; mpm-lab-{port}=y"}), ("", {"Upgrade": "WebSocket"})]:
        with pytest.raises(InvalidStatus) as refused:
            RawClient(locked + path, headers)
        assert refused.value.response.status_code == 403
        assert b"class code is missing" in refused.value.response.body or "Upgrade" in headers


def test_the_code_opens_page_and_websocket(locked):
    """However it is written; the cookie is for this server alone and no script reads it. A wrong one is told so."""
    assert enter(locked, "wave-4712") == (403, code_login.WRONG, None)
    for guess in (CODE, "WAVE 4711", "%20wave4711"):
        status, sentence, cookie = enter(locked, guess)
        assert (status, sentence) == (200, "") and len(cookie[1].partition("=")[2]) >= 40
        assert {part.strip() for part in cookie[2].split(";")} >= {"HttpOnly", "SameSite=Strict", "Path=/"}
    status, body = http_get(locked, "/", {"Cookie": f"a=b; {cookie[1]}"})
    assert status == 200 and DOOR not in body and b"lab-ground" in body
    with RawClient(locked, {"Cookie": cookie[1]}) as visitor:
        visitor.find("Problem")
    assert http_get(locked, "/", {"Cookie": cookie[1], "Origin": "http://evil.example"})[0] == 403


def test_codes_and_cookies_are_compared_in_constant_time(monkeypatch):
    """By the function made for it, with digests of one length, however long the guess, and with every code there is."""
    compared = []
    real = hmac.compare_digest
    monkeypatch.setattr(hmac, "compare_digest", lambda a, b: compared.append((len(a), len(b))) or real(a, b))
    door = CodeLogin(CODE, 8080, NOTES)
    for guess in ("", "w", CODE, NOTES, "x" * 1000, "\ud800"):
        assert bool(door.log_in(guess, "::1").cookie) == (guess in (CODE, NOTES))
    cookie = door.log_in(CODE, "::1").cookie.partition(";")[0]
    assert door.identify(Headers({"Cookie": cookie})).role == CLASS
    assert not door.is_authorised(Headers({"Cookie": "mpm-lab-8080=x"})) and not door.is_authorised(Headers())
    assert compared == [(32, 32)] * 18


def test_wrong_guesses_are_limited_for_one_network_and_for_all_and_a_right_one_opens(monkeypatch):
    """After so many wrong ones others are told to wait, for so long as is said; whatever was guessed, from wherever,
    the right code opens, also from there."""
    now = [0.0]
    monkeypatch.setattr(code_login, "TokenBucket", partial(TokenBucket, clock=lambda: now[0]))
    door = CodeLogin(CODE, 8080)
    most, all_of_them = int(ONE[0]), int(ALL[0])
    for k in range(most):
        assert door.log_in(f"wrong{k}", f"10.0.0.{k}").refusal == code_login.WRONG
    limited = door.log_in("wrong", "10.0.0.99")
    assert not limited.cookie and limited.wait == 6 and "Wait 6 s" in limited.refusal
    assert door.log_in(CODE, "10.0.0.1").cookie and door.log_in(CODE, "10.0.1.2").cookie
    assert door.log_in("wrong", "10.0.1.2").refusal == code_login.WRONG  # of another network
    now[0] += limited.wait
    assert door.log_in("wrong", "10.0.0.1").refusal == code_login.WRONG
    made = sum(door.log_in("wrong", f"10.1.{k // 250}.{k % 250}").refusal == code_login.WRONG for k in range(2000))
    assert made <= all_of_them - most + 6 * ALL[1] + 1
    assert door.log_in("wrong", "10.9.9.9").wait and door.log_in(CODE, "10.9.9.9").cookie  # all together had too many
    assert len(door._of) <= REMEMBERED
    now[0] += 1000
    same = [door.log_in("wrong", f"2001:db8::{k:x}").wait for k in range(1, most + 2)]
    assert same[:-1] == [0] * most and same[-1] > 0  # one house of IPv6 is one address


def test_limit_reaches_the_page_and_lets_the_right_code_through(monkeypatch):
    monkeypatch.setattr(code_login, "ONE", (2, 0.1))
    with start_server(code=CODE) as (_, address):
        assert [enter(address, guess)[0] for guess in ("a", "b", "c", CODE)] == [403, 403, 429, 200]
        assert enter(address, "d")[0] == 429 and re.search(r"Retry-After: \d+", http_get.head)


def test_a_misbehaving_browser_keeps_only_itself_out(monkeypatch):
    """Others of its address, which a whole class may have, come in: after too large a message, and after many reloads,
    of which those that are refused cost nobody anything."""
    for limit, value in (("RELOADS", 3), ("RELOADS_A_SECOND", 0.01), ("HANDSHAKES", 30), ("HANDSHAKES_A_SECOND", 0.01)):
        monkeypatch.setattr(web_server, limit, value)
    with start_server(code=CODE) as (_, address):
        large, often, other = (enter(address, CODE)[2][1] for _ in range(3))

        def comes_in(cookie):
            with suppress(InvalidStatus):
                RawClient(address, {"Cookie": cookie}, arrive=False).close()
                return True
            return False

        with RawClient(address, {"Cookie": large}) as one:
            with suppress(ConnectionClosed):
                one.send(bytes(2 * web_server.LARGEST_MESSAGE))
            wait_until(lambda: one.closed, "it is closed")
        wait_until(lambda: not comes_in(large), "it must wait")
        assert comes_in(other) and sum(comes_in(often) for _ in range(40)) == 3 and comes_in(other)


def test_the_teachers_code_opens_the_notes_and_the_class_code_does_not():
    """Where there is one; a code of use to nobody who is in already changes no cookie."""
    with start_server(code=CODE, notes=NOTES,
                      classroom=LessonContext(next(iter(catalogue.load_lessons())), teacher=True)) as (_,
                                                                                                                           address):
        cookies = {guess: enter(address, guess)[2][1] for guess in (CODE, NOTES)}
        for guess, cookie in cookies.items():
            with RawClient(address, {"Cookie": cookie}) as visitor:
                visitor.find("Your name")  # below the lesson's beginning
                shown = any("lab-teacher" in text for text in visitor.html.copy().values())
                assert shown == (guess == NOTES)
        def status(guess, cookie):
            return http_get(address, "/enter", {"X-Class-Code": guess, "Cookie": cookies[cookie]})[0]

        assert (status(CODE, NOTES), status(CODE, CODE), status(NOTES, CODE)) == (204, 204, 200)
    another = CodeLogin(CODE, int(address.rpartition(":")[2]))  # a lab that has come in the place of this one
    assert not another.is_authorised(Headers({"Cookie": cookies[CODE]}))


@pytest.mark.parametrize("typed", ["WAVE-4711", "wave\u20134711", "\u00a0wave\u20114711\u200b\r\n",
                                   "\uff57ave \uff14\uff17\uff11\uff11"])
def test_a_code_is_known_however_a_keyboard_changes_it(typed):
    """Long dashes, wide letters, spaces that do not break, what does not show; and quotes in one of one's own."""
    assert CodeLogin(CODE, 8080).log_in(typed, "::1").cookie
    assert CodeLogin("it's 4711", 8080).log_in("It\u2019s\u202f4711", "::1").cookie


def test_a_cookie_is_one_browsers_and_made_by_this_lab():
    """Each who comes has a key of his own; one who makes up a key, or takes another's proof for his own, has none."""
    door = CodeLogin(CODE, 8080, NOTES, BOARD)
    first, second = (door.log_in(CODE, "::1").cookie.partition(";")[0] for _ in range(2))
    guests = [door.identify(Headers({"Cookie": cookie})) for cookie in (first, second)]
    assert guests[0].key != guests[1].key and {guest.role for guest in guests} == {CLASS}
    name, _, value = first.partition("=")
    key, _, proof = value.partition(".")
    made_up = [f"{name}=x.{proof}", f"{name}={key}", f"{name}={key}.", f"{name}={key}.{proof[:-1]}", f"{name}=.{proof}",
               f"{name}={key}x.{proof}", f"mpm-lab-8081={value}"]
    assert [door.identify(Headers({"Cookie": cookie})) for cookie in made_up] == [None] * len(made_up)
    assert door.identify(Headers({"Cookie": door.log_in(BOARD, "::1").cookie.partition(";")[0]})).role == "board"


def test_strangers_learn_no_more_of_a_lab_than_that_it_is_ready(locked):
    for cookie, fields in ((None, {"ready"}), (enter(locked, CODE)[2][1], {"ready", "sessions", "places"})):
        status, body = http_get(locked, "/health", {"Cookie": cookie} if cookie else {})
        assert status == 200 and json.loads(body).keys() & {"ready", "sessions", "places"} == fields


def test_made_up_codes_are_long_and_plain():
    codes = {generate_code() for _ in range(200)}
    assert len(codes) == 200 and all(re.fullmatch(f"[{LETTERS}]{{4}}-[{LETTERS}]{{4}}", one) for one in codes)
    assert not set("0o1il") & set(LETTERS) and len(LETTERS) ** 8 > 2**39


def test_lab_that_others_reach_makes_up_a_code_and_prints_it():
    """On any address but this machine's own, and with a public name; with it there are frames, without it nothing. And
    others for the teacher and for the board."""
    log = []
    arguments = ("--host", "0.0.0.0", "--teacher", "--lesson", "4", "--board")
    with serving(arguments=arguments, coded=1, log=log) as (address, _, line):
        printed = re.search(r"class code is (\S+); (http://\S+)/#code=(\S+)", line)
        assert printed[1] == printed[3] and "0.0.0.0" not in address + printed[2]
        assert (
            http_get(printed[2])[0] == http_get(address)[0] == 200
        )  # under this machine's own name for itself, and for others
        with pytest.raises(InvalidStatus):
            RawClient(address)
        assert enter(address, "wrong-code")[0] == 403 and DOOR in http_get(address)[1]
        cookie = enter(address, printed[1])[2][1]
        with RawClient(address, {"Cookie": cookie}) as visitor:
            wait_until(lambda: visitor.frames > 3, "frames")
    notes = re.search(r"teacher's code.* is (\S+); (http://\S+)/#code=(\S+)", log[0])
    assert notes[1] == notes[3] != printed[1] and notes[2] == printed[2]
    board = re.search(r"board's code.* is (\S+); (http://\S+)/#code=(\S+) opens", log[0])
    assert board[1] == board[3] not in (printed[1], notes[1]) and board[2] == printed[2]
