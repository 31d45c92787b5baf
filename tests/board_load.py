"""What a board costs a class: ``python -m tests.board_load [VISITORS [TURNS [SECONDS]]]``.

Two labs have a class each that looks at a run that goes on, and goes through the same lesson; one has a board, whose
lecturer opens a step and shows its answers every few seconds. They take turns, and the other is held still meanwhile:
so whatever else the machine does, it does to both. Said is how many frames a second each visitor got, without a board
and with it, at the slowest and in the median, and how busy the machine was; and, which others' work changes least, how
long the server's own process was busy for a frame.
"""

from __future__ import annotations

import asyncio
import os
import re
import statistics
import subprocess
import sys
import threading
from contextlib import ExitStack, contextmanager, suppress
from time import monotonic

from app.commands.bench.class_load import STORE
from solvers.workers.processes import descendants, free_port
from tests.app.serving.test_mob import Class, busy
from tests.paths import ROOT
from tests.processes import held
from tests.pupils import Pupil, cookie_of

CODE, LESSON, LAST = "wave-4711", "04-grid-crossing", 10  # the step before one that asks for the stage's own control
PRESSES = 2.0  # seconds between two presses of the lecturer, and between two acts of a pupil
QUESTION = re.compile(r"data-question='([\w-]+)'")


class Lab:
    """A server with its class; ``own`` is the board's code where there is one."""

    def __init__(self, visitors, stack, *more):
        port = free_port()
        self._server = subprocess.Popen(
            [sys.executable, "-m", "app", "serve", "--port", str(port), "--lesson", LESSON, "--code", CODE,
             "--no-warm-up", "--max-sessions", str(visitors + 5), *more], stderr=subprocess.PIPE, text=True, cwd=ROOT)
        stack.callback(self._server.kill)
        address = f"http://{re.search(r'http://([^ ]+)', self._server.stderr.readline())[1]}"
        self._server.stderr.readline()
        own = re.search(r" is (\S+);", self._server.stderr.readline())[1] if more else ""
        threading.Thread(target=self._server.stderr.read, daemon=True).start()
        self.class_ = Class(address.removeprefix("http://"), [cookie_of(address, CODE) for _ in range(visitors)])
        stack.callback(self.class_.go)
        self._over = threading.Event()
        stack.callback(self._over.set)
        for pupil in self.class_.pupils:
            asyncio.run_coroutine_threadsafe(self._study(pupil), self.class_._loop)
        if own:
            lecturer = stack.enter_context(Pupil(address, cookie_of(address, own)))
            threading.Thread(target=self._lecture, args=(lecturer,), daemon=True).start()

    @property
    def family(self):
        return [self._server.pid, *descendants(self._server.pid)]

    def turn(self, seconds):
        """Frames a second of each, and milliseconds of a processor that the server's process has spent a frame."""
        begun, spent = monotonic(), busy(self._server.pid)
        threading.Event().wait(seconds)
        end, spent = monotonic(), busy(self._server.pid) - spent
        counts = [sum(begun <= at < end for at in pupil.frames) for pupil in self.class_.pupils]
        return [count / (end - begun) for count in counts], 1000 * spent / max(1, sum(counts))

    def _lecture(self, lecturer):
        """Step by step, and when the last is shown back and forth: the board is drawn anew each time."""
        lecturer.find("Next")
        while not self._over.wait(PRESSES):
            place = [re.search(r"data-turn='(\d+)'.*?>step (\d+) of", text, re.DOTALL)
                     for text in lecturer.html.copy().values()]
            found = next(filter(None, place), None)
            turn, at = map(int, found.groups()) if found else (0, 0)
            with suppress(Exception):
                lecturer.tell(board=["back" if at >= LAST else "next", turn])

    async def _study(self, pupil):
        """Answer, and go on when that is possible."""
        while not self._over.is_set():
            await asyncio.sleep(PRESSES)
            contents = [str(control.props.get("content")) for control in list(pupil.controls.values())]
            question = next((found[1] for text in contents if (found := QUESTION.search(text))), "")
            if question:
                await pupil.move(pupil.find(STORE), f'{{"choice": ["{question}", {1 + id(pupil) % 3}]}}')
            for text in [name for name, control in pupil.controls.items() if "Text" in control.kind
                         and str(control.props.get("label")).startswith("Answer")]:
                await pupil.move(text, "3.1")
            for label in ("Record my prediction", "Check my answer", "Next"):
                button = pupil.find(label)
                if button and not pupil.controls[button].props.get("disabled") and not (
                        label == "Next" and any(f"step {LAST} of" in text for text in contents)):
                    await pupil.move(button, True)
                    break


@contextmanager
def labs(visitors):
    with ExitStack() as stack:
        yield Lab(visitors, stack), Lab(visitors, stack, "--board")


def measure(visitors, turns, seconds):
    """Of each turn what :meth:`Lab.turn` says: without a board, and with it."""
    without, with_it = [], []
    with labs(visitors) as (plain, board):
        for turn in range(2 * turns):
            lab, other, found = (plain, board, without) if turn % 2 == 0 else (board, plain, with_it)
            with held(other.family):
                lab.turn(1.0)
                found.append(lab.turn(seconds))
    return without, with_it


def main(visitors=30, turns=6, seconds=8):
    without, with_it = measure(visitors, turns, float(seconds))
    print(f"{visitors} visitors, {turns} turns of {seconds} s each, {os.cpu_count()} processors, "
          f"load {os.getloadavg()[0]:.1f}")
    for name, found in (("without a board", without), ("with a board", with_it)):
        medians = [statistics.median(rates) for rates, _ in found]
        of_each = [statistics.mean(rates) for rates in zip(*(rates for rates, _ in found), strict=True)]
        cost = statistics.median(spent for _, spent in found)
        print(f"  {name:16} {statistics.median(of_each):5.1f} frames a second each (median), {min(of_each):.1f} "
              f"(slowest); {cost:.2f} ms a frame; turns {' '.join(f'{median:.1f}' for median in medians)}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
