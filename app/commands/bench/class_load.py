"""Load test of a class: many simulated visitors on a local server, and the service that each of them gets."""

import asyncio
import json
import math
import os
import random
import statistics
import subprocess
import sys
import threading
from bisect import bisect_right
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from itertools import pairwise
from time import monotonic
from typing import Any

from app.viewer.websocket_client import connect_to_page
from solvers.workers.worker_process import HOME, LINUX, descendants, free_port, processor_seconds, proportional_bytes

SCHEMA = "mpm-lab/class/1"
#: The command ``mpm-lab`` in a process of its own: this code, even if the working folder has an ``app``.
ITSELF = (sys.executable, "-c",
          "import sys; sys.path.insert(0, sys.argv.pop(1)); from app.cli import main; sys.exit(main())", str(HOME))
JOINING = 5.0  # seconds within which all connect
LATEST = 60.0  # seconds after which counting starts even if some visitors have no frame yet
PAUSES = (2.0, 6.0)  # seconds between two moves of a slider, least and most
SLIDERS = ("Cells", "Particles / cell", "Amplitude A", "Modulus E", "CFL number")  # first words of their labels
STORE, SCENE = "kept by the browser", "bar;estimators=recovered,transport"  # a run without end
GOODBYE = 10.0  # timeout of the server's shutdown in s
MEGABYTE = 1e6
FRAME = "/field/particles"  # end of the name of a node that every frame of every problem sets
BROKEN = "class='lab-notice lab-unstable'"  # marks the reason why a run has stopped
CAMERA = {"type": "ViewerCameraMessage", "wxyz": (1.0, 0.0, 0.0, 0.0), "position": (0.5, 0.5, 20.0), "fov": 0.07,
          "near": 1.0, "far": 400.0, "image_height": 640, "image_width": 760, "look_at": (0.5, 0.5, 0.0),
          "up_direction": (0.0, 1.0, 0.0)}
ON_ITS_WAY = 0.25  # seconds after a choice within which an earlier frame may still arrive


@dataclass(frozen=True)
class ClassLoadSettings:
    """Number of visitors, length of the test in s after all receive frames, seed of their random moves."""

    visitors: int
    seconds: float
    seed: int = 0


def is_frame(message: dict) -> bool:
    """Whether a message of the server has a frame's particles; axes also get points, before the first frame."""
    return message.get("name", "").endswith(FRAME) and "points" in message.get("updates", {})


@dataclass
class Control:
    """Widget sent by the server: the type of its message, and all its properties with the value."""

    kind: str
    props: dict[str, Any]


