"""The progress bar: what it says of the time that is left, and where there is none."""

from __future__ import annotations

import io
import sys

import pytest

from app.commands import progress
from app.commands.progress import MEASURED, RemainingTime, show_progress


def test_what_is_left_is_reckoned_from_the_first_part_on():
    """Sixty seconds of compiling before the first part count for nothing."""
    idle, remaining = RemainingTime(), RemainingTime()
    assert idle.text(0.0, 0.0) == idle.text(0.0, 100.0) == ""  # nothing was done
    assert remaining.text(0.001, 60.0) == "" and remaining.text(0.011, 61.0) == ""  # too early to say
    assert remaining.text(0.101, 70.0) == "90 s left"
    assert remaining.text(1.0, 160.0) == "0 s left"


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize("name, quiet, shown", [("xterm", False, True), ("xterm", True, False), ("dumb", False, False)])
def test_the_bar_on_a_terminal(name, quiet, shown, monkeypatch):
    """With a clock that the test turns: no estimate before work was measured, then a true one, and a line wiped off."""
    clock, terminal = [0.0], Terminal()
    monkeypatch.setattr(progress.time, "monotonic", lambda: clock[0])
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setenv("TERM", name)
    with show_progress(quiet) as show:
        for clock[0], part in ((50.0, 0.01), (50.0 + 0.9 * MEASURED, 0.1), (60.0, 0.51)):
            show(part, "a row")
    seen = terminal.getvalue()
    if not shown:
        assert seen == ""
        return
    first, second, third, wiped = seen.split("\r")[1:5]
    assert "left" not in first + second and "51 %  10 s left" in third and not wiped.strip()
    assert max(map(len, (first, second, third, wiped))) <= 80
