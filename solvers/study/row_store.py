"""Rows on disk: one JSON object per line, appended and synchronised at once, so that a kill loses no finished row."""

import contextlib
import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, BinaryIO

from solvers.study.json_schema import parse_json
from solvers.study.row import FAILED, find_fault, solver_source_hash
from solvers.untrusted import quoting

NAME = "rows.jsonl"
LARGEST, LONGEST = 100_000_000, 1_000_000  # bytes of it, and of a line; ten thousand rows have some ten million


class StoreError(Exception):
    """Error for a directory that cannot be used; the sentence says why and what to do."""

    def __init__(self, sentence: str):
        super().__init__(quoting.one_line(sentence))


class RowStore:
    """Rows of a study in a directory. A row with the key of an earlier one replaces it.

    The ``directory`` is created if missing; it must be empty, or with ``resume`` contain rows of the ``problem``, if
    one is given. If ``resume`` is None, it may contain rows and anything else. ``fault`` is a function that returns
    what is wrong with a stored row, in words, or None. Raises :class:`StoreError` where the directory cannot be used.
    """

    def __init__(self, directory: str | os.PathLike, problem: str | None, resume: bool | None = False,
                 fault: Callable[[Any], str | None] = find_fault):
        self._fault = fault
        self._path = Path(directory) / NAME
        self.rows: dict[str, dict] = {}
        _prepare_directory(self._path.parent, resume)
        try:
            self._file = open(self._path, "ab")
        except OSError as error:
            raise StoreError(f"cannot be written to: {(error.strerror or str(error)).lower()}") from None
        try:
            _lock(self._file)
            self._load(problem)
        except BaseException:
            self._file.close()
            raise

    def append(self, row: dict) -> None:
        """Stores a row in ``rows`` and at the end of the file; it is on the disk when this returns."""
        self._file.write(json.dumps(row, allow_nan=False).encode() + b"\n")
        self._file.flush()
        os.fsync(self._file.fileno())
        self.rows[row["key"]] = row

    def is_finished(self, key: str) -> bool:
        """Returns whether a task's key has a row; failed rows and those of other source are measured again."""
        return key in self.rows and self.rows[key]["status"] != FAILED and not self.is_outdated(key)

    def is_outdated(self, key: str) -> bool:
        """Returns whether a task's key has a row that was measured by other source than the present one."""
        return key in self.rows and self.rows[key].get("solvers") != solver_source_hash()

    def close(self) -> None:
        self._file.close()

    def _load(self, problem: str | None) -> None:
        """Reads the stored rows. A last line that a kill cut short is removed; its row will be measured again."""
        if (size := self._path.stat().st_size) > LARGEST:
            raise StoreError(f"holds a {NAME} of {size / 1e6:,.0f} MB; give one of at most {LARGEST / 1e6:,.0f} MB, or "
                             "another directory")
        rest = b""
        with open(self._path, "rb") as lines:
            for number, line in enumerate(iter(lambda: lines.readline(LONGEST + 1), b""), 1):
                if len(line) > LONGEST:
                    raise StoreError(f"holds a {NAME} whose line {number} has more than {LONGEST:,} letters; take that "
                                     "line out, or give another directory")
                if line.endswith(b"\n"):
                    self._add_line(number, line[:-1], problem)
                else:
                    rest = line
        if rest and self._fault_of_line(rest):
            self._file.truncate(size - len(rest))
        elif rest:  # whole but for the end of its line
            self._add_line(number, rest, problem)
            self._file.write(b"\n")
            self._file.flush()

    def _fault_of_line(self, line: bytes) -> str | None:
        try:
            return self._fault(parse_json(line))
        except ValueError:
            return "it is not JSON"

    def _add_line(self, number: int, line: bytes, problem: str | None) -> None:
        """Adds the row of a line. Raises :class:`StoreError`, with the disk unchanged, if it is none of the problem."""
        if wrong := self._fault_of_line(line):
            raise StoreError(f"holds a {NAME} whose line {number} is not a whole row ({wrong}); take that line out, "
                             "and it is measured again, or give another directory")
        row = parse_json(line)
        if row["problem"] != (problem or row["problem"]):
            raise StoreError(f"holds rows of the {row['problem']}; give another directory for the {problem}")
        self.rows[row["key"]] = row


def _prepare_directory(directory: Path, resume: bool | None) -> None:
    """Creates the directory, or raises :class:`StoreError` where it must not be used (see :class:`RowStore`)."""
    try:
        directory.mkdir(parents=True, exist_ok=True)
        names = {entry.name for entry in directory.iterdir()}
    except FileExistsError:
        raise StoreError("is a file; give a directory") from None
    except OSError as error:
        raise StoreError(f"cannot be used: {(error.strerror or str(error)).lower()}; give a directory that can be "
                         "written to") from None
    if resume is None:
        return
    if names and not resume:
        raise StoreError("is not empty; give an empty or a new directory"
                         + (", or --resume to finish the sweep in it" if NAME in names else ""))
    if names and NAME not in names:
        raise StoreError(f"holds no {NAME}, so there is no sweep to resume; give an empty or a new directory")


def _lock(file: BinaryIO) -> None:
    """Locks the file, because two sweeps must not write to it. Raises :class:`StoreError` where it is locked."""
    with contextlib.suppress(ImportError):  # there are locks only on Unix
        import fcntl
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise StoreError("is being written to by another sweep; wait for it or give another directory") from None
