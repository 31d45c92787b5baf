"""What the page says on its many threads it says in its visitor's language, also where visitors of two are here at
once: on those of widgets, of the refresh, of a typed number that waits, of a file's way, of jobs, of engines, and at
the end."""

import re
import threading
from concurrent.futures import Future
from html import unescape
from types import SimpleNamespace

import pytest

from app.language.translation import tr, use_language, with_language
from app.page.features import background_job
from app.page.features.budget.jobs import BudgetJobs
from app.page.page_server import OVER, Visitors
from app.page.visit.engine_links import PageEngineLinks
from app.page.visit.first_scene import first_scene
from app.page.visit.run_session import RunSession
from app.viewer.upload import TOO_LARGE
from solvers.workers.worker_pool import Slots
from solvers.workers.worker_process import ProcessDied
from tests.app.page.features.test_upload import Sender
from tests.support import page_server
from tests.support.processes import wait_until
from tests.support.raw_client import RawClient

CODES = ("de", "en")


def on_a_thread(work, *args):
    """Do this where nobody speaks any language."""
    thread = threading.Thread(target=work, args=args)
    thread.start()
    thread.join()


@pytest.fixture(scope="module")
def visitors():
    """One who reads German and one who reads English, with what each is to read: made at once, on two threads."""
    with page_server.start_server() as (_, address):
        both = [RawClient(f"{address}/?lang={code}") for code in CODES]
        yield dict(zip(CODES, both, strict=True))
        for visitor in both:
            visitor.close()


def label(code, text, **values):
    with use_language(code):
        return tr(text, **values)


def reads(visitor, pattern):
    return any(re.search(pattern, unescape(text)) for text in dict(visitor.html).values())


def test_a_refusal_is_in_the_language_of_the_hand_that_typed(visitors):
    """It is found on the thread of a message, and shown on the refresh's, where both visitors' words are made side
    by side."""
    boxes = {code: visitor.find(label(code, "{name}, typed", name=label(code, "Modulus E")))
             for code, visitor in visitors.items()}
    visitors["de"].find(label("de", "Tolerance"))
    assert not {"Auto step", "Tolerance", "Pin this run"} & visitors["de"]._labels().keys()
    refused = {"de": "E-Modul E: „much“ ist keine Zahl über 0 in Pa",
               "en": "Modulus E: 'much' is not a number above 0 in Pa"}
    for code, visitor in visitors.items():
        visitor.enter(boxes[code], "much", label(code, "kept by the browser"))
    for code, visitor in visitors.items():
        wait_until(lambda v=visitor, c=code: reads(v, refused[c]), refused[code])
    other = {"de": "is not a number", "en": "ist keine Zahl"}
    assert not any(reads(visitor, other[code]) for code, visitor in visitors.items())


def test_a_file_is_refused_on_the_web_servers_own_thread(visitors):
    for code, visitor in visitors.items():
        sender = Sender.__new__(Sender)
        sender.visitor, sender.box = visitor, visitor.find(label(code, "file of particles"))
        sender.start(10**9)
        wait_until(lambda v=visitor, c=code: reads(v, re.escape(label(c, TOO_LARGE))), f"a refusal in {code}")
    assert not reads(visitors["de"], "<p>The file is larger")


class Pool(page_server.SilentPool):
    """Keeps who listens, and has a job's words: a test says from another thread what a process would."""

    lower_priority = close = lambda self: None

    def submit(self, question, hear, patience):
        self.future, self.tell = Future(), hear
        return self.future

    def open_session(self, listener, beside=None):
        self.listener = listener
        return page_server.SilentLink()


@pytest.mark.parametrize(("code", "bad", "died"), [
    ("de", "der Lauf wird schlecht: boom", "der Hintergrundprozess was closed"),
    ("en", "the run goes bad: boom", "the background process was closed")])
def test_what_becomes_of_a_job(monkeypatch, code, bad, died):
    pool, jobs = Pool(), BudgetJobs(Slots(1))
    monkeypatch.setattr(background_job, "WorkerPool", lambda _: pool)
    with use_language(code):
        jobs.start_budget(first_scene("ring"))
    on_a_thread(pool.tell, {"bad": "boom"})
    assert jobs.status.trouble == bad
    on_a_thread(pool.future.set_result, {})
    assert not jobs.status.running and jobs.status.trouble == bad
    with use_language(code):
        jobs.start_budget(first_scene("ring"))
    on_a_thread(pool.future.set_exception, ProcessDied("was closed"))
    assert jobs.status.trouble == died


def test_what_an_engine_says_is_heard_in_the_language_of_its_line():
    for code, news in (("de", "unerwartet zu Ende gegangen; ein anderer"), ("en", "ended unexpectedly; another one")):
        pool = Pool()
        with use_language(code):
            session = RunSession(PageEngineLinks(pool), first_scene("bar"), lambda *_: None)
        on_a_thread(pool.listener.on_engine_lost)
        assert news in session._news[1]


def test_a_goodbye_is_everyones_own():
    """Said on threads that the server starts when it ends."""
    told = []
    pages = {one: SimpleNamespace(client=SimpleNamespace(client_id=k, flush=lambda: None), language=one,
                                  stop_output=lambda: None, close=lambda: None) for k, one in enumerate(CODES)}
    house = Visitors(page_server.SilentPool(), 2, lambda client, _: pages[CODES[client.client_id]],
                     lambda client, text: told.append((CODES[client.client_id], text)))
    for page in pages.values():
        with_language(house.connect, page.language)(page.client)
    for thread in house.close_all_pages():
        thread.join()
    assert sorted(told) == [(code, label(code, OVER)) for code in CODES]
