"""What a newcomer waits for in a browser: text, then a full picture, then one that moves."""

import json
import statistics
import time
import urllib.request

from app.commands.bench.class_load import serving
from app.commands.bench.waits.checkout import Checkout, NotMeasured
from app.commands.bench.waits.chromium import Chromium, chromium
from app.commands.bench.waits.turns import Wait

VISITS = 3  # to one server after the first, each with a browser that has seen nothing yet; the middle one counts
READY = 120.0  # seconds until a server has compiled what a first visitor sees
LOOKS = 0.05  # seconds between two looks at a page
#: Looks at each picture that the browser paints: when there is text; when nothing covers the page, a sentence says what
#: is seen, and the numbers are there; when the clock on the page has gone on since then.
MARKS = """(() => {
  const marks = window.marks = {};
  const mark = (name, is) => { if (is && !(name in marks)) marks[name] = performance.now(); };
  const text = name => document.querySelector(name)?.innerText?.trim() ?? "";
  let clock = null;
  const look = () => {
    if (document.body) {
      mark("text", document.body.innerText.trim());
      const covered = document.getElementById("lab-ground")?.checkVisibility(
        {checkOpacity: true, checkVisibilityCSS: true});
      mark("picture", text("#lab-summary") && document.querySelector("canvas") && !covered
        && document.querySelector(".lab-readout")?.textContent.trim());
      const now = text("#lab-clock");
      if ("picture" in marks) { mark("moving", clock !== null && now !== clock); clock ??= now; }
    }
    requestAnimationFrame(look);
  };
  look();
})()"""
NAMES = ("text", "picture", "moving")


def page() -> Wait:
    return Wait({"full picture for a server's first visitor": "s", **{f"{what} for others": "s" for what in (
        "first text", "full picture", "moving picture")}}, _opened, warm=True)


def _opened(checkout: Checkout) -> list[float]:
    with serving("--no-warm-up", command=checkout.command) as (address, _):  # else it would compile beside them
        wait_until_ready(address)
        first, *others = (_visit(address) for _ in range(1 + VISITS))
    return [first["picture"] / 1e3, *(statistics.median(visit[name] for visit in others) / 1e3 for name in NAMES)]


def wait_until_ready(address: str) -> None:
    """Until a server's engines can run what a first visitor sees."""
    end = time.monotonic() + READY
    while time.monotonic() < end:
        with urllib.request.urlopen(f"http://{address}/health", timeout=READY) as answer:
            if json.load(answer)["ready"]:
                return
        time.sleep(LOOKS)
    raise NotMeasured(f"the server was not ready within {READY:g} s")


def _visit(address: str) -> dict[str, float]:
    """When there was what, in ms after the address was asked for."""
    with chromium() as browser:
        seen = browser.open(MARKS)
        browser.go(seen, f"http://{address}/")
        marks = _marks(browser, seen)
        browser.go(seen, "about:blank")  # its visit ends here, and not with the browser
    return marks


def _marks(browser: Chromium, seen: str) -> dict[str, float]:
    end = time.monotonic() + READY
    while time.monotonic() < end:
        marks = browser.ask(seen, "window.marks")
        if marks and all(name in marks for name in NAMES):
            return dict(marks)
        time.sleep(LOOKS)
    raise NotMeasured(f"the page did not move within {READY:g} s")
