"""The teacher's guide to a lesson: steps, notes and right answers, as Markdown or as a page to print."""

from collections.abc import Callable, Iterator
from html import escape
from pathlib import Path

from app.language.translation import current_language, tr
from app.lessons.answer_marking import format_in_unit, right_answer
from app.lessons.catalogue import FOLDER
from app.lessons.claims import ClaimError
from app.lessons.duration import minutes_text, seconds_of_rounds, whole_minutes
from app.lessons.lesson import CHOICE, TEXT, TITLES, Lesson, Numbers, Step
from app.lessons.lesson_runs import RunCache, RunFailed
from app.lessons.markdown_html import to_html
from app.lessons.prediction_rounds_and_core import split_rounds
from app.templates import render_template
from solvers.study.markdown_tables import markdown_table

PAGE = Path(__file__).parent / "guide.html"


def guide_markdown(lesson: Lesson, outcomes: RunCache, core: bool = False) -> str:
    """Returns the teacher's guide to a lesson, or to its core, as Markdown; runs scenes for the right answers."""
    length = tr("*Teacher's guide to the core, which takes {minutes} minutes, without discussion.*",
                minutes=lesson.core_minutes) if core else \
        tr("*Teacher's guide. {length}, without discussion.*", length=minutes_text(lesson))
    parts = [f"# {lesson.title}", length, tr("Afterwards students can"),
             "\n".join(f"* {goal}" for goal in lesson.goals)]
    if lesson.prerequisites:
        parts.append(tr("Do before: {lessons}.", lessons=", ".join(lesson.prerequisites)))
    variants = ""
    if names := list(lesson.variants[0]):
        rows = ([str(k), *(f"{numbers[name]}" for name in names)] for k, numbers in enumerate(lesson.variants, 1))
        differ = tr("Numbers differ from student to student, drawn from the name:")
        variants = f"{differ}\n\n{markdown_table([tr('variant'), *names], rows)}"
    flag = " --core" if core else ""
    parts += [tr("Open the class on it: `mpm-lab serve --lesson {name}`. Handed-in files become one table by "
                 "`mpm-lab lesson grade {files}`.", name=f"{lesson.name}{flag}", files=f"FILES{flag}"),
              variants, lesson.intro, _quote_notes(lesson.notes)]
    numbers = {step.key: number for number, step in enumerate(lesson.steps_to_take(core), 1)}
    for one in split_rounds(lesson.steps_to_take(core)):
        takes = whole_minutes(seconds_of_rounds(one, lesson))
        begins = tr("*This round takes {minutes} min.*", minutes=takes) if one[0].core else \
            tr("*Deeper: this round is not part of the core and takes {minutes} min.*", minutes=takes)
        for step in one:
            stage = tr("On the stage: `{scene}`", scene=step.stage) if step.stage else ""
            parts += [f"## {numbers[step.key]}. {tr(TITLES[step.kind])}: {step.title}",
                      begins if step is one[0] else "", step.text, stage,
                      *_question_markdown(lesson, step, outcomes), _quote_notes(step.notes)]
    return "\n\n".join(part for part in parts if part.strip()) + "\n"


def guide_page(lesson: Lesson, outcomes: RunCache, core: bool = False) -> str:
    """Returns the teacher's guide to a lesson, or to its core, as one html file with its pictures; runs scenes."""
    return render_template(PAGE, language=current_language(), title=escape(lesson.title),
                           body=to_html(guide_markdown(lesson, outcomes, core), FOLDER))


def _question_markdown(lesson: Lesson, step: Step, outcomes: RunCache) -> Iterator[str]:
    """Yields Markdown for a step's question: options, and the right answer, by variant where it differs."""
    asked = step.question
    if asked is None:
        return
    if asked.options:
        yield "\n".join(f"{k}. {option}" for k, option in enumerate(asked.options, 1))
    if asked.kind == TEXT:
        yield tr("**Answer:** free text, which is not marked.")
        return
    answers = [_right_answer_text(lesson, step, numbers, outcomes) for numbers in lesson.variants]
    if len(set(answers)) == 1:
        yield tr("**Answer:** {answer}", answer=answers[0])
    else:
        rows = ([str(k), one] for k, one in enumerate(answers, 1))
        yield tr("**Answer:**") + "\n\n" + markdown_table([tr("variant"), tr("answer")], rows)


def _right_answer_text(lesson: Lesson, step: Step, numbers: Numbers, outcomes: RunCache) -> str:
    try:
        found = right_answer(lesson, step, numbers, outcomes)
    except (ClaimError, RunFailed) as error:
        return tr("could not be worked out: {why}", why=error)
    return found.text if step.asked_question.kind == CHOICE else format_in_unit(step.asked_question, found.value)


def _quote_notes(notes: str) -> str:
    """Returns the teacher's notes as a Markdown block quote, or "" without any."""
    return "\n".join(f"> {line}" for line in [tr("**Teacher**"), "", *notes.splitlines()]) if notes.strip() else ""


KINDS: dict[str, Callable[[Lesson, RunCache, bool], str]] = {".md": guide_markdown, ".html": guide_page}
