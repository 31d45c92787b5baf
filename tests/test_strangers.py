"""The table of other people's codes: what runs them, with small strangers of our own, and that its numbers are kept.

Other people's code is run by ``python -m tests.strangers`` alone and never here.
"""

from __future__ import annotations

import ast
import json
import math
import os
import re
import sys
from datetime import date

import pytest

from tests.paths import ROOT
from tests.strangers.__main__ import PAGE, RECORD
from tests.strangers.listed import SAID, STRANGERS, Stranger
from tests.strangers.record import CODES, Place, Stopped, about, recorded
from tests.strangers.table import page

SCRIPTS = sorted(path.stem for path in CODES.glob("*.py") if path.stem != "handout")
OURS = {"app", "solvers", "lessons", "tests", "mpm_lab"}
LONGEST = 80  # lines of a script, as issue and page promise
MOVES = """
import sys
import numpy as np
from handout import FreeBar
bar = FreeBar(sys.argv[1], cfl=0.5)
far = 1.0 if bar.cells == 8 else 1.1
way, turn = bar.amplitude * np.sin(2 * np.pi * bar.X), bar.omega * bar.dt
for step in range(bar.steps + 1):
    if bar.looks(step):
        bar.keep(step, bar.X + far * way * np.sin(turn * step), bar.omega * way * np.cos(turn * step))
bar.finish(sys.argv[2], version="1")
"""


def stranger(script, **changed):
    known = {"install": ("mine==1",), "python": "3.11", "problem": "bar", "flags": ("--periods", "0.1"),
             "grids": (8, 12), "precision": "double", "kin": "mpm"}
    return Stranger(script, **{**known, **changed})


def judged(tmp_path, name, text):
    """A script of ours beside ``handout.py``, run and judged as another's is."""
    codes, work = tmp_path / "codes", tmp_path / "work"
    codes.mkdir()
    work.mkdir()
    (codes / f"{name}.py").write_text(text, encoding="utf-8")
    (codes / "handout.py").write_text((CODES / "handout.py").read_text(encoding="utf-8"), encoding="utf-8")
    surroundings = {**Place(tmp_path).surroundings(), "PATH": os.environ["PATH"]}
    return recorded(stranger(name), sys.executable, work, surroundings, codes, beside=False)


def test_a_stranger_is_run_and_judged_on_all_grids(tmp_path):
    """Exact particles on 8 cells, and on 12 such as move a tenth too far."""
    found = judged(tmp_path, "mine", MOVES)
    exact, wrong = (grid["error"] for grid in found["grids"])
    assert exact["x"]["max"] < 1e-12 and exact["v"]["max"] < 1e-12  # round-off, of lengths of 1 m and 0.16 m/s
    far = 0.1 * found["scene"]["amplitude"] * 2**-0.5 * math.sin(2 * math.pi * 0.1)  # RMS of an evenly sampled sine
    assert wrong["x"]["max"] == pytest.approx(far, rel=1e-9) and wrong["v"]["max"] < 1e-12
    assert [ran["cells"] for ran in found["ran"]] == [8, 12] and found["date"] == date.today().isoformat()


def test_a_script_that_fails_is_told_of_with_its_last_words(tmp_path):
    with pytest.raises(Stopped, match="no such thing as elasticity"):
        judged(tmp_path, "broken", "raise SystemExit('no such thing as elasticity')")


def test_what_a_script_ran_is_its_last_words_whatever_the_code_has_printed():
    assert about('noise {"cells": 1}\n\x1b[0m{"cells": 8, "dt": 0.1}\n') == {"cells": 8, "dt": 0.1}
    with pytest.raises(Stopped, match="without a line"):
        about("Segmentation fault")


def test_a_code_learns_little_of_this_machine(tmp_path, monkeypatch):
    monkeypatch.setenv("SECRET", "do not tell")
    seen = Place(tmp_path).surroundings()
    assert "SECRET" not in seen and seen["HOME"] == str(tmp_path / "home")


def test_the_page_is_what_the_record_says():
    assert page(json.loads(RECORD.read_text(encoding="utf-8"))) == PAGE.read_text(encoding="utf-8")


def test_every_code_of_the_list_has_a_record_of_the_same_versions_and_grids():
    records = json.loads(RECORD.read_text(encoding="utf-8"))
    assert sorted(records) == sorted(one.script for one in STRANGERS) == SCRIPTS
    for one in STRANGERS:
        record = records[one.script]
        assert record["package"] == one.package and record["package"].endswith(f"=={record['ran'][0]['version']}")
        assert [grid["cells"] for grid in record["grids"]] == list(one.grids)
        assert record["scene"]["problem"] == one.problem
    assert len({one.package for one in STRANGERS}) >= 6


def test_what_is_installed_is_pinned():
    assert all(re.fullmatch(r"[\w.-]+==[\w.]+", package) for one in STRANGERS for package in one.install)


@pytest.mark.parametrize("script", SCRIPTS)
def test_a_script_is_short_and_knows_nothing_of_the_lab(script):
    text = (CODES / f"{script}.py").read_text(encoding="utf-8")
    assert sum(bool(line.strip()) for line in text.splitlines()) <= LONGEST
    for node in ast.walk(ast.parse(text)):
        names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else \
            [node.module] if isinstance(node, ast.ImportFrom) else []
        assert not OURS & {name.partition(".")[0] for name in names}


def test_every_text_belongs_to_a_code():
    assert {path.stem for path in SAID.glob("*.md")} == {"no_number", *SCRIPTS}
    assert all(all(one.said()) for one in STRANGERS)


def test_the_readme_counts_them():
    words = {6: "Six", 7: "Seven", 8: "Eight", 9: "Nine"}
    count = len({one.package for one in STRANGERS})
    assert f"{words[count]} codes that we did not write" in " ".join((ROOT / "README.md").read_text("utf-8").split())
