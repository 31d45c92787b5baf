"""The runs of a row, made once: a finished row is kept in a file, so that a table goes on where it was stopped.

A row counts as finished only if the very same runs were made by the very same program: its file holds every input and
a fingerprint of the solvers' source. Anything else, a half-written or foreign file included, is made again.
"""

import functools
import hashlib
import json
from collections.abc import Callable
from pathlib import Path

import solvers
from solvers.tables.document import Results
from solvers.tables.plan import Row

SCHEMA = "mpm-lab/tables-row/1"


def run_row(row: Row, show: Callable[[float], None]) -> Results:
    """Make the runs of a row; ``show`` is told the part done."""
    from solvers.run import run  # here: who only reads rows does not need Taichi

    work = {purpose: scene.particles * scene.steps for purpose, scene in row.scenes.items()}
    results, done = {}, 0
    for purpose, scene in row.scenes.items():
        def told(part: float, before: int = done, steps: int = work[purpose]) -> None:
            show((before + part * steps) / sum(work.values()))

        results[purpose] = run(scene, on_progress=told).to_dict()
        done += work[purpose]
    return results


def read_row(folder: Path, row: Row) -> Results | None:
    """The results of a finished row, or None."""
    try:
        kept = json.loads((folder / f"{row.name}.json").read_text(encoding="utf-8"))
        results = kept.pop("results")
        return results if kept == _made_from(row) and results.keys() == row.scenes.keys() else None
    except (OSError, ValueError, AttributeError, KeyError, TypeError):  # missing, or not what this program writes
        return None


def write_row(folder: Path, row: Row, results: Results) -> None:
    """Keep the results of a row; the file appears whole or not at all."""
    text = json.dumps({**_made_from(row), "results": results}, allow_nan=False, indent=2)
    part = folder / f"{row.name}.part"
    part.write_text(f"{text}\n", encoding="utf-8")
    part.replace(folder / f"{row.name}.json")


def _made_from(row: Row) -> dict:
    """What must be equal for a stored row to be this row, as it reads in JSON."""
    scenes = {name: scene.to_dict() for name, scene in row.scenes.items()}
    return json.loads(json.dumps({"schema": SCHEMA, "solvers": _fingerprint(), "scenes": scenes}))


@functools.cache
def _fingerprint() -> str:
    """Of the source of everything that is computed: a changed solver makes its rows again."""
    root = Path(solvers.__file__).parent
    digest = hashlib.sha256()
    for path in sorted(root.rglob("*.py")):
        digest.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()
