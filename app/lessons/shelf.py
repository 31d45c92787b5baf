"""The lessons that there are: a Markdown file each in ``lessons/``."""

import threading
from contextlib import suppress
from functools import lru_cache
from pathlib import Path

from app.lessons.lesson import Lesson, LessonError
from app.lessons.reading import read
from solvers.outside import quoting

FOLDER = Path(__file__).parents[2] / "lessons"
NO_LESSONS = ("README",)
_READING = threading.Lock()


class UnknownLesson(LookupError):
    """There is no lesson of that name; the message says which there are."""


def names(folder: Path = FOLDER) -> list[str]:
    """The names of the lessons, in their order: files are numbered."""
    return sorted(path.stem for path in folder.glob("*.md") if path.stem not in NO_LESSONS)


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
    return read(folder / f"{name}.md")


def lessons(folder: Path = FOLDER) -> dict[str, Lesson]:
    """All lessons by their names, as their files are now, but those with a mistake (``mpm-lab lesson check``)."""
    files = tuple((name, (folder / f"{name}.md").stat().st_mtime_ns) for name in names(folder))
    with _READING:  # a class that comes at once reads them once
        return _read(folder, files)


def after(lesson: Lesson, folder: Path = FOLDER) -> Lesson | None:
    """The lesson that comes next, if there is one."""
    every = list(lessons(folder).values())
    return next(iter(every[every.index(lesson) + 1:]), None) if lesson in every else None


@lru_cache(2)
def _read(folder: Path, files: tuple[tuple[str, int], ...]) -> dict[str, Lesson]:
    """The lessons of files that were last changed then."""
    found = {}
    for name, _ in files:
        with suppress(LessonError):
            found[name] = lesson(name, folder)
    return found
