"""An honest visitor beside a hostile one: its pictures come as before, the server grows no fatter, the log stays short.

The machine is shared. Calm and attack take turns, with the attacker held still meanwhile, and the best of some turns
counts: an attack that does harm does so in each.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from time import monotonic, sleep

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus

from tests.attacks import ATTACKS, HUGE
from tests.browser.conftest import serving
from tests.paths import ROOT
from tests.processes import children, held, until
from tests.raw import Raw

SECONDS, TURNS = 1.5, 8  # of a turn, and of how many the best counts
ENOUGH = 0.9  # of the frames a second without the attack
MOST_MEMORY = 60  # MB that the server may grow by under an attack: one more visitor's page, and frames to look back at
OFTEN = ("garbage",)  # of the attacks; the others are for the slow tests
LOG = 15_000  # bytes of log for all attacks together: some minutes with ten lines and a sum each


@pytest.fixture(scope="module")
def served():
    log = []
    with serving(log=log, frames=30) as (address, process), Raw(address) as honest:
        honest.follow("bar")  # who has no link sees the opening, which stops
        until(lambda: honest.frames > 60, "the honest visitor's frames")
        yield address, process, honest
    assert "refused" in log[0] and len(log[0]) < LOG, f"{len(log[0])} bytes of log: {log[0][:2000]}"


def memory(process):
    """MB that a process and its engines hold."""
    family = [process, *children(process, "spawn_main")]
    fields = [Path(f"/proc/{one}/smaps_rollup").read_text() for one in family]
    return sum(int(line.split()[1]) for text in fields for line in text.splitlines() if line.startswith("Pss:")) / 1e3


@pytest.mark.parametrize("kind", [kind if kind in OFTEN else pytest.param(kind, marks=pytest.mark.slow)
                                  for kind in (*ATTACKS, "knocking")])
def test_honest_visitor_is_unharmed(served, kind):
    address, process, honest = served
    before = memory(process)
    attacker = subprocess.Popen([sys.executable, "-m", "tests.attacks", address, kind], cwd=ROOT)
    try:
        honest.rate(2)  # the attacker starts
        shares = []
        while len(shares) < TURNS and max(shares, default=0) < ENOUGH:
            with held([attacker.pid]):
                calm = honest.rate(SECONDS)
            shares.append(honest.rate(SECONDS) / max(calm, 1e-9))
        grown = memory(process) - before
        print(f"{kind}: {calm:.1f} frames/s without, times {', '.join(f'{s:.2f}' for s in shares)} with; "
              f"{before:.0f} MB and {grown:+.0f} MB")
        assert attacker.poll() is None and honest.closed is None
        assert max(shares) >= ENOUGH, f"{kind}: {shares} of {calm:.1f} frames/s"
        assert grown < MOST_MEMORY
    finally:
        attacker.kill()
        attacker.wait()


def test_who_sends_far_too_much_is_sent_away_and_must_wait(served):
    """Others go on; from its address no websocket opens for some seconds."""
    address, _, honest = served
    flood = Raw(address, source_address=("127.0.0.77", 0))
    slider = flood.find("Cells, h = 1/40")
    with pytest.raises(ConnectionClosed):
        while True:
            flood.set(slider, 41)
    until(lambda: flood.closed == 1008 or flood.closed == 1006, "it is sent away")
    with pytest.raises(InvalidStatus) as refused:
        Raw(address, source_address=("127.0.0.77", 0))
    assert refused.value.response.status_code == 503 and refused.value.response.headers["Retry-After"]
    assert honest.closed is None and honest.rate(1) > 0


def test_large_message_closes_its_own_websocket_only(served):
    address, _, honest = served
    with Raw(address, source_address=("127.0.0.78", 0)) as one:
        with pytest.raises(ConnectionClosed):
            one.say(b"\x00" * HUGE)
            until(lambda: one.closed, "it is closed")
            one.say("more")
        assert one.closed in (1009, 1006)
    assert honest.closed is None and honest.rate(1) > 0


@pytest.mark.slow
def test_dragged_slider_is_not_slowed(served):
    """60 values a second, three times what a browser sends, for some seconds: the last is there at once."""
    address, _, _ = served
    with Raw(address, source_address=("127.0.0.79", 0)) as one:
        slider = one.find("Seconds a phase")
        for k in range(300):
            one.set(slider, 1.0 + k % 9)
            sleep(1 / 60)
        begun = monotonic()
        one.set(one.find("Cells, h = 1/40"), 44.0)
        one.find("Cells, h = 1/44")
        assert monotonic() - begun < 2 and one.closed is None
