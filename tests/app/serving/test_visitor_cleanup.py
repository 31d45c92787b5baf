"""What goes wrong for one visitor is one line of log. Nothing of one who has gone stays, or is done for one who takes
nothing."""

import gc
import logging
import re
import threading
import warnings
import weakref
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from itertools import count, takewhile
from types import SimpleNamespace

import numpy as np
from viser import _threadpool_exceptions

from app.access.network_limits import DiskQuota
from app.access.rate_limited_log import RateLimitFilter, error_location
from app.page import page
from app.page.stage.worst_region import WorstRegions
from app.page.visit.engine_links import PageEngineLinks
from app.viewer import upload, viser_patches
from solvers.problems.bar.scene import BarScene
from solvers.solver import soundness
from tests.app.serving.test_serve import Pool
from tests.support import page_server
from tests.support.page_server import http_get
from tests.support.processes import wait_until
from tests.support.raw_client import RawClient

SECRET = "what a stranger has written"


def fail(*_):
    raise ValueError(SECRET)


def test_what_fails_in_a_callback_is_one_line(capfd, caplog, monkeypatch):
    """Of the viewer's threads and of its loop: the kind of the error and its place, and nothing of what was said."""
    for name in ("traceback", "print"):
        monkeypatch.setattr(_threadpool_exceptions, name, None, raising=False)  # put back afterwards
    viser_patches.log_callback_failures()
    with ThreadPoolExecutor(1) as thread:
        thread.submit(fail).add_done_callback(_threadpool_exceptions.print_threadpool_errors)
    try:
        fail()
    except ValueError as error:
        viser_patches.log_loop_failure(None, {"message": SECRET, "exception": error})
    lines = [record.getMessage() for record in caplog.records]
    place = f"ValueError in test_visitor_cleanup.py, line {fail.__code__.co_firstlineno + 1}"
    assert len(lines) == 2 and all(line.endswith(place) for line in lines), lines
    assert error_location(KeyError(SECRET)) == "KeyError"  # without a trace
    assert SECRET not in caplog.text and "Traceback" not in caplog.text and capfd.readouterr() == ("", "")


def test_a_log_has_few_lines_a_minute_whoever_writes():
    """And the first of the next one says how many there were more."""
    brief = RateLimitFilter(lines=3, seconds=0.3)
    said = [logging.LogRecord("x", logging.ERROR, "", 0, f"line {k}", (), None) for k in range(50)]
    assert sum(map(brief.filter, said)) == 3
    threading.Event().wait(0.35)
    more = logging.LogRecord("x", logging.ERROR, "", 0, "line %d", (50,), None)
    assert brief.filter(more) and more.getMessage() == "(47 more lines were left out) line 50"


def test_a_page_that_has_gone_keeps_no_line():
    """Neither those that it had nor one that it opens on its way; and it forgets those that are closed meanwhile."""
    links = PageEngineLinks(pool := Pool())
    first, second = links.open(None), links.open(None)
    gone = weakref.ref(second)
    pool.links.clear()
    second.close()
    del second
    gc.collect()
    assert gone() is None and not first.closed
    links.close()
    assert first.closed and links.open(None).closed
    links.close()


def test_room_is_shared_out():
    """A network has its part and no more, all together have no more than there is; what is given back is there."""
    room = DiskQuota(of_one=10, of_all=25)
    assert room.reserve("10.0.0.1", 6) and not room.reserve("10.0.0.2", 6) and room.reserve("10.0.0.2", 4)
    assert room.reserve("10.0.1.1", 10) and not room.reserve("10.0.2.1",
                                                             6) and room.reserve("10.0.2.1", 5) and room.used == 25
    room.release("10.0.0.9", 6)
    assert room.used == 19 and room.reserve("10.0.0.1", 6) and not room.reserve("10.0.0.1", 1)


