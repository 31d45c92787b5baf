"""Rows kept by a study, spoilt in every way; closed streams."""

import json
import os
import subprocess
import sys

import pytest

from solvers.study.row import find_fault
from solvers.study.row_store import RowStore, StoreError
from solvers.study.tables.table_runs import MEASURED
from tests.support.fake_rows import fake_row
from tests.support.paths import ROOT
from tests.support.processes import HANG

GOOD = fake_row()


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
    "another problem": ({**GOOD, "problem": "rod"}, "its problem is not one of bar, square"),
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
    content = line(GOOD) + b"\n" + line(row) + b"\n" + line(fake_row(cells=40))
    (tmp_path / "rows.jsonl").write_bytes(content)
    with pytest.raises(StoreError) as caught:
        RowStore(tmp_path, "bar", resume=True)
    assert "line 2 is not a whole row" in str(caught.value) and says in str(caught.value)
    assert "take that line out" in str(caught.value)
    assert (tmp_path / "rows.jsonl").read_bytes() == content


def test_a_last_row_that_lacks_only_its_end_of_line_is_kept(tmp_path):
    (tmp_path / "rows.jsonl").write_bytes(line(GOOD))
    store = RowStore(tmp_path, "bar", resume=True)
    store.append(fake_row(cells=40))
    store.close()
    kept = map(json.loads, (tmp_path / "rows.jsonl").read_text().splitlines())
    assert [row["scene"]["cells"] for row in kept] == [20, 40]


def test_a_row_of_the_tables_has_what_is_read_of_it():
    run = {"scene": {}, "t": 1.0, "particles": 8, "error": {"x": {"max": 1e-3}}, "index": {}, "distance": {},
           "grid_crossings": None, "not_valid": {}, "refused": {},
           "seconds": {"setup": 0, "compile": 1, "run": 1.0, "estimators": {"transport": 0.1}}}
    row = {**GOOD, "result": run}
    assert find_fault(row, MEASURED) is None is find_fault({**GOOD, "status": "failed"}, MEASURED)
    for spoilt, says in ((GOOD, "it has no result"), ({**row, "result": []}, "result is no object"),
                         ({**row, "result": {**run, "error": {"x": {"max": "1"}}}}, "error.x.max is of the wrong kind"),
                         *(({**row, "result": {n: v for n, v in run.items() if n != name}}, f"no result.{name}")
                           for name in run)):
        assert says in find_fault(spoilt, MEASURED)


@pytest.mark.skipif(os.name == "nt", reason="POSIX shells")
@pytest.mark.parametrize("closed", [*(pytest.param(one, marks=pytest.mark.slow) for one in (">&-", "2>&-")),
                                    "<&- >&- 2>&-"])
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
@pytest.mark.slow
def test_a_sweep_with_closed_streams_keeps_its_rows(tmp_path):
    words = f"sweep bar --cells 8 --periods 0.1 --repeats 1 --out {tmp_path / 'out'}"
    done = subprocess.run(f"{sys.executable} -m app {words} <&- >&- 2>&-", shell=True, cwd=ROOT, timeout=HANG)
    assert done.returncode == 0
    assert json.loads((tmp_path / "out" / "rows.jsonl").read_text())["status"] == "ok"
