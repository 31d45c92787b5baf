"""The runs of a row, made once: a finished row is kept in a file, so that a table goes on where it was stopped.

A row counts as finished only if the very same runs were made by the very same program: its file holds every input and
a fingerprint of the solvers' source. Anything else, a half-written or foreign file included, is made again.
"""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from solvers.scene.scene import Scene
from solvers.solver.samples import QUANTITIES
from solvers.study.forms import NUMBER, NUMBER_OR_NONE, Each, mismatch
from solvers.study.row import fingerprint
from solvers.study.store import NotWhole, whole
from solvers.study.tables.document import Results
from solvers.study.tables.plan import Row

SCHEMA = "mpm-lab/tables-row/1"


def run_row(row: Row, show: Callable[[float], None]) -> Results:
    """Make the runs of a row; ``show`` is told the part done."""
    from solvers.running.run import run  # here: who only reads rows does not need Taichi

    work = {purpose: scene.particles * scene.steps for purpose, scene in row.scenes.items()}
    results, done = {}, 0
    for purpose, scene in row.scenes.items():
        def told(part: float, before: int = done, steps: int = work[purpose]) -> None:
            show((before + part * steps) / sum(work.values()))

        results[purpose] = run(scene, on_progress=told, prices=True, mid_run=False).to_dict()
        done += work[purpose]
    return results


def read_row(folder: Path, row: Row) -> Results | None:
    """The results of a finished row, None where nothing is kept of it; :class:`~solvers.study.store.NotWhole` where
    something else is."""
    made_from = _made_from(row)
    form = {"results": {name: _form(scene) for name, scene in row.scenes.items()}}

    def fault(kept: Any) -> str | None:
        if wrong := mismatch(kept, {"results": dict}):
            return wrong
        if {name: value for name, value in kept.items() if name != "results"} != made_from:
            raise NotWhole("was made by another version of the solvers or for another table")
        if wrong := mismatch(kept, form):
            return wrong
        alike = all(kept["results"][name]["scene"] == scene for name, scene in made_from["scenes"].items())
        return None if alike else "its results are of other scenes"

    try:
        return whole((folder / f"{row.name}.json").read_bytes(), fault)["results"]
    except FileNotFoundError:
        return None
    except OSError:
        raise NotWhole("cannot be read") from None


def _form(scene: Scene) -> dict:
    """What the results of a scene must have for a table."""
    of_one = dict.fromkeys(QUANTITIES, NUMBER_OR_NONE)
    norms = dict.fromkeys((*QUANTITIES, scene.EXTRA_ERROR), dict.fromkeys(("final", "max", "mean"), NUMBER_OR_NONE))
    several = dict.fromkeys(scene.estimators, of_one) if len(scene.estimators) > 1 else of_one
    return {"scene": dict, "status": str, "reason": (str, type(None)), "t": NUMBER, "particles": int, "error": norms,
            "index": several, "distance": several, "grid_crossings": (int, type(None)), "not_valid": Each(str),
            "seconds": {"setup": NUMBER, "compile": NUMBER, "run": NUMBER, "estimators": Each(NUMBER)}}


def write_row(folder: Path, row: Row, results: Results) -> None:
    """Keep the results of a row; the file appears whole or not at all."""
    text = json.dumps({**_made_from(row), "results": results}, allow_nan=False, indent=2)
    part = folder / f"{row.name}.part"
    part.write_text(f"{text}\n", encoding="utf-8")
    part.replace(folder / f"{row.name}.json")


def _made_from(row: Row) -> dict:
    """What must be equal for a stored row to be this row, as it reads in JSON."""
    scenes = {name: scene.to_dict() for name, scene in row.scenes.items()}
    return json.loads(json.dumps({"schema": SCHEMA, "solvers": fingerprint(), "scenes": scenes}))
