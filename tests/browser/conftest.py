"""The real server in a process of its own, and a real Chromium that looks at it."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import sys
from contextlib import ExitStack, closing, contextmanager, suppress
from dataclasses import asdict

import pytest

from app import shareable_state
from app.page.visit.first_scene import first_scene
from solvers.workers.worker_process import free_port
from tests.browser.driving import PATIENCE
from tests.browser.relay import Relay
from tests.groups import require_group
from tests.support.paths import ROOT
from tests.support.processes import HANG, STARVED, wait_until

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
# Software rendering, and none of the browser's own traffic: pages are served from this machine only.
FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
         "--disable-gpu-compositing",  # by the renderer: a third of the time, which the processors that simulate spend
         "--disable-features=PreloadTopChromeWebUI",  # of a browser's own window: a renderer more
         "--disable-background-networking", "--disable-component-update", "--disable-sync", "--no-first-run"]
# However cheap a picture is, the browser would draw as many as it can, beside the simulation. The page takes in what
# has come as often as it draws, so it is let do both a few times a second, and what it draws comes to nothing but once.
FEW_FRAMES = """
    const soon = window.requestAnimationFrame.bind(window);
    let frame = 0, drawn = 0;  // times: of this frame, and of the last one that was drawn
    window.requestAnimationFrame = (draw) => setTimeout(() => soon((now) => draw(frame = now)), 300);
    window.cancelAnimationFrame = (waiting) => clearTimeout(waiting);
    for (const name of ["clear", "drawArrays", "drawArraysInstanced", "drawElements", "drawElementsInstanced"]) {
        const usual = WebGL2RenderingContext.prototype[name];
        WebGL2RenderingContext.prototype[name] = function (...what) {
            if (frame !== drawn && frame - drawn < 900) return;
            drawn = frame;
            usual.apply(this, what);
        };
    }
    // The stage has half the pixels in each direction: enlarged as they are, they keep their colours.
    addEventListener("DOMContentLoaded", () => document.head.insertAdjacentHTML(
        "beforeend", "<style>canvas { image-rendering: pixelated; }</style>"));
"""
FEW = 10  # frames a second
SIZE = {"width": 1280, "height": 720}
PHONE = {"width": 390, "height": 844}
FIRST_SCENE = first_scene("bar")
#: A link: who comes without one sees the opening and its story.
HOME = f"#{shareable_state.write_state(shareable_state.State(FIRST_SCENE))}"
FAILED = pytest.StashKey[bool]()
HOW = "no Chromium or Chrome found: install one (Debian: apt-get install chromium) to run the browser tests"


def at_home(page) -> bool:
    """Whether the scene that runs is that of the link: a page has the opening's until it has been told."""
    said = page.locator(".lab-scene").get_attribute("data-scene")
    return json.loads(said) == json.loads(json.dumps(asdict(FIRST_SCENE)))


def _browser() -> str:
    for name in BROWSERS:
        if path := shutil.which(name):
            return path
    if os.environ.get("CI"):
        pytest.fail(HOW)
    pytest.skip(HOW)


@contextmanager
def serving(environment=None, arguments=(), coded=0, log=None, frames=FEW):
    """Address and process id of a page served by the command line itself, with further ``arguments``, and where it is
    ``coded`` also so many lines that say its codes; ``log`` is extended by what it says later. Nothing is compiled
    unasked, and few ``frames`` a second come: the tests need the processors."""
    command = [sys.executable, "-m", "app", "serve", "--port", str(free_port()), "--no-warm-up",
               "--frames", str(frames), *arguments]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, cwd=ROOT,
                               env={**os.environ, **(environment or {})})
    line = process.stderr.readline()
    found = re.search(r"http://\S+", line)
    assert found, f"the server said: {line}"
    try:
        codes = "".join(process.stderr.readline() for _ in range(coded))
        yield (found[0], process.pid, codes) if coded else (found[0], process.pid)
    finally:
        process.send_signal(signal.SIGINT)
        assert process.wait(HANG) in (0, 130)
        said = process.stderr.read()
        if log is not None:
            log.append(said)
        assert "Traceback" not in said
        process.stderr.close()


@contextmanager
def no_errors(page):
    """Any error in the browser's console fails the test."""
    errors = []
    page.on("console", lambda message: errors.append(message.text) if message.type == "error" else None)
    page.on("pageerror", lambda error: errors.append(str(error)))
    yield
    assert errors == []


