"""Whatever is quoted in a refusal is harmless and short: hostile text is fed to every flag, field and lesson
(files of particles: ``tests/solvers/judging/test_hostile_files.py``)."""

from __future__ import annotations

import csv
import io
import json
from contextlib import ExitStack
from dataclasses import fields
from unittest.mock import patch

import pytest

from app import shareable_state
from app.cli import main
from app.commands import commands
from app.lessons import catalogue, grading, student_progress
from app.lessons.claims import ClaimError, check_claim
from app.lessons.lesson import LessonError
from app.lessons.lesson_parser import parse_lesson
from app.lessons.markdown_html import RenderError, to_html
from app.page.visit.status_message import Notice
from solvers.problems import PROBLEMS
from solvers.scene.validation import SceneError
from solvers.study.csv_and_markdown_summary import csv_text, summarise_study
from solvers.study.row_store import NAME, RowStore, StoreError

EVIL = "\x1b]0;owned\x07\x1b[31m\u202e\u2066evil\x9b2J"
TEXTS = [EVIL, EVIL * 300, "9" * 10_000, "=cmd|' /C calc'!A0\t;=1" + EVIL,
         "<img src=x>![](http://evil.example)`" + EVIL]
LONGEST = 410  # letters of a message
SLOW = ("app.page.page_server.serve", "app.commands.run.command._run_and_try_cures",
        "app.commands.run.budget_command.show_progress", "app.commands.bench.command.show_progress",
        "app.commands.lesson.show_progress",
        "app.commands.export.show_progress", "app.commands.judge.command.show_progress",
        "app.commands.check.contradiction_check.show_progress", "app.commands.judge.problem._handout_files",
        "app.commands.study.study_command.Study._executor", "app.commands.study.advise.Advise._search")


class Begun(BaseException):
    """A command was let in."""


def begin(*_, **__) -> None:
    raise Begun


def harmless(said: str) -> None:
    assert all(line.isprintable() and len(line) <= LONGEST for line in said.split("\n")), ascii(said)[:600]


@pytest.mark.parametrize(("name", "texts"), [
    *(pytest.param(name, TEXTS[1:2], id="-".join(name)) for name in commands() if name[-1] not in ("ring", "vortex")),
    *(pytest.param(name, TEXTS, id="-".join((*name, "all")), marks=pytest.mark.slow) for name in commands())])
