"""What people wait for: turns and rows, what is not there, the table; the whole in the slow set."""

from __future__ import annotations

import json
import re
import shlex
import subprocess
import sys

import pytest

from app.cli import main
from app.commands.bench.waits import chromium as browsers
from app.commands.bench.waits import turns
from app.commands.bench.waits.checkout import Checkout, NotMeasured, beside, here
from app.commands.bench.waits.chromium import chromium
from app.commands.bench.waits.commands import LINES
from app.commands.bench.waits.text import waits_table
from app.commands.bench.waits.turns import SCHEMA, Wait, take_turns
from app.commands.bench.waits.visits import _searched
from solvers.workers.processes import LINUX
from tests.groups import require_group
from tests.paths import ROOT
from tests.processes import HANG, until

MACHINE = {"system": "Linux", "processor": "x", "cores": 2, "load": 0.5, "python": "3.11.7", "taichi": "1.7.4"}


def rows_of(*waits, quick=False, names=("before", "now")):
    """Rows, by name, of two checkouts that are known by their folders; and how far it was said to be."""
    parts = []
    rows = take_turns(waits, {name: Checkout(ROOT / name) for name in names}, quick, parts.append)
    assert parts == sorted(parts) and parts[-1] == 1.0
    return {row["name"]: row for row in rows}


def test_turns_go_forth_and_back_and_the_first_does_not_count():
    asked = []

    def measure(checkout):
        asked.append(checkout.folder.name)
        return float(len(asked)), 10.0 * len(asked)

    rows = rows_of(Wait({"one": "s", "other": "frames/s"}, measure))
    assert asked == ["before", "now", "now", "before", "before", "now", "now", "before"]
    assert rows["one"]["now"] == {"median": 6.0, "least": 3.0, "most": 7.0, "turns": 3, "missing": None}
    assert rows["one"]["before"] == {"median": 5.0, "least": 4.0, "most": 8.0, "turns": 3, "missing": None}
    assert rows["other"]["unit"] == "frames/s" and rows["other"]["now"]["most"] == 70.0
    asked.clear()
    assert rows_of(Wait({"one": "s", "other": "s"}, measure, warm=True), quick=True)["one"]["now"]["turns"] == 1
    assert asked == ["before", "now"]


def test_what_cannot_be_measured_is_said_and_not_asked_again():
    asked = []

    def measure(checkout):
        asked.append(checkout.folder.name)
        if checkout.folder.name == "before":
            raise NotMeasured("it was not there yet")
        return (2.0,)

    rows = rows_of(Wait({"new": "s"}, measure), quick=True)
    assert asked.count("before") == 1 and asked.count("now") == 2
    assert rows["new"]["before"]["median"] is None and rows["new"]["before"]["missing"] == "it was not there yet"
    table = waits_table({"machine": MACHINE, "beside": True, "rows": list(rows.values())})
    assert re.search(r"\| new \| s \| none \| 2\.00 \|  \| ", table) and "new: it was not there yet" in table


def test_a_value_that_there_is_not_here_costs_no_other():
    rows = rows_of(Wait({"one": "s", "other": "ms"}, lambda checkout: (1.0, float("nan"))), quick=True)
    assert rows["one"]["now"]["median"] == 1.0 and rows["other"]["now"]["missing"] == "cannot be measured here"
    assert json.loads(json.dumps(rows, allow_nan=False)) == rows


def test_other_work_is_what_the_processors_did_beside_ours(monkeypatch):
    """Ten seconds in which two processors were busy for 15 s, 12 s of that with ours."""
    moments = iter([(0.0, 100.0, 7.0), (10.0, 115.0, 19.0)])
    monkeypatch.setattr(turns, "_processors", lambda: next(moments))
    rows = rows_of(Wait({"one": "s"}, lambda checkout: (1.0,), warm=True), quick=True, names=("now",))
    assert rows["one"]["load"] == pytest.approx(0.3)
    monkeypatch.setattr(turns, "_processors", lambda: None)  # where the system does not say
    rows = rows_of(Wait({"one": "s"}, lambda checkout: (1.0,), warm=True), quick=True, names=("now",))
    assert rows["one"]["load"] is None and json.loads(json.dumps(rows, allow_nan=False)) == rows


