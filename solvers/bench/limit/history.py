"""The history of the ratios: a file with an entry a line, each a JSON object with date, commit, machine and cases."""

import json
import math
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path

SCHEMA = "mpm-lab/bench-history/1"


class HistoryError(ValueError):
    """A file that is no history; the sentence says where and why."""


def entries(content: bytes) -> list[dict]:
    """The entries of a file, oldest first; raises :class:`HistoryError`. What a later version adds does no harm."""
    try:
        lines = content.decode("utf-8").splitlines()
    except UnicodeDecodeError:
        raise HistoryError("is no text") from None
    found = []
    for number, line in enumerate(lines, 1):
        try:
            found.append(_entry(line))
        except (ValueError, TypeError, KeyError, OverflowError, RecursionError):
            raise HistoryError(f"line {number} is no entry of a bench's history") from None
    return found


def _entry(line: str) -> dict:
    entry = json.loads(line)
    if entry["schema"] != SCHEMA or not isinstance(entry["commit"], str | None):
        raise ValueError
    datetime.fromisoformat(entry["date"])
    for text in (entry["version"], entry["machine"]["system"]):
        if not isinstance(text, str):
            raise ValueError
    for number in (entry["machine"]["cores"], entry["machine"]["load"] or 0,
                   *(case[name] for case in entry["cases"] for name in ("ratio", "low", "high", "seconds", "cells"))):
        if not math.isfinite(number):
            raise ValueError
    if not all(isinstance(case[name], str) for case in entry["cases"] for name in ("problem", "method")):
        raise ValueError
    return entry


def with_entry(content: bytes, entry: dict) -> bytes:
    """The file with one more entry; what was there stays as it is, to the byte."""
    gap = b"" if not content or content.endswith(b"\n") else b"\n"
    return content + gap + json.dumps(entry, allow_nan=False).encode() + b"\n"


def content_of(path: Path) -> bytes:
    """What the file holds, nothing where it is not there yet; raises :class:`HistoryError` where it is no file."""
    if path.exists() and not path.is_file():
        raise HistoryError("is no file")
    try:
        return path.read_bytes() if path.exists() else b""
    except OSError as error:
        raise HistoryError(f"cannot be read: {(error.strerror or str(error)).lower()}") from None


def busy(entry: dict) -> bool:
    """Whether other work had the machine: with more to do than processors, turns are not at one speed."""
    return (entry["machine"]["load"] or 0) > entry["machine"]["cores"]


def latest(found: Sequence[dict], problem: str, method: str) -> dict | None:
    """The newest case of a method in these entries."""
    return next((case for entry in reversed(found) for case in entry["cases"]
                 if (case["problem"], case["method"]) == (problem, method)), None)
