"""``mpm-lab lesson list|check|guide|grade``: commands for lessons, without the page."""

import os
from collections.abc import Callable, Iterable, Sequence, Sized
from contextlib import closing
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar, TypeVar

import tyro

from app.commands import lenient_flag_types
from app.commands.output import OutputFolder, OutputTarget, json_target, print_message, put_result, put_text
from app.commands.progress import show_progress
from app.language.translation import ENGLISH, LANGUAGES, use_language
from app.lessons.lesson import Lesson, LessonError
from solvers.scene.validation import require_choice, require_whole
from solvers.untrusted.quoting import file_name
from solvers.workers.cpu_count import default_processes

if TYPE_CHECKING:
    from app.lessons.student_progress import StudentProgress

Read = TypeVar("Read")
OK, FAILED, BAD_INPUT = 0, 1, 2
MOST_CHARACTERS = 1_000_000  # of a file; usual ones have some thousand
CHECKS_SCHEMA = "mpm-lab/lesson-check/1"


@dataclass(frozen=True)
class LessonList:
    """List the lessons: name, minutes of the core and in all, title.

    Minutes are computed from what a lesson holds, by one rule for all (lessons/README.md).
    Exit status: 0 ok, 2 a lesson's file has a mistake, which is told."""

    EXAMPLE: ClassVar[str] = "mpm-lab lesson list"

    def execute(self) -> int:
        from app.lessons import catalogue
        from app.lessons.duration import minutes_text
        lessons, mistakes = _read_lessons((), lambda name: [catalogue.load_lesson(name)])
        rows = [(lesson.name, minutes_text(lesson), lesson.title) for lesson in lessons]
        names, times = (max((len(row[column]) for row in rows), default=0) for column in (0, 1))
        for name, time, title in rows:
            put_text(f"{name:<{names}}  {time:<{times}}  {title}\n")
        return BAD_INPUT if mistakes else OK


@dataclass(frozen=True)
class LessonCheck:
    """Run every scene of lessons and check every claim, headless, in every language that they have.

    So are the pages for a class in lessons/classes/, of which the timetables are added up and held against the cores.
    Exit status: 0 all claims hold, 1 one does not, 2 bad input, or a lesson's file has a mistake (the others are
    checked)."""

    EXAMPLE: ClassVar[str] = "mpm-lab lesson check 4 --variants 1"

    names: Annotated[lenient_flag_types.NamesFlag, tyro.conf.Positional, lenient_flag_types.default_hint("all")] = ()
    """Lessons, by name or number, and pages for a class, by name."""
    variants: Annotated[lenient_flag_types.NumberFlag, lenient_flag_types.default_hint("all")] = None
    """How many of each lesson's sets of numbers are tried."""
    processes: lenient_flag_types.ProcessesFlag = None
    """Processes that run scenes."""
    json: Annotated[lenient_flag_types.PathFlag,
                    lenient_flag_types.default_hint("failures and a count are printed instead")] = None
    """File for every check as JSON; - is standard output."""
    quiet: Annotated[lenient_flag_types.Switch, lenient_flag_types.default_hint("off")] = False
    """No progress bar."""

    def execute(self) -> int:
        processes = lenient_flag_types.process_count(self.processes)
        if self.variants is not None:
            require_whole("variants", self.variants, 1, 1000)
        target = json_target(self.json)
        from app.lessons import catalogue, class_plans
        from app.lessons.lesson_check import check_lesson
        from app.lessons.lesson_runs import RunCache, scene_texts
        known = class_plans.class_plan_names()
        others = tuple(name for name in self.names if name not in known)
        lessons, mistakes = (_read_lessons(others, catalogue.load_every_language, known) if others or not self.names
                             else ([], {}))
        pages = _read_each([name for name in known if name in (self.names or known)], class_plans.load_class_plan,
                           mistakes)
        with show_progress(self.quiet) as show, closing(RunCache(processes)) as outcomes:
            texts = [text for lesson in (*lessons, *(page.claims for page in pages))
                     for numbers in lesson.variants[:self.variants] for text in scene_texts(lesson, numbers)]
            outcomes.prepare(texts, lambda done, total: show(done / total))
            found = [check for lesson in lessons for check in check_lesson(lesson, outcomes, self.variants)]
            found += [check for page in pages
                      for check in class_plans.check_class_plan(page, catalogue.load_lessons(), outcomes)]
        failed = [check for check in found if not check.holds]
        for check in failed:
            print_message(check)
        names = list(dict.fromkeys(lesson.name for lesson in lessons))
        read = [_count_text(names)] * bool(names) + [_count_text(pages, "page", " for a class")] * bool(pages)
        told = ", ".join((*read, f"{len(found)} checks", f"{len(failed)} failed")) if read else "nothing was checked"
        told += f"; {_count_text(mistakes, 'file')} could not be read" if mistakes else ""
        values = {"schema": CHECKS_SCHEMA, "lessons": names, "classes": [page.name for page in pages],
                  "checks": [vars(check) for check in found], "not_read": mistakes}
        put_result(values, target, lambda _: told)
        return BAD_INPUT if mistakes else FAILED if failed else OK


