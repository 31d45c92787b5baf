"""A class beside a mob (``tests/mob.py``): its pictures come as before, newcomers come in, and nothing is left behind.

The machine is shared. Calm and riot take turns, with the mob held still meanwhile, and the median of the turns counts.
The class asks for so few frames that the server has some time to spare: else what counted would be the mob's own work,
and that of whoever else is on the machine.
"""

from __future__ import annotations

import os
import re
import signal
import statistics
import subprocess
import sys
import threading
from contextlib import ExitStack, contextmanager
from pathlib import Path
from time import monotonic

import pytest

from app.commands.bench.class_load import SCENE
from solvers.workers.processes import LINUX, descendants, free_port, proportional_bytes
from tests.app.serving.test_class_code import enter
from tests.paths import ROOT
from tests.processes import HANG, Watch, ended, held, starving, until
from tests.raw import Raw

pytestmark = pytest.mark.skipif(not LINUX, reason="finds processes in /proc")
FRAMES = 6  # a second, of each of the class at most
CODE = "wave-4711"
ENOUGH = 0.9  # of the frames a second without the mob
WITHIN, ENDS = 3.0, 2.0  # seconds in which a newcomer has the page, and in which the server ends
MOST_MEMORY = 150  # MB: pages of those of the mob who came in, and frames to look back at
LOG = 12_000  # bytes of log, however long: some minutes with ten lines and a sum each


def shared(process):
    """The blocks of shared memory that a process has: others on this machine have theirs."""
    return {Path(block) for block in re.findall(r"/dev/shm/psm_\w+", Path(f"/proc/{process}/maps").read_text())}


def memory(process):
    """MB that a process and those below it hold."""
    return sum(map(proportional_bytes, [process, *descendants(process)])) / 1e6


def newcomer(address, cookie, k):
    """Seconds until somebody who has just come has all of the page, in which the machine let all of it run."""
    with starving() as waited:
        begun = monotonic()
        with Raw(f"http://{address}", {"Cookie": cookie}, source_address=(f"127.0.9.{k + 1}", 0)) as one:
            one.find("Download CSV")
            return monotonic() - begun - waited()


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


@pytest.mark.parametrize(("visitors", "seconds", "turns"), [
    (1, 0.5, 2), pytest.param(10, 5.0, 8, marks=pytest.mark.slow)])
def test_a_class_beside_a_mob(visitors, seconds, turns, tmp_path):
    log, shares, comes, grown = [], [], [], []
    with locked(log, tmp_path) as (address, server), ExitStack() as stack:
        cookie = enter(f"http://{address}", CODE)[2][1]
        class_ = [stack.enter_context(Raw(f"http://{address}", {"Cookie": cookie})) for _ in range(visitors)]
        for visitor in class_:
            visitor.follow(SCENE)
        until(lambda: all(visitor.frames > 5 for visitor in class_), "frames for all", 120)
        mob = subprocess.Popen([sys.executable, "-m", "tests.mob", address, CODE], cwd=ROOT, stdout=subprocess.PIPE)
        stack.callback(mob.kill)
        assert mob.stdout.readline() == b"here\n"
        for turn in range(turns):
            grown.append(memory(server.pid))
            with held([mob.pid]):
                calm = class_[0].rate(seconds)
            shares.append(class_[0].rate(seconds) / max(calm, 1e-9))
            assert enter(f"http://{address}", CODE)[0] == 200
            comes.append(newcomer(address, cookie, turn))
        grown.append(memory(server.pid))
        assert mob.poll() is None and all(visitor.closed is None for visitor in class_)
        blocks = shared(server.pid)
        end = seconds_to_end(server)
    written = sum(map(len, log))
    print(f"times the frames: {shares}; s to come in: {comes}; MB: {grown}; bytes of log: {written}; end: {end:.2f} s")
    assert max(comes) < WITHIN and end < ENDS and grown[-1] - grown[1] < MOST_MEMORY
    assert written < LOG and not re.search("Traceback|Warning|leaked", "".join(log)), "".join(log)
    assert blocks and not any(block.exists() for block in blocks) and list(tmp_path.iterdir()) == []
    if turns > 2:
        assert statistics.median(shares) >= ENOUGH
