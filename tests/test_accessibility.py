"""The report of accessibility lists each criterion once, and each test that it names is there."""

from __future__ import annotations

import re

from tests.paths import ROOT

REPORT = (ROOT / "assets" / "accessibility.md").read_text(encoding="utf-8")
ROW = re.compile(r"^\| (\d\.\d\.\d+) (.+?) \| (AA?) \| (.+?) \| (.+?) \| (.*?) \|$", re.MULTILINE)
#: How many criteria of level A and AA each guideline of WCAG 2.1 has, and which of its numbers are of level AAA alone.
GUIDELINES = {"1.1": 1, "1.2": 9, "1.3": 6, "1.4": 13, "2.1": 4, "2.2": 6, "2.3": 3, "2.4": 10, "2.5": 6, "3.1": 6,
              "3.2": 5, "3.3": 6, "4.1": 3}
AAA = {"1.2.6", "1.2.7", "1.2.8", "1.2.9", "1.3.6", "1.4.6", "1.4.7", "1.4.8", "1.4.9", "2.1.3", "2.2.3", "2.2.4",
       "2.2.5", "2.2.6", "2.3.2", "2.3.3", "2.4.8", "2.4.9", "2.4.10", "2.5.5", "2.5.6", "3.1.3", "3.1.4", "3.1.5",
       "3.1.6", "3.2.5", "3.3.5", "3.3.6"}
VERDICTS = {"supported", "partly", "not", "does not apply"}


def test_each_criterion_is_listed_once():
    listed = [number for number, *_ in ROW.findall(REPORT)]
    wanted = [f"{guideline}.{k}" for guideline, count in GUIDELINES.items() for k in range(1, count + 1)]
    assert listed == [number for number in wanted if number not in AAA] and len(listed) == 50
    assert len([line for line in REPORT.splitlines() if re.match(r"\| \d", line)]) == 50
    assert [level for _, _, level, *_ in ROW.findall(REPORT)].count("AA") == 20


def test_each_verdict_is_one_of_four_and_has_a_reason():
    for number, _, _, verdict, looked_at, shown in ROW.findall(REPORT):
        assert verdict in VERDICTS and looked_at.endswith("."), number
        assert shown or verdict != "supported", f"{number} is said to be supported, and nothing shows it"


def test_each_test_that_is_named_is_there():
    named = re.findall(r"`(tests/[\w/]+\.py)::(\w+)`", REPORT)
    assert len(named) > 20
    for path, name in named:
        assert f"def {name}(" in (ROOT / path).read_text(encoding="utf-8"), f"{path}::{name}"
    cells = " ".join(shown for *_, shown in ROW.findall(REPORT))
    assert len(re.findall(r"tests/[\w/]+\.py", cells)) == len(named)
