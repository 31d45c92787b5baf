"""Class plans for teachers, in ``lessons/classes/``: which cores to take when, and what to say.

A file begins with a head: its ``title``, and the ``minutes`` of a session. A table with the columns ``from``,
``minutes`` and ``what`` is a timetable; a row that links a lesson has the time of its core, and up to ``TALK`` more."""

import functools
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

from app.lessons import catalogue, fenced_blocks, lesson_check, lesson_parser
from app.lessons.lesson import RUN, Lesson, LessonError, Step
from app.lessons.lesson_check import CheckedClaim
from app.lessons.lesson_parser import LessonSection, number_lines, split_head, split_sections
from app.lessons.lesson_runs import RunCache

FOLDER = catalogue.FOLDER / "classes"
TALK = 5  # minutes that a row may have beyond its core
ALLOWED = ("run", "claims")
COLUMNS = ("from", "minutes", "what")
LINK = re.compile(r"\]\(\.\./([\w-]+)\.md\)")


@dataclass(frozen=True)
class TimetableRow:
    """Row of a timetable: line in the file, start and length in minutes, and the lesson that it links, or ""."""

    line: int
    start: int
    minutes: int
    lesson: str


@dataclass(frozen=True)
class ClassPlan:
    """Class plan: minutes of a session, ``claims`` and their runs as a lesson, rows of timetables by heading."""

    name: str
    minutes: int
    claims: Lesson
    sessions: Mapping[str, tuple[TimetableRow, ...]]


def class_plan_names(folder: Path = FOLDER) -> list[str]:
    """Returns the sorted names of the class plans in a folder."""
    return sorted(path.stem for path in folder.glob("*.md"))


def load_class_plan(name: str, folder: Path = FOLDER) -> ClassPlan:
    """Reads a class plan by its name; raises :class:`LessonError` if its file is invalid."""
    return lesson_parser.parse_file(folder / f"{name}.md", lambda text: parse_class_plan(text, name))


def parse_class_plan(text: str, name: str) -> ClassPlan:
    """Parses the Markdown of a class plan; raises :class:`LessonError` if it is invalid."""
    head, body, first = split_head(text)
    values = fenced_blocks.parse_toml(head, 2)
    at = functools.partial(fenced_blocks.line_of_key, text=head, line=2)
    for key in values:
        if key not in ("title", "minutes"):
            raise LessonError(at(key), f"{key} is not known in the head of a page for a class; give title, minutes")
    title = fenced_blocks.require_value(values, "title", str, "give a text", at("title"))
    minutes = fenced_blocks.require_value(values, "minutes", int, "give the whole minutes of a session", at("minutes"))
    every = split_sections(body, first)
    claims = Lesson(name, title, (), (), steps=tuple(_section_to_step(part) for part in every))
    lesson_parser.check_unique_names(claims)
    lesson_parser.check_claims(claims)
    sessions = {part.heading.removeprefix("## "): rows for part in every if (rows := _parse_timetable(part))}
    if not sessions:
        raise LessonError(first, f"no timetable: give a table with the columns {', '.join(COLUMNS)}")
    return ClassPlan(name, minutes, claims, sessions)


def check_class_plan(plan: ClassPlan, lessons: Mapping[str, Lesson], outcomes: RunCache) -> Iterator[CheckedClaim]:
    """Yields checks of a plan's claims, whose scenes are run, and of its timetables; ``lessons`` are by name."""
    yield from lesson_check.check_lesson(plan.claims, outcomes)
    for session, rows in plan.sessions.items():
        total = sum(row.minutes for row in rows)
        yield CheckedClaim(plan.name, session, rows[0].line, f"the minutes add up to {plan.minutes}",
                           total == plan.minutes, f"found {total}")
        for before, row in pairwise(rows):
            end = before.start + before.minutes
            yield CheckedClaim(plan.name, session, row.line, f"begins at {end}", row.start == end, f"found {row.start}")
        for row in rows:
            if row.lesson:
                yield _check_core_time(plan, session, row, lessons)


def _check_core_time(plan: ClassPlan, session: str, row: TimetableRow, lessons: Mapping[str, Lesson]) -> CheckedClaim:
    """Checks whether a row has the minutes of its lesson's core, up to ``TALK`` more; ``session`` is its heading."""
    lesson = lessons.get(row.lesson)
    if lesson is None:
        return CheckedClaim(plan.name, session, row.line, f"{row.lesson} is a lesson", False, "there is none")
    least = lesson.core_minutes
    return CheckedClaim(plan.name, session, row.line, f"the core of {row.lesson} has {least} to {least + TALK} minutes",
                        least <= row.minutes <= least + TALK, f"found {row.minutes}")


def _section_to_step(part: LessonSection) -> Step:
    """Returns a section of a class plan as a lesson's step with its runs and claims; raises :class:`LessonError`."""
    title = part.heading.removeprefix("## ").strip()
    step = Step(RUN, title, f"line-{part.line}", part.line, "\n".join(part.text).strip())
    for kind, text, line in part.blocks:
        if kind not in ALLOWED:
            raise LessonError(line - 1, f"a page for a class has no {kind} block; it may have {', '.join(ALLOWED)}")
        if kind == "run":
            runs, stage, _ = fenced_blocks.parse_runs_and_stage(text, line, ({},))
            step = replace(step, runs=runs, stage=stage)
        else:
            step = replace(step, claims=fenced_blocks.parse_claims(text, line))
    return step


def _parse_timetable(part: LessonSection) -> tuple[TimetableRow, ...]:
    """Returns the rows of the timetable in a section, empty if it has none; raises :class:`LessonError`."""
    rows, inside = [], False
    for line, text in number_lines(part):
        cells = [cell.strip() for cell in text.strip().strip("|").split("|")]
        if tuple(cells) == COLUMNS:
            inside = True
        elif not text.startswith("|"):
            inside = False
        elif inside and not set(text) <= set("|:- "):
            if len(cells) != len(COLUMNS) or not (cells[0].isdecimal() and cells[1].isdecimal()):
                raise LessonError(line, "a row of a timetable has the minute from which it is, whole minutes, and what "
                                        "it is")
            link = LINK.search(cells[2])
            rows.append(TimetableRow(line, int(cells[0]), int(cells[1]), link[1] if link else ""))
    return tuple(rows)
