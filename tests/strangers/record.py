"""One code from its packages to the judge's verdict: an environment, the runs, and what is kept of the report."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from typing import Any

from tests.paths import ROOT
from tests.strangers.listed import Stranger

CODES = Path(__file__).parent / "codes"
LONGEST = 1200  # seconds that one run may take


class Stopped(Exception):
    """A command that failed or took too long, with the end of what it said."""


@dataclass(frozen=True)
class Place:
    """Where codes are tried: a folder outside the repository, which goes when all is said."""

    folder: Path

    def python(self, stranger: Stranger) -> Path:
        """A Python with the packages of this code and nothing of ours, one for all that asks for the same."""
        name = stranger.package.translate(str.maketrans("=.", "--"))
        environment = self.folder / name
        if not environment.exists():
            run(["uv", "venv", "--quiet", "--python", stranger.python, str(environment)], dict(os.environ))
            run(["uv", "pip", "install", "--quiet", "--python", str(environment), *stranger.install], dict(os.environ))
        return environment / "bin" / "python"

    def surroundings(self) -> dict[str, str]:
        """What a code learns of this machine: a home of its own, one thread, nothing else."""
        home = self.folder / "home"
        home.mkdir(exist_ok=True)
        return {"PATH": os.defpath, "HOME": str(home), "LANG": "C.UTF-8", "OMP_NUM_THREADS": "1",
                "TI_SKIP_VERSION_CHECK": "1", "MPLBACKEND": "Agg"}


def run(command: list[str], surroundings: dict[str, str], folder: Path | None = None) -> str:
    """What a command printed. Stopped, with its last lines, if it fails."""
    try:
        done = subprocess.run(command, env=surroundings, cwd=folder, capture_output=True, text=True, timeout=LONGEST)
    except subprocess.TimeoutExpired as error:
        raise Stopped(f"{' '.join(command)}: more than {LONGEST} s") from error
    if done.returncode:
        raise Stopped(f"{' '.join(command)}: exit status {done.returncode}\n{(done.stdout + done.stderr)[-2000:]}")
    return done.stdout


def lab(*arguments: str) -> None:
    run([sys.executable, "-m", "app", *arguments], dict(os.environ), ROOT)


def recorded(stranger: Stranger, python: Path, folder: Path, surroundings: dict[str, str],
             codes: Path = CODES, beside: bool = True) -> dict[str, Any]:
    """Run a code on all its grids with this Python, judge it, and say what came out; files go to ``folder``. Unless
    ``beside`` is false our own methods run on the same grids."""
    ran, files = [], []
    for cells in stranger.grids:
        handout, out = folder / f"handout-{cells}", folder / f"{stranger.script}-{cells}.npz"
        lab("problem", stranger.problem, "--cells", str(cells), *stranger.flags, "--out", str(handout))
        said = run([str(python), str(codes / f"{stranger.script}.py"), str(handout), str(out)], surroundings, folder)
        ran.append(about(said))
        files.append(str(out))
    verdict = folder / "verdict"
    lab("judge", stranger.problem, *files, *stranger.flags, "--out", str(verdict), "--quiet",
        *([] if beside else ["--no-compare"]))
    return {"date": date.today().isoformat(), "package": stranger.package, "ran": ran,
            **kept(json.loads((verdict / "report.json").read_text()))}


def about(said: str) -> dict[str, Any]:
    """Cells, step and versions from what a script printed; codes print before it, in colours and without line ends."""
    where = said.rfind('{"cells"')
    if where < 0 or not isinstance(found := json.loads(said[where:].splitlines()[0]), dict):
        raise Stopped(f"the script ended without a line that says what it ran:\n{said[-2000:]}")
    return found


def kept(report: dict[str, Any]) -> dict[str, Any]:
    """What the table needs of the judge's report, in the report's own words and keys."""
    grids = [{**{key: grid[key] for key in ("cells", "particles", "error", "notes", "crossings_at_least")},
              "end": grid["times"][-1],
              "ours": {run["method"]: run["error"]["x"]["max"] if run["status"] == "ok" else None
                       for run in grid["ours"] or [] if not run["linearity_preserving"]}} for grid in report["grids"]]
    order = {quantity: fit and fit["order"] for quantity, fit in (report["order"] or {}).items()}
    return {"scene": report["scene"], "grids": grids, "order": order}
