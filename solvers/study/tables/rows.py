"""The runs of a row, kept in a file as they are made, so that a table goes on where it was stopped.

A row counts as finished only if the very same runs were made by the very same program: its file holds every input and
a fingerprint of the solvers' source. Anything else, a half-written or foreign file included, is made again. A row of
which some runs are made has a file of its own for these, which is checked as strictly, until it is finished.
"""

import json
from collections.abc import Collection
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
FINISHED, BEGUN = ".json", ".begun"  # what the file of a row ends in


def read_row(folder: Path, row: Row) -> Results | None:
    """The results of a finished row, None where nothing is kept of it; :class:`~solvers.study.store.NotWhole` where
    something else is."""
    return _read(folder / f"{row.name}{FINISHED}", row, row.scenes)


def read_begun(folder: Path, row: Row) -> Results:
    """The results of those runs of a row that were made before it was finished."""
    path = folder / f"{row.name}{BEGUN}"
    try:
        return _read(path, row, ()) or {}
    except NotWhole:
        return {}


def _read(path: Path, row: Row, names: Collection[str]) -> Results | None:
    """What is kept of a row: these results at least, each of which is whole."""
    made_from = _made_from(row)

    def fault(kept: Any) -> str | None:
        if wrong := mismatch(kept, {"results": dict}):
            return wrong
        if {name: value for name, value in kept.items() if name != "results"} != made_from:
            raise NotWhole("was made by another version of the solvers or for another table")
        there = [name for name in row.scenes if name in names or name in kept["results"]]
        if wrong := mismatch(kept, {"results": {name: _form(row.scenes[name]) for name in there}}):
            return wrong
        alike = all(kept["results"][name]["scene"] == made_from["scenes"][name] for name in there)
        return None if alike else "its results are of other scenes"

    try:
        kept = whole(path.read_bytes(), fault)["results"]
    except FileNotFoundError:
        return None
    except OSError:
        raise NotWhole("cannot be read") from None
    return {name: kept[name] for name in row.scenes if name in kept}


def _form(scene: Scene) -> dict:
    """What the results of a scene must have for a table."""
    of_one = dict.fromkeys(QUANTITIES, NUMBER_OR_NONE)
    norms = dict.fromkeys((*QUANTITIES, scene.EXTRA_ERROR), dict.fromkeys(("final", "max", "mean"), NUMBER_OR_NONE))
    several = dict.fromkeys(scene.estimators, of_one) if len(scene.estimators) > 1 else of_one
    return {"scene": dict, "status": str, "reason": (str, type(None)), "t": NUMBER, "particles": int, "error": norms,
            "index": several, "distance": several, "grid_crossings": (int, type(None)), "not_valid": Each(str),
            "seconds": {"setup": NUMBER, "compile": NUMBER, "run": NUMBER, "estimators": Each(NUMBER)}}


def write_row(folder: Path, row: Row, results: Results) -> None:
    """Keep the results of a row, be they all or those made so far; a file appears whole or not at all."""
    finished = all(name in results for name in row.scenes)
    text = json.dumps({**_made_from(row), "results": results}, allow_nan=False, indent=2)
    part = folder / f"{row.name}.part"
    part.write_text(f"{text}\n", encoding="utf-8")
    part.replace(folder / f"{row.name}{FINISHED if finished else BEGUN}")
    if finished:
        (folder / f"{row.name}{BEGUN}").unlink(missing_ok=True)


def _made_from(row: Row) -> dict:
    """What must be equal for a stored row to be this row, as it reads in JSON."""
    scenes = {name: scene.to_dict() for name, scene in row.scenes.items()}
    return json.loads(json.dumps({"schema": SCHEMA, "solvers": fingerprint(), "scenes": scenes}))
