"""``mpm-lab bench --history FILE``: our rates over the limit's, kept with their date and commit, and drawn."""

import os
import subprocess
from datetime import datetime, timezone
from pathlib import Path
from typing import TYPE_CHECKING

from app import __version__
from app.commands.flags import BadInput
from app.commands.output import Target
from app.words import method_name
from solvers.bench.limit.history import SCHEMA, HistoryError, busy, content_of, entries, latest, with_entry

if TYPE_CHECKING:
    from collections.abc import Callable

ROOT = Path(__file__).resolve().parents[3]


class History:
    """The file and its picture, both tried before anything is measured."""

    def __init__(self, text: str):
        self.text = text
        name, ending = os.path.splitext(text)
        if ending.lower() == ".png":
            raise BadInput("history", text, "is the name of a picture; give a file such as history.jsonl")
        self.target, self.picture = Target("history", text), Target("history", f"{name}.png")
        self.read()

    def read(self) -> bytes:
        """What is there, all of it entries."""
        try:
            content = content_of(Path(self.text))
            entries(content)
            return content
        except HistoryError as error:
            raise BadInput("history", self.text, f"{error}; give another file") from None

    def add(self, quick: bool, show: "Callable[[float], None]") -> dict:
        """Measure, add the entry and draw all; the entry, with the cases of the one before it."""
        from app.pictures.bench_history import history_figure
        from app.pictures.run import png_bytes
        from solvers.bench.bench import machine
        from solvers.bench.limit.program import NoLimit
        from solvers.bench.limit.ratios import ratios

        here = machine()  # before: its load is others' work
        try:
            found = ratios(quick, show)
        except NoLimit as error:
            raise BadInput("history", self.text, f"cannot be measured: {error}") from None
        entry = {"schema": SCHEMA, "date": datetime.now(timezone.utc).isoformat(timespec="seconds"),
                 "version": __version__, "commit": commit(), "machine": here, "quick": quick, **found}
        content = self.read()  # again: another bench may have added to it
        self.target.write(with_entry(content, entry))
        self.picture.write(png_bytes(history_figure([*entries(content), entry])))
        before = entries(content)
        return {**entry, "before": [case for row in found["cases"]
                                    if (case := latest(before, row["problem"], row["method"]))]}


def commit() -> str | None:
    """The commit that this runs from, with a + where files were changed since; None outside a repository of git."""
    def git(*words: str) -> str:
        return subprocess.run(["git", "-C", str(ROOT), *words], capture_output=True, text=True, check=True).stdout

    if not (ROOT / ".git").exists():
        return None
    try:
        changed = git("status", "--porcelain", "--untracked-files=no")
        return git("rev-parse", "--short", "HEAD").strip() + ("+" if changed else "")
    except (OSError, subprocess.CalledProcessError):
        return None


def history_table(values: dict, /) -> str:
    """The entry that was added, each case beside the one before it."""
    machine = values["machine"]
    load = "" if machine["load"] is None else f", load {machine['load']:.1f}"
    before = {(case["problem"], case["method"]): case["ratio"] for case in values["before"]}
    lines = [f"{values['date']}, {values['commit'] or 'version ' + values['version']}, {machine['cores']} cores{load}"
             + (": busy, so believe it less" if busy(values) else ""),
             "our rate over that of hand-written C++, million particle-steps per second of one thread",
             f"{'':<24}" + "".join(f"{word:>12}" for word in ("ratio", "quartiles", "before", "ours", "C++"))]
    for case in values["cases"]:
        earlier = before.get((case["problem"], case["method"]))
        cells = (f"{case['ratio']:.3f}", f"{case['low']:.2f}..{case['high']:.2f}",
                 "" if earlier is None else f"{earlier:.3f}", f"{case['rate']:.1f}", f"{case['limit']:.1f}")
        lines.append(f"  {case['problem'] + ' ' + method_name(case['method']):<22}"
                     + "".join(f"{cell:>12}" for cell in cells))
    return "\n".join([*lines, *(f"  {problem}: {why}" for problem, why in values["missing"].items())])
