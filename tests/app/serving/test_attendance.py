"""A server and those who look at it: what nobody sees rests, who watches the server is told, the end is said."""

import json
import os
import re
import signal

import pytest

from app.page.page_server import OVER
from app.page.visit import engine_links
from app.page.visit import run_session as page
from app.page.visit.engine_links import EventRateCounter
from app.viewer import upload
from tests.app.page.features.test_upload import Sender
from tests.browser.conftest import serving
from tests.support.page_server import http_get
from tests.support.processes import children, has_ended, wait_until
from tests.support.raw_client import RawClient
from tests.support.session_listener import PATIENCE, SCENE


@pytest.fixture(scope="module")
def server():
    with serving() as one:
        yield one


def more(visitor, frames):
    """Wait until so many more have come."""
    before = visitor.frames
    wait_until(lambda: visitor.frames >= before + frames, "frames")


def frames_while(visitor, other):
    """How many come to one while twenty come to the other."""
    before = visitor.frames
    more(other, 20)
    return visitor.frames - before


def token(visitor):
    """What the visitor's browser is known by."""
    found = []
    wait_until(lambda: found or found.extend(re.findall(r"data-visitor='([\w-]+)'", " ".join(visitor.html.values()))),
               "a token")
    return found[0]


def test_what_nobody_sees_rests(server):
    """No frame comes to a page that is away, nor does its clock go on; it goes on when it is seen again."""
    with RawClient(server[0]) as visitor, RawClient(server[0]) as other:
        wait_until(lambda: visitor.frames > 3 and other.frames > 3, "frames of both")
        # A page is drawn a moment before the server knows it by its token; a browser asks again as well.
        wait_until(lambda: http_get(server[0], f"/away/{token(visitor)}")[0] == 204, "the server knows the page")
        # What was on its way comes meanwhile, later where the server is busy; a page that does not rest gets about as
        # many as the other, and never has such a pause.
        wait_until(lambda: frames_while(visitor, other) == 0, "a pause")
        assert http_get(server[0], f"/here/{token(visitor)}")[0] == 204
        more(visitor, 3)
    assert http_get(server[0], "/away/nobody")[0] == 404


def test_health(server):
    wait_until(lambda: json.loads(http_get(server[0], "/health")[1])["sessions"] == 0, "those of other tests gone")
    with RawClient(server[0]) as visitor:
        visitor.follow("bar")
        wait_until(lambda: visitor.frames > 3, "frames")
        wait_until(lambda: json.loads(http_get(server[0], "/health")[1])["frames_per_second"] > 0, "a rate")
        wait_until(lambda: json.loads(http_get(server[0], "/health")[1])["playing"] == 1,
                   "the opening and its pinned run gone")
        found = json.loads(http_get(server[0], "/health")[1])
    assert found.keys() == {"ready", "sessions", "places", "engines", "playing", "frames_per_second"}
    assert (found["ready"], found["sessions"], found["places"], found["playing"]) == (True, 1, 40, 1)
    assert found["engines"] >= 1


@pytest.mark.parametrize("end, thread", [
    (signal.SIGTERM, "second"),
    *(pytest.param(signal.SIGINT, thread, marks=pytest.mark.slow) for thread in ("first", "second"))])
def test_the_end_is_told_and_leaves_nothing(end, thread, tmp_path):
    """Neither a process nor a word of warning nor a part of a file, however it is ended, and whichever of its threads
    the system chooses to tell."""
    log = []
    with serving({"TMPDIR": str(tmp_path)}, log=log) as (address,
                                                         process), RawClient(address) as one, RawClient(address) as two:
        for visitor in (one, two):
            visitor.follow("bar")
        wait_until(lambda: one.frames > 3 and two.frames > 3, "frames")
        sender = Sender(one)
        sender.start(2 * upload.PART_BYTES)
        sender.part(0, bytes(upload.PART_BYTES))
        wait_until(lambda: any(tmp_path.rglob("coming")), "the beginning of a file")
        wait_until(lambda: all(any("lab-says" in text for text in v.html.values()) for v in (one, two)),
                   "finished pages")
        engines = children(process, "spawn_main")
        assert engines
        threads = sorted(map(int, os.listdir(f"/proc/{process}/task")))  # the second, too, lasts as long as the server
        os.kill(threads[["first", "second"].index(thread)], end)
        wait_until(lambda: one.closed is not None and two.closed is not None, "websockets closed")
        for visitor in (one, two):
            assert any(OVER in text for text in visitor.html.values())
        wait_until(lambda: has_ended(process) and all(map(has_ended, engines)), "server and engines ended")
    assert not any(tmp_path.iterdir()) and not re.search("Warning|leaked", log[0]), log[0]


def test_a_tally_counts_whole_seconds(monkeypatch):
    now = 10.0
    monkeypatch.setattr(engine_links, "monotonic", lambda: now)
    tally = EventRateCounter()
    for _ in range(3):
        tally.add()
    assert tally.events_per_second == 0
    now = 11.2
    assert tally.events_per_second == 3
    tally.add()
    now = 13.0
    assert tally.events_per_second == 0  # nothing in the second before


def test_a_run_that_nobody_touches_rests(pool):
    """And says so; Play wakes it."""
    one = page.RunSession(page.PageEngineLinks(pool), SCENE, lambda report, arrays: None)
    wait_until(lambda: one.report is not None and one.idle_seconds < 60, "a frame", PATIENCE)
    one.pause_until_return()
    wait_until(lambda: not one.report.playing, "at rest", PATIENCE)
    assert one.notice().sentence.startswith("The run is paused") and one.notice().sentence.endswith("to continue.")
    one.play(True)
    wait_until(lambda: one.report.playing, "going on", PATIENCE)
    assert one.notice() is None or "rests" not in one.notice().sentence
    one.close()


def test_who_shares_the_computer_is_told(pool, monkeypatch):
    """Where a run is slower than it was asked to be because of others', the page says so, for as long as one reads."""
    one = page.RunSession(page.PageEngineLinks(pool), SCENE, lambda report, arrays: None)
    wait_until(lambda: one.report is not None and one.report.real_speed is not None, "a speed", PATIENCE)
    one.play(False)
    wait_until(lambda: not one.report.playing, "a run that stands still", PATIENCE)
    asked = one.speed * SCENE.period
    alone, shared = (type(one.report)(**{**vars(one.report), "playing": True, "real_speed": 0.5 * asked, "number": n})
                     for n in (10**6, 10**6 + 1))
    one.report = alone
    assert one.notice() is None  # slow, but nobody else is to blame
    monkeypatch.setattr(type(pool), "playing_sessions", 7)
    one.report = shared
    assert one.notice().sentence.startswith("8 runs share this computer")
    one.report = type(one.report)(**{**vars(one.report), "real_speed": asked})
    assert one.notice().sentence.startswith("8 runs share")  # it stays a while
    monkeypatch.setattr(page, "TO_BE_READ", -1.0)
    assert one.notice() is None
    one.close()
