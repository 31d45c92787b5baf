"""A lesson's file: what it says, and every mistake with its line and what was expected; and what our own show."""

import re
from xml.etree import ElementTree

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app import shareable_state
from app.lessons import catalogue, class_plans
from app.lessons.catalogue import FOLDER, UnknownLesson, lesson_names, load_lessons, resolve_lesson_name
from app.lessons.lesson import EXPLAIN, LessonError, draw_numbers, fill_numbers
from app.lessons.lesson_parser import parse_lesson, read_lesson
from app.lessons.markdown_html import ELEMENTS, to_html, to_mathml
from solvers.scene.estimator_registry import ESTIMATORS

TEXT = """+++
title = "A test"
goals = ["see"]
controls = ["cells", "method"]
[[variants]]
A = 0.02
[[variants]]
A = 0.03
+++

Begin with A = {A}.

## Predict: What happens?

```question
kind = "choice"
options = ["nothing", "something"]
holds = ["order(grids.error.x.max) < 1", "order(grids.error.x.max) >= 1"]
```

## Run: Look

```run
grids = "bar cells=8,16 amplitude={A} periods=0.1"
stage = "grids"
```

```claims
order(grids.error.x.max) in 1..3   # second order
status == ok
```

## Observe: And?

```question
kind = "number"
expected = "first(grids.error.x.final)"
unit = "m"
```

## Explain: Why

Because $h^2$.

```teacher
Ask them.
```
"""


def use_folder(monkeypatch, folder):
    """Have all that reads lessons and pages for a class read those of this folder."""
    for function in (catalogue.lesson_names, catalogue.resolve_lesson_name, catalogue.load_lesson,
                     catalogue.load_lessons, catalogue.load_every_language):
        monkeypatch.setattr(function, "__defaults__", (folder,))
    for function in (class_plans.class_plan_names, class_plans.load_class_plan):
        monkeypatch.setattr(function, "__defaults__", (folder / "classes",))


def test_a_lesson_is_read():
    lesson = parse_lesson(TEXT, "test")
    assert (lesson.title, lesson.controls) == ("A test", ("cells", "method"))
    assert [step.kind for step in lesson.steps] == ["predict", "run", "observe", "explain"]
    assert lesson.runs["grids"].texts == ("bar cells=8 amplitude={A} periods=0.1",
                                          "bar cells=16 amplitude={A} periods=0.1")
    assert lesson.runs["grids"].varied == "cells" and lesson.steps[1].stage == lesson.runs["grids"].texts[0]
    assert [claim.text for claim in lesson.steps[1].claims] == ["order(grids.error.x.max) in 1..3", "status == ok"]
    assert lesson.steps[3].notes == "Ask them." and list(lesson.questions) == ["what-happens", "and"]
    assert [lesson.main_run(step) for step in lesson.steps] == ["grids"] * 4