@contextmanager
def visit(chromium, address, query="", script="", size=SIZE, touch=False, **how):
    """A fresh visitor with a window of this size, more in the address, and a script that runs before the page's; with a
    finger instead of a mouse, perhaps, and whatever else a new page of the driver's takes.

    Any error in the browser's console fails the test.
    """
    page = chromium.new_page(viewport=size, has_touch=touch, is_mobile=touch, **how)
    # The driver's own waits know the wall clock only: they may take what ``wait_until`` may take at most.
    page.set_default_timeout(1e3 * STARVED * PATIENCE)
    page.add_init_script(FEW_FRAMES + script)
    with no_errors(page), closing(page):  # one that stayed would go on drawing, beside all tests that follow
        page.goto(f"{address}/?fixedDpr=0.5{query}" + ("" if "#" in query else HOME))
        wait_until(page.locator(".lab-readout", has_text="periods").count, "the first numbers")
        if "#" not in query:
            # Three kinds of run may have to be compiled one after the other, the opening's two first.
            wait_until(lambda: at_home(page), "the link's scene in place of the opening's", 3 * PATIENCE)
        yield page


def axe_finds(page):
    """What axe, the checker of accessibility, finds wrong with the page."""
    from axe_playwright_python.sync_playwright import Axe

    return Axe().run(page).response["violations"]


@pytest.fixture(scope="package")
def server(chromium):
    """The page's address and process id; where there is no browser, nothing is served."""
    log = []
    with serving(log=log) as one:
        yield one
    assert "refused" not in log[0], f"what a browser says must come through: {log[0]}"


@pytest.fixture(scope="package")
def chromium():
    require_group("browser")
    from playwright.sync_api import sync_playwright  # here: files without a browser import this one, too

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=_browser(), args=FLAGS)
        yield browser
        browser.close()


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item, call):
    """Remember of each test whether it failed, for the fixture below."""
    report = (yield).get_result()
    item.stash[FAILED] = item.stash.get(FAILED, False) or report.failed


class Place:
    """A place in front of the page, at which one visitor after another sits down. To load the page costs a browser some
    seconds of a processor: so the lines are cut instead, the browser comes back by itself, and for the server that is a
    visitor who has just come."""

    def __init__(self, chromium, server):
        self._chromium, self._relay = chromium, Relay(int(server[0].rpartition(":")[2]))
        self._open = ExitStack()
        self._page = None

    def sit_down(self):
        """The page of a visitor who has just come."""
        if self._page is not None:
            self._take_over(self._page)
            with suppress(AssertionError):
                wait_until(lambda: at_home(self._page), "the link's scene in place of the opening's", 8.0)
                return self._page
            self.tidy()
        self._page = self._open.enter_context(visit(self._chromium, self._relay.address))
        return self._page

    def _take_over(self, page):
        page.set_viewport_size(SIZE)
        page.mouse.move(0, 0)
        page.get_by_role("tab", name="Explore").click()  # the browser keeps the choice of a tab
        before = page.get_by_label("Problem", exact=True).get_attribute("id")
        page.evaluate("localStorage.clear()")
        self._relay.cut()
        page.evaluate(f"history.replaceState(null, '', location.pathname + location.search + '{HOME}');"
                      "dispatchEvent(new HashChangeEvent('hashchange'))")  # else it asks for what it has seen last
        problem = page.get_by_label("Problem", exact=True)
        wait_until(lambda: problem.count() == 1 and problem.get_attribute("id") != before, "controls of its own")
        wait_until(page.locator(".lab-readout", has_text="periods").count, "the first numbers")

    def tidy(self):
        """What a failed test has left is nothing to go on from."""
        self._page = None
        with self._open.pop_all():
            pass

    def close(self):
        self._open.close()
        self._relay.close()


@pytest.fixture(scope="package")
def place(server, chromium):
    with closing(Place(chromium, server)) as place:
        yield place


@pytest.fixture
def page(place, request):
    """The page as it is at first, in a browser that may have seen other visitors before."""
    try:
        yield place.sit_down()
    finally:
        if request.node.stash.get(FAILED, True):
            place.tidy()


@pytest.fixture
def own_page(server, chromium):
    """For a test that leaves traces in the browser: a page that is loaded for it alone."""
    with visit(chromium, server[0]) as page:
        yield page
