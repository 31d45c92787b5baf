"""The lessons that there are: a Markdown file each in ``lessons/``, and beside it perhaps one with its words in another
language. What is asked for comes in the language that is spoken, or else in English."""

import threading
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from app.language.spoken import ENGLISH, LANGUAGES, kept, language, localised, speaking
from app.lessons.lesson import Lesson, LessonError
from app.lessons.reading import read
from app.lessons.translation import translated
from solvers.outside import quoting

FOLDER = Path(__file__).parents[2] / "lessons"
NO_LESSONS = ("README",)
_READING = threading.Lock()


class UnknownLesson(LookupError):
    """There is no lesson of that name; the message says which there are."""


def names(folder: Path = FOLDER) -> list[str]:
    """The names of the lessons, in their order: files are numbered."""
    return sorted(path.stem for path in folder.glob("*.md")
                  if path.stem not in NO_LESSONS and Path(path.stem).suffix.removeprefix(".") not in LANGUAGES)


def called(name: str, folder: Path = FOLDER) -> str:
    """The full name of a lesson; its number or its name without the number do as well."""
    known = names(folder)
    found = [full for full in known if name in (full, *full.split("-", 1))]
    found = found or [full for full in known if full.split("-", 1)[0].lstrip("0") == name]
    if len(found) != 1:
        raise UnknownLesson(f"there is no lesson '{quoting.quoted(name)}'; give one of {', '.join(known)}")
    return found[0]


def lesson(name: str, folder: Path = FOLDER) -> Lesson:
    """A lesson by its full name."""
    return _in_its_words(read(folder / f"{name}.md"), folder)


def in_every_language(name: str, folder: Path = FOLDER) -> Iterator[Lesson]:
    """A lesson, and it again in each language that it has been put into."""
    for code in LANGUAGES:
        if code == ENGLISH or (folder / f"{name}.{code}.md").is_file():
            with speaking(code):
                found = lesson(name, folder)
            yield found


def lessons(folder: Path = FOLDER) -> dict[str, Lesson]:
    """All lessons by their names, as their files are now, but those with a mistake (``mpm-lab lesson check``); of a
    translation with one the original."""
    paths = {name: folder / f"{name}.md" for name in names(folder)}
    files = tuple((name, path.stat().st_mtime_ns, localised(path).stat().st_mtime_ns) for name, path in paths.items())
    with _READING:  # a class that comes at once reads them once
        return _read(folder, files)


def after(lesson: Lesson, folder: Path = FOLDER) -> Lesson | None:
    """The lesson that comes next, if there is one."""
    every = list(lessons(folder).values())
    return next(iter(every[every.index(lesson) + 1:]), None) if lesson in every else None


@kept(4)
def _read(folder: Path, files: tuple[tuple[str, int, int], ...]) -> dict[str, Lesson]:
    """The lessons of files that were last changed then."""
    found = {}
    for name, *_ in files:
        with suppress(LessonError):
            found[name] = original = read(folder / f"{name}.md")
            found[name] = _in_its_words(original, folder)
    return found


def _in_its_words(original: Lesson, folder: Path) -> Lesson:
    """In the language that is spoken, if it has been put into that."""
    path = localised(folder / f"{original.name}.md")
    return original if path.stem == original.name else translated(original, path, language())
