"""``mpm-lab lesson list|check|guide|grade``: lessons without a page."""

import os
from collections.abc import Callable, Iterable, Sized
from contextlib import closing
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar

import tyro

from app.commands.flags import BadInput, FilesFlag, NamesFlag, NumberFlag, PathFlag, Switch, TextFlag, default_hint
from app.commands.output import Target, json_target, put_result, put_text, say
from app.commands.progress import working
from app.language.spoken import ENGLISH, LANGUAGES, speaking
from app.lessons.lesson import Lesson, LessonError
from solvers.outside.quoting import file_name
from solvers.scene.rules import require_choice, require_whole

if TYPE_CHECKING:
    from app.lessons.progress import Progress

OK, FAILED, BAD_INPUT = 0, 1, 2
MOST_CHARACTERS = 1_000_000  # of a file; an honest one has some thousand
CHECKS_SCHEMA = "mpm-lab/lesson-check/1"


@dataclass(frozen=True)
class LessonList:
    """List the lessons: name, minutes and title.

    Exit status: 0 ok, 2 a lesson's file has a mistake, which is told.
    """

    EXAMPLE: ClassVar[str] = "mpm-lab lesson list"

    def execute(self) -> int:
        from app.lessons import shelf
        lessons, mistakes = _read((), lambda name: [shelf.lesson(name)])
        width = max(map(len, shelf.names()), default=0)
        for lesson in lessons:
            put_text(f"{lesson.name:<{width}}  {lesson.minutes:>3} min  {lesson.title}\n")
        return BAD_INPUT if mistakes else OK


@dataclass(frozen=True)
class LessonCheck:
    """Run every scene of lessons and check every claim, headless, in every language that they have.

    Exit status: 0 all claims hold, 1 one does not, 2 bad input, or a lesson's file has a mistake (the others are
    checked).
    """

    EXAMPLE: ClassVar[str] = "mpm-lab lesson check 4 --variants 1"

    names: Annotated[NamesFlag, tyro.conf.Positional, default_hint("all lessons")] = ()
    """Lessons, by name or number."""
    variants: Annotated[NumberFlag, default_hint("all")] = None
    """How many of each lesson's sets of numbers are tried."""
    processes: NumberFlag = 2
    """Processes that run scenes."""
    json: Annotated[PathFlag, default_hint("failures and a count are printed instead")] = None
    """File for every check as JSON; - is standard output."""
    quiet: Annotated[Switch, default_hint("off")] = False
    """No progress bar."""

    def execute(self) -> int:
        require_whole("processes", self.processes, 1, 64)
        if self.variants is not None:
            require_whole("variants", self.variants, 1, 1000)
        target = json_target(self.json)
        from app.lessons import shelf
        from app.lessons.checking import checks
        from app.lessons.outcomes import Outcomes, scene_texts
        lessons, mistakes = _read(self.names, shelf.in_every_language)
        with working(self.quiet) as show, closing(Outcomes(self.processes)) as outcomes:
            texts = [text for lesson in lessons for numbers in lesson.variants[:self.variants]
                     for text in scene_texts(lesson, numbers)]
            outcomes.prepare(texts, lambda done, total: show(done / total))
            found = [check for lesson in lessons for check in checks(lesson, outcomes, self.variants)]
        failed = [check for check in found if not check.holds]
        for check in failed:
            say(check)
        names = list(dict.fromkeys(lesson.name for lesson in lessons))
        told = f"{_count(names)}, {len(found)} checks, {len(failed)} failed" if lessons else "nothing was checked"
        told += f"; {_count(mistakes)} could not be read" if mistakes else ""
        put_result({"schema": CHECKS_SCHEMA, "lessons": names,
                    "checks": [vars(check) for check in found], "not_read": mistakes}, target, lambda _: told)
        return BAD_INPUT if mistakes else FAILED if failed else OK