@dataclass(frozen=True)
class LessonTeacherGuide:
    """Write the teacher's guide to a lesson: steps, notes and right answers.

    Exit status: 0 ok, 1 could not run or write, 2 bad input, or the lesson's file has a mistake."""

    EXAMPLE: ClassVar[str] = "mpm-lab lesson guide 4 --out guide.html"

    name: Annotated[lenient_flag_types.TextFlag, tyro.conf.Positional] = ""
    """Lesson, by name or number."""
    out: Annotated[lenient_flag_types.PathFlag, lenient_flag_types.default_hint("Markdown on standard output")] = None
    """File for the guide: .md, or .html to read and print."""
    core: Annotated[lenient_flag_types.Switch, lenient_flag_types.default_hint("off")] = False
    """Of the core alone, without the deeper steps."""
    lang: lenient_flag_types.TextFlag = ENGLISH
    """Language: en or de; of a lesson that is not in it all but the lesson."""
    quiet: Annotated[lenient_flag_types.Switch, lenient_flag_types.default_hint("off")] = False
    """No progress bar."""

    def execute(self) -> int:
        require_choice("lang", self.lang, tuple(LANGUAGES))
        from app.lessons import catalogue, teacher_guide
        from app.lessons.lesson_runs import RunCache
        ending = "" if self.out is None else next((kind for kind in teacher_guide.KINDS if self.out.endswith(kind)), "")
        if self.out is not None and not ending:
            raise lenient_flag_types.BadInput("out", self.out,
                                              f"give a file that ends in {' or '.join(teacher_guide.KINDS)}")
        target = None if self.out is None else OutputTarget("out", self.out)
        with use_language(self.lang):
            lessons, _ = _read_lessons((self.name,), lambda name: [catalogue.load_lesson(name)])
            if not lessons:
                return BAD_INPUT
            with show_progress(self.quiet), closing(RunCache(1)) as outcomes:
                text = teacher_guide.KINDS[ending or ".md"](lessons[0], outcomes, self.core)
        put_text(text, target)
        return OK


@dataclass(frozen=True)
class LessonGrade:
    """Make one table of handed-in files, every mark derived anew from the runs.

    An interval counts 1 - score/2 of a right answer, but never less than nothing. Its score is its width in factors of
    ten, and ten times as much (at a level of 0.8) for what it misses by; so width costs, and so does luck that fails.
    Exit status: 0 ok, 1 a file could not be read or is no file of answers, 2 bad input."""

    EXAMPLE: ClassVar[str] = "mpm-lab lesson grade answers-*.json --out marks.csv"

    files: Annotated[lenient_flag_types.FilesFlag, tyro.conf.Positional] = ()
    """Files that the page has saved."""
    out: Annotated[lenient_flag_types.PathFlag, lenient_flag_types.default_hint("standard output")] = None
    """File for the table, .csv."""
    core: Annotated[lenient_flag_types.Switch, lenient_flag_types.default_hint("off")] = False
    """Count the questions of the core alone, for a class that was asked for no more."""
    quiet: Annotated[lenient_flag_types.Switch, lenient_flag_types.default_hint("off")] = False
    """No progress bar."""

    def execute(self) -> int:
        if not self.files:
            raise lenient_flag_types.BadInput("", "", "give the files that students have handed in")
        target = None if self.out is None else OutputTarget("out", self.out, ending=".csv")
        from app.lessons import catalogue, grading
        from app.lessons.lesson_runs import RunCache
        read = [answers for file in self.files if (answers := _read_answers(file)) is not None]
        lessons = catalogue.load_lessons()
        with show_progress(self.quiet) as show, closing(RunCache(default_processes())) as outcomes:
            rows = []
            for done, (file, found) in enumerate(read):
                show(done / len(read))
                rows.append(grading.grade_file(file, found, lessons[found.lesson], outcomes, self.core))
        put_text(grading.grades_csv(rows), target, "utf-8-sig")  # so that spreadsheets recognise the encoding
        for sentence in () if self.quiet else grading.interval_coverage(rows):
            print_message(sentence)
        return OK if len(read) == len(self.files) else FAILED


