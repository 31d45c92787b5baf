"""The history of a bench: measured against C++ that does the same work, kept line by line, never spoilt, drawn."""

from __future__ import annotations

import json
import math
import os

import pytest

from app.cli import main
from app.commands.bench import history
from app.pictures.bench_history import history_figure
from app.words import method_name
from solvers.bench.limit import program, ratios
from solvers.bench.limit.history import SCHEMA, HistoryError, busy, content_of, entries, with_entry
from solvers.problems import PROBLEMS

ENTRY = {"schema": SCHEMA, "date": "2026-11-24T06:00:00+00:00", "version": "0.1.0", "commit": "8c54749", "quick": False,
         "machine": {"system": "Linux", "processor": "x86_64", "cores": 2, "load": 0.3, "python": "3.12", "taichi": ""},
         "missing": {}, "cases": [{"problem": "bar", "method": "ugimp", "cells": 160, "particles": 640, "ratio": 0.84,
                                   "low": 0.83, "high": 0.85, "rate": 110.0, "limit": 131.0, "seconds": 5.8e-6}]}
LINE = json.dumps(ENTRY).encode() + b"\n"


@pytest.fixture(scope="module")
def bar(tmp_path_factory):
    try:
        return program.Program("bar", tmp_path_factory.mktemp("limit"))
    except program.NoLimit as why:
        return (pytest.fail if os.environ.get("CI") else pytest.skip)(f"{why}: with one this test runs")


@pytest.fixture
def short(bar, monkeypatch):
    """One method, one turn, and C++ that is compiled."""
    monkeypatch.setattr(ratios, "QUICK_TURNS", 1)
    monkeypatch.setattr(ratios, "SECONDS", 0.01)
    monkeypatch.setattr(ratios, "cases", lambda quick: [ratios.Case("bar", "ugimp", 160, (160, 2000))])
    monkeypatch.setattr(ratios, "Program", lambda problem, folder: bar)


def test_the_limit_does_the_work(bar):
    """It is fast because it is written so, not because it leaves something out."""
    (rate, coarse), (_, fine) = bar.run(80, 20_000), bar.run(160, 20_000)
    assert rate > 1 and 0 < fine < 0.01 and 1.8 < math.log2(coarse / fine) < 2.2  # uGIMP is of second order


def test_an_entry_is_added_and_all_are_drawn(short, tmp_path, capsys):
    file = tmp_path / "history.jsonl"
    file.write_bytes(LINE)
    assert main(["bench", "--quick", "--quiet", "--history", str(file)]) == 0
    said = capsys.readouterr()
    assert file.read_bytes().startswith(LINE) and said.err == ""
    _, new = entries(file.read_bytes())
    [case] = new["cases"]
    assert 0 < case["low"] <= case["ratio"] <= case["high"] and case["seconds"] > 0 and case["limit"] > 1
    assert case["ratio"] == pytest.approx(case["rate"] / case["limit"])  # of one turn
    assert f"{case['ratio']:.3f}" in said.out and "0.840" in said.out  # beside the one before
    assert (tmp_path / "history.png").read_bytes().startswith(b"\x89PNG")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["history.jsonl", "history.png"]


def test_a_file_without_an_end_of_line_gets_one():
    assert with_entry(LINE[:-1], ENTRY) == LINE + LINE == with_entry(LINE, ENTRY)


@pytest.mark.parametrize("content", [
    b"not json\n", LINE + b"\n", LINE + b"[]\n", b"\xff\xfe", b'{"schema": "mpm-lab/bench/1"}\n',
    LINE.replace(b"0.84", b"NaN"), LINE.replace(b"0.84", b"1" + 400 * b"0"), LINE.replace(b'"ugimp"', b"3"),
    LINE.replace(b"2026-11-24", b"yesterday"), b"[" * 100_000])
def test_a_bad_file_is_refused_in_a_sentence_and_left_alone(content, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(ratios, "ratios", lambda *_: pytest.fail("it measured before it had looked"))
    file = tmp_path / "history.jsonl"
    file.write_bytes(content)
    assert main(["bench", "--history", str(file)]) == 2
    said = capsys.readouterr()
    assert said.out == "" and said.err.count("\n") == 1 and "give another file" in said.err
    assert file.read_bytes() == content and [path.name for path in tmp_path.iterdir()] == ["history.jsonl"]


@pytest.mark.parametrize(("flags", "words"), [
    (["--history", "a.png"], "is the name of a picture"),
    (["--history", "no/such/folder/a.jsonl"], "cannot be written"),
    (["--history", "/dev/null"], "is no file"), (["--history", "a.jsonl", "--class", "3"], "goes without --class"),
    (["--history"], "give a file")])
def test_bad_flags_are_one_line(flags, words, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["bench", *flags]) == 2
    said = capsys.readouterr().err
    assert words in said and said.count("\n") == 1 and list(tmp_path.iterdir()) == []


def test_without_a_compiler_it_says_so(tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("CXX", "no-such-compiler")
    assert main(["bench", "--quick", "--quiet", "--history", str(tmp_path / "a.jsonl")]) == 2
    assert "there is no C++ compiler (no-such-compiler); install one" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_processor_that_a_program_is_not_for_is_named(tmp_path, monkeypatch):
    """The ring's rate is then missing with the reason, and the bar's is there."""
    monkeypatch.setattr(program, "FLAGS", ("-std=c++17",))  # the least that every processor has
    try:
        program.compiler()
    except program.NoLimit as why:
        (pytest.fail if os.environ.get("CI") else pytest.skip)(f"{why}: with one this test runs")
    with pytest.raises(program.NoLimit, match="the C\\+\\+ of the ring does not compile"):
        program.Program("ring", tmp_path)


def test_the_picture_has_a_line_for_each_case_and_a_name_for_each_entry():
    found = [ENTRY, {**ENTRY, "commit": None, "machine": {**ENTRY["machine"], "load": 9.0}}]
    figure = history_figure(found)
    [axes] = figure.axes
    lines = {line.get_label(): list(line.get_ydata()) for line in axes.get_lines()}
    assert lines[method_name("ugimp")] == [0.84, 0.84]
    assert [label.get_text() for label in axes.get_xticklabels()] == ["2026-11-24\n8c54749", "2026-11-24\n0.1.0"]
    assert [busy(entry) for entry in found] == [False, True]


def test_cases_are_there_and_a_folder_is_no_history(tmp_path):
    for case in ratios.cases():
        PROBLEMS[case.problem].scene(method=case.method, cells=case.cells)
        assert (program.HERE / f"{case.problem}.cpp").is_file()
    with pytest.raises(HistoryError, match="is no file"):
        content_of(tmp_path)


def test_a_commit_is_named_where_there_is_one(monkeypatch, tmp_path):
    monkeypatch.setattr(history, "ROOT", tmp_path)
    assert history.commit() is None
