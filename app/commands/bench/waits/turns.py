"""Taking turns: each wait is measured in every checkout before the next turn, and how busy the machine was then."""

import math
import os
import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from app.commands.bench.waits.checkout import Checkout, NotMeasured
from solvers.workers.processes import LINUX, adopt_orphans, reap

SCHEMA = "mpm-lab/waits/1"
TURNS, QUICK_TURNS = 3, 1
#: Of /proc/stat's first line: all that is neither idle nor waiting; the last of them goes to other machines.
BUSY = (0, 1, 2, 5, 6, 7)


@dataclass(frozen=True)
class Wait:
    """Something that people wait for. ``measure`` gives the values of its rows, whose names are given with their units,
    NaN for one that cannot be measured here.
    The first turn fills what is kept of compiled kernels and does not count, unless that makes no difference
    (``warm``)."""

    rows: Mapping[str, str]
    measure: Callable[[Checkout], Sequence[float]]
    warm: bool = False


def take_turns(waits: Sequence[Wait], checkouts: Mapping[str, Checkout], quick: bool,
               on_progress: Callable[[float], None]) -> list[dict[str, Any]]:
    """A row for each thing that is measured: for each checkout the median over the turns, and the least and the most of
    them, or why there is none; and the processors that other work has had meanwhile."""
    rows = []
    adopt_orphans()  # else what a server's or a browser's processes did would be others' work
    for number, wait in enumerate(waits):
        on_progress(number / len(waits))
        rows += _measured(wait, checkouts, QUICK_TURNS if quick else TURNS)
    on_progress(1.0)
    return rows


def _measured(wait: Wait, checkouts: Mapping[str, Checkout], turns: int) -> list[dict[str, Any]]:
    found: dict[str, list[Sequence[float]]] = {name: [] for name in checkouts}
    missing: dict[str, str] = {}
    others: list[float] = []
    for turn in range(turns + (not wait.warm)):
        # Forth and back: what comes second finds another machine than what comes first.
        for name in list(checkouts)[::-1 if turn % 2 else 1]:
            if name in missing:
                continue
            before = _processors()
            try:
                values = wait.measure(checkouts[name])
            except NotMeasured as why:
                missing[name] = str(why)
                continue
            reap()
            if turn or wait.warm:
                found[name].append(values)
                others += _others(before, _processors())
    busy = statistics.median(others) if others else None
    return [{"name": row, "unit": unit, "load": busy,
             **{name: _spread([values[k] for values in found[name]], missing.get(name)) for name in checkouts}}
            for k, (row, unit) in enumerate(wait.rows.items())]


def _spread(values: Sequence[float], missing: str | None) -> dict[str, Any]:
    if not missing and not all(map(math.isfinite, values)):
        missing = "cannot be measured here"
    if missing:
        return {"median": None, "least": None, "most": None, "turns": 0, "missing": missing}
    return {"median": statistics.median(values), "least": min(values), "most": max(values), "turns": len(values),
            "missing": None}


def _processors() -> tuple[float, float, float] | None:
    """Seconds so far: of the clock, of all processors at work, and of this process's and its children's part of it."""
    if not LINUX:
        return None
    with open("/proc/stat", encoding="ascii") as file:
        ticks = [int(word) for word in file.readline().split()[1:]]
    own = os.times()
    return (time.monotonic(), sum(ticks[k] for k in BUSY) / os.sysconf("SC_CLK_TCK"),
            own.user + own.system + own.children_user + own.children_system)


def _others(before: tuple[float, float, float] | None, after: tuple[float, float, float] | None) -> list[float]:
    """How many processors other work had between two moments, on the average; nothing if that is not known."""
    if before is None or after is None:
        return []
    clock, busy, own = (later - earlier for earlier, later in zip(before, after, strict=True))
    return [max(0.0, busy - own) / clock]
