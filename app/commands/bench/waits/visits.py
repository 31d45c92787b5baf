"""What visitors wait for on a server: a search's first and last answer, and the frames of a class of thirty."""

import asyncio
import json
from functools import partial
from time import monotonic
from typing import Any

from app.commands.bench.class_load import STORE, Load, Visitor, class_load, serving
from app.commands.bench.waits.checkout import Checkout, NotMeasured
from app.commands.bench.waits.page import wait_until_ready
from app.commands.bench.waits.turns import Wait

SCENE = "bar;cells=20"  # the search is for its problem, whatever the rest
TOLERANCES = ("1e-2", "1e-4")
TOLERANCE, BUTTON, TAKE = "Tolerance / A", "Find the cheapest run", "Load this scene"  # beginnings of labels
ANSWERED = "lab-cost-says", "<strong>"  # in the headline, once a run that was timed alone is accurate enough
READS = 2.0  # seconds for which a visitor looks at the Cost tab before he presses
LOOKS, PATIENCE = 0.01, 180.0
STUDENTS, QUICK_SECONDS, SECONDS = 30, 10.0, 30.0
CLASS = {"frames of thirty, median": "frames/s", "frames of thirty, slowest": "frames/s",
         "slowest of thirty over median": "frames", "the server's work, a frame of one of thirty": "ms"}


def searches() -> list[Wait]:
    """On a server that nobody has asked yet."""
    return [Wait({f"{what} on the page, {tolerance}": "s" for what in ("first answer of a search", "whole search")},
                 partial(_searched, tolerance)) for tolerance in TOLERANCES]


def thirty(quick: bool) -> Wait:
    return Wait(CLASS, partial(_class, QUICK_SECONDS if quick else SECONDS), warm=True)


def _class(seconds: float, checkout: Checkout) -> list[float]:
    found = class_load(Load(STUDENTS, seconds), lambda done: None, checkout.command)
    if found["lost"]:
        raise NotMeasured(f"visitors were lost: {found['lost'][0]}")
    work = found["server_seconds_per_frame"]
    return [found["frames_median"], found["frames_slowest"], found["slowest_of_median"],
            float("nan") if work is None else 1e3 * work]


def _searched(tolerance: str, checkout: Checkout) -> list[float]:
    with serving("--no-warm-up", command=checkout.command) as (address, _):  # it has been there for a while
        wait_until_ready(address)
        return asyncio.run(_search(address, tolerance))


async def _search(address: str, tolerance: str) -> list[float]:
    """Seconds from the press to the first answer that is good enough, and to the last one."""
    visitor = Visitor(address)
    stay = asyncio.create_task(visitor.stay())
    try:
        await visitor.move(await _found(visitor, STORE, stay), json.dumps({"link": SCENE}))
        await _until(lambda: visitor.frames, stay)
        await visitor.move(visitor.find(STORE) or "", json.dumps({"cost": True}))  # as the page says of its tab
        await visitor.move(await _found(visitor, TOLERANCE, stay), tolerance)
        button = await _found(visitor, BUTTON, stay)
        take = visitor.controls[await _found(visitor, TAKE, stay)]
        await asyncio.sleep(READS)
        pressed = monotonic()
        await visitor.move(button, True)
        await _until(lambda: visitor.says(*ANSWERED), stay)
        first = monotonic() - pressed
        await _until(lambda: take.props["visible"], stay)
        return [first, monotonic() - pressed]
    finally:
        stay.cancel()


async def _found(visitor: Visitor, label: str, stay: Any) -> str:
    await _until(lambda: visitor.find(label), stay)
    return str(visitor.find(label))


async def _until(condition: Any, stay: Any) -> None:
    end = monotonic() + PATIENCE
    while not condition():
        if stay.done() or monotonic() > end:
            raise NotMeasured("the server has closed the connection" if stay.done() else
                              f"nothing was said for {PATIENCE:g} s")
        await asyncio.sleep(LOOKS)
