"""A class beside a mob (``tests/mob.py``): its pictures come as before, newcomers come in, and nothing is left behind.

The machine is shared. Calm and riot take turns, with the mob held still meanwhile, and the median of the turns counts.
The class asks for so few frames that the server has some time to spare: else what counted would be the mob's own work,
and that of whoever else is on the machine.
"""

from __future__ import annotations

import asyncio
import json
import os
import re
import signal
import statistics
import subprocess
import sys
import threading
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from time import monotonic

import pytest

from app.commands.bench.class_load import CAMERA, SCENE, STORE, Visitor
from app.viewer.client import connected
from solvers.workers.processes import LINUX, descendants, free_port, processor_seconds
from tests.app.serving.test_attacks import memory
from tests.app.serving.test_class_code import enter
from tests.paths import ROOT
from tests.processes import HANG, Watch, ended, held, starving, until
from tests.raw import Raw

pytestmark = pytest.mark.skipif(not LINUX, reason="finds processes in /proc")
FRAMES = 6  # a second, of each of the class at most
CODE = "wave-4711"
ENOUGH = 0.9  # of the frames a second without the mob
GOODBYE = 0.5  # seconds that a class has to leave
WITHIN, ENDS = 3.0, 2.0  # seconds in which a newcomer has the page, and in which the server ends
MOST_MEMORY = 150  # MB: pages of those of the mob who came in, and frames to look back at
LOG = 12_000  # bytes of log, however long: some minutes with ten lines and a sum each


class Pupil(Visitor):
    """One of a class, who has the code."""

    cookie = ""

    async def stay(self) -> None:
        self.asked = monotonic()
        async with connected(self.address, {"Cookie": self.cookie}) as connection:
            self._connection = connection
            await connection.send(CAMERA)
            async for messages in connection:
                self._take(messages)


class Class:
    """A pupil with each of these cookies, on a thread of their own, who look at a run that goes on."""

    def __init__(self, address, cookies):
        self.pupils = [Pupil(address) for _ in cookies]
        for pupil, cookie in zip(self.pupils, cookies, strict=True):
            pupil.cookie = cookie
        self.lost, self._loop = [], asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)
        self._thread.start()
        for pupil in self.pupils:
            asyncio.run_coroutine_threadsafe(self._visit(pupil), self._loop)
        until(lambda: all(len(pupil.frames) > 5 for pupil in self.pupils), "frames for all", 120)

    async def _visit(self, pupil):
        stay = asyncio.create_task(pupil.stay())
        while not (store := pupil.find(STORE)) and not stay.done():
            await asyncio.sleep(0.05)
        with suppress(Exception):
            await pupil.move(store, json.dumps({"link": SCENE}))
            await stay
        self.lost.append(pupil)

    def rate(self, seconds):
        """The median of the pupils' frames a second."""
        begun = monotonic()
        threading.Event().wait(seconds)
        end = monotonic()
        return statistics.median(sum(begun <= at < end for at in pupil.frames) / (end - begun) for pupil in self.pupils)

    def go(self):
        def leave():
            for task in asyncio.all_tasks(self._loop):
                task.cancel()
            self._loop.call_later(GOODBYE, self._loop.stop)

        self._loop.call_soon_threadsafe(leave)
        self._thread.join()


def shared(process):
    """The blocks of shared memory that a process has: others on this machine have theirs."""
    return {Path(block) for block in re.findall(r"/dev/shm/psm_\w+", Path(f"/proc/{process}/maps").read_text())}


def newcomer(address, cookie, k):
    """Seconds until somebody who has just come has all of the page, in which the machine let all of it run."""
    with starving() as waited:
        begun = monotonic()
        with Raw(f"http://{address}", {"Cookie": cookie}, source_address=(f"127.0.9.{k + 1}", 0)) as one:
            one.find("Download CSV")
            return monotonic() - begun - waited()


def spent(class_, server, seconds):
    """Frames a second of the class, and how many processors the server keeps busy for them."""
    begun = processor_seconds(server)
    rate = class_.rate(seconds)
    return rate, (processor_seconds(server) - begun) / seconds


def riot(class_, mob, server, seconds):
    """Frames of a turn with the mob over those of one without, what more it costs, and how many frames those were."""
    with held([mob]):
        threading.Event().wait(0.5)
        calm = spent(class_, server, seconds)
    loud = spent(class_, server, seconds)
    return loud[0] / max(calm[0], 1e-9), loud[1] - calm[1], calm[0]


@contextmanager
def locked(log, folder):
    """Address and process of a lab with a code, which says in ``log`` whatever it says, and has this ``folder`` for
    files."""
    port = free_port()
    command = [sys.executable, "-m", "app", "serve", "--port", str(port), "--code", CODE, "--no-warm-up",
               "--max-sessions", "120", "--frames", str(FRAMES)]
    server = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, cwd=ROOT,
                              env={**os.environ, "TMPDIR": str(folder)})
    try:
        assert "mpm-lab is at" in server.stderr.readline()
        threading.Thread(target=lambda: log.extend(server.stderr), daemon=True).start()
        yield f"127.0.0.1:{port}", server
    finally:
        server.kill()


def seconds_to_end(server):
    """How long it takes the server to end when it is told to, with all of its processes."""
    family, watch = descendants(server.pid), Watch(server.pid)
    server.send_signal(signal.SIGTERM)
    until(lambda: ended(server.pid), "the end", pause=0.005)
    seconds = watch.seconds
    assert server.wait(HANG) in (0, 130)
    until(lambda: all(map(ended, family)), "its processes ended")
    return seconds


@pytest.mark.parametrize(("pupils", "seconds", "turns"), [
    (2, 0.5, 2), pytest.param(30, 5.0, 8, marks=pytest.mark.slow)])
def test_a_class_beside_a_mob(pupils, seconds, turns, tmp_path):
    log, shares, costs, comes, grown = [], [], [], [], []
    with locked(log, tmp_path) as (address, server), ExitStack() as stack:
        cookie = enter(f"http://{address}", CODE)[2][1]
        class_ = Class(address, [cookie] * pupils)
        mob = subprocess.Popen([sys.executable, "-m", "tests.mob", address, CODE], cwd=ROOT, stdout=subprocess.PIPE)
        stack.callback(mob.kill)
        assert mob.stdout.readline() == b"here\n"
        class_.rate(2 * seconds)
        for turn in range(turns):
            grown.append(memory(server.pid))
            share, cost, calm = riot(class_, mob.pid, server.pid, seconds)
            shares.append(share)
            costs.append(cost)
            assert enter(f"http://{address}", CODE)[0] == 200
            comes.append(newcomer(address, cookie, turn))
        grown.append(memory(server.pid))
        assert mob.poll() is None and not class_.lost
        blocks = shared(server.pid)
        end = seconds_to_end(server)
        class_.go()
    written = sum(map(len, log))
    for what, figures in (("times the frames", shares), ("processors more", costs), ("s to come in", comes),
                          ("MB", grown)):
        print(f"{what}: {', '.join(f'{figure:.2f}' for figure in figures)}")
    print(f"{pupils} pupils, {calm:.1f} frames/s at last without; {written} bytes of log; ended in {end:.2f} s")
    assert max(comes) < WITHIN and end < ENDS and grown[-1] - grown[1] < MOST_MEMORY
    assert written < LOG and not re.search("Traceback|Warning|leaked", "".join(log)), "".join(log)
    assert blocks and not any(block.exists() for block in blocks) and list(tmp_path.iterdir()) == []
    if turns > 2:
        assert statistics.median(shares) >= ENOUGH