def test_every_flag_of_every_command(name, texts, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    flags = [f.name for f in fields(commands()[name])]
    lines = [[f"--{flag.replace('_', '-')}", text] for flag in flags for text in texts] + [[text] for text in texts]
    lines += [[f"--{text}"] for text in texts]
    with ExitStack() as patches:
        for place in SLOW:
            patches.enter_context(patch(place, begin))
        for k, line in enumerate(lines):
            out = ["--out", f"out{k}"] if "--out" not in line and "out" in flags else []
            try:
                assert main([*name, *line, *out]) in (0, 1, 2)
            except Begun:
                continue
            said = capsys.readouterr().err
            assert (said.startswith("mpm-lab: ") and "failed:" not in said) or not said
            harmless(said)


@pytest.mark.parametrize("problem", PROBLEMS)
@pytest.mark.parametrize("text", TEXTS, ids=range(len(TEXTS)))
def test_every_field_of_a_scene_and_word_of_a_state(problem, text):
    kind = PROBLEMS[problem].scene
    for name in (field.name for field in fields(kind) if field.name != "problem"):
        for value in (text, (text,), 10**5000, float("nan")):
            try:
                kind(**{name: value})
            except SceneError as error:
                harmless(str(error))
                harmless(error.sentence)
        for word in (f"{name}={text}", f"{text}={name}", f"pinned;{name}={text}"):
            with pytest.raises(shareable_state.StateError) as refusal:
                shareable_state.parse_state(f"{problem};{word}")
            harmless(str(refusal.value))
    for word in shareable_state.VIEW:
        with pytest.raises(shareable_state.StateError) as refusal:
            shareable_state.parse_state(f"{problem};{word}={text}")
        harmless(str(refusal.value))


LESSON = """+++
title = "T"
goals = ["g"]
{head}
+++
{intro}

## Run: First
```run
hat = "{scene}"
```
```claims
{claim}
```
{heading}
"""
FINE = {"head": "", "intro": "", "scene": "bar cells=20", "claim": "error.x.max < 1", "heading": ""}


@pytest.mark.parametrize("text", TEXTS, ids=range(len(TEXTS)))
@pytest.mark.parametrize("place, wrong", [
    ("head", '{} = 1'), ("head", 'controls = ["{}"]'), ("head", "x = {}"), ("scene", "bar {}"), ("scene", "{}"),
    ("claim", "{} < 1"), ("claim", "error.{} < 1"), ("claim", "{}"), ("heading", "## {}: x"), ("heading", "```{}\n```"),
    ("intro", "![]({})"), ("intro", "${}$"), ("intro", "$\\{}$")])
def test_every_part_of_a_lesson(place, wrong, text):
    bare = json.dumps(text, ensure_ascii=False)[1:-1] if place == "scene" or '"{}"' in wrong else text
    try:
        parse_lesson(LESSON.format(**FINE | {place: wrong.replace("{}", bare)}), "a")
    except LessonError as error:
        harmless(str(error))
        harmless(error.sentence)


@pytest.mark.parametrize("text", TEXTS, ids=range(len(TEXTS)))
def test_claims_pictures_names_and_notices(text):
    for act, refusal in ((lambda: check_claim(text, {}, ""), ClaimError),
                         (lambda: catalogue.resolve_lesson_name(text), catalogue.UnknownLesson),
                         (lambda: to_html(f"![]({'x' * 9000}.svg)"), RenderError)):
        with pytest.raises(refusal) as found:
            act()
        harmless(str(found.value))
    said = Notice("refused", text).html
    assert said.isprintable() and "<img" not in said and len(said) < 1300


ANSWERS = {"schema": student_progress.SCHEMA, "lesson": "01-one-step", "fingerprint": "", "name": "", "step": 0,
           "answers": {}}


@pytest.mark.parametrize("text", TEXTS, ids=range(len(TEXTS)))
def test_every_field_of_handed_in_answers(text, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    wrong = [{key: text} for key in ("schema", "lesson", "step", "answers")] + [
        {"answers": {text: value}} for value in (text, {"first": 1}, {})] + [{"name": [text]}]
    for k, part in enumerate(wrong):
        (tmp_path / f"{k}.json").write_text(json.dumps(ANSWERS | part, ensure_ascii=False), encoding="utf-8")
    (tmp_path / "text.json").write_text(text, encoding="utf-8")
    name = text[:40].replace("/", "_")
    (tmp_path / f"{name}.json").write_text("no JSON", encoding="utf-8")
    files = [str(path) for path in tmp_path.iterdir()]
    assert main(["lesson", "grade", *files, text[:90]]) == 1
    said = capsys.readouterr()
    assert said.err.count("\n") == len(files) + 1
    harmless(said.err)


@pytest.mark.parametrize("text", TEXTS, ids=range(len(TEXTS)))
def test_tables_hold_no_formula_and_nothing_that_does_not_show(text):
    lesson = catalogue.load_lessons()["01-one-step"]
    key = next(key for key, step in lesson.questions.items())
    found = grading.GradedFile(text, student_progress.StudentProgress("01-one-step", "", text), lesson,
                               lesson.questions,
                            {key: (text, None)})
    row = {"scene": {"method": text, text: text}, "asked": {}, "status": "failed", "reason": text, "index": None}
    for table in (grading.grades_csv([found]), csv_text([row])):
        cells = [cell for cut in ",;" for line in csv.reader(io.StringIO(table), delimiter=cut) for cell in line]
        assert all(cell.isprintable() and not cell.startswith(tuple("=+-@\t\r")) for cell in cells)
    assert "\n* " in summarise_study("bar", [row]) and "<img" not in to_html(summarise_study("bar", [row]))
    assert all(line.isprintable() for line in summarise_study("bar", [row]).split("\n"))


@pytest.mark.parametrize("text", TEXTS, ids=range(len(TEXTS)))
def test_rows_of_a_sweep_that_is_resumed(text, tmp_path):
    for content in (text, json.dumps({"schema": text}), json.dumps({text: text, "problem": text}), "x" * 1_100_000):
        (tmp_path / NAME).write_text(content + "\n", encoding="utf-8")
        with pytest.raises(StoreError) as refusal:
            RowStore(tmp_path, "bar", resume=True)
        harmless(str(refusal.value))
