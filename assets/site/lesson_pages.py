"""Lessons as pages: read by the lab's own reader, as a student without a name meets them, before the first answer.

What is hidden in the lab until a question is answered is folded here; claims, right answers and the teacher's notes are
left out. A button of the lab that puts a run on the stage is a link to a lab that runs on this machine.
"""

from collections.abc import Iterator
from string import ascii_lowercase
from typing import Any

from app import shareable_state
from app.commands.serve import Serve
from app.lessons import catalogue
from app.lessons.fenced_blocks import parse_toml
from app.lessons.lesson import (
    CHOICE,
    DRAG,
    EXPLAIN,
    INTERVAL,
    NAMES,
    NUMBER,
    PREDICT,
    TEXT,
    Lesson,
    Numbers,
    Question,
    Step,
    draw_numbers,
    fill_numbers,
)
from app.lessons.lesson_parser import parse_lesson, split_head, split_sections
from app.lessons.prediction_rounds_and_core import split_rounds
from app.page.features.lesson import progress_and_navigation
from app.page.features.sharing import state_link

FOLDER = "lessons/"
CLASSES = "lessons/classes/"
LAB = f"http://127.0.0.1:{Serve.port}/"
DEEPER = "<small class='deeper'>Deeper: this round is not part of the core.</small>"
BUTTON = "Press **On the stage**"
#: How an answer is given; a choice shows its options.
GIVEN = {NUMBER: "A number{unit}.", INTERVAL: "Two numbers{unit} that hold it between them.",
         TEXT: "A sentence or two, for your teacher."}


def setup(app: Any) -> dict:
    """Lessons' files become Markdown that every reader knows, on their way into the site."""
    app.connect("source-read", as_page)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def as_page(app: Any, docname: str, source: list[str]) -> None:
    """The page of a lesson's file in the place of its text, and of one for a class."""
    name = docname.removeprefix(FOLDER)
    if docname.startswith(FOLDER) and name in catalogue.lesson_names():
        source[0] = page(parse_lesson(source[0], name, catalogue.FOLDER))
    if docname.startswith(CLASSES):
        source[0] = class_page(source[0])


def class_page(text: str) -> str:
    """A page for a class as Markdown: its title for its head, and no runs and claims."""
    head, body, first = split_head(text)
    parts = (f"{part.heading}\n" + "\n".join(part.text) for part in split_sections(body, first))
    return f"# {parse_toml(head, 2)['title']}\n\n" + "\n\n".join(parts) + "\n"


def page(lesson: Lesson) -> str:
    """A lesson as Markdown, with the numbers that a student without a name gets."""
    numbers = draw_numbers(lesson, "")
    before = ", ".join(f"[{catalogue.load_lesson(name).title}]({name}.md)" for name in lesson.prerequisites)
    parts = [f"# {lesson.title}", progress_and_navigation.duration_text(lesson),
             "\n".join(f"* {goal}" for goal in lesson.goals), f"Do before: {before}." if before else "",
             f"In the lab: `mpm-lab serve --lesson {lesson.name}`, or the tab *Lessons*. Links *On the stage* lead to "
             "a lab that runs on this machine.", lesson.intro]
    deeper = [first for first, *_ in split_rounds(lesson.steps) if not first.core]
    for number, step in enumerate(lesson.steps, 1):
        parts += [DEEPER] * (step in deeper)
        parts += (_explained if step.kind == EXPLAIN else _step)(lesson, step, number, numbers)
    return fill_numbers("\n\n".join(part for part in parts if part.strip()), numbers) + "\n"


def _step(lesson: Lesson, step: Step, number: int, numbers: Numbers) -> Iterator[str]:
    yield f"## {number}. {step.kind.capitalize()}: {step.title}"
    yield _text(lesson, step, numbers)
    if step.question:
        yield f":::{{admonition}} {_asks(step)}\n:class: question\n\n{_answers(step.question)}\n:::"


def _explained(lesson: Lesson, step: Step, number: int, numbers: Numbers) -> Iterator[str]:
    """Folded, title and all, for the title may be the answer."""
    yield f"<details class='explain'><summary>{number}. Explain: open it when you have answered</summary>"
    yield f":::{{rubric}} {step.title}\n:::"
    yield _text(lesson, step, numbers)
    yield "</details>"


def _text(lesson: Lesson, step: Step, numbers: Numbers) -> str:
    """A step's text, with a link where the lab has the button that puts the step's run on its stage."""
    if not step.stage:
        return step.text
    scene = fill_numbers(step.stage, numbers)
    linked = f"Press **[On the stage]({LAB}#{state_link(shareable_state.parse_state(scene), lesson.name)})**"
    text = step.text.replace(BUTTON, linked) if BUTTON in step.text else f"{step.text}\n\n- {linked}."
    return f"{text}\n\n<small class='scene'>On the stage:</small> `{scene}`"


def _asks(step: Step) -> str:
    return "What do you predict?" if step.kind == PREDICT else "What do you answer?"


def _answers(asked: Question) -> str:
    """How an answer is given, and not which is right."""
    if asked.kind == CHOICE:
        letters = zip(ascii_lowercase, asked.options, strict=False)  # as the lab counts them
        return "\n".join(f"- **{letter})** {option}" for letter, option in letters)
    if asked.kind == DRAG:
        return f"Leave **{NAMES[asked.control]}** where you mean."
    return GIVEN[asked.kind].format(unit=f" in {asked.unit}" if asked.unit else "")
