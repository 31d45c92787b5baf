"""Command lines that people wait for, and the step beside C++."""

import json
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

from app.commands.bench.waits.checkout import Checkout
from app.commands.bench.waits.turns import Wait

#: What is waited for, and its words, of which | parts one from the next. Each has what the lab chooses itself: the
#: processes, and what it keeps.
LINES = {
    "find the cheapest run: advise bar, 1e-4": "advise|bar|--tolerance|1e-4|--quiet",
    "export of a bar with its sliders": "export|bar cells=40|--out|{folder}/bar.html|--quiet",
    "export of a ring with its sliders": "export|ring cells=24|--out|{folder}/ring.html|--quiet",
    "lesson check 7": "lesson|check|7|--quiet",
    "tables 1": "tables|1|--out|{folder}/tables|--quiet",
    "stability bar, 10 periods": "stability|bar|--periods|10|--out|{folder}/map|--quiet",
    "coverage bar, 10 runs": "coverage|bar|--runs|10|--out|{folder}/counted|--quiet",
}
HISTORY = "bench|--history|{folder}/history.jsonl|--quiet"


def commands() -> list[Wait]:
    """A wait for each line."""
    return [Wait({name: "s"}, partial(_seconds, line)) for name, line in LINES.items()]


def step() -> Wait:
    """Rate of a step over that of the C++ step, which the command itself compares in turns."""
    from solvers.bench.limit.ratios import cases  # here: it brings Taichi along

    runs = [(case.problem, case.method) for case in cases()]
    return Wait({f"step of {problem} {method}": "rate of C++" for problem, method in runs}, partial(_steps, runs),
                warm=True)


def _seconds(line: str, checkout: Checkout) -> list[float]:
    return [checkout.seconds(line)]


def _steps(runs: Sequence[tuple[str, str]], checkout: Checkout) -> list[float]:
    def read(folder: Path) -> Any:
        return json.loads((folder / "history.jsonl").read_text().splitlines()[-1])

    entry: Any = checkout.run(HISTORY, read)[1]
    found = {(case["problem"], case["method"]): case["ratio"] for case in entry["cases"]}
    return [found.get(run, float("nan")) for run in runs]
