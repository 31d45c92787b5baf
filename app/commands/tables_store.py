"""Finished rows on disk, so that a table goes on where it was stopped.

A row counts as finished only if the very same runs were made by the very same program: its file holds every input and
a fingerprint of the solvers' source. Anything else, a half-written or foreign file included, is made again.
"""

from __future__ import annotations

import functools
import hashlib
import json
import os
from pathlib import Path

import solvers
from app.commands.output import Target, json_text
from solvers.tables.document import Results
from solvers.tables.plan import Row

SCHEMA = "mpm-lab/tables-row/1"
FOLDER = "rows"


class Store:
    """The rows in a directory that exists."""

    def __init__(self, directory: str):
        self._folder = os.path.join(directory, FOLDER)
        os.makedirs(self._folder, exist_ok=True)

    def read(self, row: Row) -> Results | None:
        """The results of a finished row, or None."""
        try:
            kept = json.loads(Path(self._path(row)).read_text(encoding="utf-8"))
            results = kept.pop("results")
            return results if kept == _made_from(row) and results.keys() == row.scenes.keys() else None
        except (OSError, ValueError, AttributeError, KeyError, TypeError):  # missing, or not what this program writes
            return None

    def write(self, row: Row, results: Results) -> None:
        """Keep the results of a row; the file appears whole or not at all."""
        text = json_text({**_made_from(row), "results": results}, lines=True)
        Target("out", self._path(row)).write(text.encode())

    def _path(self, row: Row) -> str:
        return os.path.join(self._folder, f"{row.name}.json")


def _made_from(row: Row) -> dict:
    """What must be equal for a stored row to be this row, as it reads in JSON."""
    scenes = {name: scene.to_dict() for name, scene in row.scenes.items()}
    return json.loads(json_text({"schema": SCHEMA, "solvers": _fingerprint(), "scenes": scenes}))


@functools.cache
def _fingerprint() -> str:
    """Of the source of everything that is computed: a changed solver makes its rows again."""
    root = Path(solvers.__file__).parent
    digest = hashlib.sha256()
    for path in sorted(root.rglob("*.py")):
        digest.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()