def an_upload(arrived, refused):
    gui = SimpleNamespace(_websock_interface=SimpleNamespace(queue_message=lambda _: None))
    button = SimpleNamespace(_impl=SimpleNamespace(uuid="box"))
    one = upload.VisitorUploads(gui, button, lambda name, path: arrived.append(path), refused.append)
    assert start(one, 3) == "a file for nobody"  # before all is there that it is for
    one.open()
    return one


def start(one, size, transfer="t", who="10.0.0.1"):
    return one.handle_message(upload.START, {"transfer_uuid": transfer, "filename": "mine.csv", "size_bytes": size,
                                     "part_count": -(-size // upload.PART_BYTES)}, who)


def part(one, content, index=0, transfer="t"):
    return one.handle_message(upload.PART, {"transfer_uuid": transfer, "part_index": index, "content": content})


def test_files_take_room_until_their_visitor_goes(monkeypatch):
    """Those that came, that which comes, and that which got stuck; the folder goes though somebody still writes."""
    room, arrived, refused = DiskQuota(3_000_000, 5_000_000), [], []
    monkeypatch.setattr(upload, "ROOM", room)
    one, other = an_upload(arrived, refused), an_upload(arrived, refused)
    assert start(one, 3) is None and part(one, b"abc") is None and arrived and room.used == 3
    assert start(one, 2_000_000, "t2") is None and room.used == 2_000_003
    assert "no room" in start(other, 2_000_000) and refused == [upload.NO_ROOM]
    assert start(other, 2_000_000, who="10.9.9.9") is None  # of another network
    assert "on its way" in start(one, 5, "t3")
    monkeypatch.setattr(upload, "STUCK", 0.0)
    assert start(one, 5, "t3") is None and room.used == 2_000_008 and part(one, b"abcde", 0, "t3") is None
    assert room.used == 2_000_005  # the newer file is there in place of the older one
    folders, over = [one.folder, other.folder], threading.Event()

    def write():
        with suppress(OSError):  # the folder has gone
            for k in takewhile(lambda _: not over.is_set(), count()):
                (folders[0] / f"table-{k}").write_text("x")

    writer = threading.Thread(target=write)
    writer.start()
    for each in (one, other):
        each.close()
        assert start(each, 3) == "a file for nobody"
    threading.Timer(0.3, over.set).start()  # as a process that is killed
    one.delete_files()
    other.delete_files()
    writer.join()
    one.delete_files()
    assert not any(folder.exists() for folder in folders) and room.used == 0


def test_a_run_gone_bad_is_no_warning():
    """Positions, and errors, that are no numbers any more."""
    scene = BarScene(cells=4)
    bad = np.full((scene.particles, 1), np.inf)
    view = SimpleNamespace(estimated=bad[:, 0], true=np.full(scene.particles, np.nan), left=SimpleNamespace(sizes=None))
    arrays = SimpleNamespace(position=bad, displacement=bad)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        WorstRegions().find(SimpleNamespace(scene=scene, status=soundness.UNSTABLE), arrays, view, "x")


def test_nothing_is_asked_for_while_the_browser_takes_nothing(here, monkeypatch):
    """And again from then on when it does; what the browser says of who looks at it holds all the same."""
    asked, still = [], [0.0]
    monkeypatch.setattr(page_server.SilentLink, "ask", lambda link, scene, pace,
                        frame: asked.append(pace.playing) or len(asked))
    monkeypatch.setattr(page, "stalled_seconds", lambda client: still[0])
    with RawClient(here[1]) as visitor:
        visitor.find("Download CSV")
        token = next(found[1] for text in visitor.html.values() if (found := re.search("data-visitor='([^']*)'", text)))
        wait_until(lambda: asked[-1], "a run that moves")
        still[0] = 3.0
        wait_until(lambda: not asked[-1], "it rests")
        http_get(here[1], f"/away/{token}")
        still[0] = 0.0
        http_get(here[1], f"/here/{token}")
        wait_until(lambda: asked[-1], "it goes on")
