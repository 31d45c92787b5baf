"""The lessons: one Markdown file each in ``lessons/``, with optional translations."""

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
    """Raised for an unknown lesson; the message lists the known ones."""


def lesson_names(folder: Path = FOLDER) -> list[str]:
    """Returns the names of the lessons in a folder, without suffix and translations, by their numbers: "04-..."."""
    return sorted(path.stem for path in folder.glob("*.md")
                  if path.stem not in NO_LESSONS and Path(path.stem).suffix.removeprefix(".") not in LANGUAGES)


def resolve_lesson_name(name: str, folder: Path = FOLDER) -> str:
    """Returns a lesson's full name, given that, its number or its name without the number. Raises UnknownLesson."""
    known = lesson_names(folder)
    found = [full for full in known if name in (full, *full.split("-", 1))]
    found = found or [full for full in known if full.split("-", 1)[0].lstrip("0") == name]
    if len(found) != 1:
        unknown = f"there is no lesson '{quoting.quote(name)}'; " if name else ""
        raise UnknownLesson(f"{unknown}give one of {', '.join(known)}")
    return found[0]


def load_lesson(name: str, folder: Path = FOLDER) -> Lesson:
    """Reads a lesson by its full name, in the current language if it is translated. Raises :class:`LessonError`."""
    return _localise_lesson(read_lesson(folder / f"{name}.md"), folder)


def load_every_language(name: str, folder: Path = FOLDER) -> Iterator[Lesson]:
    """Yields a lesson, by its full name, in English and in each language with a translated file."""
    for code in LANGUAGES:
        if code == ENGLISH or (folder / f"{name}.{code}.md").is_file():
            with use_language(code):
                found = load_lesson(name, folder)
            yield found


def load_lessons(folder: Path = FOLDER) -> dict[str, Lesson]:
    """Returns the valid lessons in a folder by full name, in the current language; reads changed files again."""
    paths = {name: folder / f"{name}.md" for name in lesson_names(folder)}
    files = tuple((name, path.stat().st_mtime_ns, localised_path(path).stat().st_mtime_ns)
                  for name, path in paths.items())
    with _READING:  # simultaneous visitors read them once
        return _read_lessons(folder, files)


def next_lesson(lesson: Lesson) -> Lesson | None:
    """Returns the lesson after this one, or None."""
    every = list(load_lessons().values())
    return next(iter(every[every.index(lesson) + 1:]), None) if lesson in every else None


@language_cache(4)
def _read_lessons(folder: Path, files: tuple[tuple[str, int, int], ...]) -> dict[str, Lesson]:
    """Returns the valid lessons; ``files`` has name and modification times in ns of a lesson and its translation."""
    found = {}
    for name, *_ in files:
        with suppress(LessonError):
            found[name] = original = read_lesson(folder / f"{name}.md")
            found[name] = _localise_lesson(original, folder)
    return found


def _localise_lesson(original: Lesson, folder: Path) -> Lesson:
    """Returns the lesson's translation into the current language, or ``original`` without one."""
    path = localised_path(folder / f"{original.name}.md")
    return original if path.stem == original.name else translate_lesson(original, path, current_language())


def translate_lesson(original: Lesson, path: Path, language: str) -> Lesson:
    """Returns the ``original`` with the words of the file ``path`` in a language (code), but its own name, steps' keys
    and fingerprint, so that answers are marked in any. Raises :class:`LessonError` if more than words differ."""
    own = read_lesson(path)
    for line, what in _structural_differences(original, own):
        raise LessonError(line, f"{what} differ from {original.name}.md; give the same there, for a translation has "
                                "other words only", path.name)
    steps = (replace(step, key=other.key) for step, other in zip(own.steps, original.steps, strict=True))
    return replace(own, name=original.name, steps=tuple(steps), fingerprint=original.fingerprint, language=language)


def _structural_differences(original: Lesson, own: Lesson) -> Iterator[tuple[int, str]]:
    """Yields where a translation ``own`` differs in more than words: its line, and what differs."""
    for name in ALIKE:
        if getattr(original, name) != getattr(own, name):
            yield 1, f"the {name} of the head"
    if len(own.goals) != len(original.goals):
        yield 1, "the numbers of goals"
    if [(step.kind, step.core) for step in own.steps] != [(step.kind, step.core) for step in original.steps]:
        yield own.steps[0].line, "the kinds of the steps, or which are core,"
        return
    for step, other in zip(own.steps, original.steps, strict=True):
        for name, mine, theirs in zip(("runs", "question", "claims"), _untranslated_parts(step),
                                      _untranslated_parts(other), strict=True):
            if mine != theirs:
                yield step.line, f"of this step the {name}"


def _untranslated_parts(step: Step) -> tuple[Any, Any, Any]:
    """Returns the parts of a step that a translation must repeat: runs with stage and phase, question, claims; without
    lines."""
    asked = step.question and replace(step.question, line=0, options=("",) * len(step.question.options))
    runs = [replace(run, line=0) for run in step.runs], step.stage, step.shown_phase
    return runs, asked, [claim.text for claim in step.claims]