@pytest.mark.parametrize("old, new, where, said", [
    ("+++\ntitle", "title", "title", "must begin with a head"),
    ('title = "A test"', 'title = "A test', "title", "this is no TOML"),
    ('title = "A test"\n', "", "goals", "title is missing"),
    ('title = "A test"\n', 'title = "A test"\nminutes = 20\n', "minutes", "minutes are computed from what the lesson"),
    ("goals", "goal", "goal", "goal is not known in a head"),
    ('"cells", "method"', '"cels"', "controls", "'cels' is not known; give problem, method"),
    ("A = 0.03", "B = 0.03", "[[variants]]", "is not like"),
    ("## Predict: What happens?", "## Pedict: What happens?", "## Pedict", "did you mean Predict?"),
    ("## Explain: Why", "## Explain", "## Explain", "begins no step"),
    ("## Predict: What", "## Predict (kern): What", "## Predict", "of a core round ## Predict (core): ..."),
    ("## Predict: What", "## Predict (core): What", "## Predict", "every round is (core); where none"),
    ("## Run: Look", "## Run (core): Look", "## Run", "the first step of a round, which is in line 13"),
    ('kind = "choice"', 'kind = "choose"', "kind", "give one of number, choice"),
    ('"nothing", "something"', '"nothing"', "kind", "give 2 to 8"),
    ('options = ["nothing"', 'choices = ["nothing"', "choices", "choices means nothing for a choice"),
    ('< 1", ', '< 1"', "holds", "this is no TOML"),
    (', "order(grids.error.x.max) >= 1"]', "]", "kind", "holds has 1 claims for 2 options"),
    ("cells=8,16", "cels=8", "grids =", "did you mean cells?"),
    ("cells=8,16", "cells=2,16", "grids =", "give a whole number from 4"),
    ('stage = "grids"', "on-the-stage = {particle = 32, phase = 2}", "on-the-stage", "a particle up to 31 and a phase"),
    ('stage = "grids"', "on-the-stage = {particle = 0, phase = 7}", "on-the-stage", "a phase up to 6"),
    ('stage = "grids"', "on-the-stage = {pause = true}", "on-the-stage", "give {particle = 0, phase = 1}"),
    ('stage = "grids"', 'status = "bar"', "status =", "has a meaning in claims"),
    ("in 1..3", "in 1", "in 1", "claims nothing"),
    ("status == ok", "statues == ok", "statues", "neither a run nor part of a result"),
    ('expected = "first(grids.error.x.final)"\n', "", 'kind = "number"', "expected is missing"),
    ('unit = "m"', "unit = 3", "unit", "unit = 3: give a text"),
    ("$h^2$", "$x^2^3$", "Because", "cannot be shown"),
    ("$h^2$", r"$\href{javascript:f()}{h}$", "Because", "has href=javascript:f(), which cannot be shown"),
    ("$h^2$", r"$\style{color:red}{h}$", "Because", "has style=color:red"),
    ("$h^2$", r"$\class{lab-notice}{h}$", "Because", "has class=lab-notice"),
    ("$h^2$", r"$\color{red;x:y}{h}$", "Because", "has mathcolor=red;x:y"),
    ("$h^2$", r"$\fcolorbox{red}{blue}{h}$", "Because", "has border-color=red"),
    ("Because", "![a](b.svg)", "![a]", "the picture b.svg is not there"),
    ("Because", "{B}", "{B}", "{B} is no number of a variant"),
    ("```teacher\nAsk them.\n```", "```teacher\nAsk them.", "```teacher", "does not end"),
    ("```teacher", "```teachers", "```teachers", "a block 'teachers' is not known"),
    ("## Observe: And?", "## Observe: What happens?", "## Observe", "is called as the one in line 13"),
    ("```run", "```question", "```question\ngrids", "has no question block"),
])
def test_a_mistake_is_told_with_its_line(old, new, where, said):
    assert old in TEXT
    text = TEXT.replace(old, new, 1)
    with pytest.raises(LessonError) as mistake:
        parse_lesson(text, "test")
    assert said in mistake.value.sentence
    assert mistake.value.line == text[:text.index(where)].count("\n") + 1


@given(st.text(alphabet="<>&;/='\"!-#x3c abimgscript", max_size=60))
def test_text_in_a_formula_is_text(text):
    """Of any that a lesson's author writes, also as a character reference, no element comes."""
    formula = ElementTree.fromstring(to_mathml(rf"\text{{{text}}} + \mbox{{{text}}} + \tag{{{text}}}", True))
    assert {element.tag.partition("}")[2] for element in formula.iter()} <= ELEMENTS
    assert "<b>" not in to_mathml(r"\unicode{3c}b\unicode{3e}", False)
    assert "<a" not in to_html("$$h$$ (lab-stage)") and "id=" not in to_html("$$h$$ (lab-stage)")


def test_a_file_that_is_no_text_is_told(tmp_path):
    (tmp_path / "07-bad.md").write_bytes(TEXT.encode() + b"\xff")
    with pytest.raises(LessonError, match="UTF-8"):
        read_lesson(tmp_path / "07-bad.md")


def test_an_editors_mark_and_line_ends_change_nothing(tmp_path):
    (tmp_path / "07-good.md").write_bytes(TEXT.replace("\n", "\r\n").encode("utf-8-sig"))
    assert read_lesson(tmp_path / "07-good.md").steps == parse_lesson(TEXT, "07-good", tmp_path).steps