@dataclass
class Visitor:
    """Simulated visitor of the page at ``address`` (host:port). Times are of ``time.monotonic``."""

    address: str
    asked_at: float = 0.0  # time of the connection request
    frames: list[float] = field(default_factory=list)  # times of arrival
    choices: list[float] = field(default_factory=list)  # times when it has set a control
    broken: set[int] = field(default_factory=set)  # indices of frames before which the run had broken down
    notice: str = ""  # id of the text that shows so now
    controls: dict[str, Control] = field(default_factory=dict)  # by id

    async def receive_messages(self) -> None:
        """Connects to the page, and records frames and controls until either side closes the connection."""
        self.asked_at = monotonic()
        async with connect_to_page(self.address) as connection:
            self._connection = connection
            await connection.send(CAMERA)
            async for messages in connection:
                self._handle_messages(messages)

    async def set_control(self, control: str, value: Any) -> None:
        """Sets the control with this id to a value, as a visitor's browser does."""
        self.choices.append(monotonic())
        await self._connection.send({"type": "GuiUpdateMessage", "uuid": control, "updates": {"value": value}})

    def find_control(self, label: str, kind: str = "") -> str | None:
        """Returns the id of the control whose label begins so, of a kind that contains ``kind``, or None."""
        return next((number for number, control in self.controls.items()
                     if str(control.props.get("label", "")).startswith(label) and kind in control.kind), None)

    async def move_slider(self, label: str, dice: random.Random) -> None:
        """Sets the slider whose label begins so, if there is one, to a random value."""
        if number := self.find_control(label, "Slider"):
            low, high, step = (self.controls[number].props[name] for name in ("min", "max", "step"))
            steps = max(1, round((high - low) / step))
            await self.set_control(number, round(low + step * dice.randint(0, steps), 9))

    def frame_rate(self, begin: float, end: float) -> float | None:
        """Returns frames per second between two times in s, without pauses after broken runs; None if all is one."""
        seconds = sum(until - since for since, until in self._pauses(begin, end))
        seen = sum(begin <= at < end for k, at in enumerate(self.frames) if k not in self.broken)
        return seen / seconds if seconds else None

    def max_freeze(self, begin: float, end: float, own: bool = False) -> float:
        """Returns the longest pause between frames from ``begin`` to ``end`` in s: after ``own`` choices, or others."""
        def is_own(since: float, until: float) -> bool:  # by bisection: an hour has 100,000 frames and 1,000 choices
            following = bisect_right(self.choices, since - ON_ITS_WAY)
            return following < len(self.choices) and self.choices[following] < until

        return max((until - since for since, until in self._pauses(begin, end) if own == is_own(since, until)),
                   default=0.0)

    def _pauses(self, begin: float, end: float) -> list[tuple[float, float]]:
        """Returns begin and end, in s, of pauses between frames from ``begin`` to ``end``, except after breakdowns."""
        times = [-math.inf, *self.frames, math.inf]
        broken = self.broken | ({len(self.frames)} if self.notice else set())
        return [(max(earlier, begin), min(later, end)) for k, (earlier, later) in enumerate(pairwise(times))
                if later > begin and earlier < end and k not in broken]

    def _handle_messages(self, messages: list[dict[str, Any]]) -> None:
        framed = False
        for message in messages:
            match message["type"]:
                case "SceneNodeUpdateMessage":
                    framed |= is_frame(message)
                case "GuiUpdateMessage" if message["uuid"] in self.controls:
                    self.controls[message["uuid"]].props.update(message["updates"])
                    self._handle_text_update(message["uuid"], message["updates"].get("content"))
                case "GuiRemoveMessage":
                    self.controls.pop(message["uuid"], None)
                case kind if kind.startswith("Gui") and "props" in message:
                    self.controls[message["uuid"]] = Control(kind, {"value": message.get("value"), **message["props"]})
        if framed:
            if self.notice:
                self.broken.add(len(self.frames))
            self.frames.append(monotonic())

    def _handle_text_update(self, text: str, content: Any) -> None:
        """Records whether the new content of the text with this id says that the run broke down, or no more."""
        if BROKEN in str(content):
            self.notice = text
            self.broken.add(len(self.frames))
        elif content is not None and text == self.notice:  # may come before the first frame of another run
            self.broken.add(len(self.frames))
            self.notice = ""


@contextmanager
def start_server(*arguments: str) -> Iterator[tuple[str, int]]:
    """Context manager: runs ``mpm-lab serve`` with these arguments; yields its address (host:port) and process id."""
    port = free_port()
    process = subprocess.Popen([*ITSELF, "serve", "--port", str(port), *arguments], stderr=subprocess.PIPE, text=True)
    assert process.stderr
    try:
        line = process.stderr.readline()
        if not line.startswith("mpm-lab is at"):
            raise RuntimeError(f"the server did not start: {line.strip()}")
        # An unread pipe fills up, and would block the server at its next warning.
        threading.Thread(target=deque, args=(process.stderr, 0), daemon=True).start()
        yield f"127.0.0.1:{port}", process.pid
    finally:
        process.terminate()
        with suppress(subprocess.TimeoutExpired):
            process.wait(GOODBYE)
        process.kill()


def run_class_load(load: ClassLoadSettings, on_progress: Callable[[float], None]) -> dict[str, Any]:
    """Runs the load test, tells its part done (0 to 1), and returns the JSON object of :func:`load_report`."""
    with start_server("--max-sessions", str(load.visitors)) as (address, server):
        return asyncio.run(_run_visits(address, server, load, on_progress))


async def _run_visits(address: str, server: int, load: ClassLoadSettings,
                      on_progress: Callable[[float], None]) -> dict[str, Any]:
    """Runs all visits to the server with this process id; returns :func:`load_report` with its memory and work."""
    dice = random.Random(load.seed)
    visitors = [Visitor(address) for _ in range(load.visitors)]
    visits = [asyncio.create_task(_visit(visitor, random.Random(dice.random()))) for visitor in visitors]
    try:
        came = monotonic()
        while (waited := monotonic() - came) < 2 * JOINING or (waited < LATEST and not all(
                visitor.frames or visit.done() for visitor, visit in zip(visitors, visits, strict=True))):
            await asyncio.sleep(0.1)
        begin, memory, worked = monotonic(), [memory_held(server)], processor_seconds(server)
        while (done := (monotonic() - begin) / load.seconds) < 1:
            on_progress(done)
            if done > 0.5 and len(memory) == 1:
                memory.append(memory_held(server))
            await asyncio.sleep(min(1.0, load.seconds / 4, begin + load.seconds - monotonic()))
        end = monotonic()
        memory.append(memory_held(server))
        work = None if worked is None else (processor_seconds(server) or 0.0) - worked
    finally:
        for visit in visits:
            visit.cancel()
        ended = await asyncio.gather(*visits, return_exceptions=True)
    on_progress(1.0)
    lost = [str(error) for error in ended if error and not isinstance(error, asyncio.CancelledError)]
    frames = sum(begin <= at < end for visitor in visitors for at in visitor.frames)
    return {**load_report(visitors, begin, end, lost), "memory": None if None in memory else memory,
            "server_seconds_per_frame": None if work is None or not frames else work / frames}