@dataclass(frozen=True)
class LessonGuide:
    """Write the teacher's guide to a lesson: steps, notes and right answers.

    Exit status: 0 ok, 1 could not run or write, 2 bad input, or the lesson's file has a mistake.
    """

    EXAMPLE: ClassVar[str] = "mpm-lab lesson guide 4 --out guide.html"

    name: Annotated[TextFlag, tyro.conf.Positional] = ""
    """Lesson, by name or number."""
    out: Annotated[PathFlag, default_hint("Markdown on standard output")] = None
    """File for the guide: .md, or .html to read and print."""
    lang: TextFlag = ENGLISH
    """Language: en or de; of a lesson that is not in it all but the lesson."""
    quiet: Annotated[Switch, default_hint("off")] = False
    """No progress bar."""

    def execute(self) -> int:
        require_choice("lang", self.lang, tuple(LANGUAGES))
        from app.lessons import guide, shelf
        from app.lessons.outcomes import Outcomes
        ending = "" if self.out is None else next((kind for kind in guide.KINDS if self.out.endswith(kind)), "")
        if self.out is not None and not ending:
            raise BadInput("out", self.out, f"give a file that ends in {' or '.join(guide.KINDS)}")
        target = None if self.out is None else Target("out", self.out)
        with speaking(self.lang):
            lessons, _ = _read((self.name,), lambda name: [shelf.lesson(name)])
            if not lessons:
                return BAD_INPUT
            with working(self.quiet), closing(Outcomes(1)) as outcomes:
                text = guide.KINDS[ending or ".md"](lessons[0], outcomes)
        put_text(text, target)
        return OK


@dataclass(frozen=True)
class LessonGrade:
    """Make one table of handed-in files, every mark derived anew from the runs.

    Exit status: 0 ok, 1 a file could not be read or is no file of answers, 2 bad input.
    """

    EXAMPLE: ClassVar[str] = "mpm-lab lesson grade answers-*.json --out marks.csv"

    files: Annotated[FilesFlag, tyro.conf.Positional] = ()
    """Files that the page has saved."""
    out: Annotated[PathFlag, default_hint("standard output")] = None
    """File for the table, .csv."""
    quiet: Annotated[Switch, default_hint("off")] = False
    """No progress bar."""

    def execute(self) -> int:
        if not self.files:
            raise BadInput("", "", "give the files that students have handed in")
        target = None if self.out is None else Target("out", self.out, ending=".csv")
        from app.lessons import grading, shelf
        from app.lessons.outcomes import Outcomes
        read = [answers for file in self.files if (answers := _answers(file)) is not None]
        lessons = shelf.lessons()
        with working(self.quiet) as show, closing(Outcomes(2)) as outcomes:
            rows = []
            for done, (file, found) in enumerate(read):
                show(done / len(read))
                rows.append(grading.graded(file, found, lessons[found.lesson], outcomes))
        put_text(grading.table(rows), target, "utf-8-sig")  # by which a spreadsheet knows the characters
        for sentence in () if self.quiet else grading.coverage(rows):
            say(sentence)
        return OK if len(read) == len(self.files) else FAILED


def _answers(file: str) -> "tuple[str, Progress] | None":
    """What a file says; None where it cannot be read, which is told."""
    from app.lessons import progress, shelf
    try:
        if os.path.exists(file) and not os.path.isfile(file):  # a pipe would be waited for
            raise progress.NotAnswers("is not a file; give files that the page has saved")
        with open(file, encoding="utf-8") as opened:
            text = opened.read(MOST_CHARACTERS + 1)
        if len(text) > MOST_CHARACTERS:
            raise progress.NotAnswers(f"is too long; give a file of at most {MOST_CHARACTERS:,} characters")
        return file_name(file), progress.read(text, shelf.lessons().get)
    except (OSError, ValueError) as error:  # also progress.NotAnswers, and what is no UTF-8
        said = error.strerror.lower() if isinstance(error, OSError) and error.strerror else \
            "is no text" if isinstance(error, UnicodeDecodeError) else str(error)
        say(BadInput("", file_name(file), said))
        return None


def _count(lessons: Sized) -> str:
    return f"{len(lessons)} lesson{'s' * (len(lessons) != 1)}"


def _read(names: tuple[str, ...], find: Callable[[str], Iterable[Lesson]]) -> tuple[list[Lesson], dict[str, str]]:
    """The lessons of these names, or all, as one ``find``s them, and by name what is wrong with those that cannot be
    read, which is told."""
    from app.lessons import shelf
    lessons, mistakes = list[Lesson](), dict[str, str]()
    for name in dict.fromkeys(map(lesson_called, names)) if names else shelf.names():
        try:
            lessons += find(name)
        except LessonError as error:
            say(error)
            mistakes[name] = str(error)
    return lessons, mistakes


def lesson_called(name: str) -> str:
    """The full name of a lesson; raises :class:`BadInput` where there is none."""
    from app.lessons import shelf
    try:
        return shelf.called(name)
    except shelf.UnknownLesson as error:
        raise BadInput("", name, str(error)) from None