@dataclass(frozen=True)
class LessonScriptsCopy:
    """Copy the scripts and notebooks that go with the lessons into a folder, to run and to change.

    Exit status: 0 ok, 1 could not write, 2 bad input."""

    EXAMPLE: ClassVar[str] = "mpm-lab lesson scripts --out scripts"

    out: Annotated[lenient_flag_types.PathFlag, lenient_flag_types.default_hint("none, it must be given")] = None
    """Directory for them, new or empty."""

    def execute(self) -> int:
        folder = OutputFolder(self.out)
        from app.lessons import catalogue
        for path in sorted(path for part in ("scripts", "scripts/codes", "notebooks")
                           for path in catalogue.FOLDER.glob(f"{part}/*.py")):
            folder.write_file(path.name, path.read_bytes())
        print_message(f"{folder.text}: begin with bar.py")
        return OK


def _read_answers(file: str) -> "tuple[str, StudentProgress] | None":
    """Returns the name of a file, without folders, and its answers; None, with a printed message, if it has none."""
    from app.lessons import catalogue, student_progress
    try:
        if os.path.exists(file) and not os.path.isfile(file):  # a pipe would block
            raise student_progress.InvalidProgress("is not a file; give files that the page has saved")
        with open(file, encoding="utf-8-sig") as opened:
            text = opened.read(MOST_CHARACTERS + 1)
        if len(text) > MOST_CHARACTERS:
            raise student_progress.InvalidProgress(f"is too long; give a file of at most {MOST_CHARACTERS:,} "
                                                   "characters")
        return file_name(file), student_progress.parse_progress(text, catalogue.load_lessons().get)
    except (OSError, ValueError) as error:  # also NotAnswers, and invalid UTF-8
        said = error.strerror.lower() if isinstance(error, OSError) and error.strerror else \
            "is no text" if isinstance(error, UnicodeDecodeError) else str(error)
        print_message(lenient_flag_types.BadInput("", file_name(file), said))
        return None


def _count_text(some: Sized, one: str = "lesson", more: str = "") -> str:
    return f"{len(some)} {one}{'s' * (len(some) != 1)}{more}"


def _read_lessons(names: tuple[str, ...], find: Callable[[str], Iterable[Lesson]],
                  other_names: Sequence[str] = ()) -> tuple[list[Lesson], dict[str, str]]:
    """Returns the lessons that ``find`` has for each name, of all if none is given, and by name the mistakes in files,
    which are printed; raises BadInput for an unknown name, which lists ``other_names`` too."""
    from app.lessons import catalogue
    lessons, mistakes = list[Lesson](), dict[str, str]()
    called = dict.fromkeys(full_lesson_name(name, other_names) for name in names) if names else catalogue.lesson_names()
    _read_each(called, lambda name: lessons.extend(find(name)), mistakes)  # keeps it without its translation
    return lessons, mistakes


def _read_each(names: Iterable[str], read: Callable[[str], Read], mistakes: dict[str, str]) -> list[Read]:
    """Returns what ``read`` makes of each name; prints a mistake in a file, and stores it in ``mistakes`` by name."""
    found = []
    for name in names:
        try:
            found.append(read(name))
        except LessonError as error:
            print_message(error)
            mistakes[name] = str(error)
    return found


def full_lesson_name(name: str, other_names: Sequence[str] = ()) -> str:
    """Returns the full name of a lesson by name or number; raises BadInput, with all valid names, if there is none."""
    from app.lessons import catalogue
    try:
        return catalogue.resolve_lesson_name(name)
    except catalogue.UnknownLesson as error:
        raise lenient_flag_types.BadInput("", name, ", ".join((str(error), *other_names))) from None