def test_table_has_before_and_now_and_their_ratio():
    spread = {"median": 8.0, "least": 7.5, "most": 12.0, "turns": 3, "missing": None}
    row = {"name": "export", "unit": "s", "load": 0.25, "before": spread, "now": {**spread, "median": 2.0}}
    table = waits_table({"machine": MACHINE, "beside": True, "rows": [row]})
    assert "| export | s | 8.00 (7.50–12.0) | 2.00 (7.50–12.0) | 0.25 | 0.25 |" in table
    del row["before"]
    alone = waits_table({"machine": MACHINE, "beside": False, "rows": [row]})
    assert "| what is waited for | unit | now | others |" in alone


def test_a_command_runs_in_a_folder_of_its_own_and_says_why_it_failed():
    seconds, kept = here().run("run|bar|--cells|8|--periods|0.1|--json|{folder}/bar.json|--quiet", lambda folder:
                               json.loads((folder / "bar.json").read_text()))
    assert seconds > 0 and kept["scene"]["cells"] == 8
    with pytest.raises(NotMeasured, match=r"mpm-lab run: mpm-lab: --cells none:"):
        here().seconds("run|bar|--cells|none")


@pytest.mark.parametrize("line", LINES.values(), ids=list(LINES))
def test_every_line_is_one_that_a_person_may_type(line, capsys):
    """Its flags are the command's, whose help names them."""
    words = line.split("|")
    flags = {word for word in words if word.startswith("--")}
    command = [word for word in words[:2] if re.fullmatch("[a-z]+", word)]
    assert main([*command, "--help"]) == 0
    assert flags <= set(re.findall(r"--[a-z-]+", capsys.readouterr().out)), shlex.join(words)


@pytest.mark.parametrize(("flags", "names"), [
    (["--beside", "."], "--beside .: goes with --waits; give both"),
    (["--waits", "--beside", "no/such/folder"], "--beside no/such/folder: holds no mpm-lab; give a folder"),
    (["--waits", "--class", "3"], "--class 3: goes without --waits; give one of them"),
    (["--waits", "--history", "h.jsonl"], "--history h.jsonl: goes without --waits; give one of them"),
])
def test_bad_input_is_one_line(flags, names, capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert main(["bench", *flags]) == 2
    seen = capsys.readouterr()
    assert seen.out == "" and seen.err.count("\n") == 1 and names in seen.err, seen.err


def test_a_folder_of_this_code_is_one():
    assert beside(str(ROOT)).folder == here().folder


def test_no_browser_is_said(monkeypatch):
    monkeypatch.setattr(browsers, "NAMES", ("no-such-browser",))
    with pytest.raises(NotMeasured, match=r"no browser was found \(no-such-browser\)"), chromium():
        pass


def test_a_browser_says_what_a_page_has_come_to():
    require_group("browser")
    with chromium() as browser:
        seen = browser.open("window.told = 6")
        browser.go(seen, "data:text/html,<title>a page</title>")
        until(lambda: browser.ask(seen, "[window.told * 7, document.title]") == [42, "a page"], "the page loaded")
        with pytest.raises(NotMeasured, match=r"refused Page\.navigate"):
            browser.go("nowhere", "about:blank")


@pytest.mark.slow
def test_a_search_answers_first_and_last():
    first, last = _searched("1e-2", here())
    assert 0 < first <= last


@pytest.mark.slow
def test_the_whole(tmp_path, capsys):
    path = tmp_path / "waits.json"
    assert main(["bench", "--waits", "--quick", "--quiet", "--json", str(path)]) == 0
    found = json.loads(path.read_text())
    assert found["schema"] == SCHEMA and found["quick"] and not found["beside"]
    assert all(row["now"]["median"] or row["now"]["missing"] for row in found["rows"])
    assert {"full picture for others", "lesson check 7", "step of ring cpdi"} <= {row["name"] for row in found["rows"]}


@pytest.mark.skipif(not LINUX, reason="where orphans can be adopted")
def test_what_orphans_have_done_is_not_others_work():
    """A child's child that outlives it and then works: in a process of its own, which adopts."""
    worker = "sum(k * k for k in range(3_000_000))"
    child = f"import subprocess, sys; subprocess.Popen([sys.executable, '-c', {worker!r}])"
    code = f"""if True:
        import os, subprocess, sys, time
        from solvers.workers.processes import adopt_orphans, descendants, reap
        adopt_orphans()
        subprocess.run([sys.executable, "-c", {child!r}], check=True)
        before, end = os.times().children_user, time.monotonic() + {HANG}
        while descendants(os.getpid()) and time.monotonic() < end:
            time.sleep(0.01)
            reap()
        print(os.times().children_user - before)"""
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, timeout=2 * HANG)
    assert float(done.stdout) > 0.02, done.stderr  # three million squares take some .2 s; a tick is .01 s