def test_numbers_are_drawn_from_the_name():
    lesson = parse_lesson(TEXT, "test")
    assert draw_numbers(lesson, "") == {"A": 0.02}
    assert draw_numbers(lesson, "Ada Lovelace") == draw_numbers(lesson, "  ada   LOVELACE ")
    assert {draw_numbers(lesson, f"student {k}")["A"] for k in range(20)} == {0.02, 0.03}
    assert fill_numbers("A = {A}, $\\frac{h}{2}$", {"A": 0.02}) == "A = 0.02, $\\frac{h}{2}$"


def test_lessons_are_found_by_name_and_number():
    full = lesson_names()
    assert len(full) == len(load_lessons()) == 11
    assert (
        resolve_lesson_name("4")
        == resolve_lesson_name("04")
        == resolve_lesson_name("grid-crossing")
        == resolve_lesson_name("04-grid-crossing")
        == full[3]
    )
    with pytest.raises(UnknownLesson, match="give one of 01-"):
        resolve_lesson_name("99")


def test_prerequisites_and_pictures_of_our_lessons_are_there():
    for lesson in load_lessons().values():
        assert set(lesson.prerequisites) <= set(lesson_names())
        assert lesson.notes or any(step.notes for step in lesson.steps)
    assert (FOLDER / "README.md").exists()


BESIDE = 400  # pixels of a figure in a window of 1280
LEAST = 11  # pixels of letters
FIGURES = sorted((FOLDER / "figures").glob("*.svg"))


@pytest.mark.parametrize("figure", FIGURES, ids=lambda path: path.stem)
def test_letters_of_a_figure_can_be_read_beside_the_stage(figure):
    text = figure.read_text(encoding="utf-8")
    width = float(re.search(r'viewBox="0 0 ([\d.]+)', text)[1])
    sizes = [float(size) for size in re.findall(r'font-size="([\d.]+)"', text)]
    assert sizes and min(sizes) * BESIDE / width >= LEAST


@pytest.mark.parametrize("name", lesson_names())
def test_an_estimate_is_on_the_stage_only_where_the_text_speaks_of_it(name):
    """In one of the steps until it is explained; or where the reader chooses estimators."""
    lesson = load_lessons()[name]
    for k, step in enumerate(lesson.steps if "estimators" not in lesson.controls else ()):
        end = next((j for j, other in enumerate(lesson.steps[k:], k + 1) if other.kind == EXPLAIN), len(lesson.steps))
        said = " ".join(f"{other.title} {other.text}" for other in lesson.steps[k:end])
        for numbers in lesson.variants if step.stage else ():
            asked = shareable_state.parse_state(fill_numbers(step.stage, numbers)).scene.estimators
            assert not asked or any(name in said for name in (*ESTIMATORS, "estimat")), (step.key, asked)


@pytest.mark.parametrize(("scene", "said"), [
    ("body", "give body and one of cantilever"), ("body beam", "give body and one of cantilever"),
    ("body cantilever cells=4", "cells is no part of a body's run"),
    ("body cantilever ppc=1,2", "ppc = 1,2: give a number"),
    ("body cantilever cells_per_metre=none", "cells_per_metre = none: give a number"),
    ("body cantilever poissons_ratio=0.5", "give a number from 0 to 0.49")])
def test_a_run_of_a_body_that_cannot_be(scene, said):
    text = f"+++\ntitle = \"T\"\ngoals = [\"G\"]\n+++\n## Run: A beam\n\n```run\nbeam = \"{scene}\"\n```\n"
    with pytest.raises(LessonError, match=re.escape(said)):
        parse_lesson(text, "test")


def test_a_run_of_a_body_has_no_stage():
    text = "+++\ntitle = \"T\"\ngoals = [\"G\"]\n+++\n## Run: A\n\n```run\nbeam = \"body cantilever ppc=1\"\n{}```\n"
    assert parse_lesson(text.format(""), "test").steps[0].stage == ""
    with pytest.raises(LessonError, match="a body is not put on the stage"):
        parse_lesson(text.format("stage = \"body cantilever\"\n"), "test")
