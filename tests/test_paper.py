"""The draft of a paper: what it cites is in its bibliography, its numbers are those of texts that measured them."""

from __future__ import annotations

import re

from tests.paths import ROOT

PAPER = ROOT / "assets" / "paper"


def test_what_is_cited_is_there_and_the_other_way_round():
    text, entries = (PAPER / "paper.md").read_text(encoding="utf-8"), (PAPER / "paper.bib").read_text(encoding="utf-8")
    listed = re.findall(r"^@\w+{(\w+),", entries, re.M)
    cited = set(re.findall(r"(?<![\w.])@(\w+)", text.partition("\n---\n")[2]))
    assert len(listed) == len(set(listed)) and set(listed) == cited
    assert entries.count("{") == entries.count("}")
    for entry in re.split(r"^@", entries, flags=re.M)[1:]:
        assert "year" in entry and ("doi" in entry or "eprint" in entry), entry


def test_its_numbers_are_those_of_the_readme():
    """Each with words around it, as both texts have it."""
    paper, readme = (" ".join((ROOT / path).read_text(encoding="utf-8").split())
                     for path in ("assets/paper/paper.md", "README.md"))
    for number in ("88 of 90 random trials", "97 %", "14 %", "87 %"):
        assert number in paper and number in readme, number
    assert "Ten lessons" in readme and "ten lessons" in paper
