"""Rows kept by a study and by the tables, spoilt in every way; closed streams."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from concurrent.futures import Future
from pathlib import Path

import pytest

from app.cli import main
from solvers.study.grid import Task
from solvers.study.row import fingerprint
from solvers.study.store import NotWhole, Store, StoreError
from solvers.study.tables import plan
from solvers.study.tables.making import Making
from solvers.study.tables.rows import read_row, write_row
from tests.paths import ROOT
from tests.processes import HANG
from tests.rows import made_up

GOOD = made_up()


def without(*names: str) -> dict:
    row = json.loads(json.dumps(GOOD))
    inner = row
    for name in names[:-1]:
        inner = inner[name]
    del inner[names[-1]]
    return row


SPOILT = {
    "no status": (without("status"), "it has no status"), "no key": (without("key"), "it has no key"),
    "no scene": (without("scene"), "it has no scene"), "no cells": (without("scene", "cells"), "no scene.cells"),
    "no seconds": (without("seconds", "min"), "it has no seconds.min"), "no life": (without("life"), "it has no life"),
    "empty": ({}, "it has no key"), "a list": ([GOOD], "it is no object"), "a number": (3, "it is no object"),
    "another status": ({**GOOD, "status": "fine"}, "its status is not one of ok"),
    "another problem": ({**GOOD, "problem": "rod"}, "its problem is not one of bar, ring"),
    "a list as key": ({**GOOD, "key": [1]}, "key is of the wrong kind"),
    "empty errors": ({**GOOD, "error": []}, "error is no object"),
    "words for numbers": ({**GOOD, "seconds": {**GOOD["seconds"], "min": "soon"}}, "seconds.min is of the wrong kind"),
    "true for a number": ({**GOOD, "h": True}, "h is of the wrong kind"),
    "nested": ("[" * 100_000 + "]" * 100_000, "it is not JSON"), "infinite": ('{"key": 1e999}', "it is not JSON"),
    "NaN": (json.dumps({**GOOD, "rate": float("nan")}), "it is not JSON"), "nothing": ("", "it is not JSON"),
    "half a character": (json.dumps({**GOOD, "reason": "\ud800"}), "it is not JSON"),
    "words": ("what", "it is not JSON"),
    "no text": (b"\xff\xfe\x00", "it is not JSON")}


def line(row: object) -> bytes:
    return row if isinstance(row, bytes) else (row if isinstance(row, str) else json.dumps(row)).encode()


@pytest.mark.parametrize("name", SPOILT)
def test_a_line_that_is_no_row_is_named_and_nothing_is_lost(name, tmp_path):
    row, says = SPOILT[name]
    content = line(GOOD) + b"\n" + line(row) + b"\n" + line(made_up(cells=40))
    (tmp_path / "rows.jsonl").write_bytes(content)
    with pytest.raises(StoreError) as caught:
        Store(tmp_path, "bar", resume=True)
    assert "line 2 is not a whole row" in str(caught.value) and says in str(caught.value)
    assert "take that line out" in str(caught.value)
    assert (tmp_path / "rows.jsonl").read_bytes() == content


def test_a_spoilt_line_is_one_sentence_on_the_command_line(tmp_path, capsys):
    (tmp_path / "rows.jsonl").write_bytes(line(without("status")) + b"\n")
    assert main(["sweep", "bar", "--out", str(tmp_path), "--resume"]) == 2
    said = capsys.readouterr().err
    assert said.startswith("mpm-lab: --out ") and said.count("\n") == 1 and "line 1" in said


def test_a_last_row_that_lacks_only_its_end_of_line_is_kept(tmp_path):
    (tmp_path / "rows.jsonl").write_bytes(line(GOOD))
    store = Store(tmp_path, "bar", resume=True)
    store.append(made_up(cells=40))
    store.close()
    kept = map(json.loads, (tmp_path / "rows.jsonl").read_text().splitlines())
    assert [row["scene"]["cells"] for row in kept] == [20, 40]


class Instant:
    """A place that needs no time and counts what it is asked for."""

    asked = 0

    def __init__(self, workers: int, work: str): ...

    def submit(self, task: Task) -> Future:
        Instant.asked += 1
        future: Future = Future()
        future.set_result({**made_up(cells=task.inputs["cells"]), "key": task.key, "asked": task.inputs})
        return future

    def check(self) -> None: ...

    def close(self) -> None: ...


def test_rows_of_other_source_are_measured_again_and_said(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("solvers.study.places.Here", Instant)
    monkeypatch.setattr("app.pictures.study.FIGURES", {})
    flags = ["sweep", "bar", "--cells", "20", "40", "--out", str(tmp_path)]
    assert main(flags) == 0
    path = tmp_path / "rows.jsonl"
    first, second = path.read_text().splitlines()
    path.write_text(first.replace(fingerprint(), "0" * 64) + "\n" + second + "\n")
    capsys.readouterr()
    Instant.asked = 0
    assert main([*flags, "--resume"]) == 0
    assert Instant.asked == 1 and path.read_text().count("\n") == 3
    assert "1 row was measured by another version of the solvers and is measured again" in capsys.readouterr().err
    assert main([*flags, "--resume"]) == 0
    assert Instant.asked == 1 and "another version" not in capsys.readouterr().err


# ---- the tables' rows -----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def kept(tmp_path_factory) -> tuple[Path, plan.Row]:
    folder = tmp_path_factory.mktemp("rows")
    row = plan.table_1({"bar": ("transport",)}, cells=(20,), end=0.01, long=0.02).rows[0]
    Making([row], {}, 1, lambda part, name: None, lambda row, made: write_row(folder, row, made)).make()
    return folder, row


def change(values: dict, names: str, value: object) -> None:
    *path, last = names.split(".")
    for name in path:
        values = values[name]
    values[last] = value


@pytest.mark.parametrize(("names", "value", "says"), [
    ("results", {}, "it has no results.errors"), ("results", [], "results is of the wrong kind"),
    ("results.errors", {}, "it has no results.errors.scene"), ("results.cost", 3, "results.cost is no object"),
    ("results.errors.error", {}, "it has no results.errors.error.x"), ("results.errors.error.x.max", "1", "wrong kind"),
    ("results.errors.scene", {}, "other scenes"), ("solvers", "0", "another version"), ("scenes", 1, "another version"),
])
def test_a_tables_row_that_is_spoilt_is_not_taken(names, value, says, kept, tmp_path):
    folder, row = kept
    values = json.loads((folder / f"{row.name}.json").read_text())
    change(values, names, value)
    (tmp_path / f"{row.name}.json").write_text(json.dumps(values))
    assert read_row(folder, row) is not None and read_row(tmp_path / "nowhere", row) is None
    with pytest.raises(NotWhole, match=says):
        read_row(tmp_path, row)


@pytest.mark.parametrize("content", [b"", b"[]", b"3", b"null", b"\xff", b"[" * 100_000, b'{"results": NaN}'], ids=repr)
def test_a_tables_row_that_is_no_row_is_not_taken(content, kept, tmp_path):
    _, row = kept
    (tmp_path / f"{row.name}.json").write_bytes(content)
    with pytest.raises(NotWhole, match=r"cannot be read|not a whole row"):
        read_row(tmp_path, row)


# ---- closed streams -------------------------------------------------------------------------------------------


@pytest.mark.skipif(os.name == "nt", reason="POSIX shells")
@pytest.mark.parametrize("closed", [">&-", "2>&-", "<&- >&- 2>&-"])
@pytest.mark.parametrize(("words", "status"), [
    ("run bar --cells 8 --periods 0.1 --quiet --json -", 0), ("sweep bar --cells 2 --out d", 2),
    *(pytest.param(words, 2, marks=pytest.mark.slow)  # refused where the sweep is, before a command is asked
      for words in ("tables 9 --out d", "advise bar --tolerance x"))])
def test_a_closed_stream_is_one_that_nobody_reads(words, status, closed):
    done = subprocess.run(f"{sys.executable} -m app {words} {closed}", shell=True, cwd=ROOT, capture_output=True,
                          text=True, timeout=HANG)
    assert done.returncode == status and "Traceback" not in done.stdout + done.stderr
    assert done.stderr.count("\n") == (1 if status and "2>&-" not in closed else 0)
    assert done.stdout.count("\n") == (1 if status == 0 and closed == "2>&-" else 0)


@pytest.mark.skipif(os.name == "nt", reason="POSIX shells")
def test_a_sweep_with_closed_streams_keeps_its_rows(tmp_path):
    words = f"sweep bar --cells 8 --periods 0.1 --repeats 1 --out {tmp_path / 'out'}"
    done = subprocess.run(f"{sys.executable} -m app {words} <&- >&- 2>&-", shell=True, cwd=ROOT, timeout=HANG)
    assert done.returncode == 0
    assert json.loads((tmp_path / "out" / "rows.jsonl").read_text())["status"] == "ok"
