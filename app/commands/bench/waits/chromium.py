"""A browser without a window that is told what to do: Chromium's DevTools protocol, over a pipe.

Playwright would be more than is wanted here and is not for users; what is asked of a browser is to open an address and
to say what a page has come to.
"""

import json
import os
import select
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

from app.commands.bench.waits.checkout import NotMeasured

NAMES = ("chromium", "chromium-browser", "google-chrome")
#: Without a sandbox root may start it, too; it opens nothing but our own page. It draws in software, as without a GPU.
FLAGS = ("--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
         "--no-first-run", "--window-size=1280,720", "--remote-debugging-pipe")
PATIENCE = 60.0  # seconds for an answer
GOODBYE = 10.0
#: A Chromium reads commands from its descriptor 3 and answers to 4; which may be what it is given, the other way round.
START = """import fcntl, os, sys
apart = [fcntl.fcntl(int(one), fcntl.F_DUPFD, 10) for one in sys.argv[1:3]]
[os.dup2(one, other) for one, other in zip(apart, (3, 4))]
os.execv(sys.argv[3], sys.argv[3:])"""


class Chromium:
    """One that runs; made by :func:`chromium`."""

    def __init__(self, reads: int, writes: int):
        self._reads, self._writes, self._rest, self._count = reads, writes, b"", 0

    def open(self, script: str) -> str:
        """A new empty page, which runs ``script`` before its own; gives what :meth:`ask` and :meth:`go` know it by."""
        target = self._call("Target.createTarget", {"url": "about:blank"})["targetId"]
        session = str(self._call("Target.attachToTarget", {"targetId": target, "flatten": True})["sessionId"])
        self._call("Page.enable", {}, session)
        self._call("Page.addScriptToEvaluateOnNewDocument", {"source": script}, session)
        return session

    def go(self, page: str, address: str) -> None:
        """Have a page load an address; does not wait for it."""
        self._call("Page.navigate", {"url": address}, page)

    def ask(self, page: str, expression: str) -> Any:
        """What an expression is in the page."""
        answer = self._call("Runtime.evaluate", {"expression": expression, "returnByValue": True}, page)
        return answer.get("result", {}).get("value")

    def _call(self, method: str, params: dict[str, Any], session: str = "") -> dict[str, Any]:
        self._count += 1
        message = {"id": self._count, "method": method, "params": params, **({"sessionId": session} if session else {})}
        try:
            os.write(self._writes, json.dumps(message).encode() + b"\0")
        except OSError:
            raise NotMeasured("the browser has ended") from None
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            for said in self._heard(end):
                if said.get("id") == self._count:
                    if "error" in said:
                        raise NotMeasured(f"the browser refused {method}: {said['error'].get('message')}")
                    return dict(said["result"])
        raise NotMeasured("the browser gave no answer")

    def _heard(self, end: float) -> list[dict[str, Any]]:
        """What the browser says next."""
        if not select.select([self._reads], [], [], max(0.0, end - time.monotonic()))[0]:
            return []
        if not (more := os.read(self._reads, 1 << 16)):
            raise NotMeasured("the browser has ended")
        *whole, self._rest = (self._rest + more).split(b"\0")
        return [json.loads(text) for text in whole]


@contextmanager
def chromium() -> Iterator[Chromium]:
    """A browser that has seen nothing yet. Raises :class:`NotMeasured` where there is none."""
    path = next(filter(None, map(shutil.which, NAMES)), None)
    if path is None or os.name == "nt":
        raise NotMeasured(f"no browser was found ({', '.join(NAMES)})")
    (reads, its_writing), (its_reading, writes) = os.pipe(), os.pipe()
    command = (sys.executable, "-c", START, str(its_reading), str(its_writing))
    with tempfile.TemporaryDirectory(prefix="mpm-lab-browser-", ignore_cleanup_errors=True) as profile:
        process = subprocess.Popen([*command, path, *FLAGS, f"--user-data-dir={profile}"], stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                   pass_fds=(its_reading, its_writing))
        try:
            os.close(its_reading)
            os.close(its_writing)
            yield Chromium(reads, writes)
        finally:
            for end in (reads, writes):
                os.close(end)
            with suppress(subprocess.TimeoutExpired):
                process.wait(GOODBYE)  # it ends when nobody speaks to it any more
            process.kill()
            process.wait()
