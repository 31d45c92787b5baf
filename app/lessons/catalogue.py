"""The lessons: a Markdown file each in ``lessons/``, perhaps with a translation beside it."""

import threading
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

from app.language.translation import ENGLISH, LANGUAGES, current_language, language_cache, localised_path, use_language
from app.lessons.lesson import Lesson, LessonError, Step
from app.lessons.lesson_parser import read_lesson
from solvers.untrusted import quoting

FOLDER = Path(__file__).parents[2] / "lessons"
NO_LESSONS = ("README",)
ALIKE = ("controls", "prerequisites", "variants")  # in every language
_READING = threading.Lock()


class UnknownLesson(LookupError):
    """There is no lesson of that name; the message says which there are."""


def lesson_names(folder: Path = FOLDER) -> list[str]:
    """The names of the lessons, in their order: files are numbered."""
    return sorted(path.stem for path in folder.glob("*.md")
                  if path.stem not in NO_LESSONS and Path(path.stem).suffix.removeprefix(".") not in LANGUAGES)


def resolve_name(name: str, folder: Path = FOLDER) -> str:
    """The full name of a lesson; its number or its name without the number do as well."""
    known = lesson_names(folder)
    found = [full for full in known if name in (full, *full.split("-", 1))]
    found = found or [full for full in known if full.split("-", 1)[0].lstrip("0") == name]
    if len(found) != 1:
        raise UnknownLesson(f"there is no lesson '{quoting.quoted(name)}'; give one of {', '.join(known)}")
    return found[0]


def load_lesson(name: str, folder: Path = FOLDER) -> Lesson:
    """A lesson by its full name."""
    return _in_its_words(read_lesson(folder / f"{name}.md"), folder)


def in_every_language(name: str, folder: Path = FOLDER) -> Iterator[Lesson]:
    """A lesson, and it again in each language that it has been put into."""
    for code in LANGUAGES:
        if code == ENGLISH or (folder / f"{name}.{code}.md").is_file():
            with use_language(code):
                found = load_lesson(name, folder)
            yield found


def load_lessons(folder: Path = FOLDER) -> dict[str, Lesson]:
    """Returns all lessons by name, as their files are now, without those that have a mistake."""
    paths = {name: folder / f"{name}.md" for name in lesson_names(folder)}
    files = tuple((name, path.stat().st_mtime_ns, localised_path(path).stat().st_mtime_ns) for name,
                  path in paths.items())
    with _READING:  # a class that comes at once reads them once
        return _read(folder, files)


def next_lesson(lesson: Lesson, folder: Path = FOLDER) -> Lesson | None:
    """The lesson that comes next, if there is one."""
    every = list(load_lessons(folder).values())
    return next(iter(every[every.index(lesson) + 1:]), None) if lesson in every else None


@language_cache(4)
def _read(folder: Path, files: tuple[tuple[str, int, int], ...]) -> dict[str, Lesson]:
    """The lessons of files that were last changed then."""
    found = {}
    for name, *_ in files:
        with suppress(LessonError):
            found[name] = original = read_lesson(folder / f"{name}.md")
            found[name] = _in_its_words(original, folder)
    return found


def _in_its_words(original: Lesson, folder: Path) -> Lesson:
    """In the language that is spoken, if it has been put into that."""
    path = localised_path(folder / f"{original.name}.md")
    return original if path.stem == original.name else translate_lesson(original, path, current_language())


def translate_lesson(original: Lesson, path: Path, language: str) -> Lesson:
    """The ``original`` in the words of a file. It keeps its name, its steps' keys and its fingerprint, so that what has
    been answered in one language is marked in any.

    Raises :class:`LessonError` where the file has a mistake, or differs in more than words.
    """
    own = read_lesson(path)
    for line, what in _differences(original, own):
        raise LessonError(line, f"{what} differ from {original.name}.md; give the same there, for a translation has "
                                "other words only", path.name)
    steps = (replace(step, key=other.key) for step, other in zip(own.steps, original.steps, strict=True))
    return replace(own, name=original.name, steps=tuple(steps), fingerprint=original.fingerprint, language=language)


def _differences(original: Lesson, own: Lesson) -> Iterator[tuple[int, str]]:
    """In which line of the translation what differs."""
    for name in ALIKE:
        if getattr(original, name) != getattr(own, name):
            yield 1, f"the {name} of the head"
    if len(own.goals) != len(original.goals):
        yield 1, "the numbers of goals"
    if [(step.kind, step.core) for step in own.steps] != [(step.kind, step.core) for step in original.steps]:
        yield own.steps[0].line, "the kinds of the steps, or which are core,"
        return
    for step, other in zip(own.steps, original.steps, strict=True):
        for name, mine, theirs in zip(("runs", "question", "claims"), _fixed(step), _fixed(other), strict=True):
            if mine != theirs:
                yield step.line, f"of this step the {name}"


def _fixed(step: Step) -> tuple[Any, Any, Any]:
    """What of a step is no words."""
    asked = step.question and replace(step.question, line=0, options=("",) * len(step.question.options))
    return ([replace(run, line=0) for run in step.runs], step.stage), asked, [claim.text for claim in step.claims]
