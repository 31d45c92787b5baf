"""The real server in a process of its own, and a real Chromium that looks at it."""

from __future__ import annotations

import os
import re
import shutil
import signal
import socket
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import pytest
from playwright.sync_api import sync_playwright

from tests.browser.driving import PATIENCE
from tests.processes import HANG, STARVED, until

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
# Software rendering, and none of the browser's own traffic: pages are served from this machine only.
FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
         "--disable-gpu-compositing",  # by the renderer: a third of the time, which the processors that simulate spend
         "--disable-features=PreloadTopChromeWebUI",  # of a browser's own window: a renderer more
         "--disable-background-networking", "--disable-component-update", "--disable-sync", "--no-first-run"]
# However cheap a picture is, the browser would draw as many as it can, beside the simulation: a few a second will do.
FEW_FRAMES = """
    const soon = window.requestAnimationFrame.bind(window);
    window.requestAnimationFrame = (draw) => setTimeout(() => soon(draw), 300);
    window.cancelAnimationFrame = (waiting) => clearTimeout(waiting);
    // The stage has half the pixels in each direction: enlarged as they are, they keep their colours.
    addEventListener("DOMContentLoaded", () => document.head.insertAdjacentHTML(
        "beforeend", "<style>canvas { image-rendering: pixelated; }</style>"));
"""
HOW = "no Chromium or Chrome found: install one (Debian: apt-get install chromium) to run the browser tests"


def _browser() -> str:
    for name in BROWSERS:
        if path := shutil.which(name):
            return path
    if os.environ.get("CI"):
        pytest.fail(HOW)
    pytest.skip(HOW)


@contextmanager
def serving(environment=None, arguments=(), coded=False, log=None):
    """Address and process id of a page served by the command line itself, with further ``arguments``, and where it is
    ``coded`` also the line that says the class code; ``log`` is extended by what it says later. Nothing is compiled
    unasked: the tests need the processor."""
    with socket.socket() as trial:
        trial.bind(("127.0.0.1", 0))
        port = str(trial.getsockname()[1])
    command = [sys.executable, "-m", "app", "serve", "--port", port, "--no-warm-up", *arguments]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, cwd=Path(__file__).parents[2],
                               env={**os.environ, **(environment or {})})
    line = process.stderr.readline()
    found = re.search(r"http://\S+", line)
    assert found, f"the server said: {line}"
    try:
        yield (found[0], process.pid, process.stderr.readline()) if coded else (found[0], process.pid)
    finally:
        process.send_signal(signal.SIGINT)
        assert process.wait(HANG) in (0, 130)
        said = process.stderr.read()
        if log is not None:
            log.append(said)
        assert "Traceback" not in said
        process.stderr.close()


@contextmanager
def visit(chromium, address, query="", script=""):
    """A fresh visitor at 1280x720, with more in the address, and a script that runs before the page's.

    Any error in the browser's console fails the test.
    """
    page = chromium.new_page(viewport={"width": 1280, "height": 720})
    # The driver's own waits know the wall clock only: they may take what ``until`` may take at most.
    page.set_default_timeout(1e3 * STARVED * PATIENCE)
    errors = []
    page.on("console", lambda message: errors.append(message.text) if message.type == "error" else None)
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.add_init_script(FEW_FRAMES + script)
    try:
        page.goto(f"{address}/?fixedDpr=0.5{query}")
        until(page.locator(".lab-readout", has_text="periods").count, "the first numbers")
        yield page
    finally:
        page.close()  # one that stayed would go on drawing, beside all tests that follow
    assert errors == []


@pytest.fixture(scope="package")
def server():
    log = []
    with serving(log=log) as one:
        yield one
    assert "refused" not in log[0], f"what a browser says must come through: {log[0]}"


@pytest.fixture(scope="package")
def chromium():
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=_browser(), args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture
def page(server, chromium):
    with visit(chromium, server[0]) as page:
        yield page
