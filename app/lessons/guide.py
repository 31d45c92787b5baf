"""The teacher's guide to a lesson: its steps, notes and right answers, as Markdown or as a page to print."""

from collections.abc import Callable, Iterator
from pathlib import Path

from app.lessons.claims import ClaimError
from app.lessons.length import round_minutes, told
from app.lessons.lesson import CHOICE, TEXT, Lesson, Numbers, Step
from app.lessons.marks import in_unit, right
from app.lessons.markup import html
from app.lessons.outcomes import Outcomes, RunFailed
from app.lessons.rounds import rounds
from app.lessons.shelf import FOLDER
from app.templates import rendered
from solvers.study.markdown import grid

PAGE = Path(__file__).parent / "guide.html"


def markdown(lesson: Lesson, outcomes: Outcomes, core: bool = False) -> str:
    """The guide as Markdown, or that to the ``core`` alone. Runs what the right answers need."""
    parts = [f"# {lesson.title}", _length(lesson, core), "Afterwards students can",
             "\n".join(f"* {goal}" for goal in lesson.goals)]
    if lesson.prerequisites:
        parts.append(f"Do before: {', '.join(lesson.prerequisites)}.")
    flag = " --core" if core else ""
    parts += [f"Open the class on it: `mpm-lab serve --lesson {lesson.name}{flag}`. Handed-in files become one table "
              f"by `mpm-lab lesson grade FILES{flag}`.", *_variants(lesson), lesson.intro, _quoted(lesson.notes)]
    numbers = {step.key: number for number, step in enumerate(lesson.walk(core), 1)}
    for one in rounds(lesson.walk(core)):
        for step in one:
            stage = f"On the stage: `{step.stage}`" if step.stage else ""
            parts += [f"## {numbers[step.key]}. {step.kind.capitalize()}: {step.title}",
                      _round(lesson, one) if step is one[0] else "", step.text, stage,
                      *_question(lesson, step, outcomes), _quoted(step.notes)]
    return "\n\n".join(part for part in parts if part.strip()) + "\n"


def page(lesson: Lesson, outcomes: Outcomes, core: bool = False) -> str:
    """The guide as one html file, with its pictures in it."""
    return rendered(PAGE, title=lesson.title, body=html(markdown(lesson, outcomes, core), FOLDER))


def _length(lesson: Lesson, core: bool) -> str:
    if core:
        return f"*Teacher's guide to the core, which takes {lesson.core_minutes} minutes, without a talk.*"
    return f"*Teacher's guide. {told(lesson)}, without a talk.*"


def _round(lesson: Lesson, one: tuple[Step, ...]) -> str:
    """What a round is, before its first step."""
    takes = round_minutes(one, lesson)
    return f"*This round takes {takes} min.*" if one[0].core else \
        f"*Deeper: the core does without this round, which takes {takes} min.*"


def _variants(lesson: Lesson) -> Iterator[str]:
    names = list(lesson.variants[0])
    if names:
        rows = ([str(k), *(f"{numbers[name]}" for name in names)] for k, numbers in enumerate(lesson.variants, 1))
        yield "Numbers differ from student to student, drawn from the name:\n\n" + grid(["variant", *names], rows)


def _question(lesson: Lesson, step: Step, outcomes: Outcomes) -> Iterator[str]:
    asked = step.question
    if asked is None:
        return
    if asked.options:
        yield "\n".join(f"{k}. {option}" for k, option in enumerate(asked.options, 1))
    if asked.kind == TEXT:
        yield "**Answer:** free text, which is not marked."
        return
    answers = [_answer(lesson, step, numbers, outcomes) for numbers in lesson.variants]
    if len(set(answers)) == 1:
        yield f"**Answer:** {answers[0]}"
    else:
        yield "**Answer:**\n\n" + grid(["variant", "answer"], ([str(k), one] for k, one in enumerate(answers, 1)))


def _answer(lesson: Lesson, step: Step, numbers: Numbers, outcomes: Outcomes) -> str:
    try:
        found = right(lesson, step, numbers, outcomes)
    except (ClaimError, RunFailed) as error:
        return f"could not be worked out: {error}"
    return found.told if step.asked.kind == CHOICE else in_unit(step.asked, found.value)


def _quoted(notes: str) -> str:
    """Notes set apart from what students see."""
    return "\n".join(f"> {line}" for line in ["**Teacher**", "", *notes.splitlines()]) if notes.strip() else ""


KINDS: dict[str, Callable[[Lesson, Outcomes, bool], str]] = {".md": markdown, ".html": page}
