"""A class at work: many visitors without a browser on a server of this machine, and what each of them gets."""

import asyncio
import os
import random
import signal
import statistics
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from time import monotonic
from typing import Any

from app.commands.bench.visitor import Visitor
from solvers.workers.processes import LINUX, descendants, free_port, proportional_bytes

SCHEMA = "mpm-lab/class/1"
JOINING = 5.0  # seconds within which all come
LATEST = 60.0  # seconds after which frames are counted though some have had none yet: a machine can be that busy
PAUSES = (2.0, 6.0)  # seconds between two moves of a slider, least and most
SLIDERS = ("Cells", "Particles / cell", "Amplitude A", "Modulus E", "CFL number")  # beginnings of their labels
GOODBYE = 10.0  # seconds that the server may take to end
MEGABYTE = 1e6


@dataclass(frozen=True)
class Load:
    """How many come and how long they stay, in s, once all have come and see a moving picture."""

    visitors: int
    seconds: float
    seed: int = 0


@contextmanager
def serving(*arguments: str) -> Iterator[tuple[str, int]]:
    """A server of the page in a process of its own: its address (host:port) and the number of the process."""
    port = free_port()
    command = [sys.executable, "-m", "app", "serve", "--port", str(port), *arguments]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    assert process.stderr
    try:
        line = process.stderr.readline()
        if not line.startswith("mpm-lab is at"):
            raise RuntimeError(f"the server did not start: {line.strip()}")
        # A pipe that nobody reads fills up, and the server would stand still at its next warning.
        threading.Thread(target=deque, args=(process.stderr, 0), daemon=True).start()
        yield f"127.0.0.1:{port}", process.pid
    finally:
        process.send_signal(signal.SIGINT)
        with suppress(subprocess.TimeoutExpired):
            process.wait(GOODBYE)
        process.kill()


def class_load(load: Load, on_progress: Callable[[float], None]) -> dict[str, Any]:
    """Have a class use a server, and say what its visitors got."""
    with serving("--max-sessions", str(load.visitors)) as (address, server):
        return asyncio.run(_attend(address, server, load, on_progress))


async def _attend(address: str, server: int, load: Load, on_progress: Callable[[float], None]) -> dict[str, Any]:
    dice = random.Random(load.seed)
    visitors = [Visitor(address) for _ in range(load.visitors)]
    visits = [asyncio.create_task(_visit(visitor, random.Random(dice.random()))) for visitor in visitors]
    try:
        came = monotonic()
        while (waited := monotonic() - came) < 2 * JOINING or (waited < LATEST and not all(
                visitor.frames or visit.done() for visitor, visit in zip(visitors, visits, strict=True))):
            await asyncio.sleep(0.1)
        begin, memory = monotonic(), [memory_held(server)]
        while (done := (monotonic() - begin) / load.seconds) < 1:
            on_progress(done)
            if done > 0.5 and len(memory) == 1:
                memory.append(memory_held(server))
            await asyncio.sleep(min(1.0, load.seconds / 4, begin + load.seconds - monotonic()))
        end = monotonic()
        memory.append(memory_held(server))
    finally:
        for visit in visits:
            visit.cancel()
        ended = await asyncio.gather(*visits, return_exceptions=True)
    on_progress(1.0)
    lost = [str(error) for error in ended if error and not isinstance(error, asyncio.CancelledError)]
    return {**load_report(visitors, begin, end, lost), "memory": None if None in memory else memory}


async def _visit(visitor: Visitor, dice: random.Random) -> None:
    """Come within a few seconds, then move a slider now and then."""
    await asyncio.sleep(JOINING * dice.random())
    stay = asyncio.create_task(visitor.stay())
    try:
        while not stay.done():
            await asyncio.wait([stay], timeout=dice.uniform(*PAUSES))
            if visitor.frames and not stay.done():
                await visitor.play_with(dice.choice(SLIDERS), dice)
        await stay  # with the reason why it ended
        raise ConnectionError("the server has closed a connection")
    finally:
        stay.cancel()


def memory_held(server: int) -> dict[str, int] | None:
    """Bytes that a server holds, and that its engines and all their compilers do; what several share counts once. None
    where the system does not tell."""
    if not LINUX:
        return None
    engines = sum(proportional_bytes(process) for process in descendants(server))
    return {"server": proportional_bytes(server), "engines": engines}


def load_report(visitors: list[Visitor], begin: float, end: float, lost: list[str]) -> dict[str, Any]:
    """What visitors got between two times, while their runs went on. ``lost`` has a reason for each visit that has
    ended by itself."""
    rates = sorted(rate for visitor in visitors if (rate := visitor.rate(begin, end)) is not None) or [0.0]
    joined = sorted(visitor.frames[0] - visitor.asked for visitor in visitors if visitor.frames)
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else None
    return {"schema": SCHEMA, "visitors": len(visitors), "seconds": end - begin, "cores": os.cpu_count(), "load": load,
            "moving": len(joined), "joined_median": statistics.median(joined) if joined else None,
            "joined_95": joined[max(0, round(0.95 * len(joined)) - 1)] if joined else None,
            "frames_median": statistics.median(rates), "frames_slowest": rates[0],
            "slowest_of_median": rates[0] / statistics.median(rates) if rates[-1] else None,
            "standstill_longest": max(visitor.standstill(begin, end) for visitor in visitors),
            "standstill_own_longest": max(visitor.standstill(begin, end, own=True) for visitor in visitors),
            "lost": lost}


def class_table(found: dict[str, Any], /) -> str:
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
    if memory := found["memory"]:
        rooms = (f"{name} " + ", ".join(f"{moment[name] / MEGABYTE:.0f}" for moment in memory)
                 for name in ("server", "engines"))
        lines.append(f"  megabytes held         {'; '.join(rooms)} (at first, half way, at last)")
    return "\n".join(lines)