async def _visit(visitor: Visitor, dice: random.Random) -> None:
    """Connects a visitor within ``JOINING`` s by a link to a run without end, shows the strips under its sliders, and
    moves a slider now and then; raises ConnectionError when the server ends the connection."""
    await asyncio.sleep(JOINING * dice.random())
    stay = asyncio.create_task(visitor.receive_messages())
    try:
        while not (store := visitor.find_control(STORE)) and not stay.done():
            await asyncio.wait([stay], timeout=0.05)
        if store:
            await visitor.set_control(store, json.dumps({"link": SCENE, "strips": {"seen": True}}))
        while not stay.done():
            await asyncio.wait([stay], timeout=dice.uniform(*PAUSES))
            if visitor.frames and not stay.done():
                await visitor.move_slider(dice.choice(SLIDERS), dice)
        await stay  # with the reason why it ended
        raise ConnectionError("the server has closed a connection")
    finally:
        stay.cancel()


def memory_held(server: int) -> dict[str, int] | None:
    """Returns bytes of memory of the process ``server``, and of all its ``engines``, shared ones once; or None."""
    if not LINUX:
        return None
    engines = sum(proportional_bytes(process) for process in descendants(server))
    return {"server": proportional_bytes(server), "engines": engines}


def load_report(visitors: list[Visitor], begin: float, end: float, lost: list[str]) -> dict[str, Any]:
    """Returns, for JSON, what visitors got between two times in s: frames per second, seconds until the first and
    longest pauses; ``lost`` has a reason for each visit that ended by itself."""
    rates = sorted(rate for visitor in visitors if (rate := visitor.frame_rate(begin, end)) is not None) or [0.0]
    joined = sorted(visitor.frames[0] - visitor.asked_at for visitor in visitors if visitor.frames)
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else None
    return {"schema": SCHEMA, "visitors": len(visitors), "seconds": end - begin, "cores": os.cpu_count(), "load": load,
            "moving": len(joined), "joined_median": statistics.median(joined) if joined else None,
            "joined_95": joined[max(0, round(0.95 * len(joined)) - 1)] if joined else None,
            "frames_median": statistics.median(rates), "frames_slowest": rates[0],
            "slowest_of_median": rates[0] / statistics.median(rates) if rates[-1] else None,
            "standstill_longest": max(visitor.max_freeze(begin, end) for visitor in visitors),
            "standstill_own_longest": max(visitor.max_freeze(begin, end, own=True) for visitor in visitors),
            "lost": lost}


def class_load_table(found: dict[str, Any], /) -> str:
    """Returns the text for the JSON object of :func:`run_class_load`."""
    def seconds(value: float | None) -> str:
        return "none" if value is None else f"{value:.1f} s"

    lines = [f"{found['visitors']} visitors for {found['seconds']:.0f} s on {found['cores']} processors "
             f"(load {found['load']:.1f}), each moving a slider now and then; while runs go on:",
             f"  a moving picture       {found['moving']} of {found['visitors']}; half of them after "
             f"{seconds(found['joined_median'])}, 95 % after {seconds(found['joined_95'])}",
             f"  frames a second each   {found['frames_median']:.1f} (median), {found['frames_slowest']:.1f} (slowest)",
             f"  longest standstill     {seconds(found['standstill_longest'])}; "
             f"{seconds(found['standstill_own_longest'])} after a visitor's own choice",
             f"  connections lost       {len(found['lost'])}" + "".join(f"; {reason}" for reason in found["lost"][:3])]
    if work := found["server_seconds_per_frame"]:
        lines.append(f"  the server's own work  {1e3 * work:.2f} ms of a processor for each frame of each visitor")
    if memory := found["memory"]:
        rooms = (f"{name} " + ", ".join(f"{moment[name] / MEGABYTE:.0f}" for moment in memory)
                 for name in ("server", "engines"))
        lines.append(f"  megabytes held         {'; '.join(rooms)} (at first, half way, at last)")
    return "\n".join(lines)
